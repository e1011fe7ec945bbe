//! The definitions of the primitives, in their own frames, as signed clearances.
//!
//! A clearance is negative inside and positive outside, and no larger in size than the distance to
//! the nearest boundary: while a boundary moves by less than that, the point stays on its side.

use octray_geometry::Primitive;
use octray_math::DVec3;

use super::Leaf;
use super::number::Number;

/// The clearance of a point from a primitive.
///
/// # Panics
/// For a primitive whose definition is not written down here (meshes), or as a polynomial.
pub(crate) fn clearance<N: Number>(primitive: &Primitive, [x, y, z]: [N; 3]) -> N {
    let rho = || (x.squared() + y.squared()).sqrt();
    // Between two heights, of which infinite ones do not count.
    let slab = |value: N, [low, high]: [f64; 2]| {
        let mut worst = value;
        if low.is_finite() {
            worst = worst.largest(N::of(low) - z);
        }
        if high.is_finite() {
            worst = worst.largest(z - N::of(high));
        }
        worst
    };
    let plane = |normal: [f64; 3], offset: f64| {
        let [nx, ny, nz] = normal.map(N::of);
        nx * x + ny * y + nz * z - N::of(offset)
    };
    match primitive {
        Primitive::Sphere { radius } => {
            (x.squared() + y.squared() + z.squared()).sqrt() - N::of(*radius)
        }
        Primitive::Box { min, max } => {
            let sides = [(x, 0), (y, 1), (z, 2)]
                .map(|(value, axis)| (N::of(min[axis]) - value).largest(value - N::of(max[axis])));
            sides[0].largest(sides[1]).largest(sides[2])
        }
        Primitive::Cylinder { radius, z } => slab(rho() - N::of(*radius), *z),
        Primitive::Cone {
            radius: [r0, r1],
            z: [z0, z1],
        } => {
            let (height, growth) = (N::of(*z1) - N::of(*z0), N::of(*r1) - N::of(*r0));
            // Across the mantle: (rho - r(z)) times the cosine of the half angle.
            let across = (rho() - N::of(*r0)) * height - growth * (z - N::of(*z0));
            let slant = (height.squared() + growth.squared()).sqrt();
            slab(across / slant, [*z0, *z1])
        }
        Primitive::Torus { major, minor } => {
            let from_ring = rho() - N::of(*major);
            (from_ring.squared() + z.squared()).sqrt() - N::of(*minor)
        }
        Primitive::HalfSpace { normal, offset } => plane(normal.to_array(), *offset),
        Primitive::Convex(polyhedron) => polyhedron
            .planes
            .iter()
            .map(|(normal, offset)| plane(normal.to_array(), *offset))
            .reduce(Number::largest)
            .expect("a polyhedron has faces"),
        Primitive::Superellipsoid { exponents } => {
            N::of(superellipsoid(*exponents, [x, y, z].map(Number::rounded)))
        }
        other => panic!("no definition of {other:?}"),
    }
}

/// `(|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n)` to the power of `n/2` is a norm for exponents up to
/// 2, at most twice the length, and the solid is its unit ball.
fn superellipsoid([e, n]: [f64; 2], q: [f64; 3]) -> f64 {
    assert!(e <= 2.0 && n <= 2.0, "not a norm: {e} {n}");
    // Of numbers as large as their maximum, so that no power overflows.
    let norm = |a: f64, b: f64, exponent: f64| {
        let largest = a.max(b);
        if largest == 0.0 {
            return 0.0;
        }
        let sum = libm::pow(a / largest, 2.0 / exponent) + libm::pow(b / largest, 2.0 / exponent);
        largest * libm::pow(sum, 0.5 * exponent)
    };
    let [x, y, z] = q.map(f64::abs);
    let excess = norm(norm(x, y, e), z, n) - 1.0;
    let rounding = 32.0 * f64::EPSILON * (1.0 + excess.abs());
    0.5 * (excess.abs() - rounding).max(0.0).copysign(excess)
}

/// The largest length among a primitive's parameters: what its rounding errors are measured by.
pub(crate) fn extent(primitive: &Primitive) -> f64 {
    let finite = |z: &[f64; 2]| {
        let sizes = z.iter().filter(|z| z.is_finite());
        sizes.fold(0.0_f64, |size, z| size.max(z.abs()))
    };
    match primitive {
        Primitive::Sphere { radius } => *radius,
        Primitive::Box { min, max } => min.abs().max(max.abs()).max_element(),
        Primitive::Cylinder { radius, z } => radius.max(finite(z)),
        Primitive::Cone { radius, z } => radius[0].max(radius[1]).max(finite(z)),
        Primitive::Torus { major, minor } => major + minor,
        Primitive::HalfSpace { offset, .. } => offset.abs(),
        Primitive::Convex(polyhedron) => polyhedron
            .vertices
            .iter()
            .fold(0.0, |size, v| v.abs().max_element().max(size)),
        Primitive::Quadric(_) | Primitive::Superellipsoid { .. } => 1.0,
        Primitive::Polynomial { .. } => 1.0,
        other => panic!("no definition of {other:?}"),
    }
}

/// The flat faces of a primitive, `normal . x <= offset`, and the clearance from its curved one.
pub(super) fn faces(leaf: &Leaf, q: DVec3) -> (Vec<(DVec3, f64)>, Option<f64>) {
    let caps = |z: &[f64; 2]| {
        let ends = [(DVec3::Z, z[1]), (DVec3::NEG_Z, -z[0])];
        ends.into_iter().filter(|end| end.1.is_finite()).collect()
    };
    let mantle = |open: Primitive| Some(clearance(&open, q.to_array()));
    let ends = [f64::NEG_INFINITY, f64::INFINITY];
    match &leaf.primitive {
        Primitive::Box { min, max } => {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter();
            let sides = axes.flat_map(|n| [(n, max.dot(n)), (-n, -min.dot(n))]);
            (sides.collect(), None)
        }
        Primitive::Cylinder { radius, z } => {
            let radius = *radius;
            (caps(z), mantle(Primitive::Cylinder { radius, z: ends }))
        }
        Primitive::Cone { radius, z } => {
            // Between the caps, or as far beyond them as the mantle is not needed.
            let slope = (radius[1] - radius[0]) / (z[1] - z[0]);
            let across = libm::hypot(q.x, q.y) - (radius[0] + slope * (q.z - z[0]));
            (caps(z), Some(across / libm::hypot(1.0, slope)))
        }
        Primitive::HalfSpace { normal, offset } => (vec![(*normal, *offset)], None),
        Primitive::Convex(polyhedron) => (polyhedron.planes.clone(), None),
        _ => (Vec::new(), Some(leaf.clearance(q.to_array()))),
    }
}
