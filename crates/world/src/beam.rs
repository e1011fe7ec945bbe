//! Neighbouring rays of a slice go through the upper cells together.

use octray_math::{Interval, Ray};

use crate::line::Line;
use crate::slice::Account;
use crate::solids::{Scratch, Solids};
use crate::{Counters, RayQuery, World};

/// Rays that travel together, at most.
const RUN: usize = 64;
/// Runs that are gathered at a time: rays to several lamps alternate.
const RUNS: usize = 4;
/// How far the directions of a run may be apart, by their components divided by that on the main
/// axis.
const SPREAD: f64 = 0.125;

/// Rays that will travel together.
#[derive(Debug, Default)]
struct Run {
    /// Where in the slice they stand.
    indices: Vec<usize>,
    lines: Vec<Line>,
}

impl Run {
    /// Whether a line may join: it goes about where the first one goes.
    fn takes(&self, line: &Line) -> bool {
        let Some(first) = self.lines.first() else {
            return true;
        };
        let (a, b) = (line.ray.direction, first.ray.direction);
        let size = b.abs();
        let larger = |x: usize, y: usize| if size[y] > size[x] { y } else { x };
        let main = larger(larger(0, 1), 2);
        let apart = (a * (b[main] / a[main]) - b).abs().max_element();
        a[main] * b[main] > 0.0 && (a * b).min_element() >= 0.0 && apart <= SPREAD * size[main]
    }
}

/// Working memory of slices in beams.
#[derive(Debug, Default)]
pub(crate) struct Runs {
    runs: [Run; RUNS],
    rays: Vec<(Ray, Interval)>,
}

impl World {
    /// Whether neighbouring rays travel together.
    pub(crate) fn has_beams(&self) -> bool {
        self.solids.has_beams() || self.sheets.triangles().has_beams()
    }

    /// Gives every query's line to `answer`, with its place in the slice: those of a run one after
    /// the other when it has entered the cells as a beam. What that cost is divided evenly. A query
    /// that is no ray is left out.
    pub(crate) fn answer_in_beams(
        &self,
        queries: &[RayQuery],
        scratch: &mut Scratch,
        account: &mut Account<'_>,
        mut answer: impl FnMut(usize, &Line, &mut Scratch, &mut Counters),
    ) {
        let mut memory = std::mem::take(&mut scratch.runs);
        let Runs { runs, rays } = &mut memory;
        // The run that a line was added to last stands first.
        for (index, query) in queries.iter().enumerate() {
            account.of(index).rays += 1;
            let Some(line) = self.line(query, false) else {
                continue;
            };
            let place = runs.iter().position(|run| run.takes(&line));
            // None takes it: the one that has waited longest goes.
            let place = place.unwrap_or(RUNS - 1);
            if !runs[place].takes(&line) || runs[place].lines.len() == RUN {
                self.answer_run(&mut runs[place], rays, scratch, account, &mut answer);
            }
            runs[place].indices.push(index);
            runs[place].lines.push(line);
            runs[..=place].rotate_right(1);
        }
        for run in runs {
            self.answer_run(run, rays, scratch, account, &mut answer);
        }
        scratch.runs = memory;
    }

    /// Answers the lines of a run, which is empty then.
    fn answer_run(
        &self,
        run: &mut Run,
        rays: &mut Vec<(Ray, Interval)>,
        scratch: &mut Scratch,
        account: &mut Account<'_>,
        answer: &mut impl FnMut(usize, &Line, &mut Scratch, &mut Counters),
    ) {
        let Run { indices, lines } = run;
        if lines.len() > 1 {
            rays.clear();
            let part = |line: &Line| (line.ray, Interval::new(line.origin, line.end));
            rays.extend(lines.iter().map(part));
            let mut shared = self.solids.enter(rays, scratch);
            let triangles = self.sheets.triangles();
            let steps = triangles.enter(rays, &mut scratch.triangles);
            shared.cells += steps.cells;
            shared.lookups += steps.lookups;
            for (place, index) in indices.iter().enumerate() {
                *account.of(*index) += shared.share(place, indices.len());
            }
        }
        for (index, line) in indices.iter().zip(lines.iter()) {
            answer(*index, line, scratch, account.of(*index));
        }
        Solids::leave(scratch);
        scratch.triangles.leave();
        indices.clear();
        lines.clear();
    }
}
