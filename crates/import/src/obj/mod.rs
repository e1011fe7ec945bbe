//! Wavefront OBJ with MTL: polygons with objects, groups, normals, texture coordinates, materials.
//!
//! Format: "Object Files (.obj)" and "Material Library File (.mtl)", Wavefront's Advanced
//! Visualizer 3.0. Points, lines, curves and free-form surfaces are passed over with a warning.

mod faces;
mod lines;
mod mesh;
mod mtl;
mod smooth;
mod syntax;

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use octray_math::DVec3;
use octray_scene::{MaterialId, SceneBuilder};

use crate::dress::default_material;
use crate::{Diagnostics, FileSystem, Imported, Options, Span, text};

/// Reads the bytes of the file `path`; its material libraries come from `files`. Every object or
/// group that has faces becomes an object.
#[must_use]
pub fn import(path: &Path, bytes: Vec<u8>, files: &dyn FileSystem, options: &Options) -> Imported {
    let mut diagnostics = Diagnostics::default();
    let source = diagnostics.add_source(path, bytes);
    let bytes = diagnostics.shared_source(source);
    if bytes.is_empty() {
        diagnostics.error(None, "the file is empty");
        return Imported::failed(diagnostics);
    }
    if let Some(encoding) = text::encoding_problem(&bytes) {
        let help = "an OBJ file must be plain text, in UTF-8 or ASCII";
        diagnostics.error(None, format!("the file is {encoding}: {help}"));
        return Imported::failed(diagnostics);
    }
    let model = syntax::read(&bytes, source, options, &mut diagnostics);
    let mut builder = SceneBuilder::new();
    // What modellers write has y upwards.
    builder.settings_mut().up = DVec3::Y;
    let mut libraries = Libraries {
        folder: path.parent().unwrap_or(Path::new("")),
        files,
        limit: options.memory_budget,
        loaded: BTreeSet::new(),
        materials: BTreeMap::new(),
    };
    for (span, name) in &model.libraries {
        libraries.add(*span, name, &mut builder, &mut diagnostics);
    }
    let materials = bind_materials(&model, &libraries.materials, &mut builder, &mut diagnostics);
    if !diagnostics.has_errors() {
        mesh::add_objects(
            model,
            &materials,
            path,
            source,
            &mut builder,
            &mut diagnostics,
        );
    }
    if builder.so_far().objects().is_empty() && !diagnostics.has_errors() {
        diagnostics.warning(None, "the file holds no faces");
    }
    Imported::finish(builder, diagnostics)
}

/// The materials of the faces: by index of `usemtl` name, the last for faces before any `usemtl`.
fn bind_materials(
    model: &syntax::Model,
    known: &BTreeMap<String, MaterialId>,
    builder: &mut SceneBuilder,
    diagnostics: &mut Diagnostics,
) -> Materials {
    let mut default = None;
    let mut by_name = Vec::with_capacity(model.materials.len());
    for (name, span) in &model.materials {
        by_name.push(known.get(name).copied());
        if !known.contains_key(name) && !name.is_empty() {
            let message = format!("no material library defines `{name}`: the default is used");
            diagnostics.warning(*span, message);
        }
    }
    let needs_default = model.faces.iter().any(|f| match f.material {
        Some(index) => by_name[index as usize].is_none(),
        None => true,
    });
    if needs_default {
        default = Some(builder.add_material(default_material()));
    }
    Materials { by_name, default }
}

/// What the names after `usemtl` mean.
pub(crate) struct Materials {
    by_name: Vec<Option<MaterialId>>,
    default: Option<MaterialId>,
}

impl Materials {
    fn of(&self, index: Option<u32>) -> Option<MaterialId> {
        let named = index.and_then(|i| self.by_name.get(i as usize).copied().flatten());
        named.or(self.default)
    }

    /// Whether no face has a material of the file.
    fn none_is_known(&self) -> bool {
        self.by_name.iter().all(Option::is_none)
    }
}

/// The material libraries that a file names.
struct Libraries<'a> {
    folder: &'a Path,
    files: &'a dyn FileSystem,
    limit: u64,
    loaded: BTreeSet<PathBuf>,
    materials: BTreeMap<String, MaterialId>,
}

impl Libraries<'_> {
    /// Reads what stands after `mtllib`: one name with blanks, or several names.
    fn add(
        &mut self,
        span: Span,
        names: &str,
        builder: &mut SceneBuilder,
        diagnostics: &mut Diagnostics,
    ) {
        let several = split_names(names);
        let whole = [names.replace("\\ ", " ")];
        let as_one = several.len() > 1 && self.read(&whole[0]).is_ok();
        for name in if as_one { &whole[..] } else { &several[..] } {
            match self.find(name) {
                Ok(None) => {}
                Ok(Some((path, bytes))) => {
                    self.loaded.insert(path.clone());
                    let source = diagnostics.add_source(&path, bytes);
                    let bytes = diagnostics.shared_source(source);
                    for material in mtl::read(&bytes, source, diagnostics) {
                        let name = material.name.clone();
                        let id = builder.add_material(material);
                        self.materials.insert(name, id);
                    }
                }
                Err(error) => {
                    let why = crate::load::io_problem(&error);
                    let message = format!("the material library `{name}` is not used: {why}");
                    diagnostics.warning(span, message);
                }
            }
        }
    }

    /// The library, `None` if it has been read already. Names come from other machines: where
    /// there is nothing at the path they give, the file of that name next to the OBJ file is meant.
    fn find(&self, name: &str) -> io::Result<Option<(PathBuf, Vec<u8>)>> {
        let slashed = name.replace('\\', "/");
        let last = slashed.rsplit('/').next().unwrap_or_default();
        self.read(name).or_else(|error| {
            self.read(&slashed)
                .or_else(|_| self.read(last))
                .map_err(|_| error)
        })
    }

    fn read(&self, name: &str) -> io::Result<Option<(PathBuf, Vec<u8>)>> {
        let path = self.folder.join(name);
        if self.loaded.contains(&path) {
            return Ok(None);
        }
        let bytes = self.files.read(&path, self.limit)?;
        Ok(Some((path, bytes)))
    }
}

/// Names between blanks; a blank after a backslash belongs to the name.
fn split_names(text: &str) -> Vec<String> {
    let mut names = vec![String::new()];
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        if c == '\\' && chars.peek() == Some(&' ') {
            chars.next();
            if let Some(name) = names.last_mut() {
                name.push(' ');
            }
        } else if c.is_whitespace() {
            names.push(String::new());
        } else if let Some(name) = names.last_mut() {
            name.push(c);
        }
    }
    names.retain(|name| !name.is_empty());
    names
}
