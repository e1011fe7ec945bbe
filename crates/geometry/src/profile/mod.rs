//! Regions of the plane, and the solids that are drawn out or turned from them.

mod arrangement;
mod chain;
mod contour;
mod curve;
mod decompose;
mod formula;
mod lathe;
mod loops;
mod pieces;
mod prism;
mod region;
mod shells;

pub use contour::Contour;
pub(crate) use contour::changes;
pub use curve::Curve;
pub use formula::{Formula, MAX_FORMULA_DEPTH};
pub(crate) use pieces::Piece;
pub use region::{Edge, MAX_EDGES, Outline, Region};
pub use shells::turned_shells;

pub use lathe::Turning;
pub(crate) use lathe::lathe;
pub(crate) use prism::prism;
