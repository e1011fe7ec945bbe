//! A scene is the same wherever it stands and however large it is.

use octray_geometry::Solid;
use octray_math::{Aabb, DAffine3, DVec3, Ray};
use octray_world::{Hit, RayQuery};
use proptest::prelude::*;

use crate::abutting::{Assembly, assemblies};
use crate::draw::Draw;
use crate::random::{model, point};
use crate::subject::{Motion, Subject, cases, chains, general_ray, moved};

/// A bit of everything, all dimensions times `k`, made large or small in the primitives.
fn machine(k: f64) -> Vec<Solid> {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * k;
    let valid = |solid: Result<Solid, octray_geometry::ShapeError>| solid.expect("valid");
    let move_to = |solid: Solid, to: DVec3| solid.translate(to).expect("finite");
    let plate = valid(Solid::cuboid(at(-1.5, -1.1, 0.0), at(1.5, 1.1, 0.4)));
    let drill = valid(Solid::cylinder(0.3 * k, 0.0, 0.4 * k));
    let sink = valid(Solid::cone(0.3 * k, 0.5 * k, 0.2 * k, 0.4 * k));
    let seal = move_to(valid(Solid::torus(0.6 * k, 0.15 * k)), at(0.0, 0.0, 0.4));
    let knob = move_to(valid(Solid::sphere(0.45 * k)), at(1.0, 0.6, 0.4));
    let rod = valid(Solid::cylinder(0.12 * k, -k, k));
    let tilt = octray_math::transform::rotation_xyz_degrees(DVec3::new(80.0, 10.0, 35.0));
    vec![
        Solid::difference([
            plate,
            move_to(Solid::union([drill, sink]), at(-0.9, -0.4, 0.0)),
            seal.clone(),
        ]),
        seal,
        knob,
        move_to(moved(&rod, &[tilt]), at(0.2, 0.1, 0.9)),
    ]
}

/// The machine of size 1 under a map.
fn mapped(chain: &[DAffine3]) -> Subject {
    Subject::new(machine(1.0).iter().map(|solid| moved(solid, chain)))
}

fn bounds(solids: &[Solid]) -> Aabb {
    solids
        .iter()
        .map(Solid::bounds)
        .fold(Aabb::EMPTY, Aabb::union)
}

#[test]
fn a_scene_scaled_by_a_power_of_two_has_the_same_bits() {
    let still = Subject::new(machine(1.0));
    let around = bounds(&machine(1.0));
    for exponent in [-30, 30] {
        let k = libm::ldexp(1.0, exponent);
        let scale = DAffine3::from_scale(DVec3::splat(k));
        for scaled in [Subject::new(machine(k)), mapped(&[scale])] {
            let mut met = 0;
            for case in 0..cases(1000) {
                let ray = general_ray(&mut Draw::new(60, case), &around);
                let expected = still.crossings(ray);
                met += expected.len();
                // Everything scaled, and with the direction as it was.
                assert_eq!(scaled.crossings(ray.transformed(&scale)), expected);
                let got = scaled.crossings(Ray::new(ray.origin * k, ray.direction));
                let stretched: Vec<Hit> = expected
                    .into_iter()
                    .map(|hit| Hit {
                        t: hit.t * k,
                        ..hit
                    })
                    .collect();
                assert_eq!(got, stretched);
            }
            assert!(met > 1000, "{met}");
        }
    }
}

