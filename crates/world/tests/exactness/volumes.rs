//! The classical solids of set operations, by the volumes that are known for them.

use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

use octray_geometry::{Polynomial, Solid};
use octray_math::{DAffine3, DQuat, DVec3, Ray, transform};

use crate::draw::Draw;
use crate::elliptic;
use crate::ray_grid::RayGrid;
use crate::subject::{Subject, cases};

pub(crate) fn both(solids: impl IntoIterator<Item = Solid>) -> Solid {
    Solid::intersection(solids)
}

pub(crate) fn minus(solids: impl IntoIterator<Item = Solid>) -> Solid {
    Solid::difference(solids)
}

pub(crate) fn infinite_cylinder(radius: f64) -> Solid {
    Solid::infinite_cylinder(radius).expect("valid")
}

pub(crate) fn ball_at(center: DVec3, radius: f64) -> Solid {
    let ball = Solid::sphere(radius).expect("valid");
    ball.translate(center).expect("finite")
}

/// What stands along z, along `axis`.
fn across(solid: &Solid, axis: DVec3) -> Solid {
    let turn = DQuat::from_rotation_arc(DVec3::Z, axis.normalize());
    solid
        .transform(DAffine3::from_quat(turn))
        .expect("invertible")
}

fn cylinder(radius: f64, length: f64) -> Solid {
    Solid::cylinder(radius, -0.5 * length, 0.5 * length).expect("valid")
}

fn above(normal: DVec3, height: f64) -> Solid {
    Solid::half_space(-normal, -height).expect("valid")
}

fn cube(edge: f64) -> Solid {
    let corner = DVec3::splat(0.5 * edge);
    Solid::cuboid(-corner, corner).expect("valid")
}

/// Cylinders of radius 1 along these axes.
pub(crate) fn crossed(axes: &[[f64; 3]]) -> Solid {
    let rod = infinite_cylinder(1.0);
    let rods = axes.iter().map(|a| across(&rod, DVec3::from_array(*a)));
    // Unbounded operands: the box is only for the grid's sake.
    both(rods.chain([cube(3.0)]))
}

#[track_caller]
fn check(solids: Vec<(&str, Solid, f64)>) {
    let grid = RayGrid::one_way();
    for (name, solid, exact) in solids {
        grid.volume(&solid)
            .assert_near(exact, grid.coarseness(), name);
    }
}

#[test]
fn parts_of_balls() {
    let ball = |r: f64| ball_at(DVec3::ZERO, r);
    let (big, small, apart) = (1.0, 0.8, 0.9);
    let sum = big + small - apart;
    let lens = PI
        * sum
        * sum
        * (apart * apart + 2.0 * apart * small - 3.0 * small * small
            + 2.0 * apart * big
            + 6.0 * big * small
            - 3.0 * big * big)
        / (12.0 * apart);
    let (radius, bore) = (1.2_f64, 0.7_f64);
    let height = 2.0 * (radius * radius - bore * bore).sqrt();
    let ring = PI * height.powi(3) / 6.0;
    let stretched = ball(1.0)
        .transform(
            transform::rotation_xyz_degrees(DVec3::new(10.0, 20.0, 30.0))
                * DAffine3::from_scale(DVec3::new(1.5, 0.4, 0.9)),
        )
        .expect("valid");
    let cap = |r: f64, h: f64| PI * h * h * (3.0 * r - h) / 3.0;
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 0 { -0.5 } else { 0.5 };
        ball_at(DVec3::new(side(0), side(1), side(2)), 0.5)
    };
    check(vec![
        ("ball", ball(1.3), 4.0 / 3.0 * PI * 1.3_f64.powi(3)),
        ("ellipsoid", stretched, 4.0 / 3.0 * PI * 1.5 * 0.4 * 0.9),
        (
            "cap",
            both([ball(1.1), above(DVec3::new(1.0, 1.0, 1.0), 0.4)]),
            cap(1.1, 0.7),
        ),
        (
            "lens",
            both([ball(big), ball_at(DVec3::X * apart, small)]),
            lens,
        ),
        (
            "napkin ring",
            minus([ball(radius), infinite_cylinder(bore)]),
            ring,
        ),
        (
            "ball and coaxial cylinder",
            both([ball(radius), infinite_cylinder(bore)]),
            4.0 / 3.0 * PI * radius.powi(3) - ring,
        ),
        (
            "ball in a cube",
            both([cube(1.0), ball(0.6)]),
            4.0 / 3.0 * PI * 0.6_f64.powi(3) - 6.0 * cap(0.6, 0.1),
        ),
        (
            "cube without balls around its corners",
            minus(std::iter::once(cube(1.0)).chain((0..8).map(corner))),
            1.0 - PI / 6.0,
        ),
    ]);
}

