//! Finds the planes that triangles of mesh operands share with other operands.

use octray_math::{Aabb, DVec3};

use super::lower::MeshOperand;
use super::plane_index::{Facet, PlaneIndex};
use crate::mesh::{FacetPlanes, Placement};
use crate::surface::Surface;

/// A crossing may lie outside of its triangle by this much, in units of the scene's size.
const SLACK: f64 = 1.0 / (1u64 << 26) as f64;

/// Sets the facet planes of the meshes: planes among `surfaces` first, then those of larger
/// triangles of other meshes near by. `tolerance` is a length.
pub(super) fn share_planes(
    surfaces: &[Surface],
    meshes: &mut [MeshOperand],
    scene_size: f64,
    tolerance: f64,
) {
    let mut index = PlaneIndex::new(scene_size, tolerance);
    for surface in surfaces {
        if let Surface::Plane { normal, offset } = surface {
            index.insert(*normal, *offset);
        }
    }
    let exact = index.planes.len() as u32;
    if meshes.is_empty() || (exact == 0 && meshes.len() == 1) {
        return;
    }
    let facets: Vec<Vec<Option<Facet>>> = meshes.iter().map(facets_of).collect();
    let near = Nearness::new(&facets, tolerance);
    let mut plane_of: Vec<Vec<u32>> = Vec::with_capacity(meshes.len());
    let mut rest: Vec<(usize, usize)> = Vec::new();
    for (mesh, facets) in facets.iter().enumerate() {
        let find = |(triangle, facet): (usize, &Option<Facet>)| {
            let facet = facet.as_ref()?;
            let found = index.find(facet);
            if found.is_none() && near.to_another(mesh, facet) {
                rest.push((mesh, triangle));
            }
            found
        };
        let found = facets.iter().enumerate().map(find);
        plane_of.push(found.map(|id| id.map_or(0, |id| id + 1)).collect());
    }
    // The planes of large triangles are the most accurate.
    let facet = |(mesh, triangle): (usize, usize)| facets[mesh][triangle].as_ref();
    let area = |at: &(usize, usize)| facet(*at).map_or(0.0, |f| f.area);
    rest.sort_by(|a, b| area(b).total_cmp(&area(a)).then(a.cmp(b)));
    // Which mesh uses a plane, and whether another does too.
    let mut users: Vec<(usize, bool)> = Vec::new();
    for &(mesh, triangle) in &rest {
        let Some(facet) = facet((mesh, triangle)) else {
            continue;
        };
        let id = match index.find(facet) {
            Some(id) => id,
            None => index.insert(facet.normal, facet.offset),
        };
        plane_of[mesh][triangle] = id + 1;
        let user = (id - exact) as usize;
        match users.get_mut(user) {
            Some((first, shared)) => *shared |= *first != mesh,
            None => users.push((mesh, false)),
        }
    }
    let is_shared = |id: u32| id < exact || users[(id - exact) as usize].1;
    for (operand, planes) in meshes.iter_mut().zip(plane_of) {
        operand.planes = used_planes(&index, planes, is_shared, scene_size * SLACK);
    }
}

/// More meshes than this are taken to be all near each other.
const MANY_MESHES: usize = 2000;

/// Which triangles come near other meshes.
struct Nearness {
    /// For each mesh the boxes of the others that meet its own; `None`: not worth finding out.
    others: Option<Vec<Vec<Aabb>>>,
}

impl Nearness {
    fn new(facets: &[Vec<Option<Facet>>], tolerance: f64) -> Self {
        if facets.len() > MANY_MESHES {
            return Self { others: None };
        }
        let corners = |of: &Vec<Option<Facet>>| {
            Aabb::from_points(of.iter().flatten().flat_map(|facet| facet.corners))
                .inflated(tolerance)
        };
        let boxes: Vec<Aabb> = facets.iter().map(corners).collect();
        let others = boxes.iter().enumerate().map(|(mesh, own)| {
            let meets = |&(other, bounds): &(usize, &Aabb)| other != mesh && bounds.overlaps(own);
            let near = boxes.iter().enumerate().filter(meets);
            near.map(|(_, bounds)| *bounds).collect()
        });
        Self {
            others: Some(others.collect()),
        }
    }

    fn to_another(&self, mesh: usize, facet: &Facet) -> bool {
        let own = Aabb::from_points(facet.corners);
        let meets = |others: &Vec<Vec<Aabb>>| others[mesh].iter().any(|b| b.overlaps(&own));
        self.others.as_ref().is_none_or(meets)
    }
}

/// Keeps the planes that are shared, numbered anew.
fn used_planes(
    index: &PlaneIndex,
    mut of_triangle: Vec<u32>,
    is_shared: impl Fn(u32) -> bool,
    slack: f64,
) -> FacetPlanes {
    let mut used: Vec<u32> = of_triangle
        .iter()
        .filter_map(|next| next.checked_sub(1))
        .collect();
    used.sort_unstable();
    used.dedup();
    used.retain(|&id| is_shared(id));
    for next in &mut of_triangle {
        let place = next
            .checked_sub(1)
            .and_then(|id| used.binary_search(&id).ok());
        *next = place.map_or(0, |place| place as u32 + 1);
    }
    let plane = |&id: &u32| {
        let (normal, offset) = index.planes[id as usize];
        Surface::Plane { normal, offset }
    };
    if used.is_empty() {
        return FacetPlanes::default();
    }
    FacetPlanes::new(used.iter().map(plane).collect(), of_triangle, slack)
}

