//! Regions of the plane, and the solids that are drawn out or turned from them.

mod chain;
mod curve;
mod formula;
mod pieces;
mod region;

pub use curve::Curve;
pub use formula::{Formula, MAX_FORMULA_DEPTH};
pub use region::{Edge, MAX_EDGES, Outline, Region};
