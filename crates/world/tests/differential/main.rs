//! A differential fuzzer: random scenes of solids against membership by definition.
//!
//! `OCTRAY_CASES` multiplies the work of the default run (5000 rays), `OCTRAY_SEED` changes the
//! scenes, `OCTRAY_SCENE` runs one of them alone. Each scene is traced by a method drawn from all, or
//! by the one that `OCTRAY_METHOD` names. The full run of ten million rays:
//!
//! ```text
//! OCTRAY_CASES=2000 cargo test --release -p octray-world --test differential -- --nocapture random
//! ```
//!
//! A disagreement is printed as a case, made as small as it goes: put into a file of
//! `regressions/`, it is tested for good.

mod campaign;
mod check;
mod draw;
mod generator;
mod model;
mod oracle;
mod shrink;
mod text;
mod walls;

use campaign::Campaign;
use check::{Tally, check};
use draw::Draw;
use generator::{Family, Rays, aim};
use model::Case;
use oracle::Sight;
use shrink::shrink;
use text::{parse, read_case, write_case};

fn setting(name: &str, default: u64) -> u64 {
    match std::env::var(name) {
        Ok(value) => value.parse().expect("a whole number"),
        Err(_) => default,
    }
}

#[test]
#[expect(clippy::print_stderr, reason = "long runs say how far they are")]
fn random_scenes_agree_with_membership_by_definition() {
    let cases = setting("OCTRAY_CASES", 1);
    let only = setting("OCTRAY_SCENE", u64::MAX);
    let campaign = Campaign {
        seed: setting("OCTRAY_SEED", 1),
        first: if only == u64::MAX { 0 } else { only },
        scenes: if only == u64::MAX { 40 * cases } else { 1 },
        rays_per_scene: 125,
        method: std::env::var("OCTRAY_METHOD")
            .ok()
            .map(|name| name.parse().expect("a method")),
    };
    let mut told = 0;
    let report = campaign.run(|report| {
        for found in &report.found[told..] {
            eprintln!("scene {}: {:?}", found.scene, found.disagreement.wrong);
        }
        told = report.found.len();
        if report.scenes % (256 * 32) == 0 {
            eprintln!("{}, {} disagree", report.lines()[0], report.found.len());
        }
        report.found.len() < 40
    });
    for line in report.lines() {
        eprintln!("{line}");
    }
    for found in &report.found {
        let small = shrink(&found.case, found.disagreement.wrong);
        let again = small
            .model
            .prepare()
            .and_then(|subject| check(&subject, small.ray, &mut Tally::default()).err());
        let details = again.map_or_else(|| found.disagreement.details.clone(), |d| d.details);
        eprintln!(
            "scene {} ({:?}): {:?}\n{}\n{details}\n",
            found.scene,
            found.family,
            found.disagreement.wrong,
            write_case(&small),
        );
    }
    assert!(report.found.is_empty(), "{} disagree", report.found.len());
    if only != u64::MAX {
        return;
    }
    // Which method a scene draws is chance, but most of all get one.
    let drawn = report.by_method.len();
    assert!(campaign.method.is_some() || drawn > 20, "{drawn} methods");
    // Rays that run along boundaries leave little to compare; the others must not.
    let random = report.by_family[&Family::Random];
    assert!(random.undecidable * 10 < random.samples, "{random:?}");
    assert!(report.tally.blind * 8 < report.tally.pieces);
}

/// The comparison notices what it should: scenes in which everything is moved by a little.
#[test]
fn a_displaced_engine_is_noticed() {
    let (mut noticed, mut scenes) = (0, 0);
    for index in 0..130 {
        let mut draw = Draw::new(7, index);
        let model = generator::scene(&mut draw);
        let Some(subject) = model.prepare() else {
            continue;
        };
        let size = subject.oracle.scene_size() + subject.oracle.center().length();
        let moved = model.moved(draw.direction() * (size * 2.0_f64.powi(-32)));
        let Some(wrong) = model.prepare_as(&moved) else {
            continue;
        };
        let rays = Rays::new(&subject.oracle);
        let (mut crossings, mut found) = (Tally::default(), false);
        for _ in 0..50 {
            let (_, ray) = aim(&mut draw, &rays);
            check(&subject, ray, &mut crossings).expect("the engine is right");
            found |= check(&wrong, ray, &mut Tally::default()).is_err();
        }
        if crossings.crossings >= 10 {
            scenes += 1;
            noticed += u32::from(found);
        }
    }
    assert!(
        scenes > 60 && noticed * 100 >= scenes * 95,
        "{noticed} of {scenes}"
    );
}

