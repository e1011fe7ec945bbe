//! The whole tree: its top, and the subtrees below, which threads build on their own.

use super::cost::{self, Choice, Costs};
use super::reference::PaddedBox;
use super::split::Piece;
use super::subtree::{self, Branch, Plan, largest};
use super::{MAX_DEPTH, WideNode, link};

/// A subtree of not more references is built by one thread. It has a node of its own, so the
/// nodes depend on this number (and on nothing else about threads).
const BRANCH: usize = 1 << 14;

/// Splits above an item. A node takes at least one split, so depth is bounded, too.
const MAX_HEIGHT: u32 = MAX_DEPTH;

/// The binary tree above the branches.
#[derive(Debug)]
pub(super) enum Part {
    /// A subtree that one thread built.
    Branch(Box<Branch>),
    /// Two halves.
    Halves(Box<Halves>),
}

#[derive(Debug)]
pub(super) struct Halves {
    bounds: PaddedBox,
    costs: Costs,
    choice: Choice,
    parts: [Part; 2],
}

/// The finished tree.
#[derive(Debug, Default)]
pub(super) struct Built {
    pub(super) nodes: Vec<WideNode>,
    pub(super) items: Vec<u32>,
    pub(super) depth: u32,
}

/// Divides a piece of at least one reference.
pub(super) fn divide(piece: Piece<'_>, plan: &Plan<'_>) -> Part {
    below(piece, MAX_HEIGHT, plan)
}

fn below(piece: Piece<'_>, height: u32, plan: &Plan<'_>) -> Part {
    if piece.references().len() <= BRANCH {
        return Part::Branch(Box::new(subtree::build(piece, height, plan)));
    }
    let [low, high] = piece.split(largest(height - 1), plan.division.as_ref());
    let half = |piece| below(piece, height - 1, plan);
    let (low, high) = rayon::join(|| half(low), || half(high));
    let bounds = low.bounds().union(high.bounds());
    let (costs, choice) = cost::join(low.costs(), high.costs(), bounds.half_area(), u32::MAX, 0);
    Part::Halves(Box::new(Halves {
        bounds,
        costs,
        choice,
        parts: [low, high],
    }))
}

/// Lays the branches one behind the other, below the nodes that lead to them.
pub(super) fn collect(root: Part) -> Built {
    let mut built = Built::default();
    let (nodes, items) = root.counts();
    built.nodes.reserve_exact(nodes + 1);
    built.items.reserve_exact(items);
    match root {
        Part::Branch(branch) if branch.nodes.is_empty() => {
            let mut node = WideNode::EMPTY;
            node.set(0, &branch.bounds, branch.root);
            built.nodes.push(node);
            built.items = branch.items;
        }
        root => built.depth = emit(root, &mut built).1,
    }
    built
}

impl Part {
    const fn bounds(&self) -> &PaddedBox {
        match self {
            Self::Branch(branch) => &branch.bounds,
            Self::Halves(halves) => &halves.bounds,
        }
    }

    const fn costs(&self) -> &Costs {
        match self {
            Self::Branch(branch) => &branch.costs,
            Self::Halves(halves) => &halves.costs,
        }
    }

    /// Bytes of the nodes and items of all branches, and at least those of the nodes above.
    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Branch(branch) => branch.bytes,
            Self::Halves(halves) => {
                let [low, high] = halves.parts.each_ref().map(Self::bytes);
                low + high + size_of::<WideNode>() as u64
            }
        }
    }

    /// Nodes and items of all branches, and at least as many nodes more as there are above them.
    fn counts(&self) -> (usize, usize) {
        match self {
            Self::Branch(branch) => (branch.nodes.len(), branch.items.len()),
            Self::Halves(halves) => {
                let [low, high] = halves.parts.each_ref().map(Self::counts);
                (low.0 + high.0 + 1, low.1 + high.1)
            }
        }
    }
}

/// Writes a part, and all below it; returns the link to it and how deep its nodes go.
fn emit(part: Part, built: &mut Built) -> (u32, u32) {
    match part {
        Part::Branch(branch) => {
            let (nodes, items) = (built.nodes.len(), built.items.len());
            built.nodes.extend(branch.nodes.into_iter().map(|mut node| {
                node.links = node.links.map(|word| link::rebased(word, nodes, items));
                node
            }));
            built.items.extend(branch.items);
            (link::rebased(branch.root, nodes, items), branch.depth)
        }
        Part::Halves(halves) => {
            let own = built.nodes.len();
            built.nodes.push(WideNode::EMPTY);
            let mut slots = Vec::with_capacity(8);
            let [low, high] = halves.parts;
            let first = halves.choice.to_first(8);
            fill(low, first, &mut slots);
            fill(high, 8 - first, &mut slots);
            let mut deepest = 0;
            for (lane, slot) in slots.into_iter().enumerate() {
                let bounds = *slot.bounds();
                let (link, depth) = emit(slot, built);
                if link::items(link).is_none() {
                    deepest = deepest.max(1 + depth);
                }
                built.nodes[own].set(lane, &bounds, link);
            }
            (link::node(own), deepest)
        }
    }
}

/// Puts a part into so many slots at most.
fn fill(part: Part, count: u32, slots: &mut Vec<Part>) {
    match part {
        Part::Halves(halves) if halves.choice.divides(count) => {
            let [low, high] = halves.parts;
            let first = halves.choice.to_first(count);
            fill(low, first, slots);
            fill(high, count - first, slots);
        }
        part => slots.push(part),
    }
}
