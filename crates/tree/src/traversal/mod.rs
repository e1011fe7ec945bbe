//! Other ways to walk the cells that a line meets than [`crate::CellTree::walk`].
//!
//! All of them visit the same occupied cells in the same order, give or take cells that the line
//! meets only within [`CellTree::CONTENT_MARGIN`] of their faces.
//!
//! [`CellTree::CONTENT_MARGIN`]: crate::CellTree::CONTENT_MARGIN

mod beam;
mod fujimoto_iwata;
mod stepper;
mod sung;
#[cfg(test)]
mod tests;

pub use beam::BeamMemory;
pub use fujimoto_iwata::TreePath;
pub use sung::LeafSearch;

/// What a walk cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    /// Cells entered, empty ones too.
    pub cells: u64,
    /// Look-ups: rows of a hash table, or nodes on the way up and down a tree.
    pub lookups: u64,
}
