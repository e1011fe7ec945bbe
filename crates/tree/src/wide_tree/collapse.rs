//! From halves to nodes of eight.

use octray_kernels::Boxes8;
use rayon::prelude::*;

use super::binary::{Binary, MAX_HEIGHT, SEQUENTIAL, Subtree};
use super::{MAX_DEPTH, WideNode, link};

/// Seven splits, tallest part first, take three off the height: at worst they split 1, 2 and 4
/// parts. So a subtree of this height always fits below a node at `depth`.
const fn tallest_below(depth: u32) -> u32 {
    3 * (MAX_DEPTH - depth)
}

const _: () = assert!(MAX_HEIGHT <= tallest_below(0));

/// Nodes in depth-first order, the root first. Links to nodes count from the first of them.
pub(super) fn collapse(binary: &Binary, leaf_size: u32) -> (Vec<WideNode>, u32) {
    let mut nodes = Vec::new();
    let depth = emit(binary, &binary.root, 0, leaf_size, &mut nodes);
    (nodes, depth)
}

/// Appends the node for `subtree` and all below it; returns the depth of the deepest.
fn emit(
    binary: &Binary,
    subtree: &Subtree,
    depth: u32,
    leaf_size: u32,
    nodes: &mut Vec<WideNode>,
) -> u32 {
    let slots = choose(binary, subtree, depth, leaf_size);
    let own = nodes.len();
    let mut node = WideNode {
        boxes: Boxes8::EMPTY,
        links: [link::leaf(0, 1); 8],
    };
    for (lane, slot) in slots.iter().enumerate() {
        node.boxes.set(lane, slot.bounds.min, slot.bounds.max);
        if slot.count <= leaf_size {
            node.links[lane] = link::leaf(slot.first, slot.count);
        }
    }
    nodes.push(node);
    let inner = |slot: &Subtree| slot.count > leaf_size;
    let mut deepest = depth;
    if subtree.count as usize <= SEQUENTIAL {
        for (lane, slot) in slots.iter().enumerate().filter(|(_, slot)| inner(slot)) {
            nodes[own].links[lane] = link::node(nodes.len());
            deepest = deepest.max(emit(binary, slot, depth + 1, leaf_size, nodes));
        }
        return deepest;
    }
    let parts: Vec<_> = slots
        .par_iter()
        .enumerate()
        .filter(|(_, slot)| inner(slot))
        .map(|(lane, slot)| {
            let mut part = Vec::new();
            let deepest = emit(binary, slot, depth + 1, leaf_size, &mut part);
            (lane, part, deepest)
        })
        .collect();
    nodes.reserve_exact(parts.iter().map(|(_, part, _)| part.len()).sum());
    for (lane, part, depth) in parts {
        let base = nodes.len();
        nodes[own].links[lane] = link::node(base);
        nodes.extend(part.into_iter().map(|mut node| {
            node.links = node.links.map(|word| link::rebased(word, base));
            node
        }));
        deepest = deepest.max(depth);
    }
    deepest
}

/// Up to eight parts of the subtree, in Morton order.
fn choose(binary: &Binary, subtree: &Subtree, depth: u32, leaf_size: u32) -> Vec<Subtree> {
    let mut slots = Vec::with_capacity(8);
    slots.push(*subtree);
    while slots.len() < 8 {
        let Some(index) = next_to_split(&slots, depth, leaf_size) else {
            break;
        };
        let [left, right] = binary.parts(&slots[index]);
        slots[index] = left;
        slots.insert(index + 1, right);
    }
    slots
}

/// The part whose splitting gains most: one that would grow too tall; else the largest that is
/// too big for a leaf; else, as slots are free anyway, the largest that holds several items.
fn next_to_split(slots: &[Subtree], depth: u32, leaf_size: u32) -> Option<usize> {
    let largest = |wanted: &dyn Fn(&Subtree) -> bool, size: &dyn Fn(&Subtree) -> f32| {
        let mut best: Option<(usize, f32)> = None;
        for (index, slot) in slots.iter().enumerate() {
            let candidate = size(slot);
            if wanted(slot) && best.is_none_or(|(_, size)| candidate > size) {
                best = Some((index, candidate));
            }
        }
        best.map(|(index, _)| index)
    };
    let area = |slot: &Subtree| slot.bounds.half_area();
    largest(&|slot| slot.height > tallest_below(depth + 1), &|slot| {
        slot.height as f32
    })
    .or_else(|| largest(&|slot| slot.count > leaf_size, &area))
    .or_else(|| largest(&|slot| slot.count > 1, &area))
}
