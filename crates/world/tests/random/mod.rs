//! Random solids, coincident faces preferred: coordinates come from a coarse grid.

mod profiles;

use octray_geometry::surface::SURFACE_TOLERANCE;
use octray_geometry::{Polynomial, Solid};
use octray_math::{DAffine3, DVec2, DVec3, transform};
use proptest::prelude::*;

pub(crate) use profiles::{Profile, profile};

/// A solid and, independently of it, a function that says which points are inside.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    pub(crate) solid: Solid,
    pub(crate) recipe: Recipe,
}

/// The oracle's own tree.
#[derive(Clone, Debug)]
pub(crate) enum Recipe {
    Sphere(f64),
    Box(DVec3, DVec3),
    Cylinder(f64, f64, f64),
    Cone(f64, f64, f64, f64),
    Torus(f64, f64),
    /// A region drawn out between two heights, and turned about the axis.
    Prism(Profile, f64, f64),
    Lathe(Profile),
    Quadric([f64; 10]),
    /// A torus as a quartic.
    Quartic(f64, f64),
    Superellipsoid(f64, f64),
    Moved(Box<Recipe>, DAffine3),
    Union(Box<Recipe>, Box<Recipe>),
    Intersection(Box<Recipe>, Box<Recipe>),
    Difference(Box<Recipe>, Box<Recipe>),
    Complement(Box<Recipe>),
}

impl Recipe {
    /// Whether `p` is inside, and a lower bound (not sharp) of how far the answer is from changing,
    /// in some primitive's units.
    pub(crate) fn contains(&self, p: DVec3) -> (bool, f64) {
        let signed = |value: f64| (value < 0.0, value.abs());
        let slab = |z0: f64, z1: f64| (z0 - p.z).max(p.z - z1);
        let rho = libm::hypot(p.x, p.y);
        match self {
            Self::Sphere(r) => signed(p.length() - r),
            Self::Box(min, max) => signed((*min - p).max_element().max((p - *max).max_element())),
            Self::Cylinder(r, z0, z1) => signed((rho - r).max(slab(*z0, *z1))),
            Self::Cone(r0, r1, z0, z1) => {
                let r = r0 + (r1 - r0) * (p.z - z0) / (z1 - z0);
                signed((rho - r).max(slab(*z0, *z1)))
            }
            Self::Torus(major, minor) => signed(libm::hypot(rho - major, p.z) - minor),
            Self::Prism(profile, z0, z1) => {
                let (inside, margin) = profile.contains(p.truncate());
                let (within, height) = signed(slab(*z0, *z1));
                (inside && within, margin.min(height))
            }
            Self::Lathe(profile) => profile.contains(DVec2::new(rho, p.z)),
            Self::Quadric(c) => {
                let DVec3 { x, y, z } = p;
                let terms = [x * x, y * y, z * z, x * y, x * z, y * z, x, y, z, 1.0];
                signed(terms.iter().zip(c).map(|(t, c)| t * c).sum())
            }
            Self::Quartic(major, minor) => {
                let k = p.length_squared() + major * major - minor * minor;
                signed(k * k - 4.0 * major * major * rho * rho)
            }
            Self::Superellipsoid(e, n) => {
                let [x, y, z] = p.abs().to_array();
                let round = libm::pow(libm::pow(x, 2.0 / e) + libm::pow(y, 2.0 / e), e / n);
                let value = libm::pow(round + libm::pow(z, 2.0 / n), 0.5 * n) - 1.0;
                // Steep where it is pinched: near a coordinate plane it says little.
                let flat = p.abs().min_element().min(1.0);
                (value < 0.0, value.abs().min(flat))
            }
            Self::Moved(inner, m) => inner.contains(m.inverse().transform_point3(p)),
            Self::Complement(a) => {
                let (inside, margin) = a.contains(p);
                (!inside, margin)
            }
            Self::Union(a, b) => join(a.contains(p), b.contains(p), |a, b| a || b),
            Self::Intersection(a, b) => join(a.contains(p), b.contains(p), |a, b| a && b),
            Self::Difference(a, b) => join(a.contains(p), b.contains(p), |a, b| a && !b),
        }
    }
}