#[test]
fn crossed_cylinders_of_one_radius() {
    let length = 3.0;
    let pipe = cylinder(1.0, length);
    let angle = 40.0_f64.to_radians();
    let tilted = [angle.sin(), 0.0, angle.cos()];
    let cubic = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let corners = [
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, -1.0],
    ];
    let edges = [
        [1.0, 1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, -1.0],
        [0.0, 1.0, 1.0],
        [0.0, 1.0, -1.0],
    ];
    check(vec![
        ("two", crossed(&cubic[1..]), 16.0 / 3.0),
        (
            "two at an angle",
            both([
                across(&cylinder(1.0, 12.0), DVec3::from_array(tilted)),
                infinite_cylinder(1.0),
            ]),
            16.0 / (3.0 * angle.sin()),
        ),
        ("three", crossed(&cubic), 8.0 * (2.0 - SQRT_2)),
        (
            "four",
            crossed(&corners),
            12.0 * (2.0 * SQRT_2 - 6.0_f64.sqrt()),
        ),
        (
            "six",
            crossed(&edges),
            16.0 / 3.0 * (3.0 + 2.0 * 3.0_f64.sqrt() - 4.0 * SQRT_2),
        ),
        (
            "union of two pipes",
            Solid::union([pipe.clone(), across(&pipe, DVec3::X)]),
            2.0 * PI * length - 16.0 / 3.0,
        ),
    ]);
}

#[test]
fn cylinders_of_two_radii_and_in_a_ball() {
    let (a, b) = (0.7, 1.0);
    let (k, e) = elliptic::complete(a / b);
    let shared = 8.0 / 3.0 * b * ((a * a + b * b) * e - (b * b - a * a) * k);
    let shaft = cylinder(b, 3.0);
    let drill = across(&infinite_cylinder(a), DVec3::X);
    let r = 1.2_f64;
    let ball = ball_at(DVec3::ZERO, r);
    let aside = |x: f64| {
        let half = infinite_cylinder(0.5 * r);
        half.translate(DVec3::X * x).expect("finite")
    };
    let viviani = (2.0 / 3.0 * PI - 8.0 / 9.0) * r.powi(3);
    check(vec![
        ("unequal", both([shaft.clone(), drill.clone()]), shared),
        (
            "drilled shaft",
            minus([shaft, drill]),
            PI * b * b * 3.0 - shared,
        ),
        ("Viviani", both([ball.clone(), aside(0.5 * r)]), viviani),
        (
            "ball without two cylinders",
            minus([ball, aside(0.5 * r), aside(-0.5 * r)]),
            16.0 / 9.0 * r.powi(3),
        ),
    ]);
}

