//! One of every kind of primitive, and difficult ones.

use std::sync::Arc;

use octray_math::{DVec2, DVec3};

use crate::polynomial::powers;
use crate::profile::{Edge, Outline, Region, Turning};
use crate::surface::QuadricForm;
use crate::{ConvexPolyhedron, Polynomial, Primitive, Solid};

/// A region with a notch, a straight side and an arc, to the right of the y axis.
pub(super) fn region() -> Region {
    let v = DVec2::new;
    let mut outline = Outline::starting_at(v(0.2, -1.0));
    outline.push(Edge::Line, v(1.0, -1.0));
    outline.push(Edge::Quadratic(v(1.8, 0.0)), v(1.0, 1.0));
    outline.push(Edge::Line, v(0.2, 1.0));
    outline.push(Edge::Line, v(0.7, 0.0));
    Region::new(&[outline]).expect("a region")
}

/// `x^4 + y^4 + z^4 - 1 < 0`.
fn quartic() -> Solid {
    let coefficients: Vec<f64> = powers(4)
        .map(|power| match power {
            [0, 0, 0] => -1.0,
            [4, 0, 0] | [0, 4, 0] | [0, 0, 4] => 1.0,
            _ => 0.0,
        })
        .collect();
    let polynomial = Polynomial::new(4, &coefficients).expect("valid");
    Solid::polynomial(polynomial).expect("bounded")
}

/// A cuboid with a step.
fn staircase() -> Solid {
    let profile = [
        (0.0, 0.0),
        (2.0, 0.0),
        (2.0, 1.0),
        (1.0, 1.0),
        (1.0, 2.0),
        (0.0, 2.0),
    ];
    let corners: Vec<DVec3> = [0.0, 1.0]
        .into_iter()
        .flat_map(|z| profile.map(|(x, y)| DVec3::new(x, y, z)))
        .collect();
    let mut faces: Vec<Vec<u32>> = vec![(0..6).rev().collect(), (6..12).collect()];
    faces.extend((0..6).map(|i| vec![i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6]));
    Solid::polyhedron(&corners, &faces).expect("closed")
}

/// A ring of teeth with a hole, tapering; `teeth` of them.
pub(super) fn gear(teeth: usize) -> Solid {
    let rim = |scale: f64| -> Vec<DVec2> {
        let corner = |i: usize| {
            let angle = std::f64::consts::PI * i as f64 / teeth as f64;
            let radius = if i.is_multiple_of(2) { 1.0 } else { 0.8 };
            DVec2::new(libm::cos(angle), libm::sin(angle)) * (radius * scale)
        };
        (0..2 * teeth).map(corner).collect()
    };
    let outlines = [1.0, 0.5].map(|scale| Outline::polygon(&rim(scale)));
    let region = Region::new(&outlines).expect("a region");
    Solid::tapered_prism(&region, [-0.5, 0.8], [1.0, 0.6]).expect("valid")
}

fn pyramid() -> Solid {
    let v = DVec3::new;
    let corners = vec![
        v(-1.0, -1.0, 0.0),
        v(1.0, -1.0, 0.0),
        v(1.0, 1.0, 0.0),
        v(-1.0, 1.0, 0.0),
        v(0.0, 0.0, 3.0),
    ];
    let faces = [
        vec![3, 2, 1, 0],
        vec![0, 1, 4],
        vec![1, 2, 4],
        vec![2, 3, 4],
        vec![3, 0, 4],
    ];
    let polyhedron = ConvexPolyhedron::from_faces(corners, &faces).expect("convex");
    Solid::primitive(Primitive::Convex(Arc::new(polyhedron)))
}

/// A disc with a round hole, and a crescent beside it.
fn ring_and_crescent() -> Region {
    let v = DVec2::new;
    let mut crescent = Outline::starting_at(v(1.4, -0.6));
    let arc = |x: f64, clockwise: bool| Edge::Arc {
        center: v(x, 0.0),
        clockwise,
    };
    crescent.push(arc(1.4, false), v(1.4, 0.6));
    crescent.push(arc(1.2, true), v(1.4, -0.6));
    let rings = [1.0, 0.45].map(|r| Outline::circle(v(0.0, 0.0), r));
    Region::new(&[rings[0].clone(), rings[1].clone(), crescent]).expect("a region")
}

