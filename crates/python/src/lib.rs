//! The Python module `octray._core`: converts arguments, releases the interpreter, calls the
//! `octray` crate, converts results. Nothing is decided here.

mod arrays;
mod background;
mod building;
mod camera;
mod cells;
mod check;
mod checkpoint;
mod convert;
mod describe;
mod diagnostics;
mod files;
mod image;
mod instances;
mod light;
mod load;
mod material;
mod mesh;
mod objects;
mod pool;
mod profile;
mod queries;
mod render;
mod report;
mod scene;
mod solid;
mod structures;
mod system;
mod task;
mod tiles;
mod world;

use pyo3::pymodule;

/// The compiled core of octray; use it through the package `octray`.
#[pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    use super::camera::Camera;
    #[pymodule_export]
    use super::cells::Cells;
    #[pymodule_export]
    use super::diagnostics::{Diagnostic, SceneError};
    #[pymodule_export]
    use super::image::Image;
    #[pymodule_export]
    use super::light::{DirectionalLight, Light, PointLight, SpotLight};
    #[pymodule_export]
    use super::load::load;
    #[pymodule_export]
    use super::material::Material;
    #[pymodule_export]
    use super::profile::{Outline, lathe, prism};
    #[pymodule_export]
    use super::queries::{Hits, Intersections};
    #[pymodule_export]
    use super::render::check_request;
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::solid::{
        Solid, cone, cubic, cuboid, cylinder, difference, empty, half_space, intersection,
        mesh_solid, polyhedron, polynomial, quadric, quartic, sphere, superellipsoid, torus, union,
    };

    #[pymodule_export]
    use super::system::{cpu_features, default_threads};
    #[pymodule_export]
    use super::tiles::{TileRenderer, TiledPicture};
    #[pymodule_export]
    use super::world::{method_name, methods};

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
