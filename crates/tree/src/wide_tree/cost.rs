//! What a ray is expected to pay, and the best use of eight slots.
//!
//! A part of the binary tree can become a leaf, a node, or dissolve into several slots of the node
//! above. The least cost of filling `n` slots with it follows from those of its two halves
//! (dynamic programming; Ylitie, Karras & Laine 2017): the chance that a line which meets the tree
//! meets a box goes by its surface (Goldsmith & Salmon 1987).

/// The cost of testing an item, where a node costs 1: items of a leaf are tested together.
const ITEM: f32 = 0.15;
/// The cost of entering a leaf.
const LEAF: f32 = 0.7;

/// The least cost of a part in up to 1, 2, ... 8 slots.
pub(super) type Costs = [f32; 8];

/// How a part of the binary tree is used, in one word.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice(u32);

const LEAF_BIT: u32 = 1 << 24;
/// From this bit on: how many slots make it worth dividing the part; 9 if none do.
const WORTH_SHIFT: u32 = 25;

impl Choice {
    pub(super) const LEAF: Self = Self(LEAF_BIT | 9 << WORTH_SHIFT);

    /// Whether it is a leaf rather than a node where it takes one slot.
    pub(super) const fn is_leaf(self) -> bool {
        self.0 & LEAF_BIT != 0
    }

    /// Whether it is divided if it may take `slots`.
    pub(super) const fn divides(self, slots: u32) -> bool {
        slots >= self.0 >> WORTH_SHIFT
    }

    /// How many of 2 to 8 slots go to the first half.
    pub(super) const fn to_first(self, slots: u32) -> u32 {
        self.0 >> (3 * (slots - 1)) & 7
    }
}

/// A part that is a leaf.
pub(super) fn leaf(area: f32, count: u32) -> Costs {
    [area * (LEAF + ITEM * count as f32); 8]
}

/// A part of two halves; it may be a leaf if `count`, its number of items, is not above
/// `leaf_size`.
#[inline]
pub(super) fn join(
    first: &Costs,
    second: &Costs,
    area: f32,
    count: u32,
    leaf_size: u32,
) -> (Costs, Choice) {
    let mut divided = [f32::INFINITY; 8];
    let mut word = 0;
    for slots in 2..=8usize {
        let (mut best, mut to_first) = (f32::INFINITY, 1);
        for k in 1..slots {
            let cost = first[k - 1] + second[slots - k - 1];
            if cost < best {
                (best, to_first) = (cost, k);
            }
        }
        divided[slots - 1] = best;
        word |= (to_first as u32) << (3 * (slots - 1));
    }
    let mut whole = area + divided[7];
    if count <= leaf_size {
        let as_leaf = area * (LEAF + ITEM * count as f32);
        if as_leaf <= whole {
            whole = as_leaf;
            word |= LEAF_BIT;
        }
    }
    // More slots never cost more, so from one number of slots on dividing is worth it.
    let worth = 1 + divided.iter().take_while(|&&cost| cost >= whole).count() as u32;
    (
        divided.map(|cost| if cost < whole { cost } else { whole }),
        Choice(word | worth << WORTH_SHIFT),
    )
}