#[test]
fn tori() {
    let torus = |major: f64, minor: f64| Solid::torus(major, minor).expect("valid");
    let ring = 2.0 * PI * PI * 1.1 * 0.09;
    let (major, minor) = (0.5_f64, 0.7_f64);
    let s = (minor * minor - major * major).sqrt();
    let spindle = 2.0 / 3.0 * PI * (2.0 * minor * minor + major * major) * s
        + PI * minor * minor * major * (PI + 2.0 * (major / s).atan());
    check(vec![
        ("ring", torus(1.1, 0.3), ring),
        ("thin ring", torus(1.1, 0.1), 2.0 * PI * PI * 1.1 * 0.01),
        ("horn", torus(0.6, 0.6), 2.0 * PI * PI * 0.6_f64.powi(3)),
        (
            "half a ring, lying",
            both([torus(1.1, 0.3), above(DVec3::Z, 0.0)]),
            0.5 * ring,
        ),
        (
            "half a ring, standing",
            both([torus(1.1, 0.3), above(DVec3::new(0.3, 1.0, 0.0), 0.0)]),
            0.5 * ring,
        ),
        ("spindle", torus(major, minor), spindle),
        (
            "square rod around a ring",
            minus([cylinder(1.4, 0.6), cylinder(0.8, 0.6), torus(1.1, 0.3)]),
            PI * (1.96 - 0.64) * 0.6 - ring,
        ),
    ]);
}

#[test]
fn cones_and_what_is_cut_from_cylinders() {
    let (r, h) = (0.9, 1.3);
    let cone = |r0: f64, r1: f64| Solid::cone(r0, r1, 0.0, h).expect("valid");
    let slope = DVec3::new(-h / r, 0.0, 1.0);
    let ungula = both([
        Solid::cylinder(r, 0.0, h).expect("valid"),
        Solid::half_space(slope, 0.0).expect("valid"),
    ]);
    check(vec![
        ("cone", cone(r, 0.0), PI * r * r * h / 3.0),
        ("cone on its tip", cone(0.0, r), PI * r * r * h / 3.0),
        (
            "frustum",
            cone(r, 0.4),
            PI * h * (r * r + 0.4 * r + 0.16) / 3.0,
        ),
        ("ungula", ungula, 2.0 / 3.0 * r * r * h),
        (
            "countersunk hole",
            minus([Solid::cylinder(2.0, 0.0, h).expect("valid"), cone(0.4, r)]),
            PI * h * (4.0 - (r * r + 0.4 * r + 0.16) / 3.0),
        ),
    ]);
}

/// The quartic `(x^2 + y^2 + z^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2)` of a torus.
fn torus_quartic(major: f64, minor: f64) -> Solid {
    let k = major * major - minor * minor;
    let mut coefficients = Vec::new();
    for x in (0..=4).rev() {
        for y in (0..=4 - x).rev() {
            coefficients.extend((0..=4 - x - y).rev().map(|z| match [x, y, z] {
                [4, 0, 0] | [0, 4, 0] | [0, 0, 4] => 1.0,
                [2, 2, 0] | [2, 0, 2] | [0, 2, 2] => 2.0,
                [2, 0, 0] | [0, 2, 0] => 2.0 * k - 4.0 * major * major,
                [0, 0, 2] => 2.0 * k,
                [0, 0, 0] => k * k,
                _ => 0.0,
            }));
        }
    }
    Solid::polynomial(Polynomial::new(4, &coefficients).expect("35 numbers")).expect("a quartic")
}

#[test]
fn formulas() {
    // The lemon inside a spindle torus: there the quartic is positive again.
    let (major, minor) = (0.5_f64, 0.7_f64);
    let s = (minor * minor - major * major).sqrt();
    let lemon = 2.0 / 3.0 * PI * (2.0 * minor * minor + major * major) * s
        - PI * minor * minor * major * (PI - 2.0 * (major / s).atan());
    let beta = |p: f64, q: f64| libm::tgamma(p) * libm::tgamma(q) / libm::tgamma(p + q);
    let super_volume =
        |e: f64, n: f64| 2.0 * e * n * beta(0.5 * n + 1.0, n) * beta(0.5 * e, 0.5 * e);
    let superellipsoid = |e, n| Solid::superellipsoid(e, n).expect("valid");
    let mut bowl = [0.0; 10];
    (bowl[0], bowl[1], bowl[8]) = (1.0, 1.0, -1.0);
    check(vec![
        (
            "lemon",
            minus([cylinder(0.3, 2.0 * s), torus_quartic(major, minor)]),
            lemon,
        ),
        (
            "ring by its quartic",
            both([cube(3.0), torus_quartic(1.0, 0.3)]),
            2.0 * PI * PI * 0.09,
        ),
        ("cushion", superellipsoid(0.5, 0.7), super_volume(0.5, 0.7)),
        ("star", superellipsoid(2.5, 1.8), super_volume(2.5, 1.8)),
        (
            "paraboloid",
            both([
                Solid::quadric(bowl).expect("valid"),
                above(DVec3::NEG_Z, -1.3),
                cube(4.0),
            ]),
            PI * 1.69 / 2.0,
        ),
    ]);
}

