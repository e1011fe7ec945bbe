//! Laws that hold for all solids, random ones first of all: no oracle is needed.
//!
//! Where both sides of a law stand in one world they share their surfaces, and the chords must be
//! the same to the bit.

use octray_geometry::Solid;
use octray_math::{DAffine3, DVec3, Ray, transform};
use octray_world::Hit;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;

use crate::random::{Model, model, point};
use crate::subject::{Subject, cases, symmetric_difference};

/// An object's chords on a line.
type Chords = Vec<[f64; 2]>;

fn or(solids: &[&Solid]) -> Solid {
    Solid::union(solids.iter().map(|s| (*s).clone()))
}

fn and(solids: &[&Solid]) -> Solid {
    Solid::intersection(solids.iter().map(|s| (*s).clone()))
}

fn minus(solids: &[&Solid]) -> Solid {
    Solid::difference(solids.iter().map(|s| (*s).clone()))
}

/// The chords of every object, as if it were alone.
fn chords(subject: &Subject, ray: Ray) -> Vec<Chords> {
    let objects = subject.world.scene().objects().len();
    let mut all = vec![Chords::new(); objects];
    for chord in subject.chords(ray) {
        all[chord.object.0 as usize].push([chord.enter.t, chord.exit.t]);
    }
    all
}

/// Every group of solids has the same chords within the group.
fn same_chords(groups: &[Vec<Solid>], lines: &[(DVec3, DVec3)]) -> TestCaseResult {
    let subject = Subject::new(groups.iter().flatten().cloned());
    for (origin, direction) in lines {
        let all = chords(&subject, Ray::new(*origin, *direction));
        let mut rest = all.as_slice();
        for (index, group) in groups.iter().enumerate() {
            let (own, others) = rest.split_at(group.len());
            for chords in own {
                prop_assert_eq!(chords, &own[0], "group {}", index);
            }
            rest = others;
        }
    }
    Ok(())
}

fn lines() -> impl Strategy<Value = Vec<(DVec3, DVec3)>> {
    proptest::collection::vec((point(4.0), point(1.0)), 30)
}

/// Parameters of what is entered and, negated, of what is left, sorted; what is entered and left
/// at one parameter is left out.
fn balance<'a>(all: impl IntoIterator<Item = &'a Chords>) -> Vec<(f64, i32)> {
    let ends = all.into_iter().flatten();
    let mut signs: Vec<(f64, i32)> = ends.flat_map(|[s, e]| [(*s, 1), (*e, -1)]).collect();
    signs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sums = signs.chunk_by(|a, b| a.0 == b.0);
    sums.map(|same| (same[0].0, same.iter().map(|(_, sign)| sign).sum()))
        .filter(|(_, sum)| *sum != 0)
        .collect()
}

fn moved(solid: &Solid, m: DAffine3) -> Solid {
    solid.transform(m).expect("invertible")
}

/// The single object's intervals, unbounded ones cut off.
fn bounded(subject: &Subject, ray: Ray) -> Chords {
    let all = chords(subject, ray).swap_remove(0);
    all.into_iter()
        .map(|ends| ends.map(|t| t.clamp(-1e3, 1e3)))
        .collect()
}

/// What is left of the precision of a crossing that is nearly a touch.
const ROUNDED: f64 = 1e-7;

