//! From a [`World`](octray_world::World) to a picture.
//!
//! [`render`] schedules tiles over the threads of the current rayon pool; in each, primary rays
//! and all that they lead to wait in bounded queues, go through the world in slices and are shaded
//! by an [`Integrator`]. Light is added up in a [`Film`] of integers, so the picture has the same
//! bits for any number of threads. [`Image`] is the developed result; the caller writes files.

pub mod bsdf;
mod camera;
mod checkpoint;
mod config;
mod cost;
mod driver;
mod film;
mod image;
mod integrator;
mod light;
mod path;
mod sampler;
mod stats;
mod tile;
mod tile_renderer;

pub use camera::PrimaryRays;
pub use checkpoint::{
    Checkpoint, CheckpointError, JobId, checkpoint_records, place_records, tile_record,
};
pub use config::{
    Crop, MAX_EDGE, MAX_GENERATIONS, MAX_SPP, Plan, RenderConfig, RenderError, Shows,
};
pub use cost::{Ledger, cost_channels};
pub use driver::{Observer, RenderJob, Rendering, render, render_tiles};
pub use film::{Film, MAX_CONTRIBUTION, PixelSums};
pub use image::{
    COST_WEIGHTS, HeatMap, Image, ImageError, develop, develop_color, encode_exr, encode_png,
    heat_color, neutral, scene_to_linear,
};
pub use integrator::{Integrator, MAX_INTERFACES, ShadowTracer, Whitted, medium_of, transmission};
pub use light::{Illumination, illuminate};
pub use path::{PathState, Queues, RayKind, ShadowState, to_single, to_vector};
pub use sampler::{pixel_position, sample_key};
pub use stats::{ByKind, RayCounts, RenderStats};
pub use tile::{OfPixel, Tile, TileFilm};
