//! Octrees that do not know what they hold.
//!
//! [`CellTree`] is a partition of a cube into cells: empty, occupied or divided. What a cell
//! contains is the business of a [`Subdivide`]; the tree only decides where to divide, and walks.
//!
//! [`WideTree`] finds the items whose boxes a line meets, front to back, eight boxes at a time.

pub mod cell_tree;
pub mod encoding;
mod grid;
mod partition;
mod tally;
pub mod traversal;
pub mod triangle_cube;
pub mod wide_tree;

pub use cell_tree::{
    Cell, CellTree, CellTreeStats, Criteria, Node, Subdivide, WalkStack, filled_share,
};
pub use encoding::{LvsiStats, LvsiStore, LvsiTable, TableSize};
pub use grid::Grid;
pub use partition::{Division, Encoding, Leaf, Partition, PartitionStats, Traversal, WalkMemory};
pub use tally::Tally;
pub use wide_tree::{
    Coordinates, Items, LeafVisitor, LocalLine, Pending, Quality, WalkCost, WideTree,
    WideTreeConfig, WideTreeError, WideTreeStats,
};
