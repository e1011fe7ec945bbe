//! From the scene's objects to faces, ranks and cells.

use std::cmp::Ordering;
use std::sync::Arc;
use std::sync::atomic::{self, AtomicU64};

use octray_geometry::csg::{Constant, Face, Lowered, LoweredScene, Lowering, MeshOperand};
use octray_geometry::membership::{Fineness, Marker};
use octray_geometry::mesh::MeshSolid;
use octray_geometry::surface::{PLACE_TOLERANCE, SURFACE_TOLERANCE};
use octray_geometry::{FaceId, MaterialId, Membership, SceneFrame, Sheet, Solid};
use octray_math::Aabb;
use octray_scene::{Object, ObjectId, Scene, Shape};
use octray_tree::cell_tree::enclosing_cube;
use octray_tree::{Division, Encoding, Partition, WideTreeConfig};

use super::cells::{Cells, Content};
use super::listed_cells::{ListedCells, fingerprint, list_of};
use super::operand_boxes::OperandBoxes;
use super::operand_cells::{OperandCells, operands_in, operands_of_faces};
use super::volumes::Volumes;
use super::{Leaves, MeshSurface, Ranked, Solids};
use crate::cell_list::ListedScene;
use crate::{CellList, CellListError, MarkingStats, Method, WorldConfig, WorldError};

/// An object before its rank is known.
struct Candidate<'a> {
    id: ObjectId,
    object: &'a Object,
    boundary: &'a Solid,
    clip: Option<&'a Solid>,
    /// In the coordinates of the scene.
    bounds: Aabb,
}

/// What merged surfaces and rounding move, many times over.
fn slack(frame: &SceneFrame) -> f64 {
    64.0 * (SURFACE_TOLERANCE * frame.size + PLACE_TOLERANCE * frame.largest())
}

impl<'a> Candidate<'a> {
    fn new(index: usize, object: &'a Object, frame: &SceneFrame) -> Option<Self> {
        let (boundary, clip) = match &object.shape {
            Shape::Solid(solid) => (solid, None),
            Shape::Sheet(Sheet::Shell { solid, clip }) => (solid, Some(clip)),
            Shape::Sheet(Sheet::Mesh { .. }) => return None,
        };
        // By the same transforms as the faces, so that rounding far from the origin moves both.
        let scene_from_world = frame.scene_from_world();
        let slack = slack(frame);
        let bounds = [Some(boundary), clip]
            .into_iter()
            .flatten()
            .map(|solid| solid.enclosure_in(&scene_from_world, slack))
            .fold(Aabb::ALL, Aabb::intersection);
        let bounds = if bounds.is_empty() {
            Aabb::EMPTY
        } else {
            bounds
        };
        Some(Self {
            id: ObjectId(index as u32),
            object,
            boundary,
            clip,
            bounds,
        })
    }

    /// Higher priority, then smaller, then later: what is inside something else is seen there.
    fn rank(&self, other: &Self) -> Ordering {
        let size = |c: &Self| {
            if c.bounds.is_bounded() {
                c.bounds.diagonal()
            } else {
                f64::INFINITY
            }
        };
        (other.object.priority.cmp(&self.object.priority))
            .then(size(self).total_cmp(&size(other)))
            .then(other.id.cmp(&self.id))
    }
}

/// The objects' expressions.
struct Expressions {
    /// For each object its boundary and its clip.
    lowered: Vec<(ObjectId, Lowered, Option<Lowered>)>,
    /// The object of each face.
    owners: Vec<ObjectId>,
    merged_surfaces: usize,
    scene: LoweredScene,
}

