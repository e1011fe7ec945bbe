//! Random primitives with lengths from a lattice, as the constructors make them.

use std::sync::Arc;

use octray_geometry::profile::{Outline, Region};
use octray_geometry::{ConvexPolyhedron, Polynomial, ShapeError, Solid};
use octray_math::{DVec2, DVec3};

use super::Lattice;
use crate::draw::Draw;

/// A primitive in its own frame.
pub(super) fn primitive(draw: &mut Draw, lattice: Lattice) -> Solid {
    let kind = draw.weighted(&[8, 12, 8, 2, 8, 6, 4, 4, 3, 1, 2, 2, 2]);
    loop {
        let made = match kind {
            0 => Solid::sphere(lattice.length(draw)),
            1 => {
                let corner = point(draw, lattice);
                let size = DVec3::new(
                    lattice.length(draw),
                    lattice.length(draw),
                    lattice.length(draw),
                );
                Solid::cuboid(corner, corner + size)
            }
            2 => {
                let z = lattice.coordinate(draw);
                Solid::cylinder(lattice.length(draw), z, z + lattice.length(draw))
            }
            3 => Solid::infinite_cylinder(lattice.length(draw)),
            4 => cone(draw, lattice),
            5 => Solid::torus(lattice.length(draw), lattice.length(draw)),
            6 => {
                let normal = direction(draw);
                Solid::half_space(normal, lattice.coordinate(draw))
            }
            7 => convex(draw, lattice),
            8 => quadric(draw),
            9 => quartic(draw),
            11 => {
                let (region, z) = (region(draw, lattice, true), lattice.coordinate(draw));
                let scale = draw.pick(&[[1.0, 1.0], [1.0, 0.5], [0.0, 1.0]]);
                let z = [z, z + lattice.length(draw)];
                region.and_then(|region| Solid::tapered_prism(&region, z, scale))
            }
            12 => region(draw, lattice, false).and_then(|region| Solid::lathe(&region)),
            _ => {
                let exponents = [0.1, 0.5, 0.8, 1.0, 1.5, 2.0];
                Solid::superellipsoid(draw.pick(&exponents), draw.pick(&exponents))
            }
        };
        // Nudged numbers may leave an edge without length: then once more.
        if let Ok(solid) = made {
            return solid;
        }
    }
}

fn point(draw: &mut Draw, lattice: Lattice) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| lattice.coordinate(draw)))
}

/// An axis, a diagonal, a small whole vector or any direction.
fn direction(draw: &mut Draw) -> DVec3 {
    if draw.chance(0.15) {
        return draw.direction();
    }
    loop {
        let v: [f64; 3] = std::array::from_fn(|_| f64::from(draw.whole(-1, 1)));
        let v = DVec3::from_array(v);
        if v != DVec3::ZERO {
            return v;
        }
    }
}

/// Mostly parts of a few cones, so that mantles coincide: radius `k step` at height 0, changing by
/// `slope` per height, cut at heights of the lattice.
fn cone(draw: &mut Draw, lattice: Lattice) -> Result<Solid, ShapeError> {
    if draw.chance(0.3) {
        let z = lattice.coordinate(draw);
        let ends = [lattice.length(draw), lattice.length(draw)];
        let narrow = draw.pick(&[0.0, 1.0, 1.0 - 1e-9, 0.5]) * ends[1];
        return Solid::cone(ends[0], narrow, z, z + lattice.length(draw));
    }
    let slope = draw.pick(&[-1.0, -0.5, 1.0, 0.5]);
    let start = 2.0 * lattice.step;
    let radius = |z: f64| start + slope * z;
    let apex = -start / slope;
    let z = [lattice.coordinate(draw), lattice.coordinate(draw)];
    let z = if draw.chance(0.4) { [z[0], apex] } else { z };
    let z = [z[0].min(z[1]), z[0].max(z[1])];
    Solid::cone(radius(z[0]).max(0.0), radius(z[1]).max(0.0), z[0], z[1])
}

