use crate::{Aabb, DVec3};

/// The deepest level of an octree: cell faces of `[0, 2^21)` are exact, 3 x 21 bits fit a `u64`.
pub const MAX_DEPTH: u32 = 21;

/// The name of an octree cell: `depth : (i, j, k)` with `0 <= i, j, k < 2^depth`.
///
/// This is the Leveled Voxel Space Index of Sung (1991). Ordering is Morton order among cells
/// of one depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CellKey {
    /// 0 is the root.
    pub depth: u32,
    /// Integer coordinates at this depth.
    pub index: [u32; 3],
}

impl CellKey {
    /// The whole cube.
    pub const ROOT: Self = Self {
        depth: 0,
        index: [0; 3],
    };

    /// The child in `octant` (bit 0 = upper x, bit 1 = upper y, bit 2 = upper z).
    #[must_use]
    pub const fn child(self, octant: u32) -> Self {
        let [i, j, k] = self.index;
        Self {
            depth: self.depth + 1,
            index: [
                2 * i + (octant & 1),
                2 * j + (octant >> 1 & 1),
                2 * k + (octant >> 2 & 1),
            ],
        }
    }

    /// The cell that holds this one, `None` above the root.
    #[must_use]
    pub const fn parent(self) -> Option<Self> {
        let [i, j, k] = self.index;
        match self.depth {
            0 => None,
            depth => Some(Self {
                depth: depth - 1,
                index: [i >> 1, j >> 1, k >> 1],
            }),
        }
    }

    /// Which child of its parent this is, 0..8.
    #[must_use]
    pub const fn octant(self) -> u32 {
        let [i, j, k] = self.index;
        (i & 1) | (j & 1) << 1 | (k & 1) << 2
    }

    /// Which child the ancestor of `depth` (at least 1, at most this depth) is of its parent.
    #[must_use]
    pub const fn octant_at(self, depth: u32) -> u32 {
        let below = self.depth - depth;
        let [i, j, k] = self.index;
        (i >> below & 1) | (j >> below & 1) << 1 | (k >> below & 1) << 2
    }

    /// The cell of this depth that holds `point`, `None` outside the cube `root`. A point on a face
    /// belongs to the upper cell; the faces of the root to the cells inside.
    #[must_use]
    pub fn containing(root: &Aabb, depth: u32, point: DVec3) -> Option<Self> {
        if !root.contains(point) {
            return None;
        }
        let cells = f64::from(1u32 << depth);
        let size = root.size().x / cells;
        let index = |axis: usize| {
            let (low, x) = (root.min[axis], point[axis]);
            let guess = libm::floor((x - low) / size).clamp(0.0, cells - 1.0);
            // The difference may have rounded across a face; the faces themselves are exact.
            let index = if x < low + guess * size {
                guess - 1.0
            } else if x >= low + (guess + 1.0) * size {
                guess + 1.0
            } else {
                guess
            };
            index.clamp(0.0, cells - 1.0) as u32
        };
        Some(Self {
            depth,
            index: [index(0), index(1), index(2)],
        })
    }

    /// The cell's box in the cube `root`.
    #[must_use]
    pub fn bounds(self, root: &Aabb) -> Aabb {
        let scale = 1.0 / f64::from(1u32 << self.depth);
        let size = root.size() * scale;
        let [i, j, k] = self.index.map(f64::from);
        let corner = DVec3::new(i, j, k);
        Aabb::new(root.min + size * corner, root.min + size * (corner + 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn parent_undoes_child(depth in 0..MAX_DEPTH, seed in any::<u64>(), octant in 0u32..8) {
            let mask = (1u64 << depth) - 1;
            let key = CellKey {
                depth,
                index: [0, 21, 42].map(|s| (seed >> s & mask) as u32),
            };
            let child = key.child(octant);
            prop_assert_eq!(child.parent(), Some(key));
            prop_assert_eq!(child.octant(), octant);
            let root = Aabb::new(DVec3::ZERO, DVec3::splat(f64::from(1u32 << MAX_DEPTH)));
            prop_assert!(key.bounds(&root).contains_box(&child.bounds(&root)));
        }
    }
}
