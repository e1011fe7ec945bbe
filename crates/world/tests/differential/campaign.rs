//! Many scenes with many rays each, all from one seed.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::check::{Disagreement, Tally, check};
use crate::draw::Draw;
use crate::generator::{self, Family, Rays, aim};
use crate::model::Case;

/// How much to do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Campaign {
    pub(crate) seed: u64,
    /// The first scene's number.
    pub(crate) first: u64,
    pub(crate) scenes: u64,
    pub(crate) rays_per_scene: u32,
}

/// A disagreement and where it was found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) scene: u64,
    pub(crate) family: Family,
    pub(crate) case: Case,
    pub(crate) disagreement: Disagreement,
}

/// What came out.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    pub(crate) tally: Tally,
    pub(crate) by_family: BTreeMap<Family, Tally>,
    pub(crate) scenes: u64,
    /// The first of every scene that has any.
    pub(crate) found: Vec<Found>,
}

impl Report {
    fn add(mut self, other: Self) -> Self {
        self.tally.add(&other.tally);
        self.scenes += other.scenes;
        for (family, tally) in other.by_family {
            self.by_family.entry(family).or_default().add(&tally);
        }
        self.found.extend(other.found);
        self
    }

    /// The figures, one line for all and one for each family of rays.
    pub(crate) fn lines(&self) -> Vec<String> {
        let line = |name: &str, t: &Tally| {
            format!(
                "{name}: {} rays, {} crossings, {} points ({:.2}% undecidable), {} pieces ({} in faces, {} short, {} blind)",
                t.rays,
                t.crossings,
                t.samples,
                100.0 * share(t),
                t.pieces,
                t.in_faces,
                t.short,
                t.blind,
            )
        };
        let all = line(&format!("{} scenes", self.scenes), &self.tally);
        let each = self.by_family.iter();
        std::iter::once(all)
            .chain(each.map(|(family, tally)| line(&format!("  {family:?}"), tally)))
            .collect()
    }
}

fn share(tally: &Tally) -> f64 {
    tally.undecidable as f64 / tally.samples.max(1) as f64
}

impl Campaign {
    /// Runs all scenes in the current thread pool; `progress` gets the report so far now and then,
    /// and says whether to go on.
    pub(crate) fn run(&self, mut progress: impl FnMut(&Report) -> bool) -> Report {
        const BATCH: u64 = 256;
        let mut report = Report::default();
        let (mut start, last) = (self.first, self.first + self.scenes);
        while start < last {
            let end = last.min(start + BATCH);
            let scenes: Vec<Report> = (start..end)
                .into_par_iter()
                .map(|index| self.scene(index))
                .collect();
            report = scenes.into_iter().fold(report, Report::add);
            start = end;
            if !progress(&report) {
                break;
            }
        }
        report
    }

    fn scene(&self, index: u64) -> Report {
        let mut report = Report {
            scenes: 1,
            ..Report::default()
        };
        let mut draw = Draw::new(self.seed, index);
        let model = generator::scene(&mut draw);
        let Some(subject) = model.prepare() else {
            return report;
        };
        let rays = Rays::new(&subject.oracle);
        for _ in 0..self.rays_per_scene {
            let (family, ray) = aim(&mut draw, &rays);
            let mut tally = Tally::default();
            let result = check(&subject, ray, &mut tally);
            report.tally.add(&tally);
            report.by_family.entry(family).or_default().add(&tally);
            if let Err(disagreement) = result {
                let case = Case {
                    model: model.clone(),
                    ray,
                };
                report.found.push(Found {
                    scene: index,
                    family,
                    case,
                    disagreement,
                });
                break;
            }
        }
        report
    }
}
