//! Operations that must cancel: `A - A`, `A + A`, `(A - B) + (A & B)`.

use octray_geometry::Solid;
use octray_math::{Aabb, DVec3};
use proptest::prelude::*;

use crate::draw::Draw;
use crate::random::{Model, model, point};
use crate::subject::{Motion, Subject, axis_ray, cases, chains, general_ray, moved};

fn primitives() -> Vec<Solid> {
    let at = DVec3::new;
    vec![
        Solid::sphere(1.3),
        Solid::cuboid(at(-1.0, -0.4, 0.1), at(0.3, 1.7, 1.0 / 3.0)),
        Solid::cylinder(0.7, -1.0, 1.1),
        Solid::cone(1.0, 0.3, -1.0, 0.9),
        Solid::cone(0.0, 1.1, -1.0, 0.9),
        Solid::torus(1.1, 0.4),
        Solid::torus(0.5, 0.7),
        Solid::half_space(at(1.0, 0.3, -0.2), 0.4),
        Solid::infinite_cylinder(0.8),
    ]
    .into_iter()
    .map(|solid| solid.expect("valid"))
    .collect()
}

#[test]
fn a_solid_minus_itself_has_no_boundary_whatever_way_it_was_turned() {
    let motion = Motion {
        degrees: DVec3::new(-20.0, 65.0, 200.3),
        offset: DVec3::new(1.9, 0.3, -0.7),
    };
    let chains = chains(&motion);
    let around = Aabb::new(DVec3::splat(-3.0), DVec3::splat(3.0));
    for (seed, solid) in primitives().into_iter().enumerate() {
        let same = |chain: &Vec<_>| {
            let turned = moved(&solid, chain);
            let first = moved(&solid, &chains[0]);
            [
                Subject::one(&Solid::difference([first.clone(), turned.clone()])),
                Subject::one(&Solid::intersection([first.complement(), turned])),
            ]
        };
        let nothing: Vec<Subject> = chains.iter().flat_map(same).collect();
        for case in 0..cases(500) {
            let draw = &mut Draw::new(20 + seed as u64, case);
            let ray = if case % 2 == 0 {
                general_ray(draw, &around)
            } else {
                axis_ray(draw, &around).transformed(&motion.matrix())
            };
            let subject = &nothing[draw.below(nothing.len())];
            assert_eq!(subject.crossings(ray), [], "{seed}: {ray:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(60) as u32))]

    #[test]
    fn a_random_solid_minus_itself_has_no_boundary_and_plus_itself_is_itself(
        model in model(), lines in proptest::collection::vec((point(4.0), point(1.0)), 30),
    ) {
        let Model { solid: a, .. } = model;
        let twice = |make: fn(Vec<Solid>) -> Solid| Subject::one(&make(vec![a.clone(), a.clone()]));
        let minus = twice(Solid::difference);
        let plus = twice(Solid::union);
        let common = twice(Solid::intersection);
        let alone = Subject::one(&a);
        for (origin, direction) in lines {
            let ray = octray_math::Ray::new(origin, direction);
            prop_assert_eq!(minus.crossings(ray), vec![]);
            // The lowest face is reported: everything is the same, not only the places.
            let expected = alone.crossings(ray);
            prop_assert_eq!(&plus.crossings(ray), &expected);
            prop_assert_eq!(&common.crossings(ray), &expected);
        }
    }

    #[test]
    fn a_random_solid_is_what_another_leaves_of_it_and_what_it_shares_with_it(
        a in model(), b in model(),
        lines in proptest::collection::vec((point(4.0), point(1.0)), 30),
    ) {
        let (a, b) = (a.solid, b.solid);
        let rest = Solid::difference([a.clone(), b.clone()]);
        let shared = Solid::intersection([a.clone(), b]);
        let parts = [
            Subject::one(&Solid::union([rest.clone(), shared.clone()])),
            Subject::one(&Solid::union([shared, rest])),
        ];
        let alone = Subject::one(&a);
        for (origin, direction) in lines {
            let ray = octray_math::Ray::new(origin, direction);
            let places = |subject: &Subject| -> Vec<(f64, bool)> {
                let hits = subject.crossings(ray);
                hits.iter().map(|hit| (hit.t, hit.entering)).collect()
            };
            let expected = places(&alone);
            let got = places(&parts[0]);
            if a.bounds().is_bounded() {
                // The same scene for everyone: the same bits.
                prop_assert_eq!(&got, &expected);
            }
            prop_assert_eq!(got.len(), expected.len());
            for (own, expected) in got.iter().zip(&expected) {
                prop_assert!((own.0 - expected.0).abs() * direction.length() <= 1e-7);
            }
            // Here B's surfaces come first and stand for those of A that coincide with them.
            let turned = places(&parts[1]);
            for found in [got, turned] {
                prop_assert_eq!(found.len(), expected.len());
                for (got, expected) in found.iter().zip(&expected) {
                    prop_assert_eq!(got.1, expected.1);
                }
            }
        }
    }
}
