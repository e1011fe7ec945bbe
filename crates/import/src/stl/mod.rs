//! STL, ascii and binary: triangle soups, the language of 3D printing.
//!
//! Corners at equal positions become one vertex, so that a closed part is recognised as closed.
//! The normals of the file are passed over: the corners' order says the same, and more exactly.

mod ascii;
mod binary;

use std::path::Path;

use octray_geometry::TriangleMesh;
use octray_math::DVec3;
use octray_scene::SceneBuilder;

use crate::budget::Budget;
use crate::dress::default_material;
use crate::mesh_object::{file_stem, mesh_object};
use crate::weld::Welder;
use crate::{Diagnostics, FileSystem, Imported, Options, text};

/// A triangle with, at worst, three vertices of its own and their places in the table.
const BYTES_PER_TRIANGLE: usize = 256;

/// One `solid` of the file.
#[derive(Default)]
struct Part {
    name: String,
    vertices: Welder,
    triangles: Vec<[u32; 3]>,
}

impl Part {
    fn add(&mut self, corners: [DVec3; 3]) {
        self.triangles
            .push(corners.map(|p| self.vertices.vertex(p)));
    }
}

/// Reads the bytes of the file `path`. Every solid that has triangles becomes an object.
#[must_use]
pub fn import(path: &Path, bytes: Vec<u8>, _files: &dyn FileSystem, options: &Options) -> Imported {
    let mut diagnostics = Diagnostics::default();
    let source = diagnostics.add_source(path, bytes);
    let bytes = diagnostics.shared_source(source);
    let mut budget = Budget::new(options.memory_budget);
    let parts = match Kind::of(&bytes) {
        Ok(Kind::Binary) => binary::read(&bytes, &mut budget, &mut diagnostics),
        Ok(Kind::Ascii) => ascii::read(&bytes, source, &mut budget, &mut diagnostics),
        Err(problem) => {
            diagnostics.error(None, problem);
            return Imported::failed(diagnostics);
        }
    };
    budget.report(&mut diagnostics);
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(default_material());
    for mut part in parts {
        if part.name.is_empty() {
            part.name = file_stem(path);
        }
        match TriangleMesh::new(part.vertices.into_positions(), part.triangles) {
            Ok(mesh) => {
                let object = mesh_object(part.name, mesh, material, &builder, &mut diagnostics);
                builder.add_object(object);
            }
            Err(error) => diagnostics.error(None, format!("solid `{}`: {error}", part.name)),
        }
    }
    if builder.so_far().objects().is_empty() && !diagnostics.has_errors() {
        diagnostics.warning(None, "the file holds no triangles");
    }
    Imported::finish(builder, diagnostics)
}

/// The two languages of STL files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Keywords and decimal numbers.
    Ascii,
    /// A header of 84 bytes and 50 bytes per triangle.
    Binary,
}

impl Kind {
    /// Which it is. `solid` at the start proves nothing: many programs begin binary files so.
    /// The length that the header announces does, and bytes that no text has.
    fn of(bytes: &[u8]) -> Result<Self, String> {
        if bytes.is_empty() {
            return Err("the file is empty".to_owned());
        }
        if Self::is_exact_binary(bytes) {
            return Ok(Self::Binary);
        }
        if let Some(encoding @ ("UTF-16" | "UTF-32")) = text::encoding_problem(bytes) {
            return Err(format!("the file is {encoding} text; save it as UTF-8"));
        }
        let is_text = text::encoding_problem(bytes).is_none();
        let first = bytes[text::text_start(bytes)..].trim_ascii_start();
        let begins_solid = first.len() >= 5 && first[..5].eq_ignore_ascii_case(b"solid");
        match (is_text, begins_solid) {
            (true, true) => Ok(Self::Ascii),
            (false, _) => Ok(Self::Binary),
            (true, false) => Err(
                "this is no STL file: it does not begin with `solid`, nor is it as long as the \
                 header of a binary file would announce"
                    .to_owned(),
            ),
        }
    }

    /// Whether the file is exactly as long as its header announces.
    pub(crate) fn is_exact_binary(bytes: &[u8]) -> bool {
        binary::announced(bytes).is_some_and(|n| binary::length(n) == bytes.len() as u64)
    }
}
