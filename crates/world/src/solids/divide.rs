//! Dividing space around the solids: by criteria or along a list, face by face or operand by operand.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use octray_geometry::csg::Operand;
use octray_geometry::membership::{Fineness, Marker};
use octray_geometry::{Membership, SceneFrame};
use octray_math::Aabb;
use octray_scene::Scene;
use octray_tree::cell_tree::enclosing_cube;
use octray_tree::{Division, Partition};

use super::Solids;
use super::candidates::{Expressions, candidates, slack};
use super::cells::{Cells, Content};
use super::leaf::LeafWriter;
use super::listed_cells::{ListedCells, list_of};
use super::operand_cells::{OperandCells, operands_in, operands_of_faces};
use crate::cell_list::ListedScene;
use crate::{CellList, CellListError, MarkingStats, WorldConfig};

/// How space is divided.
pub(super) struct Plan<'a> {
    pub(super) division: Division,
    pub(super) membership: Membership,
    pub(super) list: Option<&'a CellList>,
    pub(super) config: &'a WorldConfig,
    pub(super) frame: &'a SceneFrame,
}

/// The cells, and how operands were marked.
pub(super) struct Divided {
    pub(super) cells: Partition,
    pub(super) marking: Option<MarkingStats>,
}

impl Plan<'_> {
    /// Divides the space around `bounds`, which holds `content`; the contents of occupied cells go to
    /// `leaves`.
    pub(super) fn divide(
        &self,
        bounds: &Aabb,
        content: Content,
        by_faces: &Cells<'_>,
        operands: &[Operand],
        leaves: &mut LeafWriter,
    ) -> Result<Divided, CellListError> {
        let Self {
            division, config, ..
        } = *self;
        let (criteria, table) = (&config.criteria, config.table);
        if self.membership == Membership::Analytic {
            let how = (division, table);
            let mut keep = |content: Content| {
                leaves.push(&content);
            };
            let cells = Partition::build_into(bounds, content, by_faces, how, criteria, &mut keep);
            return Ok(Divided {
                cells,
                marking: None,
            });
        }
        let gauge = Arc::new(AtomicU64::new(0));
        let fineness = Fineness {
            within: enclosing_cube(bounds),
            memory_limit: criteria.memory_limit / 4,
        };
        let marker = Marker::new(
            operands,
            self.membership,
            slack(self.frame),
            &fineness,
            &gauge,
        );
        let operand_of = operands_of_faces(operands);
        let marking = OperandCells::new(by_faces, operands, &marker, &operand_of);
        let (cells, contents) = if let Some(list) = self.list {
            along_list(list, bounds, content, &marking, division, config)?
        } else {
            let root = marking.root(content);
            let (cells, leaves) =
                Partition::build(bounds, root, &marking, division, criteria, table);
            (cells, leaves.into_iter().map(|leaf| leaf.content).collect())
        };
        let touched =
            |content: &Content| operands_in(content.expressions(), &operand_of).len() as u64;
        let marks = contents.iter().map(touched).sum();
        for content in &contents {
            leaves.push(content);
        }
        let stats = marker.stats();
        drop(marker);
        let marking = MarkingStats {
            marker: stats,
            marks,
            pieces_left: gauge.load(Ordering::Relaxed),
        };
        Ok(Divided {
            cells,
            marking: Some(marking),
        })
    }
}

impl Solids {
    /// The occupied cells with the operands that they touch; `None` where there is no octree.
    pub(crate) fn cell_list(&self, scene: &Scene, frame: &SceneFrame) -> Option<CellList> {
        let partition = self.cells.as_ref()?;
        if partition.stats().resolution.is_some() {
            return None;
        }
        let expressions = Expressions::new(&candidates(scene, frame), frame, true);
        let operand_of = operands_of_faces(&expressions.scene.operands);
        let mut leaves = Vec::new();
        partition.visit_leaves(|leaf| leaves.push(leaf));
        let listed = ListedScene {
            root: *partition.bounds(),
            operands: expressions.scene.operands.len() as u32,
            fingerprint: expressions.fingerprint(),
        };
        Some(list_of(listed, leaves, |leaf| {
            let view = self.leaves.get(leaf);
            let words = view
                .objects
                .iter()
                .flat_map(|object| [view.expression(object), view.clip(object).unwrap_or(&[])]);
            operands_in(words, &operand_of)
        }))
    }
}

/// Whether the list is of these solids and the method has an octree for it.
pub(super) fn check_list(
    list: &CellList,
    division: Option<Division>,
    expressions: &Expressions,
) -> Result<(), CellListError> {
    let Some(Division::Octree(encoding, _)) = division else {
        return Err(CellListError::Method("the method has no octree"));
    };
    if list.depth() > encoding.max_depth() {
        let reason = "it has cells below level 10, the deepest for a hash table of occupied cells";
        return Err(CellListError::Method(reason));
    }
    let scene = &list.scene;
    let operands = expressions.scene.operands.len();
    if scene.operands as usize != operands || scene.fingerprint != expressions.fingerprint() {
        return Err(CellListError::OtherScene);
    }
    Ok(())
}

/// The cells of a list, with their contents.
fn along_list(
    list: &CellList,
    bounds: &Aabb,
    content: Content,
    marking: &OperandCells<'_>,
    division: Division,
    config: &WorldConfig,
) -> Result<(Partition, Vec<Content>), CellListError> {
    if enclosing_cube(bounds) != list.scene.root {
        return Err(CellListError::OtherScene);
    }
    let listed = ListedCells::new(marking, list);
    let root = listed.root(&marking.root(content));
    let criteria = ListedCells::criteria(&config.criteria);
    let (built, leaves) =
        Partition::build(bounds, root, &listed, division, &criteria, config.table);
    if built.stats().cells.stopped_by_memory {
        return Err(CellListError::Memory);
    }
    let contents = leaves.into_iter().map(|leaf| leaf.marked.content);
    Ok((built, contents.collect()))
}
