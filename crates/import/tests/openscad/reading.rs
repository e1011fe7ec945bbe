//! Dumps as texts, and what they came to.

use std::path::Path;
use std::sync::Arc;

use octray_geometry::{Primitive, Solid, SolidNode};
use octray_import::{Disk, Imported, Options, openscad};
use octray_math::{DVec2, DVec3, Ray};
use octray_scene::{Material, Object, Scene, SceneBuilder, Shape};
use octray_world::{Counters, RayQuery, World, WorldConfig};

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
        _ => panic!("{} is no solid", object.name),
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

/// The volume of a solid by lines along z through the middles of squares of side `step`: exact
/// where all corners lie on a grid of such squares and all walls are upright.
pub(crate) fn column_volume(solid: &Solid, step: f64) -> f64 {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    builder.add_object(Object::solid("part", solid.clone(), material));
    let scene = Arc::new(builder.build().expect("valid"));
    let world = World::prepare(scene, &WorldConfig::default()).expect("small");
    let bounds = solid.bounds();
    let steps = ((bounds.max - bounds.min) / step).ceil();
    let mut sum = 0.0;
    for i in 0..steps.x as u32 {
        for j in 0..steps.y as u32 {
            let middle = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * step;
            let origin = (bounds.min.truncate() + middle).extend(0.0);
            let query = RayQuery::new(Ray::new(origin, DVec3::Z));
            let (mut hits, mut counters) = (Vec::new(), Counters::default());
            world.crossings(&query, true, &mut hits, &mut counters);
            sum += hits.chunks_exact(2).map(|h| h[1].t - h[0].t).sum::<f64>();
        }
    }
    sum * step * step
}
