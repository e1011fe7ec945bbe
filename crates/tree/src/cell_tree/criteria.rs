//! When to divide a cell.

use octray_math::Aabb;

/// When to divide: a cell is divided if all criteria agree. Any of them can be switched off but the
/// depth and the memory, which always end the building.
///
/// By cost, a cell is divided when the expected cost of a ray that meets it falls: a ray that meets
/// a cube meets each of its octants with probability 1/4 (the ratio of surface areas, MacDonald &
/// Booth 1990). A cell of many parts may be divided a few times without gain, because many faces
/// through one octant need more than one division to come apart. (One part alone never comes apart,
/// and following it without gain would fill its whole surface with the smallest cells.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria {
    /// No cell lies deeper; at most 21.
    pub max_depth: u32,
    /// A cell of at most so many parts is not divided; 0 switches this off.
    pub max_parts: u32,
    /// A cell of which its objects occupy more than this share is not divided, because that would
    /// uncover little empty space; 1 switches this off.
    pub max_share: f64,
    /// Whether a cell is divided only where the expected cost falls.
    pub by_cost: bool,
    /// Cost of entering a cell, in units of one plane intersected with a line. The default was
    /// measured: a ray is as fast as with 1.5, the tree a tenth of the size.
    pub visit_cost: f64,
    /// By cost, division stops when nodes and contents take more than this many bytes for each part of
    /// the root's contents (beyond [`Criteria::FREE_BYTES`]): surfaces that hardly come apart, like
    /// the planes of a finely faceted ball, would be divided for ever smaller gains.
    pub bytes_per_part: u64,
    /// Division stops before nodes and contents, with what the builder keeps beside them, take more
    /// bytes; at most [`Criteria::LARGEST_MEMORY`]. Of a grid, the voxels are made larger.
    pub memory_limit: u64,
}

impl Default for Criteria {
    fn default() -> Self {
        Self {
            max_depth: 16,
            max_parts: 0,
            max_share: 1.0,
            by_cost: true,
            visit_cost: 4.0,
            bytes_per_part: 512,
            memory_limit: 4 << 30,
        }
    }
}

impl Criteria {
    /// Any tree may take this many bytes, if the memory limit allows.
    pub const FREE_BYTES: u64 = 8 << 20;
    /// The most that [`Criteria::memory_limit`] can give: cells and contents are numbered in 32 bits.
    pub const LARGEST_MEMORY: u64 = 16 << 30;

    /// How many bytes are worth it for so many parts.
    pub(super) const fn size_limit(&self, parts: u64) -> u64 {
        if self.by_cost {
            Self::FREE_BYTES.saturating_add(self.bytes_per_part.saturating_mul(parts))
        } else {
            u64::MAX
        }
    }
}

/// The points on each axis by which [`filled_share`] measures.
const SAMPLES: u32 = 4;

/// The share of a cell that boxes fill together, wherever they overlap: of 4 x 4 x 4 points spread
/// evenly over the cell, those that lie in any of the boxes.
#[must_use]
pub fn filled_share(cell: &Aabb, boxes: impl IntoIterator<Item = Aabb>) -> f64 {
    const ALL: u64 = u64::MAX;
    // One bit for each point; x runs fastest.
    let mut filled = 0_u64;
    for bounds in boxes {
        let mut inside = ALL;
        for axis in 0..3 {
            let (low, size) = (cell.min[axis], cell.max[axis] - cell.min[axis]);
            let mut slab = 0_u64;
            for i in 0..SAMPLES {
                let x = low + size * ((f64::from(i) + 0.5) / f64::from(SAMPLES));
                if (bounds.min[axis]..=bounds.max[axis]).contains(&x) {
                    slab |= match axis {
                        0 => 0x1111_1111_1111_1111 << i,
                        1 => 0x000f_000f_000f_000f << (4 * i),
                        _ => 0xffff << (16 * i),
                    };
                }
            }
            inside &= slab;
        }
        filled |= inside;
        if filled == ALL {
            break;
        }
    }
    f64::from(filled.count_ones()) / 64.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_math::DVec3;

    #[test]
    fn the_share_is_that_of_the_boxes_together() {
        let cell = Aabb::new(DVec3::ZERO, DVec3::splat(8.0));
        let part = |min: [f64; 3], max: [f64; 3]| {
            Aabb::new(DVec3::from_array(min), DVec3::from_array(max))
        };
        let left = part([0.0; 3], [2.0, 8.0, 8.0]);
        let lower = part([-5.0; 3], [9.0, 9.0, 4.0]);
        let corner = part([4.0, 6.0, 4.0], [8.0; 3]);
        let plane = part([0.0, 0.0, 3.5], [8.0, 8.0, 3.5]);
        assert_eq!(filled_share(&cell, []), 0.0);
        assert_eq!(filled_share(&cell, [left]), 0.25);
        assert_eq!(filled_share(&cell, [lower]), 0.5);
        assert_eq!(filled_share(&cell, [corner, corner]), 1.0 / 16.0);
        assert_eq!(filled_share(&cell, [plane]), 0.0);
        assert_eq!(filled_share(&cell, [left, lower]), 0.25 + 0.5 - 0.125);
        assert_eq!(filled_share(&cell, [left, lower, corner]), 0.6875);
        assert_eq!(filled_share(&cell, [Aabb::ALL]), 1.0);
        assert_eq!(filled_share(&cell, [Aabb::EMPTY]), 0.0);
    }
}
