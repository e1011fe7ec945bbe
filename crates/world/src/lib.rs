//! A scene made ready for rays: the accelerators, and what rays ask of them.
//!
//! [`World`] is the one door between the structures below it and everything that traces rays
//! above it. Its answers are the same bits whatever structure finds them: a structure only proposes
//! what to test, one `f64` function per shape decides, and ties go to the lowest face.

mod batch;
mod beam;
mod cell_list;
mod chords;
mod faces;
mod figures;
mod instances;
mod interact;
mod line;
mod method;
mod query;
mod sheets;
mod slice;
mod solids;
mod start;
mod surfaces;
mod treelets;
mod triangle_slice;
mod world;

pub use batch::{Batch, BatchError, Lists, RayRow, row_query};
pub use cell_list::{CellList, CellListError};
pub use chords::{Chord, ChordEnd, Overlaps};
pub use figures::{CellsOf, MarkingStats, MemoryStats, WorldCell};
pub use method::{Method, MethodError};
pub use octray_geometry::membership::MarkerStats;
pub use octray_geometry::membership::shells::StepCounts;
pub use query::{Counters, Departure, Hit, RayQuery, Region, SurfaceHit};
pub use surfaces::{NearCoincidence, SurfaceReport};
pub use treelets::{OcclusionSearch, Search, Step, TreeletError, Treelets};
pub use world::{World, WorldConfig, WorldError, WorldStats};

pub use octray_geometry::Membership;
pub use octray_geometry::mesh::TriangleMarks;
pub use octray_tree::{
    CellTreeStats, Criteria, Division, Encoding, LvsiStats, LvsiStore, LvsiTable, PartitionStats,
    Quality, TableSize, Tally, Traversal, WideTreeConfig, WideTreeError, WideTreeStats,
};
