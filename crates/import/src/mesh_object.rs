//! Meshes of a file as objects of the scene.

use std::path::Path;
use std::sync::Arc;

use octray_geometry::{Sheet, Solid, TriangleMesh};
use octray_scene::{MaterialId, Object, SceneBuilder};

/// A mesh from a file as an object: a sheet, or the solid that it bounds where its material lets
/// light through and the mesh is closed (then refraction and absorption need an inside).
pub(crate) fn mesh_object(
    name: impl Into<String>,
    mesh: TriangleMesh,
    material: MaterialId,
    builder: &SceneBuilder,
) -> Object {
    let mesh = Arc::new(mesh);
    let materials = builder.so_far().materials();
    let clear = |id: MaterialId| {
        let material = materials.get(id.0 as usize);
        material.is_some_and(|m| m.pigment.is_transparent())
    };
    let all_clear = match mesh.materials() {
        Some(each) => each.iter().all(|&id| clear(id)),
        None => clear(material),
    };
    if all_clear && let Ok(solid) = Solid::mesh(Arc::clone(&mesh)) {
        return Object::solid(name, solid, material);
    }
    Object::sheet(name, Sheet::mesh(mesh), material)
}

/// The file's name without folder and suffix, for what has no name of its own.
pub(crate) fn file_stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}
