//! A scanned mesh of the corpus, which is not part of the project.

use std::path::{Path, PathBuf};

use octray::geometry::{Primitive, Sheet, SolidNode, TriangleMesh};
use octray::import::{Disk, Options, load};
use octray::math::DVec3;
use octray::scene::Shape;

use super::Subject;

const ENTRY: &str = "mesh/armadillo.obj";

pub(super) fn make() -> Result<Subject, String> {
    let corpus = std::env::var_os("OCTRAY_CORPUS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let path = corpus.join(ENTRY);
    if !path.is_file() {
        return Err(format!(
            "absent: OCTRAY_CORPUS names no corpus with {ENTRY}"
        ));
    }
    let scene = load(&path, &Disk, &Options::default()).scene;
    let shape = scene.as_ref().and_then(|scene| scene.objects().first());
    let mesh: &TriangleMesh = match shape.map(|object| &object.shape) {
        Some(Shape::Sheet(Sheet::Mesh { mesh, .. })) => mesh,
        Some(Shape::Solid(solid)) => match solid.node() {
            SolidNode::Primitive(Primitive::Mesh(mesh)) => mesh,
            _ => return Err(format!("{ENTRY} holds no mesh")),
        },
        _ => return Err(format!("{ENTRY} holds no mesh")),
    };
    let bounds = mesh.bounds();
    let (center, size) = (bounds.center(), bounds.size().max_element());
    let round = |p: &DVec3| p.to_array().map(|x| x as f32);
    Ok(Subject {
        name: "scan",
        positions: mesh.positions().iter().map(round).collect(),
        triangles: mesh.triangles().to_vec(),
        eye: center + DVec3::new(0.5, 0.3, 1.35) * size,
        target: center,
        up: DVec3::Y,
        angle: 42.0,
        light: center + DVec3::new(1.5, 2.0, 1.8) * size,
    })
}
