//! One vertex for all corners at the same position.

use std::collections::HashMap;

use octray_math::DVec3;

/// Gives equal positions (-0 and 0 are equal) the same index, in order of first appearance.
#[derive(Debug, Default)]
pub(crate) struct Welder {
    positions: Vec<DVec3>,
    // Only looked up, never walked: its order does not matter.
    index: HashMap<[u64; 3], u32>,
}

impl Welder {
    /// The index of the vertex at `position`.
    pub(crate) fn vertex(&mut self, position: DVec3) -> u32 {
        let next = self.positions.len() as u32;
        let key = (position + DVec3::ZERO).to_array().map(f64::to_bits);
        let index = *self.index.entry(key).or_insert(next);
        if index == next {
            self.positions.push(position);
        }
        index
    }

    /// The vertices.
    pub(crate) fn into_positions(self) -> Vec<DVec3> {
        self.positions
    }
}
