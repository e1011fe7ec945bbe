//! Expressions as flat words, so that a cell's expression is a slice of one array.

use std::ops::Range;

use crate::FaceId;
use crate::surface::Side;

/// A boolean expression in negation normal form, in prefix order.
///
/// A word's low two bits say what it is: a literal (the rest is a [`FaceId`]), or *and* / *or* (the
/// rest is the number of words that follow and belong to it). No operation has fewer than two
/// operands or an operand of its own kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Code {
    words: Vec<u32>,
}

/// What an expression is when it does not depend on where one is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    /// Nowhere.
    False,
    /// Everywhere.
    True,
}

const LITERAL: u32 = 0;
const AND: u32 = 1;
const OR: u32 = 2;
const TAG_BITS: u32 = 2;
const TAG_MASK: u32 = (1 << TAG_BITS) - 1;

/// *And* or *or*.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    /// All.
    And,
    /// Any.
    Or,
}

impl Operation {
    const fn tag(self) -> u32 {
        match self {
            Self::And => AND,
            Self::Or => OR,
        }
    }

    /// The value that decides the operation as soon as one operand has it.
    const fn absorbing(self) -> Constant {
        match self {
            Self::And => Constant::False,
            Self::Or => Constant::True,
        }
    }

    const fn neutral(self) -> Constant {
        match self {
            Self::And => Constant::True,
            Self::Or => Constant::False,
        }
    }
}

impl Code {
    /// The words, to be stored beside others.
    #[must_use]
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// How many literals there are.
    #[must_use]
    pub fn literals(&self) -> usize {
        faces(&self.words).count()
    }
}

/// Appends to `out` the expression with every literal that `truth` decides replaced by its value;
/// the constant, and nothing appended, where nothing undecided is left.
pub fn reduce(
    words: &[u32],
    truth: &mut impl FnMut(FaceId) -> Option<bool>,
    out: &mut Vec<u32>,
) -> Option<Constant> {
    let mut writer = Writer {
        words: std::mem::take(out),
    };
    let constant = reduce_at(words, 0, truth, &mut writer);
    *out = writer.words;
    constant
}

/// Builds [`Code`] and keeps its rules: operations are spliced, collapsed and cut short on the way.
#[derive(Debug, Default)]
pub(super) struct Writer {
    words: Vec<u32>,
}

/// An operation whose operands are being written.
pub(super) struct Open {
    operation: Operation,
    start: usize,
    operands: usize,
}

impl Writer {
    /// Writes behind what is there.
    pub(super) const fn behind(words: Vec<u32>) -> Self {
        Self { words }
    }

    pub(super) fn into_words(self) -> Vec<u32> {
        self.words
    }

    pub(super) fn finish(self) -> Code {
        Code { words: self.words }
    }

    pub(super) fn literal(&mut self, face: FaceId) {
        self.words.push(face.0 << TAG_BITS | LITERAL);
    }

    pub(super) fn open(&mut self, operation: Operation) -> Open {
        let start = self.words.len();
        self.words.push(0);
        Open {
            operation,
            start,
            operands: 0,
        }
    }

    /// Takes the words written since `start` as one operand (`constant`: none were written).
    ///
    /// `true` means that the operation is decided: close it and skip its other operands.
    pub(super) fn operand(
        &mut self,
        open: &mut Open,
        start: usize,
        constant: Option<Constant>,
    ) -> bool {
        match constant {
            Some(c) if c == open.operation.absorbing() => {
                self.words.truncate(open.start);
                return true;
            }
            Some(_) => {}
            None if self.words[start] & TAG_MASK == open.operation.tag() => {
                // An operand of the same kind: its operands become ours.
                self.words.remove(start);
                open.operands += 2;
            }
            None => open.operands += 1,
        }
        false
    }

    /// What was written from a position on.
    pub(super) fn since(&self, position: usize) -> Code {
        Code {
            words: self.words[position..].to_vec(),
        }
    }

    pub(super) fn position(&self) -> usize {
        self.words.len()
    }

    /// Ends an operation that was not decided early.
    pub(super) fn close(&mut self, open: &Open) -> Option<Constant> {
        match open.operands {
            0 => {
                self.words.truncate(open.start);
                Some(open.operation.neutral())
            }
            1 => {
                self.words.remove(open.start);
                None
            }
            _ => {
                let length = (self.words.len() - open.start - 1) as u32;
                self.words[open.start] = length << TAG_BITS | open.operation.tag();
                None
            }
        }
    }
}

