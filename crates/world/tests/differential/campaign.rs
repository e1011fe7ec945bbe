//! Many scenes with many rays each, all from one seed.

use std::collections::BTreeMap;

use octray_math::{hash_combine, hash_u64};
use octray_world::Method;
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
    /// The only method; else every scene draws one of all.
    pub(crate) method: Option<Method>,
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
    /// Rays by each method.
    pub(crate) by_method: BTreeMap<String, u64>,
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
        for (method, rays) in other.by_method {
            *self.by_method.entry(method).or_default() += rays;
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
        let methods = self.by_method.iter();
        std::iter::once(all)
            .chain(each.map(|(family, tally)| line(&format!("  {family:?}"), tally)))
            .chain(methods.map(|(method, rays)| format!("  by {method}: {rays} rays")))
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

    fn method_of(&self, scene: u64) -> Method {
        let drawn = || {
            let all = Method::all();
            let key = hash_combine(hash_u64(!self.seed), scene);
            all[(key % all.len() as u64) as usize]
        };
        self.method.unwrap_or_else(drawn)
    }

    fn scene(&self, index: u64) -> Report {
        let mut report = Report {
            scenes: 1,
            ..Report::default()
        };
        let mut draw = Draw::new(self.seed, index);
        let mut model = generator::scene(&mut draw);
        model.method = self.method_of(index);
        let Some(subject) = model.prepare() else {
            return report;
        };
        let rays = Rays::new(&subject.oracle);
        let asked = report
            .by_method
            .entry(model.method.to_string())
            .or_default();
        for _ in 0..self.rays_per_scene {
            *asked += 1;
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