impl Expressions {
    /// Faces are numbered in the order of the objects.
    fn new(candidates: &[Candidate<'_>], frame: &SceneFrame, with_operands: bool) -> Self {
        let mut lowering = Lowering::new(frame);
        if with_operands {
            lowering = lowering.with_operands();
        }
        let mut lowered = Vec::with_capacity(candidates.len());
        let mut owners = Vec::new();
        for candidate in candidates {
            let boundary = lowering.lower(candidate.boundary);
            let clip = candidate.clip.map(|clip| lowering.lower(clip));
            owners.resize(lowering.face_count(), candidate.id);
            lowered.push((candidate.id, boundary, clip));
        }
        Self {
            lowered,
            owners,
            merged_surfaces: lowering.merged_surfaces(),
            scene: lowering.finish(),
        }
    }

    /// Tells these objects from others.
    fn fingerprint(&self) -> u64 {
        let words = self.lowered.iter().flat_map(|(id, boundary, clip)| {
            let codes = std::iter::once(boundary).chain(clip);
            std::iter::once(id.0).chain(codes.flat_map(|code| {
                match code {
                    Ok(code) => code.words(),
                    Err(Constant::True) => &[u32::MAX],
                    Err(Constant::False) => &[],
                }
                .iter()
                .copied()
            }))
        });
        fingerprint(&self.scene.operands, words)
    }
}

fn candidates<'a>(scene: &'a Scene, frame: &SceneFrame) -> Vec<Candidate<'a>> {
    let objects = scene.objects().iter().enumerate();
    objects
        .filter_map(|(index, object)| Candidate::new(index, object, frame))
        .collect()
}

