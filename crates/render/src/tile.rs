//! The piece of a picture that one thread works on.

use octray_math::DVec3;

use crate::film::PixelSums;
use crate::path::{PathState, ShadowState};
use crate::stats::RenderStats;

/// Some of the pixels in a rectangle of the film: those whose coordinates are multiples of
/// `stride`, without those that an earlier, coarser pass has rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Left edge in the film, a multiple of `2 * stride`.
    pub x: u32,
    /// Upper edge in the film, a multiple of `2 * stride`.
    pub y: u32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Distance of the pixels.
    pub stride: u32,
    /// Whether the multiples of `2 * stride` are done already.
    pub refines: bool,
}

/// Pixels, of those that a pass renders, along the edge of a block of neighbours.
const BLOCK: u32 = 8;

impl Tile {
    /// All tiles of a film of this size: squares of `edge * stride` pixels, cut at the border.
    #[must_use]
    pub fn cover((width, height): (u32, u32), edge: u32, stride: u32, refines: bool) -> Vec<Self> {
        let step = (edge * stride) as usize;
        let mut tiles = Vec::new();
        for y in (0..height).step_by(step) {
            for x in (0..width).step_by(step) {
                tiles.push(Self {
                    x,
                    y,
                    width: (edge * stride).min(width - x),
                    height: (edge * stride).min(height - y),
                    stride,
                    refines,
                });
            }
        }
        tiles
    }

    /// Its pixels as coordinates in the film: square blocks of neighbours one after the other, whose
    /// rays travel together.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let tile = *self;
        let step = tile.stride as usize;
        let coarser = 2 * tile.stride;
        let block = BLOCK * tile.stride;
        let along = move |start: u32, length: u32| (start..start + length).step_by(step);
        let blocks = |start: u32, length: u32| {
            let end = start + length;
            (start..end)
                .step_by(block as usize)
                .map(move |at| (at, block.min(end - at)))
        };
        let columns = blocks(tile.x, tile.width);
        blocks(tile.y, tile.height)
            .flat_map(move |row| columns.clone().map(move |column| (column, row)))
            .flat_map(move |((x, width), (y, height))| {
                along(y, height).flat_map(move |y| along(x, width).map(move |x| (x, y)))
            })
            .filter(move |(x, y)| {
                !(tile.refines && x.is_multiple_of(coarser) && y.is_multiple_of(coarser))
            })
    }
}

/// Light of a tile's pixels while they are being rendered.
#[derive(Clone, Debug)]
pub struct TileFilm {
    tile: Tile,
    film_width: u32,
    columns: u32,
    sums: Vec<PixelSums>,
}

/// What knows which pixel its light belongs to.
pub trait OfPixel {
    /// Index of the pixel in the film, and whether the sample has an odd index.
    fn pixel(&self) -> (u32, bool);
}

impl OfPixel for PathState {
    fn pixel(&self) -> (u32, bool) {
        (self.pixel, self.odd)
    }
}

impl OfPixel for ShadowState {
    fn pixel(&self) -> (u32, bool) {
        (self.pixel, self.odd)
    }
}

impl TileFilm {
    /// Dark, for a tile of a film of this width.
    #[must_use]
    pub fn new(tile: Tile, film_width: u32) -> Self {
        let columns = tile.width.div_ceil(tile.stride);
        let count = columns as usize * tile.height.div_ceil(tile.stride) as usize;
        Self {
            tile,
            film_width,
            columns,
            sums: vec![PixelSums::default(); count],
        }
    }

    /// The tile that it is for.
    #[must_use]
    pub const fn tile(&self) -> &Tile {
        &self.tile
    }

    /// Adds the light that `state` brings to its pixel, which is one of the tile's.
    pub fn add(&mut self, state: &impl OfPixel, light: DVec3, stats: &mut RenderStats) {
        let (pixel, odd) = state.pixel();
        let slot = self.slot((pixel % self.film_width, pixel / self.film_width));
        if self.sums[slot].add(odd, light) {
            stats.replaced_contributions += 1;
        }
    }

    /// Light of the pixel at these coordinates in the film.
    #[must_use]
    pub fn sums(&self, pixel: (u32, u32)) -> PixelSums {
        self.sums[self.slot(pixel)]
    }

    const fn slot(&self, (x, y): (u32, u32)) -> usize {
        let column = (x - self.tile.x) / self.tile.stride;
        let row = (y - self.tile.y) / self.tile.stride;
        row as usize * self.columns as usize + column as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_passes_touch_every_pixel_once() {
        for size in [(1, 1), (7, 9), (64, 48), (130, 33)] {
            let mut count = vec![0; size.0 as usize * size.1 as usize];
            for (stride, refines) in [(8, false), (4, true), (2, true), (1, true)] {
                for tile in Tile::cover(size, 4, stride, refines) {
                    for (x, y) in tile.pixels() {
                        count[(y * size.0 + x) as usize] += 1;
                    }
                }
            }
            assert!(count.iter().all(|n| *n == 1), "{size:?}");
        }
    }

    #[test]
    fn every_pixel_of_a_tile_has_a_place_of_its_own() {
        let tile = Tile {
            x: 16,
            y: 32,
            width: 13,
            height: 10,
            stride: 2,
            refines: true,
        };
        let film = TileFilm::new(tile, 100);
        let slots: std::collections::BTreeSet<_> = tile.pixels().map(|p| film.slot(p)).collect();
        assert_eq!(slots.len(), tile.pixels().count());
        assert!(slots.iter().all(|slot| *slot < film.sums.len()));
    }
}
