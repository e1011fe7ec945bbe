//! Dumps as texts, and what they came to.

use std::path::Path;

use octray_geometry::{Primitive, Solid, SolidNode};
use octray_import::{Disk, Imported, Options, openscad};
use octray_scene::{Object, Scene, Shape};

pub(crate) fn read_with(text: &str, facets: bool) -> Imported {
    let options = Options {
        facets,
        ..Options::default()
    };
    openscad::import(Path::new("a.csg"), text.into(), &Disk, &options)
}

/// The scene of a text without mistakes, and its warnings as they are shown.
pub(crate) fn read(text: &str) -> (Scene, Vec<String>) {
    let imported = read_with(text, false);
    let shown = shown(&imported);
    (
        imported.scene.unwrap_or_else(|| panic!("{shown:#?}")),
        shown,
    )
}

pub(crate) fn shown(imported: &Imported) -> Vec<String> {
    let diagnostics = &imported.diagnostics;
    diagnostics.iter().map(|d| diagnostics.render(d)).collect()
}

/// The scene of a text that nothing is wrong with.
pub(crate) fn clean(text: &str) -> Scene {
    let (scene, warnings) = read(text);
    assert_eq!(warnings, Vec::<String>::new(), "{text}");
    scene
}

/// The first lines of all messages of a text with mistakes.
pub(crate) fn mistakes(text: &str) -> Vec<String> {
    let imported = read_with(text, false);
    assert!(imported.scene.is_none(), "{text}");
    let first = |message: String| message.lines().next().unwrap_or_default().to_owned();
    shown(&imported).into_iter().map(first).collect()
}

pub(crate) fn solid(object: &Object) -> &Solid {
    match &object.shape {
        Shape::Solid(solid) => solid,
        Shape::Sheet(_) => panic!("{} is a sheet", object.name),
    }
}

pub(crate) fn only(scene: &Scene) -> &Solid {
    assert_eq!(scene.objects().len(), 1);
    solid(&scene.objects()[0])
}

pub(crate) fn primitive(solid: &Solid) -> &Primitive {
    match solid.node() {
        SolidNode::Primitive(primitive) => primitive,
        SolidNode::Transformed { child, .. } | SolidNode::WithMaterial { child, .. } => {
            primitive(child)
        }
        other => panic!("not a primitive: {other:?}"),
    }
}

/// The signed volume of the mesh of a solid.
pub(crate) fn mesh_volume(solid: &Solid) -> f64 {
    let Primitive::Mesh(mesh) = primitive(solid) else {
        panic!("not a mesh: {solid:?}");
    };
    let corner = |i: u32| mesh.positions()[i as usize];
    let tetrahedra = mesh.triangles().iter().map(|t| {
        let [a, b, c] = t.map(corner);
        a.dot(b.cross(c)) / 6.0
    });
    tetrahedra.sum()
}