impl Solids {
    /// The solids of the scene, for the method of the configuration, in cells along a list if there
    /// is one. The triangles of
    /// mesh operands get octrees of their own if there is a configuration.
    ///
    /// # Errors
    /// A mesh operand cannot be used as a solid; or the list cannot be used.
    pub(crate) fn prepare(
        scene: &Scene,
        frame: &SceneFrame,
        config: &WorldConfig,
        list: Option<&CellList>,
        triangles: Option<&WideTreeConfig>,
    ) -> Result<Self, WorldError> {
        let mut candidates = candidates(scene, frame);
        // Ranks are a matter of this module.
        let by_share = config.criteria.max_share < 1.0;
        let division = config.method.division();
        // A list says itself what cells touch; what it does not name is asked of boxes first.
        let membership = match list {
            Some(_) => Membership::BoundingBox,
            None => config.method.membership(),
        };
        let by_operands = division.is_some() && membership != Membership::Analytic;
        let expressions = Expressions::new(
            &candidates,
            frame,
            by_share || by_operands || list.is_some(),
        );
        if let Some(list) = list {
            check_list(list, division, &expressions)?;
        }
        let Expressions {
            lowered,
            owners,
            merged_surfaces,
            scene:
                LoweredScene {
                    faces,
                    surfaces,
                    meshes: mesh_operands,
                    operands,
                },
        } = expressions;
        candidates.sort_by(Candidate::rank);
        let ranked: Vec<Ranked> = candidates.iter().map(Ranked::new).collect();
        let mut rank_of = vec![u32::MAX; scene.objects().len()];
        for (rank, object) in ranked.iter().enumerate() {
            rank_of[object.object.0 as usize] = rank as u32;
        }
        let face_owner: Vec<u32> = owners.iter().map(|id| rank_of[id.0 as usize]).collect();
        let meshes = mesh_surfaces(
            &mesh_operands,
            &faces,
            &face_owner,
            &ranked,
            scene,
            surfaces.len(),
            triangles,
        )?;

        let mut root = Content::default();
        let mut unbounded = Content::default();
        let mut everywhere = Vec::new();
        for (id, boundary, clip) in lowered {
            let rank = rank_of[id.0 as usize];
            let shell = ranked[rank as usize].shell;
            if !shell && boundary == Err(Constant::True) {
                everywhere.push(rank);
            }
            add(&mut root, rank, shell, &boundary, clip.as_ref());
            if !candidates[rank as usize].bounds.is_bounded() {
                add(&mut unbounded, rank, shell, &boundary, clip.as_ref());
            }
        }
        for content in [&mut root, &mut unbounded] {
            content.objects.sort_by_key(|object| object.rank);
            content.finish(&faces);
        }

        let bounds = candidates
            .iter()
            .map(|c| c.bounds)
            .filter(Aabb::is_bounded)
            .fold(Aabb::EMPTY, Aabb::union);
        let object_bounds: Vec<Aabb> = candidates.iter().map(|c| c.bounds).collect();
        let volumes = match config.method {
            Method::Spheres => Some(Volumes::new(&object_bounds, true)),
            Method::Boxes => Some(Volumes::new(&object_bounds, false)),
            _ => None,
        };
        let mut contents = Vec::new();
        let mut cells = None;
        let mut marking_stats = None;
        let mut outer = root;
        let mut whole = None;
        let operand_boxes =
            by_share.then(|| OperandBoxes::new(&operands, &face_owner, &object_bounds));
        if let Some(division) = division.filter(|_| !bounds.is_empty()) {
            let restricting = Cells {
                faces: &faces,
                surfaces: &surfaces,
                meshes: &meshes,
                ranked: &ranked,
                bounds: &object_bounds,
                operands: operand_boxes.as_ref(),
            };
            if matches!(division, Division::Octree(Encoding::Lvsi(_), _)) {
                whole = Some(outer.clone());
            }
            let (built, leaves) = if by_operands {
                let gauge = Arc::new(AtomicU64::new(0));
                let fineness = Fineness {
                    within: enclosing_cube(&bounds),
                    memory_limit: config.criteria.memory_limit / 4,
                };
                let marker = Marker::new(&operands, membership, slack(frame), &fineness, &gauge);
                let operand_of = operands_of_faces(&operands);
                let marking = OperandCells::new(&restricting, &operands, &marker, &operand_of);
                let made: (Partition, Vec<Content>) = match list {
                    Some(list) => along_list(list, &bounds, outer, &marking, division, config)?,
                    None => {
                        let root = marking.root(outer);
                        let criteria = &config.criteria;
                        let (built, leaves) = Partition::build(
                            &bounds,
                            root,
                            &marking,
                            division,
                            criteria,
                            config.table,
                        );
                        (built, leaves.into_iter().map(|leaf| leaf.content).collect())
                    }
                };
                let touched = |content: &Content| {
                    operands_in(content.expressions(), &operand_of).len() as u64
                };
                let marks = made.1.iter().map(touched).sum();
                let stats = marker.stats();
                drop(marker);
                marking_stats = Some(MarkingStats {
                    marker: stats,
                    marks,
                    pieces_left: gauge.load(atomic::Ordering::Relaxed),
                });
                made
            } else {
                Partition::build(
                    &bounds,
                    outer,
                    &restricting,
                    division,
                    &config.criteria,
                    config.table,
                )
            };
            contents = leaves;
            cells = Some(built);
            outer = unbounded;
        }
        let mut leaf_of = |content: Content| {
            (!content.objects.is_empty() || content.base != 0).then(|| {
                contents.push(content);
                contents.len() as u32 - 1
            })
        };
        let whole = whole.and_then(&mut leaf_of);
        let outer = leaf_of(outer);
        let has_unbounded = object_bounds.iter().any(|b| !b.is_bounded());
        let leaves = Leaves::new(&contents);
        let priorities_differ = ranked
            .windows(2)
            .any(|pair| pair[0].priority != pair[1].priority);
        Ok(Self {
            faces,
            face_owner,
            surfaces,
            meshes,
            ranked,
            priorities_differ,
            leaves,
            cells,
            volumes,
            outer,
            whole,
            everywhere,
            has_unbounded,
            merged_surfaces,
            marking: marking_stats,
        })
    }

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