/// A prism or pyramid over a polygon of the lattice.
fn convex(draw: &mut Draw, lattice: Lattice) -> Result<Solid, ShapeError> {
    let step = lattice.step;
    let outline: &[[f64; 2]] = draw.pick(&[
        &[[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]][..],
        &[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 2.0], [0.0, 2.0]][..],
        &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][..],
    ]);
    let n = outline.len() as u32;
    let (bottom, height) = (lattice.coordinate(draw), lattice.length(draw));
    let at = |p: &[f64; 2], z: f64| DVec3::new(p[0] * step, p[1] * step, z);
    let mut vertices: Vec<DVec3> = outline.iter().map(|p| at(p, bottom)).collect();
    let mut faces = vec![(0..n).rev().collect::<Vec<u32>>()];
    if draw.chance(0.5) {
        vertices.extend(outline.iter().map(|p| at(p, bottom + height)));
        faces.push((n..2 * n).collect());
        faces.extend((0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]));
    } else {
        vertices.push(at(&draw.pick(outline), bottom + height));
        // The sides at the corner under the apex stand upright and may be flat: left to the check.
        faces.extend((0..n).map(|i| vec![i, (i + 1) % n, n]));
    }
    let polyhedron = ConvexPolyhedron::from_faces(vertices, &faces)?;
    Ok(Solid::convex(Arc::new(polyhedron)))
}

/// Any quadric with small coefficients, most of them 0.
fn quadric(draw: &mut Draw) -> Result<Solid, ShapeError> {
    let coefficients = std::array::from_fn(|i| {
        let often = if i < 3 { 0.8 } else { 0.2 };
        if draw.chance(often) {
            0.5 * f64::from(draw.whole(-2, 2))
        } else {
            0.0
        }
    });
    Solid::quadric(coefficients)
}

/// A cubic or quartic with small coefficients, most of them 0.
fn quartic(draw: &mut Draw) -> Result<Solid, ShapeError> {
    let (degree, count) = draw.pick(&[(3, 20), (4, 35), (4, 35)]);
    let coefficients: Vec<f64> = (0..count)
        .map(|_| match draw.weighted(&[4, 1]) {
            0 => 0.0,
            _ => f64::from(draw.whole(-2, 2)),
        })
        .collect();
    Solid::polynomial(Polynomial::new(degree, &coefficients)?)
}

/// A concave polygon of the lattice, or a square with a square or a round hole; right of the axis
/// unless it may be anywhere. Outlines do not cross: those become one surface of degree n.
fn region(draw: &mut Draw, lattice: Lattice, anywhere: bool) -> Result<Region, ShapeError> {
    let corners: &[[f64; 2]] = draw.pick(&[
        &[
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ][..],
        &[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 1.0]][..],
        &[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.0, 2.0], [0.0, 3.0]][..],
        &[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]][..],
    ]);
    let shift = |draw: &mut Draw| lattice.step * f64::from(draw.whole(0, 3));
    let mut at = DVec2::new(shift(draw), shift(draw));
    if anywhere {
        at -= DVec2::splat(2.0 * lattice.step);
    }
    let place = |p: &[f64; 2]| at + DVec2::from_array(*p) * lattice.step;
    let outline: Vec<DVec2> = corners.iter().map(place).collect();
    let mut outlines = vec![Outline::polygon(&outline)];
    if corners[1..] == [[3.0, 0.0], [3.0, 3.0], [0.0, 3.0]] {
        if draw.chance(0.5) {
            outlines.push(Outline::circle(place(&[1.5, 2.0]), 0.5 * lattice.step));
        } else {
            let hole = [[0.5, 0.5], [2.5, 1.0], [2.0, 2.5], [1.0, 1.0]];
            outlines.push(Outline::polygon(&hole.map(|p| place(&p))));
        }
    }
    Region::new(&outlines)
}
