//! PLY, the Stanford polygon format, ascii and binary of both byte orders.
//!
//! Read are vertices (position, normal, texture coordinates, colour), faces and triangle strips,
//! with any types and in any order; other elements and properties are passed over. Format:
//! Greg Turk, "The PLY Polygon File Format", 1994.

mod color;
mod header;
mod rows;
mod table;

use std::path::Path;

use octray_geometry::{CornerAttribute, MeshError, TriangleMesh};
use octray_scene::SceneBuilder;

use crate::dress::default_material;
use crate::face_colors::{Painted, paint};
use crate::mesh_object::{file_stem, mesh_object};
use crate::{Diagnostics, FileSystem, Imported, Options, text};
use header::Format;
use table::Tables;

/// Reads the bytes of the file `path`: one object.
#[must_use]
pub fn import(path: &Path, bytes: Vec<u8>, _files: &dyn FileSystem, options: &Options) -> Imported {
    let mut diagnostics = Diagnostics::default();
    let source = diagnostics.add_source(path, bytes);
    let bytes = diagnostics.shared_source(source);
    if bytes.is_empty() {
        diagnostics.error(None, "the file is empty");
        return Imported::failed(diagnostics);
    }
    if let Some(encoding @ ("UTF-16" | "UTF-32")) = text::encoding_problem(&bytes) {
        let message = format!("the file is {encoding} text; save it as UTF-8");
        diagnostics.error(None, message);
        return Imported::failed(diagnostics);
    }
    let Some(header) = header::read(&bytes, source, &mut diagnostics) else {
        return Imported::failed(diagnostics);
    };
    let Some(tables) = table::read(&bytes, source, &header, options, &mut diagnostics) else {
        return Imported::failed(diagnostics);
    };
    if diagnostics.has_errors() {
        return Imported::failed(diagnostics);
    }
    if tables.triangles.is_empty() {
        let message = if tables.positions.is_empty() {
            "the file holds no vertices"
        } else {
            "the file holds no faces: points alone are not shown"
        };
        diagnostics.warning(None, message);
        return Imported::finish(y_up(), diagnostics);
    }
    let mut builder = y_up();
    if let Err(error) = add_mesh(tables, path, &mut builder, &mut diagnostics) {
        diagnostics.error(None, error.to_string());
    }
    Imported::finish(builder, diagnostics)
}

/// Scans and modellers that write PLY have y upwards.
fn y_up() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.settings_mut().up = octray_math::DVec3::Y;
    builder
}

fn add_mesh(
    tables: Tables,
    path: &Path,
    builder: &mut SceneBuilder,
    diagnostics: &mut Diagnostics,
) -> Result<(), MeshError> {
    let triangles = tables.triangles;
    let painted = match &tables.colors {
        _ if !tables.face_colors.is_empty() => paint(tables.face_colors.into_iter(), builder),
        Some(colors) => {
            let uniform = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| colors[i as usize]);
                (a == b && b == c).then_some(a)
            };
            paint(triangles.iter().map(uniform), builder)
        }
        None => Painted::Plain,
    };
    let mut mesh = TriangleMesh::new(tables.positions, triangles.clone())?;
    if let Some(values) = tables.normals {
        let triangles = triangles.clone();
        mesh = mesh.with_normals(CornerAttribute { values, triangles })?;
    }
    if let Some(values) = tables.texcoords {
        mesh = mesh.with_texcoords(CornerAttribute { values, triangles })?;
    }
    let material = match painted {
        Painted::Plain => builder.add_material(default_material()),
        Painted::Whole(material) => material,
        Painted::Faces { first, each } => {
            mesh = mesh.with_materials(each)?;
            first
        }
        Painted::Varied => {
            diagnostics.warning(
                None,
                "colours that vary within faces are not shown: the object has one colour",
            );
            builder.add_material(default_material())
        }
    };
    let object = mesh_object(file_stem(path), mesh, material, builder, diagnostics);
    builder.add_object(object);
    Ok(())
}

/// Whether the bytes begin as a PLY file does.
pub(crate) fn is_ply(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

impl Format {
    const fn is_text(self) -> bool {
        matches!(self, Self::Ascii)
    }
}
