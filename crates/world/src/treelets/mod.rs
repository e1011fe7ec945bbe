//! Object space: a world cut into treelets, and a search that goes from one to the next.
//!
//! **What a treelet is.** The leaves of the octree over the solids and the triangles of sheets are put
//! in Morton order and cut into runs of about equal cost. One run is a treelet. What has no place is
//! shared by all: the outer leaf with the unbounded objects, copies of prototypes, lights, materials.
//!
//! **The top tree.** Of each treelet everyone knows a few boxes, one for each largest subtree of the
//! octree that is the treelet's alone. They give every line an order of the treelets that it may meet:
//! by the parameter where it enters the nearest of their boxes, of equals by number. The order is a
//! function of the line and the boxes, so that a search needs no list of where it has been: the
//! treelet that holds it says who comes next.
//!
//! **What travels.** A search is the ray, the best boundary so far (parameter, face and copy for ties,
//! and the treelet that found it), and for rays without a departure the parameter behind which they
//! begin to count. A treelet asks its own leaves alone. This is enough, because contents of cells are decided with a
//! margin and a line is clipped to half of it: whatever changes at a crossing stands in each cell
//! that reports it, with the regions on both sides, and the nearest of what the cells report is the
//! same in any order. When no treelet is left that the line enters before the best boundary, the
//! search is final and goes to the treelet that found it. There the boundary is found again, and
//! shaded. Two questions can be asked only then: whether the ray starts on that boundary (`start.rs`),
//! which needs its normal; if so the search begins anew behind it. And which region a triangle of a
//! sheet stands in, which is the business of the treelet whose cell holds the point.
//!
//! What is cut so far is the work, not the memory: a step asks only the leaves and triangles of its
//! treelet, but they lie in the one world. Three things still look at all of it: the region at a
//! triangle, the plane of a triangle that a ray leaves, and the tables of faces.
//!
//! A search for something that stops light goes the same way and ends at the first thing that does.

mod cut;
mod search;

pub use cut::{TreeletError, Treelets};
pub use search::{OcclusionSearch, Search, Step};
