//! Times of all contenders, chunk by chunk: each chunk is given to all of them, one after the other,
//! several times, and of each contender's times the smallest counts.
//!
//! What else the machine does then slows all of them alike, and not the one that was at work.

use std::ops::Range;
use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

use crate::contender::{Answer, Contender};
use crate::rays::Rays;

/// Rays of a chunk.
pub const CHUNK: usize = 16_384;
/// The share of the distance by which two distances may differ.
const TOLERANCE: f64 = 1e-4;

/// What one contender did with all rays of one kind.
#[derive(Clone, Copy, Debug, Default)]
pub struct Score {
    /// Processor seconds, the sum over chunks.
    pub seconds: f64,
    /// Rays that met another triangle than octray says, or met something where it says nothing, or
    /// the other way round.
    pub other: usize,
    /// Rays that met the same triangle at a distance that differs by more than one in ten thousand.
    pub moved: usize,
}

/// What a clock of the system shows, in seconds.
fn clock(which: ClockId) -> f64 {
    let time = clock_gettime(which);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32).as_secs_f64()
}

/// Processor seconds of this thread.
fn thread_seconds() -> f64 {
    clock(ClockId::ThreadCPUTime)
}

/// Runs `work` and returns how long it took: processor seconds of all threads with `alone`, else
/// seconds.
pub fn timed<T>(alone: bool, work: impl FnOnce() -> T) -> (T, f64) {
    let which = if alone {
        ClockId::ProcessCPUTime
    } else {
        ClockId::Monotonic
    };
    let start = clock(which);
    let result = work();
    (result, clock(which) - start)
}

/// Gives all rays to all contenders.
pub fn measure(rays: &Rays, contenders: &mut [Contender<'_>], repetitions: u32) -> Vec<Score> {
    let mut scores = vec![Score::default(); contenders.len()];
    let mut answers = vec![Answer::MISS; CHUNK];
    for first in (0..rays.len()).step_by(CHUNK) {
        let chunk = first..rays.len().min(first + CHUNK);
        let answers = &mut answers[..chunk.len()];
        let mut least = vec![f64::INFINITY; contenders.len()];
        for repetition in 0..repetitions {
            for (index, contender) in contenders.iter_mut().enumerate() {
                let start = thread_seconds();
                contender.answer(rays, chunk.clone(), answers);
                least[index] = least[index].min(thread_seconds() - start);
                if repetition == 0 {
                    compare(rays, chunk.clone(), answers, &mut scores[index]);
                }
            }
        }
        for (score, least) in scores.iter_mut().zip(least) {
            score.seconds += least;
        }
    }
    scores
}

/// Counts the answers that differ from those of octray's world.
fn compare(rays: &Rays, chunk: Range<usize>, answers: &[Answer], score: &mut Score) {
    for (answer, hit) in answers.iter().zip(&rays.hits[chunk]) {
        let truth = Answer::of(hit, rays.kind);
        if answer.triangle != truth.triangle || answer.t.is_finite() != truth.t.is_finite() {
            // Triangles that share the place where the ray passes are as good as each other.
            let same_place = (answer.t - truth.t).abs() <= TOLERANCE * truth.t;
            score.other += usize::from(!same_place);
        } else if (answer.t - truth.t).abs() > TOLERANCE * truth.t {
            score.moved += 1;
        }
    }
}
