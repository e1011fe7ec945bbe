/// A closed interval of ray parameters, empty where `start > end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end, possibly `-inf`.
    pub start: f64,
    /// Upper end, possibly `inf`.
    pub end: f64,
}

impl Interval {
    /// The whole line.
    pub const ALL: Self = Self {
        start: f64::NEG_INFINITY,
        end: f64::INFINITY,
    };
    /// No parameter at all.
    pub const EMPTY: Self = Self {
        start: f64::INFINITY,
        end: f64::NEG_INFINITY,
    };

    /// The interval `[start, end]`.
    #[must_use]
    pub const fn new(start: f64, end: f64) -> Self {
        Self { start, end }
    }

    /// Whether it holds no parameter (a NaN end makes it empty too).
    #[must_use]
    pub fn is_empty(&self) -> bool {
        // Written so that NaN counts as empty.
        !matches!(
            self.start.partial_cmp(&self.end),
            Some(std::cmp::Ordering::Less | std::cmp::Ordering::Equal)
        )
    }

    /// Whether `t` lies inside, ends included.
    #[must_use]
    pub fn contains(&self, t: f64) -> bool {
        self.start <= t && t <= self.end
    }

    /// The common part.
    #[must_use]
    pub const fn intersection(&self, other: &Self) -> Self {
        Self {
            start: self.start.max(other.start),
            end: self.end.min(other.end),
        }
    }
}
