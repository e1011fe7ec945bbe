//! The schedule of a picture: which pixels when, on which thread. It does not show in the result.

use std::sync::{Mutex, PoisonError};

use octray_scene::{Camera, Encoding};
use octray_world::World;
use rayon::prelude::*;

use crate::checkpoint::{CheckpointError, place_records, tile_record};
use crate::image::Image;
use crate::integrator::Whitted;
use crate::tile::{Tile, TileFilm};
use crate::tile_renderer::{TileRenderer, TileResult};
use crate::{Film, Plan, PrimaryRays, RenderConfig, RenderError, RenderStats, Shows};

/// Pixels along the edge of a tile of the last pass, a multiple of 2; where pixels have many
/// samples, fewer.
const TILE_EDGES: [(u32, u32); 3] = [(256, 8), (16, 16), (1, 32)];
/// Pixels, of those that a coarse pass renders, along the edge of its tiles.
const COARSE_TILE_EDGE: u32 = 16;
/// Distances of the pixels in the passes of a progressive rendering.
const PASSES: [u32; 4] = [8, 4, 2, 1];

/// Who watches a rendering. Both functions are called from the threads that render and should
/// be quick.
pub trait Observer: Sync {
    /// `done` of `total` pixels are finished. Called by one thread at a time; never decreases.
    fn progress(&self, done: u64, total: u64) {
        let _ = (done, total);
    }

    /// All of a tile's pixels are finished.
    fn finished(&self, tile: &Tile, light: &TileFilm) {
        let _ = (tile, light);
    }

    /// Whether to stop as soon as possible.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Nobody watches.
impl Observer for () {}

/// A picture being made, pass by pass.
#[derive(Debug)]
pub struct RenderJob<'a> {
    world: &'a World,
    plan: Plan,
    rays: PrimaryRays,
    film: Film,
    stats: RenderStats,
    done: u64,
    passes_left: &'static [u32],
    resumed: bool,
    cancelled: bool,
}

/// A picture that is finished, or as far as it came before it was cancelled.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The light (or the costs), and which pixels have it.
    pub film: Film,
    /// What it cost.
    pub stats: RenderStats,
    /// What was decided before it began.
    pub plan: Plan,
    /// What the film's values mean.
    pub encoding: Encoding,
}

/// Renders a picture in the current rayon pool, seen by `camera`, else by the scene's.
///
/// If the observer cancels, the result has the pixels that were finished until then.
///
/// # Errors
/// There is no camera, or a number of the configuration is out of its range.
pub fn render(
    world: &World,
    camera: Option<&Camera>,
    config: &RenderConfig,
    observer: &dyn Observer,
) -> Result<Rendering, RenderError> {
    let mut job = RenderJob::new(world, camera, config)?;
    while job.run_pass(observer) {}
    Ok(job.finish())
}

impl<'a> RenderJob<'a> {
    /// Prepares a picture seen by `camera`, else by the scene's.
    ///
    /// # Errors
    /// There is no camera, or a number of the configuration is out of its range.
    pub fn new(
        world: &'a World,
        camera: Option<&Camera>,
        config: &RenderConfig,
    ) -> Result<Self, RenderError> {
        let scene = world.scene();
        let plan = config.plan(scene.settings())?;
        let camera = camera.or(scene.camera()).ok_or(RenderError::NoCamera)?;
        let rays = PrimaryRays::new(camera, plan.size)?;
        Ok(Self {
            world,
            plan,
            rays,
            film: Film::new(plan.crop, plan.spp),
            stats: RenderStats::default(),
            done: 0,
            passes_left: if plan.progressive {
                &PASSES
            } else {
                &PASSES[PASSES.len() - 1..]
            },
            resumed: false,
            cancelled: false,
        })
    }

