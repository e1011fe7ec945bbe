//! Where a world is cut, and in which order a line meets the parts.

use octray_math::{Aabb, CellKey, DVec3, Interval, MAX_DEPTH};
use octray_tree::{CellTree, Node};
use thiserror::Error;

use crate::World;
use crate::line::Line;

/// Why a world cannot be cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TreeletError {
    /// Regions of copies are known only where all of them are.
    #[error(
        "a scene with copies of prototypes where materials let light through or priorities differ cannot be cut into treelets yet"
    )]
    Copies,
    /// No treelets, or more than their numbers can tell apart.
    #[error("the number of treelets must lie between 1 and 65535")]
    Count,
}

/// Which treelet holds what, and the boxes of the top tree. See the [module](super).
#[derive(Clone, Debug, PartialEq)]
pub struct Treelets {
    count: u16,
    /// In the coordinates of the scene, grown by what rounding and the margin of contents move.
    boxes: Vec<(Aabb, u16)>,
    /// By the index of the leaf.
    pub(super) leaves: Vec<u16>,
    /// By the triangle of sheets.
    pub(super) triangles: Vec<u16>,
}

/// Something that is one treelet's.
struct Item {
    code: u64,
    /// The octree's cell of the greatest depth at its centre.
    key: CellKey,
    bounds: Aabb,
    cost: u64,
    /// A leaf, else a triangle.
    is_leaf: bool,
    index: u32,
}

/// The octants on the way to a cell, as one number.
fn morton(key: CellKey) -> u64 {
    (1..=key.depth).fold(0, |code, depth| {
        (code << 3) | u64::from(key.octant_at(depth))
    })
}

impl World {
    /// Cuts the world into so many treelets, some of them empty where there is less to hold. Without an octree over
    /// the solids ([`crate::Method`]) all solids are shared.
    ///
    /// # Errors
    /// See [`TreeletError`].
    pub fn treelets(&self, count: usize) -> Result<Treelets, TreeletError> {
        let count = u16::try_from(count).ok().filter(|n| *n > 0);
        let count = count.ok_or(TreeletError::Count)?;
        if !self.instances.is_empty() && (self.has_transparency() || self.instances.hide()) {
            return Err(TreeletError::Copies);
        }
        let mut found = Vec::new();
        if let Some(cells) = self.solids.partition() {
            cells.visit_leaves(|leaf| {
                if let Node::Occupied(index) = leaf.node {
                    let cost = 1 + u64::from(self.solids.held(index).parts);
                    found.push((leaf.bounds, cost, true, index));
                }
            });
        }
        for triangle in 0..self.sheets.triangle_count() as u32 {
            let corners = self.sheets.triangles().corners(triangle);
            found.push((Aabb::from_points(corners), 1, false, triangle));
        }
        Ok(Treelets::cut(count, &found))
    }
}

