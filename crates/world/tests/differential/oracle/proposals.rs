//! Where a ray may cross the primitives. Only proposals of where to look: a wrong one costs a
//! sample, a missing one costs attention, and no answer depends on either.

use super::implicit;
use super::sight::LocalLine;
use super::{Leaf, Sight};

/// The finest pieces a line is divided into, as halvings of the scene.
const HALVINGS: u32 = 12;

/// A walk along one line: clearances change by at most `speed` per parameter, so a piece whose
/// middle is far enough from the boundary has no crossing.
struct Walk<'a> {
    leaf: &'a Leaf,
    line: &'a LocalLine,
    speed: f64,
    /// A stretch of finest pieces that may touch the boundary, all on one side at their ends.
    open: Option<(f64, f64)>,
    found: Vec<f64>,
}

impl Sight<'_> {
    /// Parameters at which a primitive is crossed or nearly touched, in order.
    pub(crate) fn proposals(&self) -> Vec<f64> {
        let reach = self.parameter(1.5 * self.oracle.radius);
        let mut found = Vec::new();
        for (leaf, line) in self.oracle.leaves.iter().zip(&self.lines) {
            let mut walk = Walk {
                leaf,
                line,
                speed: line.direction.length(),
                open: None,
                found: Vec::new(),
            };
            if leaf.terms.is_some() {
                walk.sample(reach);
            } else {
                walk.divide(-reach, reach, HALVINGS);
                walk.close();
            }
            found.extend(walk.found.iter().map(|u| self.shift + u));
        }
        found.sort_by(f64::total_cmp);
        found
    }
}

impl Walk<'_> {
    /// Negative inside: the clearance, or the value of the polynomial that defines the primitive.
    fn value(&self, u: f64) -> f64 {
        let q = (self.line.origin + self.line.direction * u).to_array();
        match &self.leaf.terms {
            Some(terms) => implicit::value(terms, q),
            None => self.leaf.clearance(q),
        }
    }

    /// Looks at evenly spaced points: for polynomials, whose clearances cost too much.
    fn sample(&mut self, reach: f64) {
        let step = reach / 100.0;
        let at = |i: i32| f64::from(i) * step;
        for i in -100..100 {
            let [a, b, c] = [i - 1, i, i + 1].map(|i| self.value(at(i)));
            if (b < 0.0) != (c < 0.0) {
                self.bisect(at(i), at(i + 1));
            } else if (a < 0.0) == (b < 0.0) && b.abs() < a.abs() && b.abs() <= c.abs() {
                self.open = Some((at(i - 1), at(i + 1)));
                self.close();
            }
        }
    }

    fn divide(&mut self, low: f64, high: f64, halvings: u32) {
        let middle = 0.5 * (low + high);
        if self.value(middle).abs() > self.speed * 0.5 * (high - low) {
            return;
        }
        if halvings > 0 {
            self.divide(low, middle, halvings - 1);
            self.divide(middle, high, halvings - 1);
            return;
        }
        match &mut self.open {
            Some((_, end)) if *end == low => *end = high,
            _ => {
                self.close();
                self.open = Some((low, high));
            }
        }
    }

    /// Settles the stretch that is open.
    fn close(&mut self) {
        let Some((low, high)) = self.open.take() else {
            return;
        };
        if (self.value(low) < 0.0) != (self.value(high) < 0.0) {
            self.bisect(low, high);
            return;
        }
        // The point nearest to the other side, by ternary search.
        let side = if self.value(low) < 0.0 { -1.0 } else { 1.0 };
        let (mut a, mut b) = (low, high);
        for _ in 0..60 {
            let (c, d) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
            if side * self.value(c) < side * self.value(d) {
                b = d;
            } else {
                a = c;
            }
        }
        let nearest = 0.5 * (a + b);
        if side * self.value(nearest) < 0.0 {
            self.bisect(low, nearest);
            self.bisect(nearest, high);
        } else {
            self.found.push(nearest);
        }
    }

    fn bisect(&mut self, mut low: f64, mut high: f64) {
        let start = self.value(low) < 0.0;
        for _ in 0..48 {
            let middle = 0.5 * (low + high);
            if (self.value(middle) < 0.0) == start {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.found.push(0.5 * (low + high));
    }
}
