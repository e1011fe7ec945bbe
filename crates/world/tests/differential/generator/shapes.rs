//! Random primitives with lengths from a lattice, as the constructors make them.

use std::sync::Arc;

use octray_geometry::{ConvexPolyhedron, Solid};
use octray_math::DVec3;

use super::Lattice;
use crate::draw::Draw;

/// A primitive in its own frame.
pub(super) fn primitive(draw: &mut Draw, lattice: Lattice) -> Solid {
    let kind = draw.weighted(&[4, 6, 4, 1, 4, 3, 2, 2]);
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
            _ => convex(draw, lattice),
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
fn cone(draw: &mut Draw, lattice: Lattice) -> Result<Solid, octray_geometry::ShapeError> {
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
fn convex(draw: &mut Draw, lattice: Lattice) -> Result<Solid, octray_geometry::ShapeError> {
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
