//! Many rays at once: slices of them, over the threads of the pool that one is called in.
//!
//! Answers stand in the order of the rays and are the same bits for any number of threads. Beside
//! them only what the threads have in work is held in memory.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use octray_geometry::FaceId;
use octray_math::{DVec3, Ray};
use rayon::prelude::*;
use thiserror::Error;

use crate::slice::Account;
use crate::solids::Scratch;
use crate::{Chord, ChordEnd, Counters, Hit, Overlaps, RayQuery, Region, World};

/// Rays that one thread takes at a time. A thread looks after each whether it should stop.
const SLICE: usize = 1024;

/// A ray as numbers: its origin, then its direction, of any length.
pub type RayRow = [f64; 6];

/// A list for each ray, all in one array.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lists<T> {
    /// Where the list of each ray starts in `items`, and at last how many items there are.
    pub offsets: Vec<u64>,
    /// The lists, one after the other.
    pub items: Vec<T>,
}

impl<T> Lists<T> {
    /// The list of a ray.
    ///
    /// # Panics
    /// There is no such ray.
    #[must_use]
    pub fn of(&self, ray: usize) -> &[T] {
        &self.items[self.offsets[ray] as usize..self.offsets[ray + 1] as usize]
    }

    /// The number of lists.
    #[must_use]
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is no list.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Why there are no answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum BatchError {
    /// One was asked to stop.
    #[error("stopped before all rays were answered")]
    Cancelled,
    /// The lists of all rays together need more memory than there is.
    #[error("the lists of all rays together do not fit into memory: ask for fewer rays at a time")]
    OutOfMemory,
}

/// Asks a world about many rays at once.
#[derive(Clone, Copy, Debug)]
pub struct Batch<'a> {
    world: &'a World,
    cancel: &'a AtomicBool,
}

impl World {
    /// Queries for many rays at once, which end early once `cancel` is true.
    #[must_use]
    pub const fn batch<'a>(&'a self, cancel: &'a AtomicBool) -> Batch<'a> {
        let world = self;
        Batch { world, cancel }
    }
}

/// The query of a row, up to `t_max`.
#[must_use]
pub fn row_query(row: &RayRow, t_max: f64) -> RayQuery {
    let [ox, oy, oz, dx, dy, dz] = *row;
    RayQuery {
        t_max,
        ..RayQuery::new(Ray::new(DVec3::new(ox, oy, oz), DVec3::new(dx, dy, dz)))
    }
}

fn whole_query(row: &RayRow) -> RayQuery {
    row_query(row, f64::INFINITY)
}

