//! One suite for every method: each answers every query as brute force does, to the bit.

mod answers;
mod parts;
mod random;

use answers::{Answers, answers, methods, rays_about};
use octray_geometry::Solid;
use octray_math::{DVec3, Ray};
use octray_world::Method;
use parts::world;
use proptest::prelude::*;
use random::{model, point};

/// The answers that all methods agree on.
fn conform(solids: &[(Solid, i32)], rays: &[Ray]) -> Answers {
    let expected = answers(&world(solids, Method::Brute), rays);
    for method in methods() {
        assert_eq!(answers(&world(solids, method), rays), expected, "{method}");
    }
    expected
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(25))]

    #[test]
    fn every_method_answers_as_brute_force_does(
        models in proptest::collection::vec((model(), 0..2i32), 1..6),
        rays in proptest::collection::vec((point(4.0), point(1.0)), 30),
    ) {
        let solids: Vec<(Solid, i32)> = models.iter().map(|(m, p)| (m.solid.clone(), *p)).collect();
        let rays: Vec<Ray> = rays.into_iter().map(|(o, d)| Ray::new(o, d)).collect();
        let answers = conform(&solids, &rays);
        // And brute force itself knows who is where.
        for (ray, region) in rays.iter().zip(answers.regions) {
            let holds: Vec<_> = models.iter().map(|(m, _)| m.recipe.contains(ray.origin)).collect();
            if holds.iter().all(|(_, margin)| *margin > 1e-6) {
                let found = region.object().map(|object| holds[object.0 as usize].0);
                prop_assert_eq!(found.unwrap_or(true), found.is_some() || !holds.iter().any(|h| h.0));
            }
        }
    }
}

#[test]
fn odd_scenes_end_with_the_right_answers() {
    let ball = |radius: f64, at: DVec3| {
        let ball = Solid::sphere(radius).expect("valid");
        (ball.translate(at).expect("finite"), 0)
    };
    // Nothing; one object; all at one point; huge coordinates; flat; a needle; only unbounded.
    conform(&[], &rays_about(DVec3::ZERO, 1.0));
    conform(&[ball(1.0, DVec3::ONE)], &rays_about(DVec3::ONE, 1.0));
    let stacked: Vec<_> = (1..20)
        .map(|i| ball(f64::from(i) * 0.05, DVec3::ONE))
        .collect();
    conform(&stacked, &rays_about(DVec3::ONE, 1.0));
    let far = DVec3::new(1e30, -1e30, 3e29);
    conform(
        &[ball(1e29, far), ball(2e29, far * 0.9)],
        &rays_about(far, 1e29),
    );
    let slab = |size: DVec3| (Solid::cuboid(-size, size).expect("valid"), 0);
    conform(
        &[slab(DVec3::new(1.0, 1.0, 1e-9))],
        &rays_about(DVec3::ZERO, 1.0),
    );
    conform(
        &[slab(DVec3::new(1e6, 0.5, 0.5)), ball(1.0, DVec3::X)],
        &rays_about(DVec3::ZERO, 1.0),
    );
    let floor = (Solid::half_space(DVec3::Z, -0.5).expect("valid"), 0);
    conform(std::slice::from_ref(&floor), &rays_about(DVec3::ZERO, 1.0));
    conform(
        &[floor, ball(1.0, DVec3::ZERO)],
        &rays_about(DVec3::ZERO, 1.0),
    );
}
