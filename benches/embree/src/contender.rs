//! Who is measured: octray's ways to ask about rays, and Embree's.

use std::ops::Range;

use octray::geometry::mesh::{SearchCost, SearchMemory, TriangleTree};
use octray::math::Interval;
use octray::world::{Counters, Hit, World};

use crate::library::{EmbreeScene, NOTHING, Packet, Valid};
use crate::rays::{Kind, Rays};

/// What a contender says about a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Infinite for a miss; of shadow rays, which only meet something or not, 0 or infinite.
    pub t: f64,
    /// [`NOTHING`] for a miss and of shadow rays.
    pub triangle: u32,
}

impl Answer {
    /// No triangle.
    pub const MISS: Self = Self {
        t: f64::INFINITY,
        triangle: NOTHING,
    };
    const BLOCKED: Self = Self {
        t: 0.0,
        triangle: NOTHING,
    };

    /// What a hit of octray's world says.
    #[must_use]
    pub fn of(hit: &Hit, kind: Kind) -> Self {
        match (hit.is_miss(), kind) {
            (true, _) => Self::MISS,
            (false, Kind::Shadow) => Self::BLOCKED,
            (false, _) => Self {
                t: hit.t,
                triangle: hit.face.0,
            },
        }
    }

    const fn blocked(is: bool) -> Self {
        if is { Self::BLOCKED } else { Self::MISS }
    }
}

/// Someone who answers rays.
pub enum Contender<'a> {
    /// `World::closest` and `World::occluded` on the chunk as a slice.
    Slice(&'a World, Buffers),
    /// The same on slices of one ray.
    One(&'a World, Buffers),
    /// `TriangleTree::closest` and `any`, ray by ray, without a world around it.
    Tree(&'a TriangleTree, SearchMemory),
    /// Embree's functions for packets of so many rays.
    Embree {
        /// The triangles.
        scene: &'a EmbreeScene<'a>,
        /// 1, 8 or 16.
        width: usize,
        /// Whether Embree is told that the rays are coherent.
        coherent: bool,
    },
}

/// Where octray's world puts its answers.
#[derive(Debug, Default)]
pub struct Buffers {
    hits: Vec<Hit>,
    blocked: Vec<bool>,
}

impl Contender<'_> {
    /// Answers a chunk of the rays into `answers`, which is as long. This is what is timed.
    pub fn answer(&mut self, rays: &Rays, chunk: Range<usize>, answers: &mut [Answer]) {
        match self {
            Self::Slice(world, buffers) => slice(world, buffers, rays, chunk, answers),
            Self::One(world, buffers) => {
                for (ray, answer) in chunk.zip(answers.chunks_exact_mut(1)) {
                    slice(world, buffers, rays, ray..ray + 1, answer);
                }
            }
            Self::Tree(tree, memory) => search(tree, memory, rays, chunk, answers),
            Self::Embree {
                scene,
                width,
                coherent,
            } => match width {
                1 => packets::<1>(scene, *coherent, rays, chunk, answers),
                8 => packets::<8>(scene, *coherent, rays, chunk, answers),
                _ => packets::<16>(scene, *coherent, rays, chunk, answers),
            },
        }
    }
}

fn slice(
    world: &World,
    buffers: &mut Buffers,
    rays: &Rays,
    chunk: Range<usize>,
    answers: &mut [Answer],
) {
    let queries = &rays.queries[chunk];
    let counters = &mut Counters::default();
    if rays.kind == Kind::Shadow {
        world.occluded(queries, &mut buffers.blocked, counters);
        for (answer, &blocked) in answers.iter_mut().zip(&buffers.blocked) {
            *answer = Answer::blocked(blocked);
        }
    } else {
        world.closest(queries, &mut buffers.hits, counters);
        for (answer, hit) in answers.iter_mut().zip(&buffers.hits) {
            *answer = Answer::of(hit, rays.kind);
        }
    }
}

fn search(
    tree: &TriangleTree,
    memory: &mut SearchMemory,
    rays: &Rays,
    chunk: Range<usize>,
    answers: &mut [Answer],
) {
    let cost = &mut SearchCost::default();
    for (query, answer) in rays.queries[chunk].iter().zip(answers) {
        let span = Interval::new(0.0, query.t_max);
        if rays.kind == Kind::Shadow {
            let inside = |_: u32, hit: &octray::geometry::mesh::TriangleHit| {
                hit.t > 0.0 && hit.t < query.t_max
            };
            *answer = Answer::blocked(tree.any(&query.ray, span, memory, cost, inside));
            continue;
        }
        let mut best = Answer::MISS;
        tree.closest(&query.ray, span, memory, cost, |triangle, hit, end| {
            if hit.t <= 0.0 {
                return end;
            }
            if hit.t < best.t || (hit.t == best.t && triangle < best.triangle) {
                best = Answer { t: hit.t, triangle };
            }
            best.t
        });
        *answer = best;
    }
}

#[inline(always)]
fn packets<const N: usize>(
    scene: &EmbreeScene<'_>,
    coherent: bool,
    rays: &Rays,
    chunk: Range<usize>,
    answers: &mut [Answer],
) {
    let mut packet = Packet::<N>::new();
    for (first, answers) in chunk.step_by(N).zip(answers.chunks_mut(N)) {
        let count = answers.len();
        let mut valid = Valid([0; N]);
        valid.0[..count].fill(-1);
        for axis in 0..3 {
            let from = |all: &Vec<f32>, to: &mut [f32; N]| {
                to[..count].copy_from_slice(&all[first..first + count]);
            };
            from(&rays.origin[axis], &mut packet.origin[axis]);
            from(&rays.direction[axis], &mut packet.direction[axis]);
        }
        packet.far = [rays.end; N];
        packet.forget();
        if rays.kind == Kind::Shadow {
            scene.occluded(&valid, &mut packet, coherent);
            for (answer, far) in answers.iter_mut().zip(packet.far) {
                *answer = Answer::blocked(far < 0.0);
            }
        } else {
            scene.closest(&valid, &mut packet, coherent);
            for (lane, answer) in answers.iter_mut().enumerate() {
                *answer = if packet.triangle[lane] == NOTHING {
                    Answer::MISS
                } else {
                    Answer {
                        t: f64::from(packet.far[lane]),
                        triangle: packet.triangle[lane],
                    }
                };
            }
        }
    }
}
