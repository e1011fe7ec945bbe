//! Histograms of whole numbers.

use std::collections::BTreeMap;

/// How often each number occurs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally(BTreeMap<u64, u64>);

impl Tally {
    /// Counts one occurrence of `number`.
    pub fn add(&mut self, number: u64) {
        *self.0.entry(number).or_default() += 1;
    }

    /// The numbers that occur, increasing, each with how often it does.
    pub fn counts(&self) -> impl Iterator<Item = (u64, u64)> + '_ {
        self.0.iter().map(|(number, count)| (*number, *count))
    }

    /// How many occurrences there are.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.0.values().sum()
    }

    /// The largest number, 0 if there is none.
    #[must_use]
    pub fn max(&self) -> u64 {
        self.0.keys().next_back().copied().unwrap_or(0)
    }

    /// The mean, 0 if there is nothing.
    #[must_use]
    pub fn mean(&self) -> f64 {
        let sum: u64 = self.counts().map(|(number, count)| number * count).sum();
        sum as f64 / self.total().max(1) as f64
    }
}

impl Extend<u64> for Tally {
    fn extend<I: IntoIterator<Item = u64>>(&mut self, numbers: I) {
        numbers.into_iter().for_each(|number| self.add(number));
    }
}

impl FromIterator<u64> for Tally {
    fn from_iter<I: IntoIterator<Item = u64>>(numbers: I) -> Self {
        let mut tally = Self::default();
        tally.extend(numbers);
        tally
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_counted() {
        let tally: Tally = [3, 1, 3, 5, 3].into_iter().collect();
        assert!(tally.counts().eq([(1, 1), (3, 3), (5, 1)]));
        assert_eq!((tally.total(), tally.max(), tally.mean()), (5, 5, 3.0));
        let nothing = Tally::default();
        assert_eq!(
            (nothing.total(), nothing.max(), nothing.mean()),
            (0, 0, 0.0)
        );
    }
}
