//! One suite for every method over whole scenes: pictures and answers to the bit as by brute force.
//!
//! By default small scenes (up to 2,000 primitives) are rendered by every method; larger ones, smaller,
//! by a selection of combinations that has every pair; large meshes are asked by rays.
//! `OCTRAY_CONFORMANCE=full` (what `make conformance` sets) takes the full product and the full size
//! everywhere and says how far it is;
//! `OCTRAY_CONFORMANCE_SCENE` takes only the scenes whose name contains its value.

mod combination;
#[path = "../corpus/mod.rs"]
mod corpus;
mod evidence;
mod scenes;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use combination::{Combination, pairwise, product, usual};
use evidence::{Evidence, Questions};
use rayon::prelude::*;
use scenes::{Collection, Specimen};

/// Scenes of more primitives are not rendered by every method by default.
const SMALL: usize = 2_000;

/// How a scene is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    Small,
    Large,
    Mesh,
}

impl Class {
    fn of(specimen: &Specimen) -> Self {
        match (specimen.primitives <= SMALL, specimen.is_mesh) {
            (true, _) => Self::Small,
            (false, false) => Self::Large,
            (false, true) => Self::Mesh,
        }
    }

    /// Brute force takes time, and many combinations are not much better on large scenes.
    const fn questions(self, full: bool) -> Questions {
        let (picture, rays) = match (self, full) {
            (Self::Small, _) | (Self::Large, true) => (Some((64, 48)), 64),
            (Self::Large, false) => (Some((16, 12)), 64),
            (Self::Mesh, _) => (None, 2_000),
        };
        Questions { picture, rays }
    }
}

/// One scene's share of the work.
struct Subject {
    specimen: Specimen,
    class: Class,
    questions: Questions,
    brute: Evidence,
}

#[derive(Default)]
struct Row {
    scenes: usize,
    combinations: usize,
    worlds: usize,
    pixels: u64,
    rays: u64,
    differences: usize,
}

#[test]
#[expect(clippy::print_stdout, reason = "what was compared is the result")]
#[expect(clippy::print_stderr, reason = "long runs say how far they are")]
fn every_method_shows_what_brute_force_shows() {
    let full = std::env::var("OCTRAY_CONFORMANCE").is_ok_and(|value| value == "full");
    let only = std::env::var("OCTRAY_CONFORMANCE_SCENE").unwrap_or_default();
    let Collection {
        mut specimens,
        skipped,
    } = Collection::all();
    for reason in skipped {
        println!("skipped: {reason}");
    }
    specimens.retain(|specimen| specimen.name.contains(&only));
    let subjects = distinct(specimens, full);
    let combinations = |class: Class| match (full, class) {
        (true, _) => product(),
        (false, Class::Small) => usual(),
        (false, Class::Large | Class::Mesh) => pairwise(),
    };
    let done = AtomicUsize::new(0);
    let look = |subject: &Subject| {
        let found: Vec<String> = combinations(subject.class)
            .par_iter()
            .filter_map(|combination| subject.difference(combination))
            .collect();
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if full {
            let (name, all) = (&subject.specimen.name, subjects.len());
            eprintln!("{done} of {all}: {name}, {} differences", found.len());
        }
        found
    };
    let found: Vec<Vec<String>> = subjects.par_iter().map(look).collect();

    let mut table: BTreeMap<Class, Row> = BTreeMap::new();
    for (subject, found) in subjects.iter().zip(&found) {
        let row = table.entry(subject.class).or_default();
        let combinations = combinations(subject.class).len();
        let (pixels, rays) = subject.brute.counts();
        row.scenes += 1;
        row.combinations = combinations;
        row.worlds += combinations;
        row.pixels += pixels * combinations as u64;
        row.rays += rays * combinations as u64;
        row.differences += found.len();
    }
    println!("scenes   number  combinations  worlds     pixels       rays  differences");
    for (class, row) in &table {
        println!(
            "{:8} {:6} {:13} {:7} {:10} {:10} {:12}",
            format!("{class:?}").to_lowercase(),
            row.scenes,
            row.combinations,
            row.worlds,
            row.pixels,
            row.rays,
            row.differences
        );
    }
    let differences: Vec<String> = found.into_iter().flatten().collect();
    assert!(
        differences.is_empty(),
        "{} differences, the first ones:\n{}",
        differences.len(),
        differences[..differences.len().min(12)].join("\n")
    );
}

impl Subject {
    fn difference(&self, combination: &Combination) -> Option<String> {
        let evidence = Evidence::of(&self.specimen, &combination.config(), self.questions);
        let difference = evidence.difference(&self.brute)?;
        Some(format!(
            "{} by {combination}: {difference}",
            self.specimen.name
        ))
    }
}

/// What brute force makes of each scene; of scenes that look and answer alike, the first.
#[expect(clippy::print_stdout, reason = "a scene that is left out is said")]
fn distinct(specimens: Vec<Specimen>, full: bool) -> Vec<Subject> {
    let by_brute_force = |specimen: Specimen| {
        let class = Class::of(&specimen);
        let questions = class.questions(full);
        let config = Combination::BRUTE.config();
        Subject {
            brute: Evidence::of(&specimen, &config, questions),
            class,
            questions,
            specimen,
        }
    };
    let all: Vec<Subject> = specimens.into_par_iter().map(by_brute_force).collect();
    let mut subjects: Vec<Subject> = Vec::new();
    for subject in all {
        let name = &subject.specimen.name;
        let twin = |other: &&Subject| {
            other.specimen.primitives == subject.specimen.primitives && other.brute == subject.brute
        };
        if let Some(other) = subjects.iter().find(twin) {
            println!("skipped: {name} is the same as {}", other.specimen.name);
        } else {
            subjects.push(subject);
        }
    }
    subjects
}
