//! What occupied cells hold, in flat arrays. Equal expressions are stored once.

use std::collections::HashMap;
use std::ops::Range;

use octray_geometry::csg::{self, Face};
use octray_math::hash_combine;

use super::cells::Content;

/// The contents of all leaves.
#[derive(Debug, Default)]
pub(crate) struct Leaves {
    leaves: Vec<Leaf>,
    surfaces: Vec<u32>,
    objects: Vec<LeafObject>,
    words: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Leaf {
    surfaces: [u32; 2],
    objects: [u32; 2],
    base: u32,
}

/// An object whose boundary passes through the cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafObject {
    /// Index into the ranked objects.
    pub(super) rank: u32,
    expression: [u32; 2],
    /// Empty: not clipped.
    clip: [u32; 2],
}

/// One leaf's slices.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafView<'a> {
    /// The surfaces to cross, increasing.
    pub(super) surfaces: &'a [u32],
    /// In the order of their ranks.
    pub(super) objects: &'a [LeafObject],
    /// 1 + the lowest rank among the objects that fill the cell, 0 for none.
    pub(super) base: u32,
    words: &'a [u32],
}

impl<'a> LeafView<'a> {
    /// The same leaf with some of its objects only; `surfaces` is overwritten with theirs.
    pub(super) fn only<'b>(
        &self,
        objects: &'b [LeafObject],
        surfaces: &'b mut Vec<u32>,
        faces: &[Face],
    ) -> LeafView<'b>
    where
        'a: 'b,
    {
        surfaces.clear();
        for object in objects {
            let words = [self.expression(object), self.clip(object).unwrap_or(&[])];
            let own = words.into_iter().flat_map(csg::faces);
            surfaces.extend(own.map(|face| faces[face.0 as usize].surface.0));
        }
        surfaces.sort_unstable();
        surfaces.dedup();
        LeafView {
            surfaces,
            objects,
            base: self.base,
            words: self.words,
        }
    }

    pub(super) fn expression(&self, object: &LeafObject) -> &[u32] {
        &self.words[range(object.expression)]
    }

    /// `None` where all of the boundary counts.
    pub(super) fn clip(&self, object: &LeafObject) -> Option<&[u32]> {
        let words = &self.words[range(object.clip)];
        (!words.is_empty()).then_some(words)
    }
}

const fn range(ends: [u32; 2]) -> Range<usize> {
    ends[0] as usize..ends[1] as usize
}

impl Leaves {
    pub(super) fn get(&self, leaf: u32) -> LeafView<'_> {
        let leaf = &self.leaves[leaf as usize];
        LeafView {
            surfaces: &self.surfaces[range(leaf.surfaces)],
            objects: &self.objects[range(leaf.objects)],
            base: leaf.base,
            words: &self.words,
        }
    }

    /// Bytes of the lists of objects and surfaces.
    pub(super) fn list_bytes(&self) -> u64 {
        (size_of_val(self.leaves.as_slice())
            + size_of_val(self.surfaces.as_slice())
            + size_of_val(self.objects.as_slice())) as u64
    }

    /// Bytes of the expressions.
    pub(super) fn expression_bytes(&self) -> u64 {
        size_of_val(self.words.as_slice()) as u64
    }

    /// Everything, for hashing and comparing.
    pub(super) fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let leaves = self.leaves.iter().flat_map(|l| {
            [
                l.surfaces[0],
                l.surfaces[1],
                l.objects[0],
                l.objects[1],
                l.base,
            ]
        });
        let objects = self.objects.iter().flat_map(|o| {
            [
                o.rank,
                o.expression[0],
                o.expression[1],
                o.clip[0],
                o.clip[1],
            ]
        });
        leaves
            .chain(self.surfaces.iter().copied())
            .chain(objects)
            .chain(self.words.iter().copied())
    }
}

/// Writes the contents of cells down as they become leaves.
#[derive(Debug, Default)]
pub(super) struct LeafWriter {
    leaves: Leaves,
    /// By a hash of its words, an expression that was written. Of two with one hash only the first is
    /// found again.
    seen: HashMap<u64, [u32; 2]>,
}

impl LeafWriter {
    /// Adds the contents of the next leaf; returns its index.
    pub(super) fn push(&mut self, content: &Content) -> u32 {
        let index = self.leaves.leaves.len() as u32;
        let first = [
            self.leaves.surfaces.len() as u32,
            self.leaves.objects.len() as u32,
        ];
        for object in content.objects() {
            let expression = self.stored(object.expression);
            let clip = self.stored(object.clip);
            self.leaves.objects.push(LeafObject {
                rank: object.rank,
                expression,
                clip,
            });
        }
        let leaves = &mut self.leaves;
        leaves.surfaces.extend_from_slice(content.surfaces());
        leaves.leaves.push(Leaf {
            surfaces: [first[0], leaves.surfaces.len() as u32],
            objects: [first[1], leaves.objects.len() as u32],
            base: content.base,
        });
        index
    }

    /// Where words are, which are written if they have not been before.
    fn stored(&mut self, words: &[u32]) -> [u32; 2] {
        if words.is_empty() {
            return [0, 0];
        }
        let all = &mut self.leaves.words;
        let hash = words
            .iter()
            .fold(0, |hash, word| hash_combine(hash, u64::from(*word)));
        if let Some(&known) = self.seen.get(&hash)
            && all[range(known)] == *words
        {
            return known;
        }
        let start = all.len() as u32;
        all.extend_from_slice(words);
        let found = [start, all.len() as u32];
        self.seen.entry(hash).or_insert(found);
        found
    }

    /// All of them.
    pub(super) fn finish(self) -> Leaves {
        let mut leaves = self.leaves;
        leaves.leaves.shrink_to_fit();
        leaves.surfaces.shrink_to_fit();
        leaves.objects.shrink_to_fit();
        leaves.words.shrink_to_fit();
        leaves
    }
}
