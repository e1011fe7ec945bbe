//! One suite for every method over whole scenes: pictures and answers to the bit as by brute force.
//!
//! By default small scenes (up to 2,000 primitives, and not much work) are rendered by every method; the others
//! are dealt a selection of combinations that together has every pair, large scenes with smaller pictures;
//! large meshes are asked by 2,000 rays.
//! `OCTRAY_CONFORMANCE=full` (what `make conformance` sets) takes the full product everywhere, with more cells
//! and larger pictures, but for scenes of more than 5,000 solids;
//! `OCTRAY_CONFORMANCE_SCENE` takes only the scenes whose name contains its value.

mod combination;
#[path = "../corpus/mod.rs"]
mod corpus;
mod evidence;
mod scenes;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use combination::{Combination, pairwise, product, usual};
use evidence::{Evidence, Questions, brute_force_tests};
use rayon::prelude::*;
use scenes::{Collection, Specimen};

/// Scenes of more primitives are not small.
const SMALL: usize = 2_000;
/// What cells may take, in bytes: building is most of the work, and few cells are as wrong as many.
const MEMORY_LIMIT: u64 = 512 << 10;
/// The same where the full product is asked for.
const FULL_MEMORY_LIMIT: u64 = 16 << 20;
/// Nor are those of which brute force, for 16 x 12 pixels, makes more intersection tests.
const LITTLE_WORK: u64 = 20_000;
/// Of solids that overlap a ray in their thousands brute force asks each again at every change, which takes as
/// long as the square of their number: scenes of more solids are vast, and even the full product looks at them
/// in small pictures. Those of the corpus are left out without being asked for.
const VAST: usize = 5_000;
/// The selection goes round among so many large scenes, or meshes.
const HANDS: usize = 32;

/// How a scene is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    Small,
    Large,
    Vast,
    Mesh,
}

impl Class {
    fn of(specimen: &Specimen) -> Self {
        if specimen.primitives > SMALL {
            let is_mesh = specimen.is_mesh;
            return match specimen.primitives {
                _ if is_mesh => Self::Mesh,
                n if n > VAST => Self::Vast,
                _ => Self::Large,
            };
        }
        if brute_force_tests(specimen, PREVIEW) > LITTLE_WORK {
            Self::Large
        } else {
            Self::Small
        }
    }

    const fn questions(self, full: bool) -> Questions {
        let (picture, rays) = match (self, full) {
            (Self::Small, _) => (Some((64, 48)), 64),
            (Self::Large, true) => (Some((32, 24)), 64),
            (Self::Large, false) | (Self::Vast, _) => (Some(PREVIEW), 64),
            (Self::Mesh, _) => (None, 2_000),
        };
        Questions {
            picture,
            rays,
            one_pass: matches!(self, Self::Mesh) && !full,
        }
    }

    /// The combinations for one of the class, by its place there.
    fn combinations(self, place: usize, full: bool) -> Vec<Combination> {
        match (self, full) {
            (_, true) => product(),
            (Self::Small, _) => usual(),
            (Self::Large | Self::Vast | Self::Mesh, _) => {
                let all = pairwise().iter().copied().skip(place % HANDS);
                all.step_by(HANDS).collect()
            }
        }
    }
}

const PREVIEW: (u32, u32) = (16, 12);

/// One scene's share of the work.
struct Subject {
    specimen: Specimen,
    class: Class,
    full: bool,
    questions: Questions,
    brute: Evidence,
}