fn reduce_at(
    words: &[u32],
    at: usize,
    truth: &mut impl FnMut(FaceId) -> Option<bool>,
    writer: &mut Writer,
) -> Option<Constant> {
    let operation = match words[at] & TAG_MASK {
        LITERAL => {
            let face = FaceId(words[at] >> TAG_BITS);
            return match truth(face) {
                Some(true) => Some(Constant::True),
                Some(false) => Some(Constant::False),
                None => {
                    writer.literal(face);
                    None
                }
            };
        }
        AND => Operation::And,
        _ => Operation::Or,
    };
    let mut open = writer.open(operation);
    for child in operands(words, at) {
        let start = writer.position();
        let constant = reduce_at(words, child, truth, writer);
        if writer.operand(&mut open, start, constant) {
            return Some(operation.absorbing());
        }
    }
    writer.close(&open)
}

/// What stands at a position of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// A face.
    Literal(FaceId),
    /// All of the [`operands`].
    And,
    /// Any of the [`operands`].
    Or,
}

/// The term at position `at`; the whole expression stands at 0.
#[must_use]
pub fn term(words: &[u32], at: usize) -> Term {
    match words[at] & TAG_MASK {
        LITERAL => Term::Literal(FaceId(words[at] >> TAG_BITS)),
        AND => Term::And,
        _ => Term::Or,
    }
}

/// The positions of the operands of the operation at `at`.
pub fn operands(words: &[u32], at: usize) -> impl Iterator<Item = usize> + '_ {
    let body = body(words, at);
    let mut next = body.start;
    std::iter::from_fn(move || {
        (next < body.end).then(|| {
            let child = next;
            next = self::body(words, child).end;
            child
        })
    })
}

/// The words that belong to the operation (or literal) at `at`, without its own.
fn body(words: &[u32], at: usize) -> Range<usize> {
    let length = match words[at] & TAG_MASK {
        LITERAL => 0,
        _ => (words[at] >> TAG_BITS) as usize,
    };
    at + 1..at + 1 + length
}

/// The faces of an expression's literals, in order, with repetitions.
pub fn faces(words: &[u32]) -> impl Iterator<Item = FaceId> + '_ {
    words
        .iter()
        .filter(|w| **w & TAG_MASK == LITERAL)
        .map(|w| FaceId(w >> TAG_BITS))
}

/// The expression's value, given that of every face.
pub fn evaluate(words: &[u32], truth: &impl Fn(FaceId) -> bool) -> bool {
    evaluate_at(words, 0, truth)
}

fn evaluate_at(words: &[u32], at: usize, truth: &impl Fn(FaceId) -> bool) -> bool {
    let word = words[at];
    let stop_at = match word & TAG_MASK {
        LITERAL => return truth(FaceId(word >> TAG_BITS)),
        AND => false,
        _ => true,
    };
    let end = at + 1 + (word >> TAG_BITS) as usize;
    let mut child = at + 1;
    while child < end {
        // Most operands are literals: these need no call.
        let word = words[child];
        let (value, next) = if word & TAG_MASK == LITERAL {
            (truth(FaceId(word >> TAG_BITS)), child + 1)
        } else {
            let next = child + 1 + (word >> TAG_BITS) as usize;
            (evaluate_at(words, child, truth), next)
        };
        if value == stop_at {
            return stop_at;
        }
        child = next;
    }
    !stop_at
}

/// The lowest face that takes part in the expression's change from `before` to `after`.
///
/// A face takes part if it and every operation above it changes in the same direction as the whole;
/// since nothing is negated, such a face exists wherever the expression changes.
pub fn changed_face(
    words: &[u32],
    before: &impl Fn(FaceId) -> bool,
    after: &impl Fn(FaceId) -> bool,
) -> Option<FaceId> {
    let target = evaluate(words, after);
    if evaluate(words, before) == target {
        return None;
    }
    changed_at(words, 0, target, before, after)
}

/// The lowest face that takes part in the change to `target` of the operation (or literal) at `at`,
/// which is known to change.
fn changed_at(
    words: &[u32],
    at: usize,
    target: bool,
    before: &impl Fn(FaceId) -> bool,
    after: &impl Fn(FaceId) -> bool,
) -> Option<FaceId> {
    let word = words[at];
    if word & TAG_MASK == LITERAL {
        return Some(FaceId(word >> TAG_BITS));
    }
    operands(words, at)
        .filter_map(|child| {
            let changes = evaluate_at(words, child, after) == target
                && evaluate_at(words, child, before) != target;
            if !changes {
                return None;
            }
            changed_at(words, child, target, before, after)
        })
        .min()
}