fn facets_of(operand: &MeshOperand) -> Vec<Option<Facet>> {
    let placement = Placement::new(&operand.scene_from_mesh);
    let positions: Vec<DVec3> = placement.positions(&operand.mesh).collect();
    let triangles = operand.mesh.triangles().iter();
    triangles
        .map(|corners| Facet::new(corners.map(|i| positions[i as usize])))
        .collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::csg::{LoweredScene, Lowering};
    use crate::{MeshRule, SceneFrame, Solid, TriangleMesh};
    use octray_math::{DAffine3, Ray};
    use octray_tree::WalkCost;

    /// The cube from 0 to 1, two triangles per face.
    fn cube() -> TriangleMesh {
        let corner =
            |i: i32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let quads: [[u32; 4]; 6] = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles = quads.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).concat();
        TriangleMesh::new((0..8).map(corner).collect(), triangles).expect("valid")
    }

    fn lowered(solids: &[Solid]) -> Vec<MeshOperand> {
        let mut lowering = Lowering::new(&SceneFrame::around_origin(4.0));
        for solid in solids {
            lowering.lower(solid).expect("not constant");
        }
        lowering.finish().meshes
    }

    fn shared(solids: &[Solid]) -> Vec<usize> {
        lowered(solids)
            .iter()
            .map(|mesh| mesh.planes.len())
            .collect()
    }

    fn mesh_cube(frame: DAffine3) -> Solid {
        let solid = Solid::mesh(Arc::new(cube()), MeshRule::Strict).expect("sound");
        solid.transform(frame).expect("invertible")
    }

    fn at(x: f64, y: f64, z: f64) -> DAffine3 {
        DAffine3::from_translation(DVec3::new(x, y, z))
    }

    #[test]
    fn planes_are_shared_with_other_operands_only() {
        let turn = DAffine3::from_rotation_x(0.7) * DAffine3::from_rotation_z(0.4);
        let block = |frame: DAffine3| {
            let cuboid = Solid::cuboid(DVec3::ZERO, DVec3::ONE).expect("valid");
            cuboid.transform(frame).expect("invertible")
        };
        for frame in [DAffine3::IDENTITY, turn] {
            let mesh = mesh_cube(frame);
            assert_eq!(shared(std::slice::from_ref(&mesh)), [0]);
            assert_eq!(shared(&[mesh.clone(), block(frame)]), [6]);
            assert_eq!(shared(&[block(frame), mesh.clone()]), [6]);
            // Beside: one common plane, and the four that run along both.
            assert_eq!(
                shared(&[mesh.clone(), block(frame * at(1.0, 0.0, 0.0))]),
                [5]
            );
            assert_eq!(
                shared(&[mesh.clone(), mesh_cube(frame * at(1.0, 0.0, 0.0))]),
                [5, 5]
            );
            assert_eq!(
                shared(&[mesh.clone(), mesh_cube(frame * at(0.5, 0.25, 2.5))]),
                [0, 0]
            );
            // Within the tolerance of 4 * 2^-40 and outside of it.
            let aside = |by: f64| block(frame * at(1.0 + by, 0.25, 0.25));
            assert_eq!(shared(&[mesh.clone(), aside(3e-12)]), [1]);
            assert_eq!(shared(&[mesh.clone(), aside(5e-12)]), [0]);
        }
    }

    #[test]
    fn on_a_shared_plane_the_parameters_have_the_plane_s_bits() {
        let turn = DAffine3::from_rotation_x(0.7) * DAffine3::from_rotation_z(0.4);
        let top = Solid::half_space(turn.transform_vector3(DVec3::Z), 1.0).expect("valid");
        let mut lowering = Lowering::new(&SceneFrame::around_origin(4.0));
        for solid in [mesh_cube(turn), top] {
            lowering.lower(&solid).expect("not constant");
        }
        let LoweredScene {
            surfaces, meshes, ..
        } = lowering.finish();
        let operand = &meshes[0];
        let solid = crate::mesh::MeshSolid::new(&operand.mesh, &operand.scene_from_mesh, None);
        let plain = solid.expect("sound");
        let solid = plain.clone().with_planes(operand.planes.clone());
        let (mut same, mut differed) = (0, 0);
        for i in 0..500 {
            let x = f64::from(i) / 500.0;
            let target = turn.transform_point3(DVec3::new(x, 0.3 + 0.4 * x, 1.0));
            let direction = DVec3::new(0.3 - x, 0.1, -1.0);
            let ray = Ray::new(target - direction, direction);
            let mut wanted = f64::NAN;
            surfaces[0].crossings(&ray, |t| wanted = t);
            let crossings = |solid: &crate::mesh::MeshSolid| {
                let mut found = Vec::new();
                solid.crossings(&ray, &mut found, &mut WalkCost::default());
                found
            };
            let (found, before) = (crossings(&solid), crossings(&plain));
            assert_eq!(found.len(), before.len());
            same += usize::from(found.iter().any(|c| c.t == wanted));
            differed += usize::from(found != before);
        }
        assert!(same == 500 && differed > 50, "{same} {differed}");
    }
}
