//! A differential fuzzer: random scenes of solids against membership by definition.
//!
//! `OCTRAY_CASES` multiplies the work of the default run (10 000 rays), `OCTRAY_SEED` changes the
//! scenes. The full run of ten million rays:
//!
//! ```text
//! OCTRAY_CASES=1000 cargo test --release -p octray-world --test differential -- --nocapture random
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

use campaign::Campaign;
use check::{Tally, check};
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
    let campaign = Campaign {
        seed: setting("OCTRAY_SEED", 1),
        scenes: 100 * cases,
        rays_per_scene: 100,
    };
    let report = campaign.run(|report| {
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
    assert!(report.undecidable() < 0.1, "{}", report.undecidable());
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
