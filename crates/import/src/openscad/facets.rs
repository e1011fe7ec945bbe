//! The polyhedra OpenSCAD makes of round shapes.
//!
//! Rules from the OpenSCAD User Manual (`$fa`, `$fs`, `$fn`; corners start on the x axis) and the
//! behaviour of OpenSCAD 2021.01: the rings of a sphere lie in the middles of equal steps of the
//! polar angle, so it has flat caps and no poles.

use octray_geometry::ConvexPolyhedron;
use octray_math::transform::sin_cos_degrees;
use octray_math::{DVec2, DVec3};

/// Below this radius OpenSCAD makes triangles (its grid of 2^-20).
const FINEST_RADIUS: f64 = 1.0 / (1 << 20) as f64;

/// OpenSCAD's three special variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Resolution {
    /// `$fn`: number of fragments of a circle, 0 to decide by the others.
    pub(super) count: f64,
    /// `$fa`: smallest angle of a fragment in degrees.
    pub(super) angle: f64,
    /// `$fs`: smallest length of a fragment.
    pub(super) size: f64,
}

impl Resolution {
    /// Whether the author asked for a polyhedron rather than for something round.
    pub(super) fn is_explicit(&self) -> bool {
        self.count > 0.0 || self.count.is_nan()
    }

    /// The number of corners of a circle of this radius, at least 3.
    pub(super) fn fragments(&self, radius: f64) -> usize {
        // Also true of radii and counts that are not numbers.
        if !(radius >= FINEST_RADIUS && self.count.is_finite()) {
            return 3;
        }
        if self.count > 0.0 {
            return self.count.max(3.0) as usize;
        }
        // OpenSCAD raises both to 0.01 before it divides.
        let by_angle = 360.0 / self.angle.max(0.01);
        let by_size = radius * std::f64::consts::TAU / self.size.max(0.01);
        libm::ceil(by_angle.min(by_size).max(5.0)) as usize
    }
}

/// The number of rings of a sphere with this many fragments.
pub(super) const fn rings(fragments: usize) -> usize {
    fragments.div_ceil(2)
}

/// Corners of a circle about the origin, counter-clockwise from the x axis.
pub(super) fn circle(radius: f64, fragments: usize) -> impl Iterator<Item = DVec2> {
    (0..fragments).map(move |index| {
        let (sin, cos) = sin_cos_degrees(360.0 * index as f64 / fragments as f64);
        DVec2::new(radius * cos, radius * sin)
    })
}

/// OpenSCAD's sphere; `None` if it is too small for its faces to have normals.
pub(super) fn sphere(radius: f64, fragments: usize) -> Option<ConvexPolyhedron> {
    let rings = rings(fragments);
    let layers = (0..rings).map(|ring| {
        let polar = 180.0 * (ring as f64 + 0.5) / rings as f64;
        let (sin, cos) = sin_cos_degrees(polar);
        (radius * sin, radius * cos)
    });
    layered(&layers.collect::<Vec<_>>(), fragments)
}

/// OpenSCAD's cylinder, frustum or cone: radius `radii[0]` at `z[0]` below `z[1]`.
pub(super) fn frustum(radii: [f64; 2], z: [f64; 2], fragments: usize) -> Option<ConvexPolyhedron> {
    layered(&[(radii[1], z[1]), (radii[0], z[0])], fragments)
}