fn join(a: (bool, f64), b: (bool, f64), op: impl Fn(bool, bool) -> bool) -> (bool, f64) {
    (op(a.0, b.0), a.1.min(b.1))
}

pub(crate) fn point(range: f64) -> impl Strategy<Value = DVec3> {
    (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

/// Multiples of 1/2 in [-2, 2], some a few units in the last place or a few surface tolerances off:
/// what should coincide and what should not.
fn grid() -> impl Strategy<Value = f64> {
    nearly((-4i32..=4).prop_map(|i| f64::from(i) * 0.5))
}

fn nearly(exact: impl Strategy<Value = f64>) -> impl Strategy<Value = f64> {
    let off = prop_oneof![
        4 => Just(0.0),
        1 => (-3i32..=3).prop_map(|ulps| f64::from(ulps) * f64::EPSILON),
        1 => (-3i32..=3).prop_map(|steps| f64::from(steps) * SURFACE_TOLERANCE),
    ];
    (exact, off).prop_map(|(x, off)| x * (1.0 + off))
}

fn grid_point() -> impl Strategy<Value = DVec3> {
    (grid(), grid(), grid()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn length() -> impl Strategy<Value = f64> {
    nearly((1i32..=4).prop_map(|i| f64::from(i) * 0.5))
}

fn frame() -> impl Strategy<Value = DAffine3> {
    let general = (point(180.0), point(1.0)).prop_map(|(degrees, scale)| {
        transform::rotation_xyz_degrees(degrees) * DAffine3::from_scale(scale.abs() + 0.3)
    });
    let quarter_turns = (0..4, 0..4, any::<bool>()).prop_map(|(x, z, mirror)| {
        let degrees = DVec3::new(f64::from(x) * 90.0, 0.0, f64::from(z) * 90.0);
        let side = if mirror {
            DVec3::new(-1.0, 1.0, 1.0)
        } else {
            DVec3::ONE
        };
        transform::rotation_xyz_degrees(degrees) * DAffine3::from_scale(side)
    });
    (grid_point(), prop_oneof![1 => general, 3 => quarter_turns])
        .prop_map(|(shift, turn)| DAffine3::from_translation(shift) * turn)
}

/// Ellipsoids, hyperboloids, paraboloids, cylinders, cones and planes, with simple coefficients, so
/// that all kinds occur and coincide with the primitives of the same shape.
fn quadric() -> impl Strategy<Value = [f64; 10]> {
    let square = prop_oneof![Just(1.0), Just(0.0), Just(-1.0), Just(0.25)];
    let small = || prop_oneof![4 => Just(0.0), 1 => Just(1.0), 1 => -1.0..1.0f64];
    let squares = proptest::array::uniform3(square);
    let mixed = proptest::array::uniform3(prop_oneof![3 => Just(0.0), 1 => Just(1.0)]);
    let constant = prop_oneof![Just(-1.0), Just(0.0), Just(1.0), Just(-2.25)];
    (squares, mixed, proptest::array::uniform3(small()), constant)
        .prop_map(|(s, m, l, c)| [s[0], s[1], s[2], m[0], m[1], m[2], l[0], l[1], l[2], c])
}

fn exponent() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), Just(2.0), Just(0.2), 0.01..3.0f64]
}

/// The coefficients of `(x^2 + y^2 + z^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2)`.
fn torus(major: f64, minor: f64) -> [f64; 35] {
    let (square, k) = (major * major, (major - minor) * (major + minor));
    let mut all = [0.0; 35];
    // Places of x^4, x^2 y^2, x^2 z^2, x^2, y^4, y^2 z^2, y^2, z^4, z^2 and 1.
    let places = [0, 4, 7, 9, 20, 23, 25, 30, 32, 34];
    let across = 2.0 * k - 4.0 * square;
    let values = [1.0, 2.0, 2.0, across, 1.0, 2.0, across, 1.0, 2.0 * k, k * k];
    for (place, value) in places.into_iter().zip(values) {
        all[place] = value;
    }
    all
}

fn primitive() -> impl Strategy<Value = Model> {
    let recipe = prop_oneof![
        length().prop_map(Recipe::Sphere),
        (grid_point(), (length(), length(), length()))
            .prop_map(|(a, (x, y, z))| Recipe::Box(a, a + DVec3::new(x, y, z))),
        (length(), grid(), length()).prop_map(|(r, z, h)| Recipe::Cylinder(r, z, z + h)),
        (length(), length(), grid(), length(), any::<bool>()).prop_map(|(r0, r1, z, h, tip)| {
            let r1 = if tip { 0.0 } else { r1 };
            Recipe::Cone(r0, r1, z, z + h)
        }),
        (length(), length()).prop_map(|(major, minor)| Recipe::Torus(major, minor)),
        (profile(false), grid(), length()).prop_map(|(p, z, h)| Recipe::Prism(p, z, z + h)),
        profile(true).prop_map(Recipe::Lathe),
        quadric().prop_map(Recipe::Quadric),
        (length(), length()).prop_map(|(major, minor)| Recipe::Quartic(major, minor)),
        (exponent(), exponent()).prop_map(|(e, n)| Recipe::Superellipsoid(e, n)),
    ];
    recipe.prop_map(|recipe| {
        let solid = match &recipe {
            Recipe::Sphere(r) => Solid::sphere(*r),
            Recipe::Box(a, b) => Solid::cuboid(*a, *b),
            Recipe::Cylinder(r, z0, z1) => Solid::cylinder(*r, *z0, *z1),
            Recipe::Cone(r0, r1, z0, z1) => Solid::cone(*r0, *r1, *z0, *z1),
            Recipe::Torus(major, minor) => Solid::torus(*major, *minor),
            Recipe::Prism(profile, z0, z1) => Solid::prism(&profile.region, *z0, *z1),
            Recipe::Lathe(profile) => Solid::lathe(&profile.region),
            Recipe::Quadric(c) => Solid::quadric(*c),
            Recipe::Quartic(major, minor) => {
                Polynomial::new(4, &torus(*major, *minor)).and_then(Solid::polynomial)
            }
            Recipe::Superellipsoid(e, n) => Solid::superellipsoid(*e, *n),
            _ => unreachable!("only primitives are made above"),
        };
        Model {
            solid: solid.expect("valid"),
            recipe,
        }
    })
}

/// A bounded or unbounded random solid of up to about a dozen primitives.
pub(crate) fn model() -> impl Strategy<Value = Model> {
    let leaf = (primitive(), frame()).prop_map(|(model, m)| Model {
        solid: model.solid.transform(m).expect("invertible"),
        recipe: Recipe::Moved(Box::new(model.recipe), m),
    });
    leaf.prop_recursive(4, 12, 2, |inner| {
        let pair = (inner.clone(), inner.clone());
        prop_oneof![
            3 => pair.clone().prop_map(|(a, b)| Model {
                solid: Solid::union([a.solid, b.solid]),
                recipe: Recipe::Union(Box::new(a.recipe), Box::new(b.recipe)),
            }),
            2 => pair.clone().prop_map(|(a, b)| Model {
                solid: Solid::intersection([a.solid, b.solid]),
                recipe: Recipe::Intersection(Box::new(a.recipe), Box::new(b.recipe)),
            }),
            4 => pair.prop_map(|(a, b)| Model {
                solid: Solid::difference([a.solid, b.solid]),
                recipe: Recipe::Difference(Box::new(a.recipe), Box::new(b.recipe)),
            }),
            1 => inner.prop_map(|a| Model {
                solid: a.solid.complement(),
                recipe: Recipe::Complement(Box::new(a.recipe)),
            }),
        ]
    })
}