/// The truth of a face's literal on one side of its surface.
#[must_use]
pub const fn truth_on(side: Side, inside_is_positive: bool) -> Option<bool> {
    match side {
        Side::Negative => Some(!inside_is_positive),
        Side::Positive => Some(inside_is_positive),
        Side::Both => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An expression as a tree: the oracle for the flat form.
    #[derive(Clone, Debug)]
    enum Tree {
        Literal(u32),
        And(Vec<Tree>),
        Or(Vec<Tree>),
    }

    impl Tree {
        fn value(&self, truth: u32) -> bool {
            match self {
                Self::Literal(i) => truth >> i & 1 == 1,
                Self::And(all) => all.iter().all(|t| t.value(truth)),
                Self::Or(all) => all.iter().any(|t| t.value(truth)),
            }
        }

        fn write(&self, writer: &mut Writer) -> Option<Constant> {
            let (operation, all) = match self {
                Self::Literal(i) => {
                    writer.literal(FaceId(*i));
                    return None;
                }
                Self::And(all) => (Operation::And, all),
                Self::Or(all) => (Operation::Or, all),
            };
            let mut open = writer.open(operation);
            for child in all {
                let start = writer.position();
                let constant = child.write(writer);
                if writer.operand(&mut open, start, constant) {
                    return Some(operation.absorbing());
                }
            }
            writer.close(&open)
        }
    }

    fn tree() -> impl Strategy<Value = Tree> {
        (0u32..8)
            .prop_map(Tree::Literal)
            .prop_recursive(5, 40, 4, |inner| {
                let many = proptest::collection::vec(inner, 0..4);
                prop_oneof![many.clone().prop_map(Tree::And), many.prop_map(Tree::Or)]
            })
    }

    fn check_form(words: &[u32], at: usize) {
        let tag = words[at] & TAG_MASK;
        if tag != LITERAL {
            let children: Vec<usize> = operands(words, at).collect();
            assert!(children.len() >= 2);
            for child in children {
                assert_ne!(words[child] & TAG_MASK, tag);
                check_form(words, child);
            }
        }
    }

    proptest! {
        #[test]
        fn flat_form_has_the_tree_s_value_before_and_after_reduction(
            tree in tree(), truth in 0u32..256, known in 0u32..256,
        ) {
            let mut writer = Writer::default();
            let constant = tree.write(&mut writer);
            let code = writer.finish();
            let value = |c: &Result<Code, Constant>| match c {
                Err(c) => *c == Constant::True,
                Ok(code) => {
                    check_form(code.words(), 0);
                    evaluate(code.words(), &|f| truth >> f.0 & 1 == 1)
                }
            };
            let whole = constant.map_or(Ok(code), Err);
            prop_assert_eq!(value(&whole), tree.value(truth));
            let reduced = whole.and_then(|code| {
                let mut words = Vec::new();
                let mut known = |f: FaceId| {
                    (known >> f.0 & 1 == 1).then_some(truth >> f.0 & 1 == 1)
                };
                match reduce(code.words(), &mut known, &mut words) {
                    Some(constant) => Err(constant),
                    None => Ok(Code { words }),
                }
            });
            prop_assert_eq!(value(&reduced), tree.value(truth));
            if let Ok(code) = reduced {
                prop_assert!(faces(code.words()).all(|f| known >> f.0 & 1 == 0));
            }
        }

        #[test]
        fn a_change_has_a_face_that_changes_the_same_way(
            tree in tree(), before in 0u32..256, after in 0u32..256,
        ) {
            let mut writer = Writer::default();
            if tree.write(&mut writer).is_none() {
                let code = writer.finish();
                let at = |truth: u32| move |f: FaceId| truth >> f.0 & 1 == 1;
                let face = changed_face(code.words(), &at(before), &at(after));
                prop_assert_eq!(face.is_some(), tree.value(before) != tree.value(after));
                if let Some(face) = face {
                    prop_assert_eq!(at(after)(face), tree.value(after));
                    prop_assert_eq!(at(before)(face), tree.value(before));
                }
            }
        }
    }
}
