//! One thread at work: primary rays of a tile, and everything they lead to.

use octray_math::Ray;
use octray_world::{Departure, Hit, RayQuery, World};

use crate::cost::Ledger;
use crate::integrator::{Integrator, ShadowTracer};
use crate::path::{PathState, Queues, RayKind};
use crate::sampler::{pixel_position, sample_key};
use crate::stats::RenderStats;
use crate::tile::{Tile, TileFilm};
use crate::{Observer, Plan, PrimaryRays, Shows};

/// Rays that are traced together, at most.
const SLICE: usize = 1024;
/// From this many waiting rays on, slices become smaller, so that the queue stays short: a slice
/// of one adds at most one waiting ray per generation.
const LONG_QUEUE: usize = 8 * SLICE;
/// Shadow rays that wait, at most, where the scene has no more lamps than that.
const MAX_SHADOWS: usize = 64 * SLICE;

/// Renders tiles one after the other; keeps its buffers.
pub(crate) struct TileRenderer<'a> {
    world: &'a World,
    integrator: &'a dyn Integrator,
    rays: &'a PrimaryRays,
    plan: &'a Plan,
    observer: &'a dyn Observer,
    shadow_tracer: ShadowTracer<'a>,
    queues: Queues,
    slice: Vec<PathState>,
    queries: Vec<RayQuery>,
    /// Of rays of a later kind.
    run_hits: Vec<Hit>,
    hits: Vec<Hit>,
}

/// What became of a tile.
pub(crate) struct TileResult {
    pub(crate) film: TileFilm,
    /// The first so many of the tile's pixels are finished.
    pub(crate) finished: usize,
    pub(crate) stats: RenderStats,
}

impl TileResult {
    /// Whether all pixels of the tile are finished.
    pub(crate) fn is_whole(&self) -> bool {
        self.finished == self.film.tile().pixels().count()
    }
}

impl<'a> TileRenderer<'a> {
    pub(crate) fn new(
        world: &'a World,
        integrator: &'a dyn Integrator,
        rays: &'a PrimaryRays,
        plan: &'a Plan,
        observer: &'a dyn Observer,
    ) -> Self {
        Self {
            world,
            integrator,
            rays,
            plan,
            observer,
            shadow_tracer: ShadowTracer::new(world),
            queues: Queues::default(),
            slice: Vec::new(),
            queries: Vec::new(),
            run_hits: Vec::new(),
            hits: Vec::new(),
        }
    }

    /// All samples of all pixels of the tile, or of the first ones if cancelled meanwhile.
    pub(crate) fn render(&mut self, tile: &Tile) -> TileResult {
        let dark = || TileFilm::new(*tile, self.plan.crop.width);
        let costs = (self.plan.shows == Shows::Cost).then(dark);
        let mut ledger = Ledger::for_film(costs);
        let mut result = TileResult {
            film: dark(),
            finished: 0,
            stats: RenderStats::default(),
        };
        let spp = self.plan.spp as usize;
        let pixels: Vec<_> = tile.pixels().collect();
        let total = pixels.len() * spp;
        let mut next = 0;
        while next < total {
            let end = (next + self.slice_length()).min(total);
            for index in next..end {
                let sample = (index % spp) as u32;
                let state = self.primary(pixels[index / spp], sample);
                self.queues.paths.push(state);
            }
            // The newest ray is taken first: this keeps the samples in order.
            self.queues.paths.reverse();
            if !self.drain(&mut result.film, &mut ledger, &mut result.stats) {
                break;
            }
            next = end;
            result.finished = next / spp;
        }
        // Instead of the light.
        if let Some(costs) = ledger.into_film() {
            result.film = costs;
        }
        result
    }

    fn primary(&self, (x, y): (u32, u32), sample: u32) -> PathState {
        let plan = self.plan;
        let pixel = (plan.crop.x + x, plan.crop.y + y);
        let position = pixel_position(plan.seed, pixel, sample, plan.spp);
        let Ray { origin, direction } = self.rays.ray(pixel, position);
        PathState {
            origin,
            direction,
            key: sample_key(plan.seed, pixel.0, pixel.1, sample),
            throughput: [1.0; 3],
            pixel: y * plan.crop.width + x,
            departure: Departure::NONE,
            generation: 1,
            kind: RayKind::Primary,
            odd: sample % 2 == 1,
        }
    }

    /// Traces and shades until nothing waits, the newest rays first. `false` if cancelled; then
    /// nothing waits either.
    fn drain(&mut self, film: &mut TileFilm, ledger: &mut Ledger, stats: &mut RenderStats) -> bool {
        while !self.queues.paths.is_empty() {
            if self.observer.cancelled() {
                self.queues.paths.clear();
                return false;
            }
            self.shade_slice(film, ledger, stats);
            while !self.queues.shadows.is_empty() {
                let rest = self.queues.shadows.len().saturating_sub(SLICE);
                let newest = &self.queues.shadows[rest..];
                self.shadow_tracer.trace(newest, film, ledger, stats);
                self.queues.shadows.truncate(rest);
            }
        }
        true
    }

    fn shade_slice(&mut self, film: &mut TileFilm, ledger: &mut Ledger, stats: &mut RenderStats) {
        let waiting = self.queues.paths.len();
        stats.longest_queue = stats.longest_queue.max(waiting as u64);
        let rest = waiting.saturating_sub(self.slice_length());
        self.slice.clear();
        self.slice.extend(self.queues.paths.drain(rest..).rev());
        // By kind, so that costs can be told apart; the film does not mind the order.
        if !self.slice.is_sorted_by_key(|state| state.kind) {
            self.slice.sort_by_key(|state| state.kind);
        }
        self.hits.clear();
        for run in self.slice.chunk_by(|a, b| a.kind == b.kind) {
            let kind = run[0].kind;
            self.queries.clear();
            self.queries.extend(run.iter().map(PathState::query));
            let is_first = self.hits.is_empty();
            let hits = if is_first {
                &mut self.hits
            } else {
                &mut self.run_hits
            };
            let cost = ledger.closest(self.world, &self.queries, run.iter(), hits, stats);
            *stats.queries.of_path(kind) += cost;
            let met = hits.iter().filter(|hit| !hit.is_miss()).count();
            *stats.rays.of_path(kind) += run.len() as u64;
            *stats.hits.of_path(kind) += met as u64;
            if !is_first {
                self.hits.append(&mut self.run_hits);
            }
        }
        self.integrator
            .shade(&self.slice, &self.hits, film, &mut self.queues, stats);
    }

    /// How many rays to take next: fewer where many wait, and where each makes many shadow rays.
    fn slice_length(&self) -> usize {
        let by_queue = match self.queues.paths.len() {
            waiting if waiting < LONG_QUEUE => SLICE,
            waiting if waiting < 2 * LONG_QUEUE => SLICE / 32,
            _ => 1,
        };
        let lights = self.world.scene().lights().len().max(1);
        by_queue.min(MAX_SHADOWS / lights).max(1)
    }
}
