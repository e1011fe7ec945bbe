//! What light a ray brings to its pixel.
//!
//! An integrator works on slices of states and never traces a ray itself: it adds light to the
//! film and leaves new rays in the queues. What traces them, in which order and on which machine,
//! is not its business.

mod media;
mod shadow;
mod whitted;

pub use media::{medium_of, transmission};
pub use shadow::{MAX_INTERFACES, ShadowTracer};
pub use whitted::Whitted;

use octray_world::Hit;

use crate::path::{PathState, Queues};
use crate::stats::RenderStats;
use crate::tile::TileFilm;

/// Turns rays and what they met into light and more rays.
pub trait Integrator: Sync {
    /// Shades `states[i]`, which met `hits[i]`, for all `i`: adds light to `film`, appends spawned
    /// rays to `queues`, counts what it ends in `stats`.
    ///
    /// A state appends at most two paths, and one shadow ray per lamp.
    fn shade(
        &self,
        states: &[PathState],
        hits: &[Hit],
        film: &mut TileFilm,
        queues: &mut Queues,
        stats: &mut RenderStats,
    );
}
