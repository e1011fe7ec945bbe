//! From the scene's objects to faces, ranks and cells.

use octray_geometry::Membership;
use octray_geometry::SceneFrame;
use octray_geometry::csg::{Constant, Face, LoweredScene, MeshOperand};
use octray_geometry::mesh::MeshSolid;
use octray_geometry::surface::Surface;
use octray_math::Aabb;
use octray_scene::Scene;
use octray_tree::{Criteria, Division, Encoding, WideTreeConfig};
use rayon::prelude::*;

use super::candidates::{Candidate, Expressions, candidates};
use super::cells::{Cells, Content, Draft, ScratchPool, cost};
use super::divide::{Plan, check_list};
use super::flat_object::FlatObjects;
use super::leaf::LeafWriter;
use super::object_tree::ObjectTree;
use super::operand_boxes::OperandBoxes;
use super::volumes::Volumes;
use super::{MeshSurface, Ranked, Solids};
use crate::{CellList, Method, WorldConfig, WorldError};

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
            mut lowered,
            words,
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
        candidates.par_sort_unstable_by(Candidate::rank);
        let ranked: Vec<Ranked> = candidates.iter().map(Ranked::new).collect();
        let mut sizes = Vec::new();
        if scene.has_instances() {
            sizes.resize(scene.objects().len(), 0.0);
            for candidate in &candidates {
                sizes[candidate.id.0 as usize] = candidate.size;
            }
        }
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

        let (mut root, mut unbounded) = (Draft::default(), Draft::default());
        let mut everywhere = Vec::new();
        lowered.sort_unstable_by_key(|object| rank_of[object.id.0 as usize]);
        for object in lowered {
            let rank = rank_of[object.id.0 as usize];
            let boundary = object.boundary.words(&words);
            let clip = object.clip.words(&words);
            let shell = ranked[rank as usize].shell;
            if !shell && boundary == Err(Constant::True) {
                everywhere.push(rank);
            }
            add(&mut root, rank, shell, boundary, clip);
            if !candidates[rank as usize].bounds.is_bounded() {
                add(&mut unbounded, rank, shell, boundary, clip);
            }
        }
        let [root, unbounded] = [root, unbounded]
            .map(|mut draft| draft.finish(&faces, |surface| cost(&surfaces, surface)));

        let bounds = candidates
            .iter()
            .map(|c| c.bounds)
            .filter(Aabb::is_bounded)
            .fold(Aabb::EMPTY, Aabb::union);
        let object_bounds: Vec<Aabb> = candidates.iter().map(|c| c.bounds).collect();
        // Of millions of objects all of this is large, and not needed any more.
        drop((candidates, words, owners, rank_of));
        let volumes = match config.method {
            Method::Spheres => Some(Volumes::new(&object_bounds, true)),
            Method::Boxes => Some(Volumes::new(&object_bounds, false)),
            _ => None,
        };
        // Unless someone wants cells.
        let leaves_open = config.method == Method::Auto
            && config.criteria == Criteria::default()
            && list.is_none();
        let small = leaves_open
            && meshes.is_empty()
            && ObjectTree::suits(&root, &object_bounds, &faces, &surfaces);
        let mut leaves = LeafWriter::default();
        let mut cells = None;
        let mut marking = None;
        let mut outer = root;
        let mut whole = None;
        let operand_boxes =
            by_share.then(|| OperandBoxes::new(&operands, &face_owner, &object_bounds));
        if let Some(division) = division.filter(|_| !(small || bounds.is_empty())) {
            let restricting = Cells {
                faces: &faces,
                surfaces: &surfaces,
                meshes: &meshes,
                ranked: &ranked,
                bounds: &object_bounds,
                reaches: &surfaces.iter().map(Surface::reach).collect::<Vec<_>>(),
                operands: operand_boxes.as_ref(),
                scratch: ScratchPool::default(),
            };
            if matches!(division, Division::Octree(Encoding::Lvsi(_), _)) {
                whole = Some(outer.clone());
            }
            let plan = Plan {
                division,
                membership,
                list,
                config,
                frame,
            };
            let divided = plan.divide(&bounds, outer, &restricting, &operands, &mut leaves)?;
            cells = Some(divided.cells);
            marking = divided.marking;
            outer = unbounded;
        }
        let mut leaf_of = |content: Content| {
            let is_empty = content.object_count() == 0 && content.base == 0;
            (!is_empty).then(|| leaves.push(&content))
        };
        let whole = whole.and_then(&mut leaf_of);
        let outer = leaf_of(outer);
        let has_unbounded = object_bounds.iter().any(|b| !b.is_bounded());
        let leaves = leaves.finish();
        let objects = match outer.filter(|_| small) {
            Some(leaf) => {
                let view = leaves.get(leaf);
                let shell = |rank: u32| ranked[rank as usize].shell;
                let flat = FlatObjects::new(&view, &object_bounds, shell, &faces, &surfaces);
                Some(ObjectTree::build(
                    &view,
                    &object_bounds,
                    flat,
                    &config.triangles,
                )?)
            }
            None => None,
        };
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
            objects,
            volumes,
            outer,
            whole,
            everywhere,
            has_unbounded,
            merged_surfaces,
            bounds,
            sizes,
            marking,
        })
    }
}

/// Adds an object with nothing decided but what is constant by itself.
fn add(
    content: &mut Draft,
    rank: u32,
    shell: bool,
    boundary: Result<&[u32], Constant>,
    clip: Result<&[u32], Constant>,
) {
    let expression = match boundary {
        Ok(words) => words,
        Err(Constant::True) if !shell => return content.fill(rank),
        Err(_) => return,
    };
    let clip = match clip {
        Err(Constant::True) => &[],
        Err(Constant::False) => return,
        Ok(words) => words,
    };
    content.add(rank, shell, expression, clip, &mut |_| None);
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
            let object = scene.objects()[object.0 as usize].name.to_string();
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
