//! The faces of an OBJ file as meshes, one per object.

use std::path::Path;

use octray_geometry::{CornerAttribute, MeshError, TriangleMesh};
use octray_math::DVec3;
use octray_scene::{MaterialId, SceneBuilder};

use super::syntax::{Face, Model, NONE};
use super::{Materials, smooth};
use crate::face_colors::{Painted, paint};
use crate::mesh_object::{file_stem, mesh_object};
use crate::polygon::Triangulator;
use crate::{Diagnostics, SourceId, Span};

/// Adds an object for every object or group with faces. Problems are reported.
pub(super) fn add_objects(
    mut model: Model,
    materials: &Materials,
    path: &Path,
    source: SourceId,
    builder: &mut SceneBuilder,
    diagnostics: &mut Diagnostics,
) {
    smooth::apply(&mut model);
    let use_colors = !model.colors.is_empty() && materials.none_is_known();
    if !model.colors.is_empty() && !use_colors {
        diagnostics.warning(
            None,
            "the vertices' colours are passed over for the materials",
        );
    }
    model.colors.resize(model.positions.len(), None);
    let mut order: Vec<usize> = (0..model.faces.len()).collect();
    order.sort_by_key(|&i| model.faces[i].object);
    let mut split = Splitter {
        triangulator: Triangulator::new(),
        used: [
            Subset::new(model.positions.len()),
            Subset::new(model.texcoords.len()),
            Subset::new(model.normals.len()),
        ],
    };
    for run in order.chunk_by(|&a, &b| model.faces[a].object == model.faces[b].object) {
        let Some(&first) = run.first() else {
            continue;
        };
        let part = match split.part(&model, run) {
            Ok(part) => part,
            Err((start, message)) => {
                diagnostics.error(Span::new(source, start..start + 1), message);
                return;
            }
        };
        let painted = if use_colors {
            paint(part.colors(&model), builder)
        } else {
            Painted::Plain
        };
        if painted == Painted::Varied {
            diagnostics.warning(
                None,
                "colours that vary within faces are not shown: the object has one colour",
            );
        }
        let name = &model.objects[model.faces[first].object as usize];
        let name = if name.is_empty() {
            file_stem(path)
        } else {
            name.clone()
        };
        if let Err(error) = part.add(name, &model, &painted, materials, builder, diagnostics) {
            diagnostics.error(None, error.to_string());
        }
    }
}

/// Some elements of a list, numbered anew in the order of their first use.
struct Subset {
    /// New numbers of the elements; only those of `members` mean something.
    place: Vec<u32>,
    members: Vec<u32>,
}

impl Subset {
    fn new(count: usize) -> Self {
        Self {
            place: vec![NONE; count],
            members: Vec::new(),
        }
    }

    fn number(&mut self, element: u32) -> u32 {
        let place = &mut self.place[element as usize];
        if *place == NONE {
            *place = self.members.len() as u32;
            self.members.push(element);
        }
        *place
    }

    /// The members, and the subset empty again.
    fn take(&mut self) -> Vec<u32> {
        let members = std::mem::take(&mut self.members);
        for &element in &members {
            self.place[element as usize] = NONE;
        }
        members
    }
}

struct Splitter {
    triangulator: Triangulator,
    used: [Subset; 3],
}

/// The triangles of one object.
struct Part {
    /// Which positions, texture coordinates and normals of the model it uses.
    members: [Vec<u32>; 3],
    /// Triangles of indices into those; `NONE` for corners without.
    triangles: [Vec<[u32; 3]>; 3],
    /// The face of each triangle.
    materials: Vec<Option<u32>>,
}

impl Splitter {
    fn part(&mut self, model: &Model, faces: &[usize]) -> Result<Part, (usize, String)> {
        let mut triangles = [Vec::new(), Vec::new(), Vec::new()];
        let mut materials = Vec::new();
        let mut outline = Vec::new();
        for &index in faces {
            let Face {
                corners,
                material,
                start,
                ..
            } = &model.faces[index];
            let corners = &model.corners[corners.clone()];
            outline.clear();
            outline.extend(corners.iter().map(|c| model.positions[c[0] as usize]));
            let split = self.triangulator.triangulate(&outline);
            for triangle in split.map_err(|error| (*start, error.to_string()))? {
                for (field, list) in triangles.iter_mut().enumerate() {
                    list.push(triangle.map(|i| match corners[i as usize][field] {
                        NONE => NONE,
                        element => self.used[field].number(element),
                    }));
                }
                materials.push(*material);
            }
        }
        Ok(Part {
            members: std::array::from_fn(|field| self.used[field].take()),
            triangles,
            materials,
        })
    }
}

impl Part {
    /// The colour of each triangle, where it is one.
    fn colors<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = Option<DVec3>> + 'a {
        let color = |i: u32| model.colors[self.members[0][i as usize] as usize];
        self.triangles[0].iter().map(move |t| {
            let [a, b, c] = t.map(color);
            a.filter(|_| a == b && b == c)
        })
    }

    fn add(
        self,
        name: String,
        model: &Model,
        painted: &Painted,
        materials: &Materials,
        builder: &mut SceneBuilder,
        diagnostics: &mut Diagnostics,
    ) -> Result<(), MeshError> {
        let [positions, texcoords, normals] = self.members;
        let [corners, uv_corners, normal_corners] = self.triangles;
        let positions = positions.iter().map(|&i| model.positions[i as usize]);
        let mut mesh = TriangleMesh::new(positions.collect(), corners)?;
        if !normals.is_empty() {
            let values = normals.iter().map(|&i| model.normals[i as usize]).collect();
            mesh = mesh.with_normals(attribute(values, normal_corners))?;
        }
        if !texcoords.is_empty() {
            let values = texcoords
                .iter()
                .map(|&i| model.texcoords[i as usize])
                .collect();
            mesh = mesh.with_texcoords(attribute(values, uv_corners))?;
        }
        let each: Vec<MaterialId> = match painted {
            Painted::Faces { each, .. } => each.clone(),
            Painted::Whole(id) => vec![*id; self.materials.len()],
            Painted::Plain | Painted::Varied => {
                let of = |&index: &Option<u32>| materials.of(index);
                self.materials.iter().filter_map(of).collect()
            }
        };
        let Some(&material) = each.first() else {
            return Ok(());
        };
        if each.iter().any(|&id| id != material) {
            mesh = mesh.with_materials(each)?;
        }
        let object = mesh_object(name, mesh, material, builder, diagnostics);
        builder.add_object(object);
        Ok(())
    }
}

/// Corners without a value get the zero value, which for normals means "as the face".
fn attribute<T: Default>(mut values: Vec<T>, mut triangles: Vec<[u32; 3]>) -> CornerAttribute<T> {
    let missing = values.len() as u32;
    for index in triangles.iter_mut().flatten() {
        if *index == NONE {
            *index = missing;
        }
    }
    values.push(T::default());
    CornerAttribute { values, triangles }
}
