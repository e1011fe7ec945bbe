//! Cells along a list, and the list of cells that there are.

use std::fmt::{self, Write};

use octray_geometry::Primitive;
use octray_geometry::csg::Operand;
use octray_geometry::membership::Marks;
use octray_math::{Aabb, CellKey, hash_combine};
use octray_tree::{Cell, Criteria, Leaf, Node, Subdivide};

use super::operand_cells::{MarkedContent, OperandCells};
use crate::cell_list::{CellList, ListedScene, morton};

/// A cell while the tree is built along a list.
pub(super) struct Listed {
    key: CellKey,
    /// The cells of the list in it.
    range: [usize; 2],
    /// Whether it is divided, because there are smaller ones.
    divided: bool,
    pub(super) marked: MarkedContent,
}

/// Follows a list.
pub(super) struct ListedCells<'a> {
    marking: &'a OperandCells<'a>,
    list: &'a CellList,
}

impl<'a> ListedCells<'a> {
    pub(super) const fn new(marking: &'a OperandCells<'a>, list: &'a CellList) -> Self {
        Self { marking, list }
    }

    /// The criteria by which nothing but the list and memory decide.
    pub(super) fn criteria(given: &Criteria) -> Criteria {
        Criteria {
            max_depth: octray_math::MAX_DEPTH,
            by_cost: false,
            memory_limit: given.memory_limit,
            ..Criteria::default()
        }
    }

    pub(super) fn root(&self, content: &MarkedContent) -> Listed {
        let root = self.list.scene.root;
        self.cell(CellKey::ROOT, content, [0, self.list.len()], &root)
    }

    fn cell(
        &self,
        key: CellKey,
        parent: &MarkedContent,
        [start, end]: [usize; 2],
        bounds: &Aabb,
    ) -> Listed {
        let [first, after] = morton(key);
        let cells = &self.list.cells[start..end];
        let low = start + cells.partition_point(|c| morton(c.key)[0] < first);
        let high = start + cells.partition_point(|c| morton(c.key)[0] < after);
        let within = &self.list.cells[low..high];
        let divided = within.iter().any(|c| c.key.depth > key.depth);
        let mut operands: Vec<u32> = (within.iter())
            .flat_map(|c| self.list.operands_of(c))
            .copied()
            .collect();
        operands.sort_unstable();
        operands.dedup();
        let touched = if divided {
            self.marking
                .touched_besides(&parent.marks, operands, bounds)
        } else {
            Marks::of(operands)
        };
        Listed {
            key,
            range: [low, high],
            divided,
            marked: self.marking.reduce(parent, touched, bounds, true),
        }
    }
}

impl Subdivide for ListedCells<'_> {
    type Content = Listed;

    fn restrict(&self, parent: &Listed, cell: &Aabb) -> Listed {
        let root = &self.list.scene.root;
        let depth = parent.key.depth + 1;
        let key = CellKey::containing(root, depth, cell.center()).unwrap_or(CellKey::ROOT);
        self.cell(key, &parent.marked, parent.range, cell)
    }

    fn describe(&self, content: &Listed) -> Cell {
        if content.divided {
            return Cell::Occupied {
                cost: 1.0,
                parts: 1,
            };
        }
        self.marking.describe(&content.marked)
    }

    fn bytes(&self, content: &Listed) -> u64 {
        self.marking.bytes(&content.marked)
    }

    fn building_bytes(&self, content: &Listed) -> u64 {
        self.marking.building_bytes(&content.marked)
    }

    fn settle(&self, content: &mut Listed) {
        self.marking.settle(&mut content.marked);
    }

    fn prescribed(&self, content: &Listed) -> Option<bool> {
        Some(content.divided)
    }
}

/// The list of these leaves, in any order; `operands` says what an occupied one holds.
pub(super) fn list_of(
    scene: ListedScene,
    mut leaves: Vec<Leaf>,
    operands: impl Fn(u32) -> Vec<u32>,
) -> CellList {
    leaves.sort_by_key(|leaf| morton(leaf.key));
    let mut list = CellList::new(scene);
    for (index, leaf) in leaves.iter().enumerate() {
        match leaf.node {
            Node::Occupied(content) => list.push(leaf.key, &operands(content)),
            _ if is_needed(&leaves[index..]) => list.push(leaf.key, &[]),
            _ => {}
        }
    }
    list
}

/// Whether the first of these leaves begins eight brothers that are all empty: then nothing else tells
/// that their parent was divided.
fn is_needed(leaves: &[Leaf]) -> bool {
    let Some(brothers) = leaves.get(..8) else {
        return false;
    };
    let parent = leaves[0].key.parent();
    parent.is_some()
        && (brothers.iter())
            .all(|leaf| leaf.key.parent() == parent && matches!(leaf.node, Node::Empty(_)))
}

/// A number that differs for other operands, in another place or order.
pub(super) fn fingerprint(operands: &[Operand], expressions: impl Iterator<Item = u32>) -> u64 {
    let mut hash = operands.len() as u64;
    let mut add = |value: u64| hash = hash_combine(hash, value);
    for operand in operands {
        add_primitive(&operand.primitive, &mut add);
        for number in operand.scene_from_local.to_cols_array() {
            add(number.to_bits());
        }
        add(u64::from(operand.complemented));
    }
    for word in expressions {
        add(u64::from(word));
    }
    hash
}

/// Everything that tells a primitive from others.
fn add_primitive(primitive: &Primitive, add: &mut impl FnMut(u64)) {
    if let Primitive::Mesh(mesh) = primitive {
        for position in mesh.positions() {
            for number in position.to_array() {
                add(number.to_bits());
            }
        }
        for corner in mesh.triangles().iter().flatten() {
            add(u64::from(*corner));
        }
        return;
    }
    // All numbers are written so that they can be read back.
    let written = write!(Bytes(add), "{primitive:?}");
    debug_assert!(written.is_ok(), "nothing refuses to be hashed");
}

/// Takes text apart.
struct Bytes<'a, F>(&'a mut F);

impl<F: FnMut(u64)> fmt::Write for Bytes<'_, F> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0(u64::from(byte));
        }
        Ok(())
    }
}
