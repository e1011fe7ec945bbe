//! What is wrong with the meshes of a scene and doubtful about its surfaces, as plain dictionaries
//! and lists.

use std::sync::Arc;

use octray::geometry::mesh::Flaw;
use octray::geometry::{Primitive, Sheet, Solid, SolidNode, TriangleMesh};
use octray::scene::{Object, Scene, Shape};
use octray::world::{NearCoincidence, SurfaceReport};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// The distinct meshes of an object, in the order of their first use.
fn meshes_of(object: &Object) -> Vec<Arc<TriangleMesh>> {
    let mut found: Vec<Arc<TriangleMesh>> = Vec::new();
    match &object.shape {
        Shape::Instances(instances) => {
            let parts = instances.prototype().parts().objects();
            parts.iter().for_each(|part| add_meshes(part, &mut found));
        }
        _ => add_meshes(object, &mut found),
    }
    found
}

fn add_meshes(object: &Object, found: &mut Vec<Arc<TriangleMesh>>) {
    let mut stack: Vec<&Solid> = Vec::new();
    let mut add = |mesh: &Arc<TriangleMesh>| {
        if !found.iter().any(|known| Arc::ptr_eq(known, mesh)) {
            found.push(Arc::clone(mesh));
        }
    };
    match &object.shape {
        Shape::Solid(solid) => stack.push(solid),
        Shape::Sheet(Sheet::Mesh { mesh, .. }) => add(mesh),
        Shape::Sheet(Sheet::Shell { solid, clip }) => stack.extend([clip, solid]),
        // Prototypes hold none.
        Shape::Instances(_) => {}
    }
    while let Some(solid) = stack.pop() {
        match solid.node() {
            SolidNode::Primitive(Primitive::Mesh(mesh)) => add(mesh),
            SolidNode::Empty | SolidNode::Primitive(_) => {}
            SolidNode::Transformed { child, .. }
            | SolidNode::WithMaterial { child, .. }
            | SolidNode::Complement(child) => stack.push(child),
            SolidNode::Union(all) | SolidNode::Intersection(all) | SolidNode::Difference(all) => {
                stack.extend(all.iter().rev());
            }
        }
    }
}

fn place<'py>(py: Python<'py>, flaw: &Flaw) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("kind", flaw.kind.name())?;
    let points: Vec<[f64; 3]> = flaw.places.iter().map(|p| p.to_array()).collect();
    dict.set_item("points", points)?;
    dict.set_item("triangles", &flaw.triangles)?;
    dict.set_item("message", flaw.to_string())?;
    Ok(dict)
}

/// One dictionary for each mesh of each object.
pub(crate) fn meshes<'py>(py: Python<'py>, scene: &Scene) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for (id, object) in scene.objects().iter().enumerate() {
        for mesh in meshes_of(object) {
            let report = py.detach(|| mesh.check());
            let dict = PyDict::new(py);
            dict.set_item("object", id)?;
            dict.set_item("name", &*object.name)?;
            dict.set_item("triangles", report.triangles)?;
            dict.set_item("closed", report.is_closed())?;
            dict.set_item("solid", report.is_sound())?;
            dict.set_item("shells", report.shells)?;
            let flaws = PyDict::new(py);
            for (kind, count) in report.counts() {
                flaws.set_item(kind.name(), count)?;
            }
            dict.set_item("flaws", flaws)?;
            let places = report.flaws().iter().map(|flaw| place(py, flaw));
            dict.set_item("places", places.collect::<PyResult<Vec<_>>>()?)?;
            dict.set_item("summary", report.to_string())?;
            list.append(dict)?;
        }
    }
    Ok(list)
}

/// So many near coincidences are listed.
const LISTED: usize = 16;

fn near<'py>(py: Python<'py>, pair: &NearCoincidence) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("kind", if pair.planes { "plane" } else { "curved" })?;
    dict.set_item("objects", pair.objects.map(|id| id.0))?;
    dict.set_item("gap", pair.gap)?;
    dict.set_item("position", pair.position.to_array())?;
    Ok(dict)
}

/// What the surface table makes of the scene.
pub(crate) fn surfaces<'py>(py: Python<'py>, scene: &Scene) -> PyResult<Bound<'py, PyDict>> {
    let report = py
        .detach(|| SurfaceReport::new(scene))
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let dict = PyDict::new(py);
    dict.set_item("surfaces", report.surfaces)?;
    dict.set_item("merged", report.merged)?;
    dict.set_item("tolerance", report.tolerance)?;
    dict.set_item("near", report.near)?;
    dict.set_item("near_count", report.pairs.len())?;
    let pairs = report.pairs.iter().take(LISTED);
    let pairs: Vec<_> = pairs.map(|p| near(py, p)).collect::<PyResult<_>>()?;
    dict.set_item("pairs", pairs)?;
    Ok(dict)
}
