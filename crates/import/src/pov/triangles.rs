//! Triangles of one look, collected from many objects into one mesh.

use std::collections::{BTreeMap, HashMap};

use octray_geometry::mesh::MeshError;
use octray_geometry::{CornerAttribute, MaterialId, TriangleMesh};
use octray_math::{DAffine3, DVec3};

use super::object::MeshDef;

/// One mesh to be.
#[derive(Debug, Default)]
struct Batch {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// From the first triangle with normals on; before that, nothing.
    normals: Vec<DVec3>,
    normal_of: Vec<[u32; 3]>,
}

/// One mesh per look, so that a thousand lone triangles are one object: by material, and whether
/// it casts shadows.
#[derive(Debug, Default)]
pub(super) struct Triangles(BTreeMap<(MaterialId, bool), Batch>);

/// Where the vertices of a mesh went.
enum Places {
    /// All into one batch: by vertex, `u32::MAX` for none yet.
    One(Vec<u32>),
    /// By the material of the batch and vertex.
    Many(HashMap<(MaterialId, u32), u32>),
}

impl Places {
    /// The place of a vertex in the batch of a material; `next` is the one it gets if it is new.
    fn of(&mut self, material: MaterialId, vertex: u32, next: u32) -> u32 {
        match self {
            Self::One(places) => {
                let place = &mut places[vertex as usize];
                if *place == u32::MAX {
                    *place = next;
                }
                *place
            }
            Self::Many(places) => *places.entry((material, vertex)).or_insert(next),
        }
    }
}

impl Batch {
    /// Adds the normals of a triangle whose first corner's is number `corners[0]`.
    fn add_normals(&mut self, corners: Option<[DVec3; 3]>) {
        // The triangles so far have none: number 0 is no direction, which means "use the face's".
        if corners.is_some() && self.normals.is_empty() {
            self.normals.push(DVec3::ZERO);
            self.normal_of.resize(self.triangles.len() - 1, [0; 3]);
        }
        if self.normals.is_empty() {
            return;
        }
        let numbers = corners.map_or([0; 3], |corners| {
            let first = self.normals.len() as u32;
            self.normals.extend(corners);
            [first, first + 1, first + 2]
        });
        self.normal_of.push(numbers);
    }

    fn mesh(self) -> Result<TriangleMesh, MeshError> {
        let mesh = TriangleMesh::new(self.positions, self.triangles)?;
        if self.normals.is_empty() {
            return Ok(mesh);
        }
        mesh.with_normals(CornerAttribute {
            values: self.normals,
            triangles: self.normal_of,
        })
    }
}

impl Triangles {
    /// Adds a mesh in a frame of the world; `own` are the materials of its textures, `general` that
    /// of the triangles without.
    pub(super) fn add(
        &mut self,
        def: &MeshDef,
        world: &DAffine3,
        general: MaterialId,
        own: &[MaterialId],
        casts_shadows: bool,
    ) {
        let turn = world.matrix3.inverse().transpose();
        // A mirrored frame turns the corners' order round.
        let mirrored = world.matrix3.determinant() < 0.0;
        let order = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
        let mut places = if def.texture_of.is_empty() {
            Places::One(vec![u32::MAX; def.mesh.positions().len()])
        } else {
            Places::Many(HashMap::new())
        };
        for (index, corners) in def.mesh.triangles().iter().enumerate() {
            let texture = def.texture_of.get(index).copied().flatten();
            let material = texture
                .and_then(|t| own.get(t as usize).copied())
                .unwrap_or(general);
            let batch = self.0.entry((material, casts_shadows)).or_default();
            let triangle = order.map(|i| {
                let vertex = corners[i];
                let next = batch.positions.len() as u32;
                let place = places.of(material, vertex, next);
                if place == next {
                    let p = def.mesh.positions()[vertex as usize];
                    batch.positions.push(world.transform_point3(p));
                }
                place
            });
            batch.triangles.push(triangle);
            batch.add_normals(def.mesh.normals().map(|normals| {
                order.map(|i| {
                    let normal = normals.values[normals.triangles[index][i] as usize];
                    (turn * normal).normalize_or_zero()
                })
            }));
        }
    }

    /// The meshes with their looks, or why there is none.
    pub(super) fn into_meshes(
        self,
    ) -> impl Iterator<Item = ((MaterialId, bool), Result<TriangleMesh, MeshError>)> {
        self.0.into_iter().map(|(look, batch)| (look, batch.mesh()))
    }
}