/// A wall of no thickness is noticed: two boxes that are apart by more than the tolerance of their
/// own scene, but by far less than that of the oracle's, which has a large box in the distance.
#[test]
fn a_skin_is_noticed() {
    let small = "(box 0 0 0 4 4 4)";
    let gap = 2.0_f64.powi(-36);
    let beside = format!("(box {:?} 0 0 8 4 4)", 4.0 + gap);
    let large = "(box -1000 -1000 -1000 -900 -900 -900)";
    let scene = |boxes: &str| {
        read_case(&parse(&format!(
            "(case (object 0 (union {boxes})) (ray -1 2 1.5 1 0 0))"
        )))
    };
    let oracle = scene(&format!("{small} {beside} {large}"));
    let engine = scene(&format!("{small} {beside}"));
    let subject = oracle.model.prepare_as(&engine.model).expect("a scene");
    let found = check(&subject, oracle.ray, &mut Tally::default());
    assert!(found.is_err_and(|found| found.wrong == check::Wrong::Skin));
    let right = oracle.model.prepare().expect("a scene");
    let found = check(&right, oracle.ray, &mut Tally::default());
    assert!(found.is_ok(), "{found:?}");
}

/// The quick answers of the oracle are those of the exact definitions, near boundaries too.
#[test]
fn rounded_answers_are_exact_where_they_are_given() {
    let (mut given, mut asked) = (0, 0);
    for index in 0..80 {
        let mut draw = Draw::new(11, index);
        let model = generator::scene(&mut draw);
        let Some(subject) = model.prepare() else {
            continue;
        };
        let rays = Rays::new(&subject.oracle);
        for _ in 0..4 {
            let (_, ray) = aim(&mut draw, &rays);
            let sight = Sight::new(&subject.oracle, ray);
            let mut answers = Vec::new();
            let crossed = sight.proposals();
            let near = crossed.iter().take(6).flat_map(|t| {
                let step = sight.parameter(sight.uncertainty(*t));
                [-64.0, -8.0, 0.0, 3.0, 20.0, 1e6].map(|multiple| t + multiple * step)
            });
            for t in near {
                sight.answers(t, &mut answers);
                let exact = subject.oracle.exact_answers(&ray, t);
                for (answer, exact) in answers.iter().zip(&exact) {
                    asked += 1;
                    given += u32::from(answer.is_some());
                    let agree = answer.is_none() || exact.is_none() || answer == exact;
                    let case = Case {
                        model: model.clone(),
                        ray,
                    };
                    assert!(
                        agree,
                        "t = {t:?}: {answer:?} {exact:?} {}",
                        write_case(&case)
                    );
                }
            }
        }
    }
    assert!(asked > 1000 && given * 3 > asked, "{given} of {asked}");
}

#[test]
fn cases_found_before_agree() {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/differential/regressions"
    );
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .expect("the folder of cases")
        .map(|entry| entry.expect("readable").path())
        .collect();
    files.sort();
    assert!(!files.is_empty());
    for file in files {
        let text = std::fs::read_to_string(&file).expect("readable");
        // Lines that start with a semicolon say what the case shows.
        let lines: Vec<&str> = text.lines().filter(|l| !l.starts_with(';')).collect();
        let case = read_case(&parse(&lines.join("\n")));
        let subject = case.model.prepare().expect("a scene");
        if let Err(found) = check(&subject, case.ray, &mut Tally::default()) {
            panic!("{}: {:?}\n{}", file.display(), found.wrong, found.details);
        }
    }
}
