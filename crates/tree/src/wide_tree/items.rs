//! What a tree is built over.

use octray_math::{Aabb, DVec3};

use super::frame::Frame;

/// Where a tree's coordinates lie: those of its items, moved and scaled so that all of them are
/// within `[-1, 1]`.
#[derive(Clone, Copy, Debug)]
pub struct Coordinates(pub(super) Frame);

impl Coordinates {
    /// The point, each component off by at most `2^-52`.
    #[must_use]
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.0.point(p)
    }
}

/// Things with a place in space, named by their indices.
///
/// Large ones may stand in several leaves, each time with a box around a part of them.
pub trait Items: Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// A box around all of an item; an empty one (NaN makes a box empty) if no line meets it.
    fn bounds(&self, item: u32) -> Aabb;

    /// Whether items can be divided.
    const DIVISIBLE: bool;

    /// For each axis, boxes around what an item has within a box below and above a plane; all in the
    /// tree's coordinates.
    ///
    /// Every point of the item that lies in the box must lie in one of the two, up to the rounding
    /// of [`Coordinates::point`]; what they hold beyond that is cut off by the builder.
    fn halves(
        &self,
        item: u32,
        coordinates: &Coordinates,
        within: &Aabb,
        planes: DVec3,
    ) -> [[Aabb; 2]; 3];
}

/// Boxes stand for items that are known by nothing else: each stands in one leaf.
impl Items for [Aabb] {
    fn count(&self) -> usize {
        self.len()
    }

    fn bounds(&self, item: u32) -> Aabb {
        self[item as usize]
    }

    const DIVISIBLE: bool = false;

    fn halves(&self, _: u32, _: &Coordinates, within: &Aabb, _: DVec3) -> [[Aabb; 2]; 3] {
        [[*within; 2]; 3]
    }
}
