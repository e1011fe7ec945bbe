//! Meshes of a file as objects of the scene.

use std::path::Path;
use std::sync::Arc;

use octray_geometry::{MeshRule, ShapeError, Sheet, Solid, TriangleMesh};
use octray_scene::{MaterialId, Object, SceneBuilder};

use crate::diagnostic::Diagnostics;

/// A mesh from a file as an object: a sheet, or the solid that it bounds where its material lets
/// light through and the mesh is closed (then refraction and absorption need an inside).
pub(crate) fn mesh_object(
    name: impl Into<String>,
    mesh: TriangleMesh,
    material: MaterialId,
    builder: &SceneBuilder,
    diagnostics: &mut Diagnostics,
) -> Object {
    let name = name.into();
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
    if all_clear && let Ok((solid, doubt)) = mesh_solid(&mesh) {
        if let Some(doubt) = doubt {
            diagnostics.warning(None, format!("`{name}`: {doubt}"));
        }
        return Object::solid(name, solid, material);
    }
    Object::sheet(name, Sheet::mesh(mesh), material)
}

/// The inside of a closed mesh by its winding number, and what to warn of if others may see it
/// differently. Files of others are shown as far as possible: which way the mesh faces as a whole,
/// edges of four triangles and folds change nothing and are no reason to complain.
pub(crate) fn mesh_solid(mesh: &Arc<TriangleMesh>) -> Result<(Solid, Option<String>), ShapeError> {
    let solid = Solid::mesh(Arc::clone(mesh), MeshRule::Winding)?;
    let report = mesh.check();
    let doubt = (!report.is_unambiguous()).then(|| {
        format!("the mesh is solid where its winding number is not 0, for it has flaws: {report}")
    });
    Ok((solid, doubt))
}

/// The file's name without folder and suffix, for what has no name of its own.
pub(crate) fn file_stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}