/// From the axis outwards and back, by curves: a bulge, a waist and a lip.
fn vase() -> Region {
    let v = DVec2::new;
    let mut outline = Outline::starting_at(v(0.0, -1.0));
    outline.push(Edge::Cubic(v(1.2, -1.0), v(1.2, 0.2)), v(0.4, 0.4));
    outline.push(Edge::Quadratic(v(0.2, 0.7)), v(0.7, 1.0));
    outline.push(Edge::Line, v(0.5, 1.0));
    let center = v(0.25, 1.0);
    let clockwise = true;
    outline.push(Edge::Arc { center, clockwise }, v(0.0, 1.0));
    Region::new(&[outline]).expect("a region")
}

/// Five corners of a pentagon, every other one next: its edges cross.
fn pentagram() -> Region {
    let corner = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(2 * i) / 5.0;
        DVec2::new(libm::cos(angle), libm::sin(angle))
    };
    Region::polygon(&[0, 1, 2, 3, 4].map(corner)).expect("a region")
}

fn notched() -> Region {
    let corners = [(0.0, -1.0), (1.0, -1.0), (0.4, 0.0), (1.0, 1.0), (0.0, 0.6)];
    Region::polygon(&corners.map(|(x, y)| DVec2::new(x, y))).expect("a region")
}

/// One of every kind, and difficult ones.
pub(super) fn primitives() -> Vec<(&'static str, Solid)> {
    let v = DVec3::new;
    let good = |solid: Result<Solid, crate::ShapeError>| solid.expect("valid");
    let quadric = |form: QuadricForm| Solid::primitive(Primitive::Quadric(form));
    let superellipsoid = |e: f64, n: f64| good(Solid::superellipsoid(e, n));
    let turned = |region: Region, start: f64, sweep: f64, steps: Option<u32>| {
        let turning = Turning {
            start,
            sweep,
            steps,
        };
        good(Solid::turned_lathe(&region, turning))
    };
    let endless = Primitive::Cylinder {
        radius: 0.5,
        z: [f64::NEG_INFINITY, f64::INFINITY],
    };
    vec![
        ("sphere", good(Solid::sphere(1.3))),
        (
            "box",
            good(Solid::cuboid(v(-1.0, -2.0, 0.0), v(0.5, 1.0, 2.0))),
        ),
        (
            "half-space",
            good(Solid::half_space(v(1.0, 2.0, -1.0), 0.3)),
        ),
        ("cylinder", good(Solid::cylinder(0.7, -1.0, 1.5))),
        ("long cylinder", good(Solid::cylinder(1e-3, -1.0, 1.0))),
        ("endless cylinder", Solid::primitive(endless)),
        ("cone", good(Solid::cone(1.0, 0.2, -1.0, 1.0))),
        ("needle", good(Solid::cone(1e-6, 0.0, -1.0, 1.0))),
        ("torus", good(Solid::torus(1.0, 0.3))),
        ("thin torus", good(Solid::torus(1.0, 1e-3))),
        ("spindle", good(Solid::torus(0.6, 1.0))),
        ("nearly a horn", good(Solid::torus(1.0, 0.99))),
        ("horn", good(Solid::torus(1.0, 1.0))),
        ("hardly a spindle", good(Solid::torus(1.0, 1.001))),
        ("one sheet", quadric(QuadricForm::OneSheet)),
        ("two sheets", quadric(QuadricForm::TwoSheets)),
        ("double cone", quadric(QuadricForm::DoubleCone)),
        ("paraboloid", quadric(QuadricForm::EllipticParaboloid)),
        ("saddle", quadric(QuadricForm::HyperbolicParaboloid)),
        (
            "hyperbolic cylinder",
            quadric(QuadricForm::HyperbolicCylinder),
        ),
        (
            "parabolic cylinder",
            quadric(QuadricForm::ParabolicCylinder),
        ),
        ("pyramid", pyramid()),
        ("staircase", staircase()),
        ("gear", gear(12)),
        ("pentagram", good(Solid::prism(&pentagram(), -0.5, 0.8))),
        ("prism", good(Solid::prism(&region(), -0.5, 0.8))),
        (
            "tapered arcs",
            good(Solid::tapered_prism(
                &ring_and_crescent(),
                [-0.5, 0.8],
                [0.3, 1.0],
            )),
        ),
        ("lathe", good(Solid::lathe(&region()))),
        ("vase", good(Solid::lathe(&vase()))),
        ("part of a turn", turned(vase(), 30.0, 200.0, None)),
        ("turn in steps", turned(notched(), 10.0, 360.0, Some(7))),
        ("quartic", quartic()),
        ("superellipsoid", superellipsoid(0.5, 0.8)),
        ("rounded box", superellipsoid(0.1, 0.1)),
        ("pinched", superellipsoid(3.0, 3.0)),
        ("pillow", superellipsoid(2.5, 0.3)),
        ("spool", superellipsoid(0.7, 4.0)),
    ]
}