/// Regular polygons `(radius, z)` stacked from the top to the bottom, with planes between them.
///
/// The planes at the ends are exactly `z = const`; radius 0 at an end is a point without plane.
fn layered(layers: &[(f64, f64)], fragments: usize) -> Option<ConvexPolyhedron> {
    let (top, bottom) = (layers.first()?, layers.last()?);
    let mut planes = Vec::with_capacity(fragments * (layers.len() - 1) + 2);
    let mut vertices = Vec::with_capacity(fragments * layers.len());
    if top.0 > 0.0 {
        planes.push((DVec3::Z, top.1));
    }
    if bottom.0 > 0.0 {
        planes.push((DVec3::NEG_Z, -bottom.1));
    }
    let unit: Vec<DVec2> = circle(1.0, fragments).collect();
    let corner = |layer: (f64, f64), index: usize| (unit[index] * layer.0).extend(layer.1);
    for &layer in layers {
        let corners = if layer.0 > 0.0 { fragments } else { 1 };
        vertices.extend((0..corners).map(|index| corner(layer, index)));
    }
    for pair in layers.windows(2) {
        let [upper, lower] = [pair[0], pair[1]];
        for index in 0..fragments {
            let next = (index + 1) % fragments;
            // Twice the area vector of the trapezoid is the cross product of its diagonals; it
            // holds for triangles too, where two corners are one point.
            let diagonals = [
                corner(upper, next) - corner(lower, index),
                corner(upper, index) - corner(lower, next),
            ];
            let area = diagonals[0].cross(diagonals[1]);
            let normal = (area / area.abs().max_element()).try_normalize()?;
            let wide = if upper.0 > lower.0 { upper } else { lower };
            planes.push((normal, normal.dot(corner(wide, index))));
        }
    }
    Some(ConvexPolyhedron { planes, vertices })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by(count: f64, angle: f64, size: f64) -> Resolution {
        Resolution { count, angle, size }
    }

    #[test]
    fn fragments_follow_the_manual() {
        // Manual: 360 / $fa and 2 pi r / $fs, whichever is fewer, at least 5; $fn overrides, at
        // least 3.
        assert_eq!(by(0.0, 12.0, 2.0).fragments(10.0), 30);
        assert_eq!(by(0.0, 12.0, 2.0).fragments(5.0), 16);
        assert_eq!(by(0.0, 12.0, 2.0).fragments(1.0), 5);
        assert_eq!(by(0.0, 5.0, 0.1).fragments(10.0), 72);
        assert_eq!(by(19.7, 12.0, 2.0).fragments(10.0), 19);
        assert_eq!(by(0.1, 12.0, 2.0).fragments(5.0), 3);
        assert_eq!(by(f64::INFINITY, 12.0, 2.0).fragments(5.0), 3);
        assert_eq!(by(8.0, 12.0, 2.0).fragments(1e-7), 3);
        assert_eq!(by(0.0, 0.0, 0.0).fragments(1e9), 36_000);
    }

    #[test]
    fn corners_are_where_openscad_puts_them() {
        let square: Vec<DVec2> = circle(2.0, 4).collect();
        assert_eq!(
            square,
            [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(|v| v * 2.0)
        );
        // sphere(r = 1, $fn = 4) of OpenSCAD 2021.01: two rings at 45 and 135 degrees.
        let ball = sphere(1.0, 4).expect("a polyhedron");
        assert_eq!(ball.vertices.len(), 8);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((ball.vertices[0] - DVec3::new(half, 0.0, half)).length() < 1e-15);
        assert!((ball.vertices[7] - DVec3::new(0.0, -half, -half)).length() < 1e-15);
    }

    /// All corners inside all planes, and on as many as meet there.
    fn check_hull(solid: &ConvexPolyhedron, faces: usize, corners: usize) {
        assert_eq!((solid.planes.len(), solid.vertices.len()), (faces, corners));
        let size = solid.bounds().diagonal();
        for &(normal, offset) in &solid.planes {
            assert!((normal.length() - 1.0).abs() < 1e-15);
            let mut on = 0;
            for v in &solid.vertices {
                let height = normal.dot(*v) - offset;
                assert!(height < 1e-14 * size, "{height} above a face");
                on += usize::from(height > -1e-12 * size);
            }
            assert!(on >= 3, "a face with {on} corners");
        }
    }

    #[test]
    fn hulls_have_the_faces_and_corners_of_openscad() {
        for n in [3_usize, 4, 5, 6, 7, 30, 31, 100] {
            let rings = n.div_ceil(2);
            check_hull(
                &sphere(7.0, n).expect("sphere"),
                n * (rings - 1) + 2,
                n * rings,
            );
            let z = [-1.0, 3.0];
            check_hull(&frustum([2.0, 2.0], z, n).expect("prism"), n + 2, 2 * n);
            check_hull(&frustum([2.0, 0.5], z, n).expect("frustum"), n + 2, 2 * n);
            check_hull(&frustum([2.0, 0.0], z, n).expect("cone"), n + 1, n + 1);
            check_hull(&frustum([0.0, 2.0], z, n).expect("cone"), n + 1, n + 1);
        }
    }

    /// Volume by the divergence theorem over the faces, each ordered round its normal.
    fn volume(solid: &ConvexPolyhedron) -> f64 {
        let mut sum = 0.0;
        for &(normal, offset) in &solid.planes {
            let on = |v: &&DVec3| (normal.dot(**v) - offset).abs() < 1e-10;
            let mut face: Vec<DVec3> = solid.vertices.iter().filter(on).copied().collect();
            let middle = face.iter().sum::<DVec3>() / face.len() as f64;
            let (x, y) = normal.any_orthonormal_pair();
            let angle = |v: &DVec3| (*v - middle).dot(y).atan2((*v - middle).dot(x));
            face.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
            for (a, b) in face.iter().zip(face.iter().cycle().skip(1)) {
                sum += middle.dot(a.cross(*b)) / 6.0;
            }
        }
        sum
    }

    #[test]
    fn volumes_are_those_of_the_formulas() {
        for n in [3_usize, 4, 6, 30, 45] {
            let wedge = (std::f64::consts::TAU / n as f64).sin() * n as f64 / 2.0;
            let near = |solid: ConvexPolyhedron, expected: f64| {
                let measured = volume(&solid);
                assert!(
                    (measured - expected).abs() < 1e-12 * expected,
                    "{measured} {expected}"
                );
            };
            near(
                frustum([2.0, 2.0], [0.0, 5.0], n).expect("prism"),
                wedge * 4.0 * 5.0,
            );
            near(
                frustum([3.0, 0.0], [0.0, 5.0], n).expect("cone"),
                wedge * 9.0 * 5.0 / 3.0,
            );
            near(
                frustum([1.0, 2.0], [-1.0, 2.0], n).expect("frustum"),
                wedge * (1.0 + 2.0 + 4.0),
            );
            // A stack of frusta.
            let rings = n.div_ceil(2);
            let ring = |i: usize| {
                let polar = ((i as f64 + 0.5) * 180.0 / rings as f64).to_radians();
                (polar.sin(), polar.cos())
            };
            let ball: f64 = (1..rings)
                .map(|i| {
                    let ((r, z), (s, w)) = (ring(i - 1), ring(i));
                    wedge * (r * r + r * s + s * s) * (z - w) / 3.0
                })
                .sum();
            near(sphere(2.0, n).expect("sphere"), 8.0 * ball);
        }
    }

    #[test]
    fn faces_that_should_be_axis_aligned_are_exactly() {
        // A hexagon's upper and lower sides are planes y = const, whatever the radius.
        for radius in [1.0, 0.3, 7.77, 1e-3] {
            let prism = frustum([radius, radius], [0.0, 1.0], 6).expect("prism");
            let height = radius * 0.75_f64.sqrt();
            assert!(prism.planes.contains(&(DVec3::Y, height)), "{prism:?}");
            assert!(prism.planes.contains(&(DVec3::NEG_Y, height)));
            assert_eq!(prism.planes[0], (DVec3::Z, 1.0));
            assert_eq!(prism.planes[1], (DVec3::NEG_Z, 0.0));
        }
    }
}