    /// How many face ids the solids use; triangles of sheets are numbered from here.
    pub(crate) fn face_count(&self) -> u32 {
        match self.meshes.last() {
            Some(mesh) => mesh.first_face + mesh.solid.triangle_count(),
            None => self.faces.len() as u32,
        }
    }

    /// The object and material of one of the solids' faces.
    pub(crate) fn owner(&self, face: FaceId, scene: &Scene) -> Option<(ObjectId, MaterialId)> {
        let (literal, triangle) = match self.mesh_triangle(face) {
            Some((mesh, triangle)) => (self.meshes[mesh].literal, Some((mesh, triangle))),
            None => (face.0, None),
        };
        let owner = *self.face_owner.get(literal as usize)?;
        let object = self.ranked[owner as usize].object;
        let of_triangle = triangle.and_then(|(mesh, t)| self.meshes[mesh].solid.material(t));
        let material = of_triangle
            .or(self.faces[literal as usize].material)
            .unwrap_or(scene.objects()[object.0 as usize].material);
        Some((object, material))
    }

    /// Which mesh operand and which of its triangles a face is.
    pub(super) fn mesh_triangle(&self, face: FaceId) -> Option<(usize, u32)> {
        let mesh = self
            .meshes
            .partition_point(|m| m.first_face <= face.0)
            .checked_sub(1)?;
        let triangle = face.0 - self.meshes[mesh].first_face;
        (triangle < self.meshes[mesh].solid.triangle_count()).then_some((mesh, triangle))
    }

    /// Whether the expression wants the outside of a mesh operand.
    pub(super) fn mesh_is_complemented(&self, mesh: usize) -> bool {
        self.faces[self.meshes[mesh].literal as usize].inside_is_positive
    }
}

impl Ranked {
    fn new(candidate: &Candidate<'_>) -> Self {
        Self {
            object: candidate.id,
            priority: candidate.object.priority,
            shell: matches!(candidate.object.shape, Shape::Sheet(_)),
        }
    }
}

/// Adds an object with nothing decided but what is constant by itself.
fn add(content: &mut Content, rank: u32, shell: bool, boundary: &Lowered, clip: Option<&Lowered>) {
    let expression = match boundary {
        Ok(code) => code.words(),
        Err(Constant::True) if !shell => return content.fill(rank),
        Err(_) => return,
    };
    let clip = match clip {
        None | Some(Err(Constant::True)) => &[],
        Some(Err(Constant::False)) => return,
        Some(Ok(code)) => code.words(),
    };
    content.add(rank, shell, expression, clip, &mut |_| None);
}

/// Whether the list is of these solids and the method has an octree for it.
fn check_list(
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

fn mesh_surfaces(
    operands: &[MeshOperand],
    faces: &[Face],
    face_owner: &[u32],
    ranked: &[Ranked],
    scene: &Scene,
    first_mesh_surface: usize,
    config: Option<&WideTreeConfig>,
) -> Result<Vec<MeshSurface>, WorldError> {
    let mut literals = vec![0; operands.len()];
    for (literal, face) in faces.iter().enumerate() {
        if let Some(mesh) = (face.surface.0 as usize).checked_sub(first_mesh_surface) {
            literals[mesh] = literal as u32;
        }
    }
    let mut first_face = faces.len() as u32;
    let mut meshes = Vec::with_capacity(operands.len());
    for (operand, literal) in operands.iter().zip(literals) {
        let solid = MeshSolid::new(&operand.mesh, &operand.scene_from_mesh, config);
        let solid = solid.map_err(|error| {
            let object = ranked[face_owner[literal as usize] as usize].object;
            let object = scene.objects()[object.0 as usize].name.clone();
            WorldError::Mesh { object, error }
        })?;
        let solid = solid.with_planes(operand.planes.clone());
        let triangles = solid.triangle_count();
        meshes.push(MeshSurface {
            solid,
            literal,
            first_face,
        });
        first_face += triangles;
    }
    Ok(meshes)
}