/// The single chord of a line.
fn chord(subject: &Subject, ray: Ray) -> f64 {
    subject.intervals(ray).iter().map(|[s, e]| e - s).sum()
}

#[test]
fn chords_have_the_lengths_of_school_geometry() {
    let r = 1.3_f64;
    let ball = Subject::one(&ball_at(DVec3::new(0.3, -2.0, 1.0), r));
    let two = Subject::one(&crossed(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
    let ring = Subject::one(&Solid::torus(1.0, 0.25).expect("valid"));
    let cone = Subject::one(&Solid::cone(1.0, 0.0, 0.0, 2.0).expect("valid"));
    let half = |squared: f64| 2.0 * squared.max(0.0).sqrt();
    let near = |subject: &Subject, ray: Ray, expected: f64| {
        let got = chord(subject, ray);
        // Near a tangent a rounding error counts as its root.
        assert!(
            (got * got - expected * expected).abs() < 1e-13,
            "{got}, not {expected}: {ray:?}"
        );
    };
    for case in 0..cases(1000) {
        let draw = &mut Draw::new(50, case);
        let toward = draw.direction();
        let aside = toward.any_orthonormal_vector();
        let b = draw.between(0.0, 1.2 * r);
        let origin = DVec3::new(0.3, -2.0, 1.0) + aside * b - toward * draw.between(-9.0, 9.0);
        near(&ball, Ray::new(origin, toward), half(r * r - b * b));
        let (x, y) = (draw.between(-1.2, 1.2), draw.between(-1.2, 1.2));
        let down = Ray::new(DVec3::new(x, y, 7.0), DVec3::NEG_Z);
        let (wide, deep) = (1.0 - x * x, 1.0 - y * y);
        near(&two, down, half(wide.min(deep)));
        let rho = x.hypot(y);
        near(&ring, down, half(0.0625 - (rho - 1.0) * (rho - 1.0)));
        near(&cone, down, (2.0 - 2.0 * rho).max(0.0));
        // Through the ring's middle plane along x.
        let along = Ray::new(DVec3::new(-5.0, y, 0.0), DVec3::X);
        let hole = half(0.5625 - y * y);
        // Where it touches the hole its root is the hole's length alone.
        if (0.5625 - y * y).abs() > 1e-2 {
            near(&ring, along, half(1.5625 - y * y) - hole);
        }
    }
}

#[test]
fn lines_across_a_ring_at_45_degrees() {
    // In the plane y = 0 the ring is two discs.
    let ring = Subject::one(&Solid::torus(2.0, 0.5).expect("valid"));
    for i in -30..=30 {
        let x = f64::from(i) * 0.1;
        let toward = DVec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);
        let got = chord(&ring, Ray::new(DVec3::new(x, 0.0, 0.0), toward));
        let disc = |center: f64| {
            let b = (x - center) * FRAC_1_SQRT_2;
            2.0 * (0.25 - b * b).max(0.0).sqrt()
        };
        let expected = disc(2.0) + disc(-2.0);
        assert!((got - expected).abs() < 1e-12, "{x}: {got} {expected}");
    }
}