/// Tangents turn a rounding error `e` into a chord of `sqrt(e)`, and what is nearly coincident may
/// come to lie on the other side of the surface table's tolerance.
const MOVED: f64 = 1e-5;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(60) as u32))]

    #[test]
    fn de_morgan(a in model(), b in model(), lines in lines()) {
        let (a, b) = (&a.solid, &b.solid);
        let (not_a, not_b) = (&a.complement(), &b.complement());
        same_chords(&[
            vec![or(&[a, b]).complement(), and(&[not_a, not_b])],
            vec![and(&[a, b]).complement(), or(&[not_a, not_b])],
            vec![minus(&[a, b]), and(&[a, not_b]), or(&[not_a, b]).complement()],
            vec![a.clone(), not_a.complement()],
        ], &lines)?;
    }

    #[test]
    fn operands_can_be_swapped_regrouped_and_distributed(
        a in model(), b in model(), c in model(), lines in lines(),
    ) {
        let (a, b, c) = (&a.solid, &b.solid, &c.solid);
        same_chords(&[
            vec![
                or(&[a, &or(&[b, c])]), or(&[&or(&[a, b]), c]), or(&[a, b, c]), or(&[c, &or(&[b, a])]),
            ],
            vec![
                and(&[a, &and(&[b, c])]), and(&[&and(&[a, b]), c]), and(&[c, b, a]),
            ],
            vec![and(&[a, &or(&[b, c])]), or(&[&and(&[a, b]), &and(&[a, c])])],
            vec![or(&[a, &and(&[b, c])]), and(&[&or(&[a, b]), &or(&[a, c])])],
            vec![minus(&[a, b, c]), minus(&[&minus(&[a, c]), b]), minus(&[a, &or(&[b, c])])],
            vec![a.clone(), or(&[a, &and(&[a, b])]), and(&[a, &or(&[a, c])])],
        ], &lines)?;
    }

    #[test]
    fn chords_of_two_are_those_of_union_and_intersection(
        a in model(), b in model(), lines in lines(),
    ) {
        let (a, b) = (&a.solid, &b.solid);
        let subject = Subject::new([a.clone(), b.clone(), or(&[a, b]), and(&[a, b])]);
        for (origin, direction) in lines {
            let all = chords(&subject, Ray::new(origin, direction));
            prop_assert_eq!(balance(&all[..2]), balance(&all[2..]));
            let length = |all: &[Chords]| -> f64 { all.iter().flatten().map(|[s, e]| e - s).sum() };
            let (apart, together) = (length(&all[..2]), length(&all[2..]));
            if apart.is_finite() {
                prop_assert!((apart - together).abs() <= 1e-12 * (1.0 + apart));
            }
        }
    }

    #[test]
    fn a_line_meets_the_same_both_ways(models in proptest::collection::vec(model(), 1..3), lines in lines()) {
        let subject = Subject::new(models.into_iter().map(|m| m.solid));
        for (origin, direction) in lines {
            let there = subject.crossings(Ray::new(origin, direction));
            let mut back = subject.crossings(Ray::new(origin, -direction));
            back.reverse();
            prop_assert_eq!(there.len(), back.len());
            for (there, back) in there.iter().zip(&back) {
                // The roots of quartics are bracketed from one side.
                prop_assert!((there.t + back.t).abs() <= ROUNDED * (direction.length().recip() + there.t.abs()));
                let (t, turned) = (there.t, !back.entering);
                let back = Hit { t, entering: turned, from: back.to, to: back.from, ..*back };
                prop_assert_eq!(there, &back);
            }
        }
    }

    #[test]
    fn a_complement_is_where_the_solid_is_not(model in model(), lines in lines()) {
        let Model { solid, .. } = model;
        let subject = Subject::new([solid.clone(), solid.complement()]);
        let everything = vec![(f64::NEG_INFINITY, 1), (f64::INFINITY, -1)];
        for (origin, direction) in lines {
            let ray = Ray::new(origin, direction);
            let all = chords(&subject, ray);
            prop_assert_eq!(balance(&all), everything.clone());
            let hits = subject.crossings(ray);
            prop_assert!(hits.iter().all(|hit| hit.from.object() != hit.to.object()));
            prop_assert!(hits.iter().all(|hit| hit.from.object().and(hit.to.object()).is_some()));
        }
    }

    #[test]
    fn a_mirrored_solid_is_met_by_mirrored_lines(model in model(), lines in lines()) {
        let m = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let (still, mirrored) = (Subject::one(&model.solid), Subject::one(&moved(&model.solid, m)));
        for (origin, direction) in lines {
            let ray = Ray::new(origin, direction);
            let (there, image) = (still.crossings(ray), mirrored.crossings(ray.transformed(&m)));
            prop_assert_eq!(there.len(), image.len());
            for (there, image) in there.iter().zip(&image) {
                prop_assert!((there.t - image.t).abs() <= ROUNDED * (direction.length().recip() + there.t.abs()));
                prop_assert_eq!(*there, Hit { t: there.t, ..*image });
            }
        }
    }

    #[test]
    fn a_moved_solid_is_met_by_moved_lines(
        model in model(), degrees in point(180.0), offset in point(3.0), lines in lines(),
    ) {
        let m = DAffine3::from_translation(offset) * transform::rotation_xyz_degrees(degrees);
        let (still, moving) = (Subject::one(&model.solid), Subject::one(&moved(&model.solid, m)));
        for (origin, direction) in lines {
            let ray = Ray::new(origin, direction);
            let moved = ray.transformed(&m);
            let wrong = symmetric_difference(&bounded(&still, ray), &bounded(&moving, moved));
            prop_assert!(wrong * direction.length() <= MOVED, "{}", wrong);
        }
    }
}
