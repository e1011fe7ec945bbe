//! The triangles of a wide tree leaf by leaf, as the kernel wants them.
//!
//! Corners are rounded to `f32` in the tree's coordinates; they only rule out. A leaf of `n` items
//! that begins at place `p` has the floats `9 p .. 9 (p + n)`: `n` times x of corner 0, of corner 1,
//! of corner 2, then y, then z.

use std::ops::Range;

use octray_kernels::triangles::{FLOATS, PADDING, WINDOW};
use octray_math::DVec3;
use octray_tree::WideTree;

/// Leaves that one task packs.
const LEAVES_PER_TASK: usize = 1024;

/// See the module.
#[derive(Clone, Debug)]
pub(super) struct PackedTriangles(Vec<f32>);

impl PackedTriangles {
    /// Bytes that so many items take.
    pub(super) const fn bytes_for(items: usize) -> u64 {
        ((items * FLOATS + PADDING) * size_of::<f32>()) as u64
    }

    /// Packs the items of the tree's leaves, in the current thread pool.
    pub(super) fn new(tree: &WideTree, corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self {
        let mut leaves: Vec<Range<usize>> = tree.leaves().collect();
        leaves.sort_unstable_by_key(|leaf| leaf.start);
        let mut rows = vec![0.0; tree.items().len() * FLOATS + PADDING];
        pack(tree, &leaves, &mut rows, &corners);
        Self(rows)
    }

    /// The floats of a leaf and what follows.
    #[inline(always)]
    pub(super) fn leaf(&self, places: &Range<usize>) -> &[f32; WINDOW] {
        let (windows, _) = self.0[FLOATS * places.start..].as_chunks();
        &windows[0]
    }

    pub(super) fn bytes(&self) -> u64 {
        size_of_val(self.0.as_slice()) as u64
    }
}

/// Fills the rows of leaves that follow each other.
fn pack(
    tree: &WideTree,
    leaves: &[Range<usize>],
    rows: &mut [f32],
    corners: &(impl Fn(u32) -> [DVec3; 3] + Sync),
) {
    let Some(first) = leaves.first() else { return };
    if leaves.len() > LEAVES_PER_TASK {
        let (left, right) = leaves.split_at(leaves.len() / 2);
        let middle = FLOATS * (right[0].start - first.start);
        let (left_rows, right_rows) = rows.split_at_mut(middle);
        rayon::join(
            || pack(tree, left, left_rows, corners),
            || pack(tree, right, right_rows, corners),
        );
        return;
    }
    for leaf in leaves {
        let own = &mut rows[FLOATS * (leaf.start - first.start)..];
        let count = leaf.len();
        for (lane, &item) in tree.items()[leaf.clone()].iter().enumerate() {
            for (corner, point) in corners(item).into_iter().enumerate() {
                for (axis, x) in tree.local(point).into_iter().enumerate() {
                    own[(3 * axis + corner) * count + lane] = x;
                }
            }
        }
    }
}