/// Asserts that the machine mapped by `map`, which scales by `k`, has the machine's crossings to
/// within `place` (in the machine's units), at steep angles of incidence.
fn check_mapped(map: &DAffine3, k: f64, subject: &Subject, place: f64, seed: u64) {
    let still = Subject::new(machine(1.0));
    let around = bounds(&machine(1.0));
    let (mut compared, mut worst) = (0, 0.0_f64);
    for case in 0..cases(2000) {
        let ray = general_ray(&mut Draw::new(seed, case), &around);
        let far = Ray::new(
            map.transform_point3(ray.origin),
            map.transform_vector3(ray.direction) / k,
        );
        let expected = still.crossings(ray);
        let query = RayQuery::new(ray);
        let steepness = |hit: &Hit| {
            let normal = still.world.interact(&query, hit).normal;
            normal.dot(ray.direction).abs()
        };
        if expected.iter().any(|hit| steepness(hit) < 1e-2) {
            continue;
        }
        let got = subject.crossings(far);
        assert_eq!(got.len(), expected.len(), "{ray:?}\n{got:?}\n{expected:?}");
        for (got, expected) in got.iter().zip(&expected) {
            let off = (got.t / k - expected.t).abs() * steepness(expected);
            worst = worst.max(off);
            assert!(off <= place, "{ray:?}: {off:e} {place:e}");
            assert_eq!((got.face, got.entering), (expected.face, expected.entering));
            assert_eq!((got.from, got.to), (expected.from, expected.to));
            compared += 1;
        }
    }
    assert!(compared > 1000, "{compared}");
    // A promise that is kept a thousandfold should be made stricter.
    assert!(worst > 1e-3 * place, "{worst:e} {place:e}");
}

#[test]
fn a_scene_scaled_by_a_billion_or_a_billionth_is_the_same() {
    for k in [1e-9, 1e9] {
        let map = DAffine3::from_scale(DVec3::splat(k));
        for subject in [mapped(&[map]), Subject::new(machine(k))] {
            check_mapped(&map, k, &subject, 1e-14, 61);
        }
    }
}

/// What a point's coordinates are rounded to at a distance, and a line's place by its origin's and
/// its direction's rounding: some of the last places of the distance.
fn rounding_at(distance: f64) -> f64 {
    8.0 * f64::EPSILON * distance
}

#[test]
fn a_scene_turned_and_carried_a_million_diameters_away_is_the_same() {
    let diameter = bounds(&machine(1.0)).diagonal();
    let away = DVec3::new(0.6, -0.5, 0.62).normalize() * 1e6 * diameter;
    for (seed, offset) in [DVec3::ZERO, away, DVec3::Z * 1e6 * diameter]
        .into_iter()
        .enumerate()
    {
        let motion = Motion {
            degrees: DVec3::new(21.0, -47.0, 163.0),
            offset,
        };
        let place = 1e-12 * diameter + rounding_at(offset.length());
        let map = motion.matrix();
        for chain in &chains(&motion)[..5] {
            let subject = mapped(chain);
            let place = if offset == DVec3::ZERO { 1e-14 } else { place };
            check_mapped(&map, 1.0, &subject, place, 70 + seed as u64);
        }
    }
}

#[test]
fn no_wall_comes_up_between_solids_that_touch_a_million_diameters_away() {
    let motion = Motion {
        degrees: DVec3::new(21.0, -47.0, 163.0),
        offset: DVec3::new(3e6, -1.7e6, 2.2e6),
    };
    let chains = &chains(&motion)[..5];
    for (seed, (_, pieces)) in assemblies().into_iter().enumerate() {
        let far: Vec<Solid> = pieces
            .iter()
            .zip(chains.iter().cycle())
            .map(|(piece, chain)| moved(piece, chain))
            .collect();
        let assembly = Assembly::new(&far);
        let met: usize = (0..cases(400))
            .map(|case| {
                let ray = general_ray(&mut Draw::new(80 + seed as u64, case), &assembly.bounds);
                assembly.check(ray, 1e-6)
            })
            .sum();
        assert!(met > 100, "{met}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(60) as u32))]

    #[test]
    fn random_solids_scaled_by_a_power_of_two_have_the_same_bits(
        model in model(), exponent in -40..40, lines in proptest::collection::vec((point(4.0), point(1.0)), 20),
    ) {
        // Unbounded solids have no size of their own: what is near them is decided in units of 1.
        let around = Solid::sphere(6.0).expect("valid");
        let solid = Solid::intersection([model.solid, around]);
        let k = libm::ldexp(1.0, exponent);
        let scale = DAffine3::from_scale(DVec3::splat(k));
        let (still, scaled) = (Subject::one(&solid), Subject::one(&moved(&solid, &[scale])));
        for (origin, direction) in lines {
            let ray = Ray::new(origin, direction);
            prop_assert_eq!(scaled.crossings(ray.transformed(&scale)), still.crossings(ray));
        }
    }
}