    /// Takes over the tiles of a [`Checkpoint`](crate::Checkpoint) of this picture: they are not
    /// rendered again.
    ///
    /// # Errors
    /// A record is damaged or not of this picture; those before it have been taken.
    pub fn resume<'r>(
        &mut self,
        records: &'r [u8],
    ) -> Result<Vec<(Tile, &'r [u8])>, CheckpointError> {
        self.resumed = true;
        let placed = place_records(records, &mut self.film);
        self.done = self.film.complete_pixels();
        placed
    }

    /// Renders the next pass; returns whether there is another one. Without
    /// [`RenderConfig::progressive`] there is only one.
    pub fn run_pass(&mut self, observer: &dyn Observer) -> bool {
        let Some((stride, later)) = self.passes_left.split_first() else {
            return false;
        };
        let refines = self.plan.progressive && *stride != PASSES[0];
        self.passes_left = later;
        let edge = if *stride == 1 {
            self.plan.tile_edge()
        } else {
            COARSE_TILE_EDGE
        };
        let crop = self.plan.crop;
        let mut tiles = Tile::cover((crop.width, crop.height), edge, *stride, refines);
        if self.resumed {
            tiles.retain(|tile| !self.film.has(tile));
        }
        let (world, plan, rays) = (self.world, &self.plan, &self.rays);
        let integrator = Whitted::new(world, plan);
        let total = u64::from(crop.width) * u64::from(crop.height);
        let shared = Mutex::new((&mut self.film, &mut self.stats, &mut self.done));
        tiles.par_iter().for_each_init(
            || TileRenderer::new(world, &integrator, rays, plan, observer),
            |renderer, tile| {
                if observer.cancelled() {
                    return;
                }
                let result = renderer.render(tile);
                if result.is_whole() {
                    observer.finished(tile, &result.film);
                }
                let mut shared = shared.lock().unwrap_or_else(PoisonError::into_inner);
                let (film, stats, done) = &mut *shared;
                **done += take(film, tile, &result);
                **stats += result.stats;
                observer.progress(**done, total);
            },
        );
        self.cancelled |= observer.cancelled();
        !(self.cancelled || self.passes_left.is_empty())
    }

    /// The picture so far; missing pixels show the nearest coarser one.
    #[must_use]
    pub fn preview(&self) -> Image {
        Image::coarse_from_film(&self.film, self.encoding())
    }

    /// The light so far.
    #[must_use]
    pub const fn film(&self) -> &Film {
        &self.film
    }

    /// Ends the job, finished or not.
    #[must_use]
    pub fn finish(self) -> Rendering {
        let encoding = self.encoding();
        Rendering {
            film: self.film,
            stats: self.stats,
            plan: self.plan,
            encoding,
        }
    }

    /// What the film's values mean.
    fn encoding(&self) -> Encoding {
        match self.plan.shows {
            Shows::Light => self.world.scene().settings().encoding,
            Shows::Cost => Encoding::Linear,
        }
    }
}

/// Moves the finished pixels of a tile to the film; returns how many it did not have before.
fn take(film: &mut Film, tile: &Tile, result: &TileResult) -> u64 {
    let mut new = 0;
    for pixel in tile.pixels().take(result.finished) {
        new += u64::from(!film.is_complete(pixel.0, pixel.1));
        film.finish_pixel(pixel, result.film.sums(pixel));
    }
    new
}

impl Plan {
    /// Pixels along the edge of the tiles that are rendered at once.
    #[must_use]
    pub fn tile_edge(&self) -> u32 {
        let edge = TILE_EDGES.iter().find(|(least, _)| self.spp >= *least);
        edge.map_or(TILE_EDGES[2].1, |(_, edge)| *edge)
    }

    /// The tiles of the whole picture: whoever renders them all, in whatever order and wherever,
    /// has the picture.
    #[must_use]
    pub fn tiles(&self) -> Vec<Tile> {
        let size = (self.crop.width, self.crop.height);
        Tile::cover(size, self.tile_edge(), 1, false)
    }
}

/// Renders some tiles of a picture in the current rayon pool; gives their records for
/// [`place_records`], in the order of the tiles. Those that were not finished when the observer cancelled are left
/// out.
///
/// # Errors
/// There is no camera, or it is not finite.
pub fn render_tiles(
    world: &World,
    plan: &Plan,
    tiles: &[Tile],
    observer: &dyn Observer,
) -> Result<(Vec<u8>, RenderStats), RenderError> {
    let camera = world.scene().camera().ok_or(RenderError::NoCamera)?;
    let rays = PrimaryRays::new(camera, plan.size)?;
    let integrator = Whitted::new(world, plan);
    let parts: Vec<Option<(Vec<u8>, RenderStats)>> = tiles
        .par_iter()
        .map_init(
            || TileRenderer::new(world, &integrator, &rays, plan, observer),
            |renderer, tile| {
                if observer.cancelled() {
                    return None;
                }
                let result = renderer.render(tile);
                let whole = result.is_whole();
                whole.then(|| (tile_record(tile, &result.film), result.stats))
            },
        )
        .collect();
    let mut stats = RenderStats::default();
    let mut records = Vec::new();
    for (record, own) in parts.into_iter().flatten() {
        records.extend_from_slice(&record);
        stats += own;
    }
    Ok((records, stats))
}

impl Rendering {
    /// Whether every pixel is finished.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let crop = self.plan.crop;
        self.film.complete_pixels() == u64::from(crop.width) * u64::from(crop.height)
    }

    /// The picture in linear light; unfinished pixels are black.
    #[must_use]
    pub fn image(&self) -> Image {
        Image::from_film(&self.film, self.encoding)
    }

    /// The picture in linear light; unfinished pixels of a progressive rendering show the
    /// nearest coarser one.
    #[must_use]
    pub fn coarse_image(&self) -> Image {
        Image::coarse_from_film(&self.film, self.encoding)
    }
}
