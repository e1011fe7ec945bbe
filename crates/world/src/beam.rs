//! Neighbouring rays of a slice go through the upper cells together.

use octray_math::{Interval, Ray};

use crate::line::Line;
use crate::slice::Account;
use crate::solids::Scratch;
use crate::{Counters, RayQuery, World};

/// Rays that travel together, at most.
const RUN: usize = 64;
/// How far the directions of a run may be apart, by their components divided by that on the main axis.
const SPREAD: f64 = 0.125;

/// Whether a line goes about where another one does.
fn goes_along(line: &Line, first: &Line) -> bool {
    let (a, b) = (line.ray.direction, first.ray.direction);
    let size = b.abs();
    let main = (0..3).fold(
        0,
        |main, axis| if size[axis] > size[main] { axis } else { main },
    );
    let apart = (a * (b[main] / a[main]) - b).abs().max_element();
    a[main] * b[main] > 0.0 && (a * b).min_element() >= 0.0 && apart <= SPREAD * size[main]
}

impl World {
    /// Gives every query's line (`None` for one that is none) to `answer`, in order; those of a run
    /// when it has entered the cells as a beam. What that cost is divided evenly.
    pub(crate) fn answer_in_beams(
        &self,
        queries: &[RayQuery],
        scratch: &mut Scratch,
        account: &mut Account<'_>,
        mut answer: impl FnMut(Option<Line>, &mut Scratch, &mut Counters),
    ) {
        let mut lines: Vec<Option<Line>> = Vec::with_capacity(RUN);
        let mut rays: Vec<(Ray, Interval)> = Vec::with_capacity(RUN);
        let mut start = 0;
        let mut next = queries.first().and_then(|query| self.line(query, false));
        while start < queries.len() {
            lines.clear();
            rays.clear();
            let first = next;
            // The line that ends the run begins the next one.
            loop {
                lines.push(next);
                rays.extend(next.map(|l| (l.ray, Interval::new(l.origin, l.end))));
                let Some(query) = queries.get(start + lines.len()) else {
                    break;
                };
                next = self.line(query, false);
                let is_along = first.zip(next).is_some_and(|(a, b)| goes_along(&b, &a));
                if lines.len() == RUN || !is_along {
                    break;
                }
            }
            let shared = if rays.len() > 1 {
                self.solids.enter(&rays, scratch)
            } else {
                Counters::default()
            };
            for (index, line) in lines.iter().enumerate() {
                let counters = account.of(start + index);
                counters.rays += 1;
                *counters += shared.share(index, lines.len());
                answer(*line, scratch, counters);
            }
            self.solids.leave(scratch);
            start += lines.len();
        }
    }
}