impl Batch<'_> {
    /// The nearest surface on each ray; see [`World::closest`].
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn closest(&self, rays: &[RayRow]) -> Result<Vec<Hit>, BatchError> {
        if self.world.has_beams() {
            return self.in_beams(rays, f64::INFINITY, Hit::MISS, |queries, hits| {
                self.world.closest(queries, hits, &mut Counters::default());
            });
        }
        self.each(rays.len(), Hit::MISS, |ray, scratch| {
            let query = whole_query(&rays[ray]);
            self.world
                .closest_one(&query, scratch, &mut Counters::default())
        })
    }

    /// Position of the surface that each ray meets, as [`World::interact`] has it; NaN for a miss.
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn positions(&self, rays: &[RayRow], hits: &[Hit]) -> Result<Vec<DVec3>, BatchError> {
        self.each(rays.len(), DVec3::NAN, |ray, _| match &hits[ray] {
            hit if hit.is_miss() => DVec3::NAN,
            hit => whole_query(&rays[ray]).ray.at(hit.t),
        })
    }

    /// Unit normal of the surface that each ray meets, as [`World::interact`] has it; NaN for a miss.
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn normals(&self, rays: &[RayRow], hits: &[Hit]) -> Result<Vec<DVec3>, BatchError> {
        self.each(rays.len(), DVec3::NAN, |ray, _| match &hits[ray] {
            hit if hit.is_miss() => DVec3::NAN,
            hit => self.world.normal(&whole_query(&rays[ray]), hit),
        })
    }

    /// Whether anything, transparent or not, lies on each ray at `0 < t < t_max`.
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn meets_any(&self, rays: &[RayRow], t_max: f64) -> Result<Vec<bool>, BatchError> {
        if self.world.has_beams() {
            return self.in_beams(rays, t_max, false, |queries, blocked| {
                let account = Account::Sum(&mut Counters::default());
                self.world
                    .meets_on_account(queries, &|_| true, blocked, account);
            });
        }
        self.each(rays.len(), false, |ray, scratch| {
            let query = row_query(&rays[ray], t_max);
            self.world
                .meets_any(&query, &|_| true, scratch, &mut Counters::default())
        })
    }

    /// How many boundaries each ray crosses; see [`World::count_crossings`].
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn count_crossings(
        &self,
        rays: &[RayRow],
        whole_line: bool,
    ) -> Result<Vec<u64>, BatchError> {
        self.each(rays.len(), 0, |ray, scratch| {
            let line = self.world.line(&whole_query(&rays[ray]), whole_line);
            line.map_or(0, |line| {
                self.world
                    .count_on_line(&line, scratch, &mut Counters::default())
            })
        })
    }

    /// The chords of each ray; see [`World::chords`].
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn chords(
        &self,
        rays: &[RayRow],
        whole_line: bool,
        overlaps: Overlaps,
    ) -> Result<Lists<Chord>, BatchError> {
        self.lists(rays.len(), |ray, scratch, chords| {
            if let Some(line) = self.world.line(&whole_query(&rays[ray]), whole_line) {
                let counters = &mut Counters::default();
                self.world
                    .add_chords(&line, overlaps, scratch, chords, counters);
            }
        })
    }

    /// The normals at both ends of every chord, as [`World::chord_normal`] has them; NaN where no
    /// face is crossed.
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn chord_normals(
        &self,
        rays: &[RayRow],
        chords: &Lists<Chord>,
    ) -> Result<Lists<[DVec3; 2]>, BatchError> {
        self.lists(rays.len(), |ray, _, normals| {
            let query = whole_query(&rays[ray]);
            let normal = |end: &ChordEnd| match end.face {
                FaceId::NONE => DVec3::NAN,
                _ => self.world.chord_normal(&query, end),
            };
            let own = chords.of(ray).iter();
            normals.extend(own.map(|chord| [normal(&chord.enter), normal(&chord.exit)]));
        })
    }

    /// The boundaries that are seen on each ray; see [`World::crossings`].
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn crossings(&self, rays: &[RayRow], whole_line: bool) -> Result<Lists<Hit>, BatchError> {
        self.lists(rays.len(), |ray, scratch, hits| {
            if let Some(line) = self.world.line(&whole_query(&rays[ray]), whole_line) {
                self.world
                    .add_crossings(&line, scratch, hits, &mut Counters::default());
            }
        })
    }

    /// The region of each point; see [`World::regions`].
    ///
    /// # Errors
    /// See [`BatchError`].
    pub fn regions(&self, points: &[[f64; 3]]) -> Result<Vec<Region>, BatchError> {
        self.each(points.len(), Region::OUTSIDE, |point, scratch| {
            self.world
                .region_of(points[point].into(), scratch, &mut Counters::default())
        })
    }

    /// What `answer` finds for slices of the rays, which travel together; `blank` stands where the
    /// answers will be.
    fn in_beams<T: Copy + Send + Sync>(
        &self,
        rays: &[RayRow],
        t_max: f64,
        blank: T,
        answer: impl Fn(&[RayQuery], &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, BatchError> {
        self.in_place(rays.len(), blank, |slice, places| {
            let queries = rays[slice].iter().map(|row| row_query(row, t_max));
            let mut answers = Vec::with_capacity(places.len());
            answer(&queries.collect::<Vec<_>>(), &mut answers);
            places.copy_from_slice(&answers);
        })
    }

    /// `answer` for every index; `blank` stands where the answers will be.
    fn each<T: Copy + Send + Sync>(
        &self,
        count: usize,
        blank: T,
        answer: impl Fn(usize, &mut Scratch) -> T + Sync,
    ) -> Result<Vec<T>, BatchError> {
        self.in_place(count, blank, |slice, places| {
            self.world.scratch.with(|scratch| {
                for (index, place) in slice.zip(places) {
                    *place = answer(index, scratch);
                }
            });
        })
    }

    /// `work` on every slice of the indices and of the answers. The threads share in fetching the
    /// memory for these too, which takes as long as many an answer.
    fn in_place<T: Copy + Send + Sync>(
        &self,
        count: usize,
        blank: T,
        work: impl Fn(Range<usize>, &mut [T]) + Sync,
    ) -> Result<Vec<T>, BatchError> {
        let mut all = room(count)?;
        let one = |(slice, places): (usize, &mut [T])| {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(BatchError::Cancelled);
            }
            let start = slice * SLICE;
            work(start..start + places.len(), places);
            Ok(())
        };
        // A few rays are answered before another thread would have started.
        if count <= SLICE {
            all.resize(count, blank);
            all.chunks_mut(SLICE).enumerate().try_for_each(one)?;
        } else {
            all.par_extend(rayon::iter::repeat_n(blank, count).with_min_len(SLICE));
            all.par_chunks_mut(SLICE).enumerate().try_for_each(one)?;
        }
        Ok(all)
    }

    /// What `add` adds for every index.
    fn lists<T: Send>(
        &self,
        count: usize,
        add: impl Fn(usize, &mut Scratch, &mut Vec<T>) + Sync,
    ) -> Result<Lists<T>, BatchError> {
        let slices = self.slices(count, |slice, scratch| {
            let mut items = Vec::with_capacity(slice.len());
            let mut ends = Vec::with_capacity(slice.len());
            for index in slice {
                add(index, scratch, &mut items);
                ends.push(items.len() as u64);
            }
            (ends, items)
        })?;
        let mut offsets = room(count + 1)?;
        offsets.push(0);
        let mut items = room(slices.iter().map(|(_, items)| items.len()).sum())?;
        for (ends, part) in slices {
            let before = items.len() as u64;
            offsets.extend(ends.into_iter().map(|end| before + end));
            items.extend(part);
        }
        Ok(Lists { offsets, items })
    }

    /// `work` on every slice of the indices, in order.
    fn slices<T: Send>(
        &self,
        count: usize,
        work: impl Fn(Range<usize>, &mut Scratch) -> T + Sync,
    ) -> Result<Vec<T>, BatchError> {
        let one = |slice: usize| {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(BatchError::Cancelled);
            }
            let start = slice * SLICE;
            let indices = start..count.min(start + SLICE);
            Ok(self.world.scratch.with(|scratch| work(indices, scratch)))
        };
        let slices = count.div_ceil(SLICE);
        // A few rays are answered before another thread would have started.
        if slices <= 1 {
            return (0..slices).map(one).collect();
        }
        (0..slices).into_par_iter().map(one).collect()
    }
}

/// Room for so many answers.
fn room<T>(count: usize) -> Result<Vec<T>, BatchError> {
    let mut all = Vec::new();
    all.try_reserve_exact(count)
        .map_err(|_| BatchError::OutOfMemory)?;
    Ok(all)
}
