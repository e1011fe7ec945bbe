//! Dividing the largest of many things until all are small, or many.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The size of a thing; of equal ones the older is the larger.
#[derive(PartialEq)]
struct Size {
    size: f64,
    age: usize,
}

impl Eq for Size {}

impl Ord for Size {
    fn cmp(&self, other: &Self) -> Ordering {
        self.size
            .total_cmp(&other.size)
            .then(other.age.cmp(&self.age))
    }
}

impl PartialOrd for Size {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Divides the largest thing until none is larger than `size` or there are `limit` of them; in the order in
/// which they were made.
pub(super) fn refined<T, Parts: IntoIterator<Item = T>>(
    things: impl IntoIterator<Item = T>,
    size_of: impl Fn(&T) -> f64,
    size: f64,
    limit: usize,
    divided: impl Fn(&T) -> Parts,
) -> Vec<T> {
    let mut all: Vec<Option<T>> = things.into_iter().map(Some).collect();
    let sized = |(age, thing): (usize, &Option<T>)| {
        let size = size_of(thing.as_ref()?);
        Some(Size { size, age })
    };
    let mut waiting: BinaryHeap<Size> = all.iter().enumerate().filter_map(sized).collect();
    while waiting.len() < limit && waiting.peek().is_some_and(|largest| largest.size > size) {
        let Some(largest) = waiting.pop().and_then(|largest| all[largest.age].take()) else {
            break;
        };
        for part in divided(&largest) {
            waiting.push(Size {
                size: size_of(&part),
                age: all.len(),
            });
            all.push(Some(part));
        }
    }
    all.into_iter().flatten().collect()
}
