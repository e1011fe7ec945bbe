//! Random choices, the same for the same key.

use octray_math::DVec3;
use octray_math::{hash_combine, hash_u64, unit_f64};

/// A stream of choices.
#[derive(Clone, Debug)]
pub(crate) struct Draw {
    key: u64,
}

impl Draw {
    /// The stream of one of a seed's cases.
    pub(crate) fn new(seed: u64, case: u64) -> Self {
        Self {
            key: hash_combine(hash_u64(seed), case),
        }
    }

    fn next(&mut self) -> u64 {
        self.key = self.key.wrapping_add(0x9e37_79b9_7f4a_7c15);
        hash_u64(self.key)
    }

    /// In `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        unit_f64(self.next())
    }

    /// In `[low, high)`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// In `low..=high`.
    pub(crate) fn whole(&mut self, low: i32, high: i32) -> i32 {
        let count = u64::from(high.abs_diff(low)) + 1;
        low + (self.next() % count) as i32
    }

    /// In `0..count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// True so often.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    pub(crate) fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())].clone()
    }

    /// One of the indices of `weights`, as often as they say.
    pub(crate) fn weighted(&mut self, weights: &[u32]) -> usize {
        let total: u32 = weights.iter().sum();
        let mut left = (self.next() % u64::from(total)) as u32;
        for (index, weight) in weights.iter().enumerate() {
            if left < *weight {
                return index;
            }
            left -= weight;
        }
        unreachable!("the weights sum up to the total")
    }

    /// Evenly on the unit sphere.
    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(
                self.between(-1.0, 1.0),
                self.between(-1.0, 1.0),
                self.between(-1.0, 1.0),
            );
            let length = v.length();
            if length > 0.01 && length <= 1.0 {
                return v / length;
            }
        }
    }
}