impl Treelets {
    fn cut(count: u16, found: &[(Aabb, u64, bool, u32)]) -> Self {
        let all = found
            .iter()
            .fold(Aabb::EMPTY, |all, item| all.union(item.0));
        let (root, margin) = if all.is_empty() {
            (Aabb::new(DVec3::ZERO, DVec3::ONE), 0.0)
        } else {
            // Room on every side, so that every centre lies within.
            let half = all.half_size().max_element() * 1.0625 + f64::MIN_POSITIVE;
            let size = DVec3::splat(half);
            let cube = Aabb::new(all.center() - size, all.center() + size);
            (cube, 2.0 * half * CellTree::CONTENT_MARGIN)
        };
        let mut items: Vec<Item> = found
            .iter()
            .map(|&(bounds, cost, is_leaf, index)| {
                let key = CellKey::containing(&root, MAX_DEPTH, bounds.center());
                let key = key.unwrap_or(CellKey::ROOT);
                Item {
                    code: morton(key),
                    key,
                    bounds,
                    cost,
                    is_leaf,
                    index,
                }
            })
            .collect();
        items.sort_by_key(|item| (item.code, !item.is_leaf, item.index));
        let of_kind = |leaf| items.iter().filter(|item| item.is_leaf == leaf).count();
        let mut treelets = Self {
            count,
            boxes: Vec::new(),
            leaves: vec![0; of_kind(true)],
            triangles: vec![0; of_kind(false)],
        };
        let total: u64 = items.iter().map(|item| item.cost).sum();
        let mut owners = Vec::with_capacity(items.len());
        let mut before = 0;
        let mut last: Option<(u64, u16)> = None;
        for item in &items {
            let owner = match last {
                // What lies in one cell of the greatest depth stays together.
                Some((code, owner)) if code == item.code => owner,
                _ => (u128::from(before) * u128::from(count) / u128::from(total.max(1))) as u16,
            };
            last = Some((item.code, owner));
            before += item.cost;
            owners.push(owner);
            let list = if item.is_leaf {
                &mut treelets.leaves
            } else {
                &mut treelets.triangles
            };
            list[item.index as usize] = owner;
        }
        treelets.add_boxes(&items, &owners, 0, margin);
        treelets
    }

    /// One box for each largest cell whose items are one treelet's.
    fn add_boxes(&mut self, items: &[Item], owners: &[u16], depth: u32, margin: f64) {
        let (Some(first), Some(last)) = (owners.first(), owners.last()) else {
            return;
        };
        // They increase.
        if first == last || depth == MAX_DEPTH {
            let bounds = items.iter().fold(Aabb::EMPTY, |all, i| all.union(i.bounds));
            self.boxes.push((bounds.inflated(margin), *first));
            return;
        }
        let octant = |item: &Item| match item.key.depth {
            0 => 0,
            _ => item.key.octant_at(depth + 1),
        };
        let mut start = 0;
        for run in items.chunk_by(|a, b| octant(a) == octant(b)) {
            let end = start + run.len();
            self.add_boxes(run, &owners[start..end], depth + 1, margin);
            start = end;
        }
    }

    /// How many there are.
    #[must_use]
    pub const fn count(&self) -> u16 {
        self.count
    }

    /// How many leaves of the octree over solids and how many triangles of sheets a treelet holds.
    #[must_use]
    pub fn held(&self, treelet: u16) -> (usize, usize) {
        let count = |all: &[u16]| all.iter().filter(|owner| **owner == treelet).count();
        (count(&self.leaves), count(&self.triangles))
    }

    /// Boxes of the top tree.
    #[must_use]
    pub const fn box_count(&self) -> usize {
        self.boxes.len()
    }

    /// The treelet that the line enters next after `last`, no later than at `limit`;
    /// the first one if `last` is `None`.
    pub(super) fn next(&self, line: &Line, last: Option<u16>, limit: f64) -> Option<u16> {
        let span = Interval::new(line.origin, line.end.min(limit));
        let entry = |bounds: &Aabb| {
            let part = bounds.clip(&line.ray).intersection(&span);
            (!part.is_empty()).then_some(part.start)
        };
        let mut entries: Vec<(f64, u16)> = Vec::new();
        for (bounds, owner) in &self.boxes {
            let Some(s) = entry(bounds) else { continue };
            match entries.iter_mut().find(|(_, known)| known == owner) {
                Some(known) => known.0 = known.0.min(s),
                None => entries.push((s, *owner)),
            }
        }
        entries.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        match last {
            None => entries.first().map(|(_, owner)| *owner),
            Some(last) => {
                let at = entries.iter().position(|(_, owner)| *owner == last)?;
                entries.get(at + 1).map(|(_, owner)| *owner)
            }
        }
    }

    /// The first treelet whose boxes hold a point in the coordinates of the scene.
    pub(super) fn holding(&self, point: DVec3) -> Option<u16> {
        let found = self.boxes.iter().find(|(bounds, _)| bounds.contains(point));
        found.map(|(_, owner)| *owner)
    }
}
