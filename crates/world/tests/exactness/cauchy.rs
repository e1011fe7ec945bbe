//! Cauchy's formulas for convex bodies: the mean shadow is a quarter of the area, the mean chord
//! four volumes over the area. And for any body Crofton's: twice the mean number of crossings.

use std::f64::consts::{PI, SQRT_2};

use octray_geometry::Solid;
use octray_math::{DAffine3, DVec3};

use crate::ray_grid::RayGrid;
use crate::volumes::{ball_at, both, crossed, infinite_cylinder, minus};

/// A convex body with its volume and area.
fn convex_bodies() -> Vec<(&'static str, Solid, f64, f64)> {
    let slant = |r: f64, h: f64| (r * r + h * h).sqrt();
    let cuboid = Solid::cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)).expect("valid");
    let ball = Solid::sphere(1.0).expect("valid");
    let lower = Solid::half_space(DVec3::Z, -0.3).expect("valid");
    let cap_height = 0.7;
    let axes = DVec3::AXES.map(|axis| axis.to_array());
    // Prolate: half axes 0.5, 0.5, 1.
    let long = ball
        .transform(DAffine3::from_scale(DVec3::new(0.5, 0.5, 1.0)))
        .expect("valid");
    let excentricity = 0.75_f64.sqrt();
    vec![
        ("box", cuboid, 6.0, 22.0),
        ("ball", ball.clone(), 4.0 / 3.0 * PI, 4.0 * PI),
        (
            "cylinder",
            Solid::cylinder(0.8, -0.5, 1.0).expect("valid"),
            PI * 0.64 * 1.5,
            2.0 * PI * 0.8 * (0.8 + 1.5),
        ),
        (
            "cone",
            Solid::cone(0.9, 0.0, 0.0, 1.2).expect("valid"),
            PI * 0.81 * 1.2 / 3.0,
            PI * 0.9 * (0.9 + slant(0.9, 1.2)),
        ),
        (
            "frustum",
            Solid::cone(1.0, 0.4, 0.0, 0.8).expect("valid"),
            PI * 0.8 * (1.0 + 0.4 + 0.16) / 3.0,
            PI * (1.0 + 0.16 + 1.4 * slant(0.6, 0.8)),
        ),
        (
            "cap",
            both([ball, lower]),
            PI * cap_height * cap_height * (3.0 - cap_height) / 3.0,
            2.0 * PI * cap_height + PI * cap_height * (2.0 - cap_height),
        ),
        ("bicylinder", crossed(&axes[1..]), 16.0 / 3.0, 16.0),
        (
            "tricylinder",
            crossed(&axes),
            8.0 * (2.0 - SQRT_2),
            24.0 * (2.0 - SQRT_2),
        ),
        (
            "prolate ellipsoid",
            long,
            PI / 3.0,
            2.0 * PI * (0.25 + 0.5 * excentricity.asin() / excentricity),
        ),
    ]
}

#[test]
fn mean_shadow_and_mean_chord_of_convex_bodies() {
    let grid = RayGrid::all_ways();
    let near = grid.coarseness();
    for (name, body, volume, area) in convex_bodies() {
        let [shadow, chords] = grid.integrals(&body, |met| {
            assert!(met.len() <= 1, "{name} is convex: {met:?}");
            let [length] = [met.iter().map(|[s, e]| e - s).sum()];
            [met.len() as f64, length]
        });
        shadow.assert_near(area / 4.0, near, name);
        chords.assert_near(volume, near, name);
        let mean_chord = chords.mean / shadow.mean;
        let exact = 4.0 * volume / area;
        assert!((mean_chord / exact - 1.0).abs() < near, "{name}");
    }
    // The numbers of the first one, written out.
    let (_, _, volume, area) = convex_bodies().swap_remove(0);
    assert_eq!((area / 4.0, 4.0 * volume / area), (5.5, 12.0 / 11.0));
}

#[test]
fn chords_of_a_ball_have_their_known_moments() {
    // Density l / (2 r^2) on [0, 2r]: the mean of l is 4r/3, of l^2 2 r^2, of l^3 16 r^3 / 5.
    let grid = RayGrid::one_way();
    let r = 1.5_f64;
    let ball = Solid::sphere(r).expect("valid");
    let estimates = grid.integrals(&ball, |met| {
        let length: f64 = met.iter().map(|[s, e]| e - s).sum();
        [1, 2, 3].map(|power| length.powi(power))
    });
    let means = [4.0 * r / 3.0, 2.0 * r * r, 16.0 * r.powi(3) / 5.0];
    for (estimate, mean) in estimates.iter().zip(means) {
        estimate.assert_near(PI * r * r * mean, grid.coarseness(), "moment");
    }
}

#[test]
fn crossings_count_the_area_of_hollow_bodies() {
    let grid = RayGrid::all_ways();
    let ball = Solid::sphere(1.0).expect("valid");
    let hole = infinite_cylinder(0.6);
    // The hole is 1.6 long.
    let ring_area = 2.0 * PI * 1.6 + 2.0 * PI * 1.6 * 0.6;
    let bowl = minus([ball.clone(), ball_at(DVec3::Z, 1.0)]);
    let bodies = [
        ("napkin ring", minus([ball.clone(), hole]), ring_area),
        (
            "torus",
            Solid::torus(1.0, 0.3).expect("valid"),
            4.0 * PI * PI * 0.3,
        ),
        // What a ball of the same size bites out: as much area as the ball had.
        ("bowl", bowl, 4.0 * PI),
        (
            "hollow ball",
            minus([ball, ball_at(DVec3::X * 0.2, 0.5)]),
            5.0 * PI,
        ),
    ];
    for (name, body, area) in bodies {
        grid.area(&body)
            .assert_near(area, 2.0 * grid.coarseness(), name);
    }
}
