//! Boolean formulas over numbered sides.

/// Deepest nesting of a formula: everything that reads one recurses.
pub const MAX_FORMULA_DEPTH: u32 = 400;

/// A set as a boolean combination of the insides and outsides of numbered sides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Formula {
    /// Everywhere or nowhere.
    Constant(bool),
    /// One side.
    Side {
        /// Which.
        side: u32,
        /// Its inside or its outside.
        inside: bool,
    },
    /// Where all hold.
    All(Vec<Formula>),
    /// Where any holds.
    Any(Vec<Formula>),
}

impl Formula {
    /// The inside of a side.
    #[must_use]
    pub const fn inside(side: u32) -> Self {
        Self::Side { side, inside: true }
    }

    /// Where all of `parts` hold; constants and single operands are resolved, nested conjunctions
    /// spliced.
    #[must_use]
    pub fn all(parts: impl IntoIterator<Item = Self>) -> Self {
        let mut kept = Vec::new();
        for part in parts {
            match part {
                Self::Constant(true) => {}
                Self::Constant(false) => return Self::Constant(false),
                Self::All(inner) => kept.extend(inner),
                other => kept.push(other),
            }
        }
        match kept.len() {
            0 => Self::Constant(true),
            1 => kept.swap_remove(0),
            _ => Self::All(kept),
        }
    }

    /// Where any of `parts` holds, simplified likewise.
    #[must_use]
    pub fn any(parts: impl IntoIterator<Item = Self>) -> Self {
        let mut kept = Vec::new();
        for part in parts {
            match part {
                Self::Constant(false) => {}
                Self::Constant(true) => return Self::Constant(true),
                Self::Any(inner) => kept.extend(inner),
                other => kept.push(other),
            }
        }
        match kept.len() {
            0 => Self::Constant(false),
            1 => kept.swap_remove(0),
            _ => Self::Any(kept),
        }
    }

    /// The complement (De Morgan).
    #[must_use]
    pub fn complement(self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(!value),
            Self::Side { side, inside } => Self::Side {
                side,
                inside: !inside,
            },
            Self::All(parts) => Self::any(parts.into_iter().map(Self::complement)),
            Self::Any(parts) => Self::all(parts.into_iter().map(Self::complement)),
        }
    }

    /// The formula with every side replaced by what `of` makes of its inside.
    #[must_use]
    pub fn substitute(&self, of: &impl Fn(u32) -> Self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(*value),
            Self::Side { side, inside: true } => of(*side),
            Self::Side {
                side,
                inside: false,
            } => of(*side).complement(),
            Self::All(parts) => Self::all(parts.iter().map(|p| p.substitute(of))),
            Self::Any(parts) => Self::any(parts.iter().map(|p| p.substitute(of))),
        }
    }

    /// The value, given whether one is inside of each side.
    pub fn evaluate(&self, is_inside: &impl Fn(u32) -> bool) -> bool {
        match self {
            Self::Constant(value) => *value,
            Self::Side { side, inside } => is_inside(*side) == *inside,
            Self::All(parts) => parts.iter().all(|p| p.evaluate(is_inside)),
            Self::Any(parts) => parts.iter().any(|p| p.evaluate(is_inside)),
        }
    }

    /// How many sides it names, repetitions counted.
    #[must_use]
    pub fn literals(&self) -> usize {
        match self {
            Self::Constant(_) => 0,
            Self::Side { .. } => 1,
            Self::All(parts) | Self::Any(parts) => parts.iter().map(Self::literals).sum(),
        }
    }

    /// Operations below each other.
    #[must_use]
    pub fn depth(&self) -> u32 {
        match self {
            Self::Constant(_) | Self::Side { .. } => 0,
            Self::All(parts) | Self::Any(parts) => {
                1 + parts.iter().map(Self::depth).max().unwrap_or(0)
            }
        }
    }
}