#[derive(Default)]
struct Row {
    scenes: usize,
    combinations: BTreeSet<String>,
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
    specimens.retain(|specimen| {
        let is_ours = specimen.name.starts_with("scenes/");
        let is_large = !specimen.is_mesh && specimen.primitives > VAST;
        let is_vast = is_large && !is_ours && !full;
        if is_vast {
            println!("skipped: {}: brute force takes minutes", specimen.name);
        }
        !is_vast && specimen.name.contains(&only)
    });
    let subjects = distinct(specimens, full);
    let mut places: BTreeMap<Class, usize> = BTreeMap::new();
    let mut work = Vec::new();
    for subject in &subjects {
        let place = places.entry(subject.class).or_default();
        work.push((subject, subject.class.combinations(*place, full)));
        *place += 1;
    }
    // One list of all worlds: scenes inside of which work is shared would all be begun at once.
    let jobs: Vec<(usize, Combination)> = work
        .iter()
        .enumerate()
        .flat_map(|(i, (_, combinations))| combinations.iter().map(move |c| (i, *c)))
        .collect();
    let left: Vec<AtomicUsize> = work
        .iter()
        .map(|(_, c)| AtomicUsize::new(c.len()))
        .collect();
    let spent: Vec<AtomicUsize> = work.iter().map(|_| AtomicUsize::new(0)).collect();
    let (done, worlds) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let look = |&(i, combination): &(usize, Combination)| {
        let start = Instant::now();
        let found = work[i].0.difference(&combination);
        let took = usize::try_from(start.elapsed().as_millis()).unwrap_or(usize::MAX);
        spent[i].fetch_add(took, Ordering::Relaxed);
        let made = worlds.fetch_add(1, Ordering::Relaxed) + 1;
        if made.is_multiple_of(1000) {
            eprintln!("{made} of {} worlds", jobs.len());
        }
        if left[i].fetch_sub(1, Ordering::Relaxed) == 1 {
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let (name, all) = (&work[i].0.specimen.name, work.len());
            let took = spent[i].load(Ordering::Relaxed);
            eprintln!(
                "{done} of {all}: {name} by {} in {took} ms",
                work[i].1.len()
            );
        }
        found.map(|difference| {
            eprintln!("{difference}");
            (i, difference)
        })
    };
    let differing: Vec<(usize, String)> =
        jobs.par_iter().with_max_len(1).filter_map(look).collect();
    let mut found: Vec<Vec<String>> = vec![Vec::new(); work.len()];
    for (i, difference) in differing {
        found[i].push(difference);
    }

    let mut table: BTreeMap<Class, Row> = BTreeMap::new();
    for ((subject, combinations), found) in work.iter().zip(&found) {
        let row = table.entry(subject.class).or_default();
        let (pixels, rays) = subject.brute.counts();
        row.scenes += 1;
        row.combinations
            .extend(combinations.iter().map(ToString::to_string));
        row.worlds += combinations.len();
        row.pixels += pixels * combinations.len() as u64;
        row.rays += rays * combinations.len() as u64;
        row.differences += found.len();
    }
    println!("scenes   number  combinations  worlds     pixels       rays  differences");
    for (class, row) in &table {
        println!(
            "{:8} {:6} {:13} {:7} {:10} {:10} {:12}",
            format!("{class:?}").to_lowercase(),
            row.scenes,
            row.combinations.len(),
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
        let mut config = combination.config();
        let limit = if self.full {
            FULL_MEMORY_LIMIT
        } else {
            MEMORY_LIMIT
        };
        config.criteria.memory_limit = config.criteria.memory_limit.min(limit);
        let evidence = Evidence::of(&self.specimen, &config, self.questions);
        let difference = evidence.difference(&self.brute)?;
        Some(format!(
            "{} by {combination}: {difference}",
            self.specimen.name
        ))
    }
}

/// What brute force makes of each scene; of scenes that look and answer alike, the first.
#[expect(clippy::print_stdout, reason = "a scene that is left out is said")]
#[expect(clippy::print_stderr, reason = "long runs say how far they are")]
fn distinct(specimens: Vec<Specimen>, full: bool) -> Vec<Subject> {
    let by_brute_force = |specimen: Specimen| {
        let start = Instant::now();
        let class = Class::of(&specimen);
        let questions = class.questions(full);
        let config = Combination::BRUTE.config();
        let brute = Evidence::of(&specimen, &config, questions);
        let took = start.elapsed().as_millis();
        eprintln!("by brute force: {} ({class:?}) in {took} ms", specimen.name);
        Subject {
            brute,
            full,
            class,
            questions,
            specimen,
        }
    };
    // One by one: a few take as long as all others together.
    let all: Vec<Subject> = specimens
        .into_par_iter()
        .with_max_len(1)
        .map(by_brute_force)
        .collect();
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

#[test]
fn the_hands_together_hold_the_selection() {
    let hands = (0..HANDS).flat_map(|place| Class::Large.combinations(place, false));
    let names: BTreeSet<String> = hands.map(|c| c.to_string()).collect();
    assert_eq!(names, pairwise().iter().map(ToString::to_string).collect());
}
