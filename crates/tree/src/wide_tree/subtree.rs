//! A subtree that one thread builds: halves first, then nodes of eight.
//!
//! The binary tree is needed only until the best use of the slots is known. Building it for some
//! thousand references at a time keeps it in the cache, and memory small.

use std::sync::atomic::{AtomicU64, Ordering};

use octray_kernels::Boxes8;

use super::cost::{self, Choice, Costs};
use super::divide::Division;
use super::reference::PaddedBox;
use super::split::Piece;
use super::{WideNode, link};

/// A part of the binary tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) bounds: PaddedBox,
    /// Of a single reference, its place; of halves, the first of the two parts.
    index: u32,
    count: u32,
    pub(super) choice: Choice,
}

/// How to build, and how much memory there is left for nodes and items.
#[derive(Debug)]
pub(super) struct Plan<'a> {
    pub(super) leaf_size: u32,
    /// How large references are cut in two, if they are.
    pub(super) division: Option<Division<'a>>,
    pub(super) bytes: u64,
    pub(super) taken: AtomicU64,
}

/// Nodes and items on their own, links counting from 0.
#[derive(Debug)]
pub(super) struct Branch {
    pub(super) bounds: PaddedBox,
    pub(super) costs: Costs,
    /// The root node, or a leaf.
    pub(super) root: u32,
    /// Depth of the deepest node below a root at 0.
    pub(super) depth: u32,
    /// Bytes of nodes and items. There are none if the budget did not allow for them.
    pub(super) bytes: u64,
    pub(super) nodes: Vec<WideNode>,
    pub(super) items: Vec<u32>,
}

/// Working memory of a thread.
#[derive(Debug)]
struct Arena<'a> {
    parts: Vec<Part>,
    /// Items in the order of the references.
    items: Vec<u32>,
    plan: &'a Plan<'a>,
}

impl Part {
    const BLANK: Self = Self {
        bounds: PaddedBox::EMPTY,
        index: 0,
        count: 0,
        choice: Choice::LEAF,
    };
}

/// Builds the subtree over a piece of at least one reference, at most `height` splits high.
pub(super) fn build(piece: Piece<'_>, height: u32, plan: &Plan<'_>) -> Branch {
    let count = piece.slots();
    let mut arena = Arena {
        parts: Vec::with_capacity(2 * count - 1),
        items: Vec::with_capacity(count),
        plan,
    };
    arena.parts.push(Part::BLANK);
    let costs = arena.divide(0, piece, height);
    let (nodes, items) = (arena.count_nodes(0), arena.items.len());
    let mut branch = Branch {
        bounds: arena.parts[0].bounds,
        costs: [costs[0]; 8],
        root: link::node(0),
        depth: 0,
        bytes: (nodes * size_of::<WideNode>() + items * size_of::<u32>()) as u64,
        nodes: Vec::new(),
        items: Vec::new(),
    };
    let taken = plan.taken.fetch_add(branch.bytes, Ordering::Relaxed);
    if taken + branch.bytes > plan.bytes {
        return branch;
    }
    branch.nodes.reserve_exact(nodes);
    branch.items.reserve_exact(items);
    if nodes == 0 {
        branch.root = arena.leaf(0, &mut branch.items);
    } else {
        branch.depth = arena.emit(0, &mut branch);
    }
    branch
}

impl Arena<'_> {
    /// Makes the part of a piece, and all below it.
    fn divide(&mut self, part: usize, piece: Piece<'_>, height: u32) -> Costs {
        if let [reference] = piece.references() {
            let bounds = reference.0;
            self.parts[part] = Part {
                bounds,
                index: self.items.len() as u32,
                count: 1,
                choice: Choice::LEAF,
            };
            self.items.push(reference.item());
            return cost::leaf(bounds.half_area(), 1);
        }
        let halves = self.parts.len();
        self.parts.extend([Part::BLANK; 2]);
        let [low, high] = piece.split(largest(height - 1), self.plan.division.as_ref());
        let first = self.divide(halves, low, height - 1);
        let second = self.divide(halves + 1, high, height - 1);
        let (low, high) = (&self.parts[halves], &self.parts[halves + 1]);
        let (bounds, count) = (low.bounds.union(&high.bounds), low.count + high.count);
        let (costs, choice) = cost::join(
            &first,
            &second,
            bounds.half_area(),
            count,
            self.plan.leaf_size,
        );
        self.parts[part] = Part {
            bounds,
            index: halves as u32,
            count,
            choice,
        };
        costs
    }

    /// Writes the node of a part and all below it; returns how deep that goes.
    fn emit(&self, part: usize, branch: &mut Branch) -> u32 {
        let slots = self.slots(part);
        let own = branch.nodes.len();
        branch.nodes.push(WideNode::EMPTY);
        let mut deepest = 0;
        for (lane, &slot) in slots.as_slice().iter().enumerate() {
            let Part { bounds, choice, .. } = &self.parts[slot];
            let link = if choice.is_leaf() {
                self.leaf(slot, &mut branch.items)
            } else {
                let link = link::node(branch.nodes.len());
                deepest = deepest.max(1 + self.emit(slot, branch));
                link
            };
            branch.nodes[own].set(lane, bounds, link);
        }
        deepest
    }

    fn count_nodes(&self, part: usize) -> usize {
        if self.parts[part].choice.is_leaf() {
            return 0;
        }
        let slots = self.slots(part);
        1 + slots
            .as_slice()
            .iter()
            .map(|&slot| self.count_nodes(slot))
            .sum::<usize>()
    }

    /// Appends the items of a part.
    fn leaf(&self, part: usize, items: &mut Vec<u32>) -> u32 {
        let first = items.len();
        let mut low = part;
        // References of a part lie together: its first is that of its first half.
        while self.parts[low].count > 1 {
            low = self.parts[low].index as usize;
        }
        let place = self.parts[low].index as usize;
        for &item in &self.items[place..place + self.parts[part].count as usize] {
            // Two parts of an item are one again.
            if !items[first..].contains(&item) {
                items.push(item);
            }
        }
        link::leaf(first as u32, (items.len() - first) as u32)
    }

    /// What stands in the node of a part.
    fn slots(&self, part: usize) -> Slots {
        let mut slots = Slots::default();
        let Part { index, choice, .. } = self.parts[part];
        self.fill(index as usize, choice.to_first(8), &mut slots);
        self.fill(index as usize + 1, 8 - choice.to_first(8), &mut slots);
        slots
    }

    /// Puts a part into so many slots at most.
    fn fill(&self, part: usize, count: u32, slots: &mut Slots) {
        let Part { index, choice, .. } = self.parts[part];
        if choice.divides(count) {
            let first = choice.to_first(count);
            self.fill(index as usize, first, slots);
            self.fill(index as usize + 1, count - first, slots);
        } else {
            slots.push(part);
        }
    }
}

/// The most references that fit into a tree of so many splits.
pub(super) const fn largest(height: u32) -> usize {
    if height < 32 { 1 << height } else { 1 << 32 }
}

/// Up to eight parts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slots {
    parts: [usize; 8],
    count: usize,
}

impl Slots {
    pub(super) const fn push(&mut self, part: usize) {
        self.parts[self.count] = part;
        self.count += 1;
    }

    pub(super) fn as_slice(&self) -> &[usize] {
        &self.parts[..self.count]
    }
}

impl WideNode {
    pub(super) const EMPTY: Self = Self {
        boxes: Boxes8::EMPTY,
        links: [link::leaf(0, 1); 8],
    };

    pub(super) fn set(&mut self, lane: usize, bounds: &PaddedBox, link: u32) {
        let [x, y, z, _] = bounds.min;
        let [u, v, w, _] = bounds.max;
        self.boxes.set(lane, [x, y, z], [u, v, w]);
        self.links[lane] = link;
    }
}
