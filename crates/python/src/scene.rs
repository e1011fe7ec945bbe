//! The scene: a builder that Python code adds to.

mod state;

use std::path::PathBuf;

use numpy::PyArrayDyn;
use octray::geometry::Sheet;
use octray::scene::{SceneBuilder, Shape};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};

use crate::background;
use crate::building::Building;
use crate::camera::Camera;
use crate::cells::{self, Cells};
use crate::convert::{Triple, vector};
use crate::diagnostics::Diagnostic;
use crate::image::Image;
use crate::instances;
use crate::light::Light;
use crate::mesh;
use crate::objects::Common;
use crate::queries::{self, Crossings, Hits, Intersections};
use crate::render::{self, Request};
use crate::solid::Solid;
use crate::structures;
use crate::world::{Prepared, prepare, prepared, read_cells, write_cells};

/// Objects, lights, a camera and a background.
#[pyclass(module = "octray")]
#[derive(Debug, Default)]
pub(crate) struct Scene {
    builder: SceneBuilder,
    diagnostics: Vec<Diagnostic>,
    /// A scene file keeps the lights it has, or its darkness.
    imported: bool,
    /// Counts the changes, so that a world made meanwhile is known to be stale.
    revision: u64,
    prepared: Option<Prepared>,
}

#[pymethods]
impl Scene {
    /// An empty scene; `units` is the unit of length, for reports.
    #[new]
    #[pyo3(signature = (*, units = "", up = None))]
    fn new(units: &str, up: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let mut scene = Self::default();
        scene.builder.settings_mut().units = units.to_owned();
        if let Some(up) = up {
            let direction = vector("up", up)?.try_normalize();
            scene.builder.settings_mut().up =
                direction.ok_or_else(|| PyValueError::new_err("up must be finite and not zero"))?;
        }
        Ok(scene)
    }

    /// Adds a solid; returns the object's id, which queries report.
    #[pyo3(signature = (solid, *, name = None, material = None, priority = 0, shadows = true))]
    fn add(
        &mut self,
        solid: &Bound<'_, PyAny>,
        name: Option<&str>,
        material: Option<&Bound<'_, PyAny>>,
        priority: i32,
        shadows: bool,
    ) -> PyResult<u32> {
        let solid = solid.cast::<Solid>().map_err(|_| {
            PyTypeError::new_err(
                "expected a solid; meshes are added with add_mesh, lights with add_light",
            )
        })?;
        let common = Common {
            name,
            material,
            priority,
            shadows,
        };
        let id = self.wanted_material(material)?;
        let shape = Shape::Solid(solid.get().inner().clone());
        Ok(self.add_shape(shape, "", id, &common))
    }

    /// Adds a mesh: the path of a mesh file, a pair (vertices, faces), or anything that has
    /// `.vertices` and `.faces`. Returns the object's id; the objects of a file that holds several
    /// follow one another.
    ///
    /// With `solid=True` or `"strict"` its inside is filled: it must be closed, and nothing may
    /// cross, overlap or face the wrong way, or a `ValueError` says what is wrong where. With
    /// `"winding"` inside is where the winding number is not 0, whatever crosses or overlaps; the
    /// mesh must be closed.
    #[pyo3(signature = (
        mesh, *, name = None, material = None, solid = None, priority = 0, shadows = true
    ))]
    fn add_mesh(
        &mut self,
        mesh: &Bound<'_, PyAny>,
        name: Option<&str>,
        material: Option<&Bound<'_, PyAny>>,
        solid: Option<&Bound<'_, PyAny>>,
        priority: i32,
        shadows: bool,
    ) -> PyResult<u32> {
        let filled = solid.map(mesh::filling).transpose()?.flatten();
        let common = Common {
            name,
            material,
            priority,
            shadows,
        };
        match mesh::Source::of(mesh)? {
            mesh::Source::Arrays(mesh) => {
                let shape = Shape::Sheet(Sheet::mesh(mesh));
                self.adopt(&shape, "", None, filled, &common)
            }
            mesh::Source::File(path) => {
                let (file, said) = crate::load::read(mesh.py(), &path, false)?;
                let mut first = None;
                for object in file.objects() {
                    let look = Some((file.materials(), object.material));
                    let id = self.adopt(&object.shape, &object.name, look, filled, &common)?;
                    first.get_or_insert(id);
                }
                self.diagnostics.extend(said);
                first.ok_or_else(|| PyValueError::new_err("the file has no mesh in it"))
            }
        }
    }

    /// Adds many copies of a solid, a mesh (as `add_mesh` takes it), or a list of solids and meshes,
    /// one for each of the affine maps in an array of shape (N, 4, 4) or (N, 3, 4), by rows. Returns
    /// the object's id; `Hits.instance_id` tells the copies apart.
    ///
    /// What is copied must be bounded. A copy takes about 140 bytes however large what is copied is.
    /// Where solids overlap, a copy counts as an object would, of the size of its box; the later copy
    /// before the earlier. `solid` fills meshes as in `add_mesh`. A ValueError says which transform
    /// is not finite, flat or not affine.
    #[pyo3(signature = (
        what, transforms, *, name = None, material = None, solid = None, priority = 0, shadows = true
    ))]
    #[expect(clippy::too_many_arguments, reason = "most by keyword")]
    fn add_instances(
        &mut self,
        what: &Bound<'_, PyAny>,
        transforms: &Bound<'_, PyAny>,
        name: Option<&str>,
        material: Option<&Bound<'_, PyAny>>,
        solid: Option<&Bound<'_, PyAny>>,
        priority: i32,
        shadows: bool,
    ) -> PyResult<u32> {
        let filled = solid.map(mesh::filling).transpose()?.flatten();
        let common = Common {
            name,
            material,
            priority,
            shadows,
        };
        let id = self.wanted_material(material)?;
        let given = material.map(|_| id);
        let copies = instances::instances(self, what, transforms, filled, given)?;
        Ok(self.add_shape(Shape::Instances(copies), "", id, &common))
    }

    /// Adds a light.
    fn add_light(&mut self, light: &Light) {
        self.changed().add_light(light.inner().clone());
    }

    /// The camera, or `None`: then a good place is chosen when the picture is taken.
    #[getter]
    fn camera(&self) -> Option<Camera> {
        self.builder.so_far().camera().copied().map(Camera::new)
    }

    #[setter]
    fn set_camera(&mut self, camera: &Camera) {
        // The trees do not depend on it, but the lights of a scene without any do.
        if self.imported || !self.builder.so_far().lights().is_empty() {
            self.builder.set_camera(*camera.inner());
        } else {
            self.changed().set_camera(*camera.inner());
        }
    }

    /// Puts a camera where it sees everything, from the front and a little from above.
    fn view_all(&mut self) -> PyResult<()> {
        let camera = crate::camera::view_all(self.builder.so_far())?;
        self.set_camera(&camera);
        Ok(())
    }

    /// Puts a camera that sees everything in a parallel projection from a side: "front", "back",
    /// "left", "right", "top", "bottom" or "iso".
    fn view_from(&mut self, side: &str) -> PyResult<()> {
        let camera = crate::camera::view_from(self.builder.so_far(), side)?;
        self.set_camera(&camera);
        Ok(())
    }

    /// What rays see that meet nothing: colours from straight down to straight up. Set it to one
    /// colour, or to a list of two or more.
    #[getter]
    fn background(&self) -> Vec<[f64; 3]> {
        let scene = self.builder.so_far();
        crate::describe::background(scene.background(), scene.settings().up)
    }

    #[setter]
    fn set_background(&mut self, background: &Bound<'_, PyAny>) -> PyResult<()> {
        let up = self.settings().up;
        let background = background::background(background, up)?;
        self.changed().set_background(background);
        Ok(())
    }

    /// The names of the objects; an object's id is an index into it.
    #[getter]
    fn names(&self) -> Vec<&str> {
        let objects = self.builder.so_far().objects();
        objects.iter().map(|o| &*o.name).collect()
    }

    /// The names of the materials; a material's id is an index into it.
    #[getter]
    fn material_names(&self) -> Vec<&str> {
        let materials = self.builder.so_far().materials();
        materials.iter().map(|m| m.name.as_str()).collect()
    }

    /// The box around all bounded objects as (lowest corner, highest corner), or `None`.
    #[getter]
    fn bounds(&self) -> Option<(Triple, Triple)> {
        let bounds = self.builder.so_far().bounds();
        (!bounds.is_empty()).then(|| (bounds.min.into(), bounds.max.into()))
    }

    /// What the importer said about the file that this scene came from.
    #[getter]
    fn diagnostics(&self) -> Vec<Diagnostic> {
        self.diagnostics.clone()
    }

    /// Builds the trees now rather than with the first picture or query, by other criteria if these
    /// are given. A cell is divided if all of them agree; the answers are the same by any.
    ///
    /// `quality`: "fast" builds the tree over the triangles of meshes in less time, "full" (the
    /// default) one in which rays find them in less.
    /// `tree_objects`: a cell of at most so many surfaces is not divided. `tree_depth`: the deepest
    /// level, 0 to 21. `tree_cost`: what entering a cell costs in planes intersected with a ray, as a
    /// cell is divided where the expected cost of rays falls; `"off"` divides whatever it costs.
    /// `tree_share`: a cell of which its objects' boxes fill more than this share is not divided.
    /// `tree_memory`: the bytes that a tree may take; what does not fit is left undivided (a tree of
    /// triangles is refused), and reported. `lvsi_table` ("prime" or "power-of-two") and `lvsi_load`
    /// (rows used for each row of the table) say how large a hash table is. `cells`: the path of a
    /// list of cells (`dump_cells`) along which the octree over solids is built.
    #[pyo3(signature = (
        *, accel = "auto", threads = None, quality = None, tree_objects = None, tree_depth = None,
        tree_cost = None, tree_share = None, tree_memory = None, lvsi_table = None, lvsi_load = None,
        cells = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "all by keyword")]
    fn prepare(
        slf: &Bound<'_, Self>,
        accel: &str,
        threads: Option<usize>,
        quality: Option<&str>,
        tree_objects: Option<u32>,
        tree_depth: Option<u32>,
        tree_cost: Option<&Bound<'_, PyAny>>,
        tree_share: Option<f64>,
        tree_memory: Option<u64>,
        lvsi_table: Option<&str>,
        lvsi_load: Option<f64>,
        cells: Option<PathBuf>,
    ) -> PyResult<()> {
        let building = Building {
            quality,
            objects: tree_objects,
            depth: tree_depth,
            cost: tree_cost,
            share: tree_share,
            memory: tree_memory,
            table: lvsi_table,
            load: lvsi_load,
        };
        let config = building.config(accel)?;
        let cells = cells.map(read_cells).transpose()?;
        prepare(slf, config, cells, threads).map(|_| ())
    }

    /// Writes the occupied cells of the octree over solids, each with the primitives that it may
    /// touch, as text that `prepare` takes as `cells`.
    #[pyo3(signature = (path, *, accel = "octree", threads = None))]
    #[expect(clippy::needless_pass_by_value, reason = "how PyO3 takes paths")]
    fn dump_cells(
        slf: &Bound<'_, Self>,
        path: PathBuf,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<()> {
        write_cells(&path, &prepared(slf, accel, threads)?)
    }

    /// Figures about what a method builds: `method`, `build_s`, `trees`, `memory` and `world`, as in
    /// `Image.report`. What `prepare` built with criteria of its own counts.
    #[pyo3(signature = (*, accel = "auto", threads = None))]
    fn stats<'py>(
        slf: &Bound<'py, Self>,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        structures::stats(slf.py(), &prepared(slf, accel, threads)?)
    }

    /// The cells that a method makes over the scene's solids, or over the triangles of its meshes. A
    /// method without any is a `ValueError`.
    #[pyo3(signature = (*, accel = "auto", kind = "solids", threads = None))]
    fn cells(
        slf: &Bound<'_, Self>,
        accel: &str,
        kind: &str,
        threads: Option<usize>,
    ) -> PyResult<Cells> {
        cells::cells(slf, accel, kind, threads)
    }

    /// The scene as bytes, with the camera and the lights that a picture of it gets: for other
    /// processes and machines. The same scene gives the same bytes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let plain = self.complete(py)?;
        Ok(PyBytes::new(py, &py.detach(|| plain.to_bytes())))
    }

    /// The scene that `to_bytes` gave, from bytes or an array of uint8. A ValueError says what is
    /// wrong with them.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self::imported(
            crate::load::from_bytes(py, data)?,
            Vec::new(),
        ))
    }

    /// Renders a picture: of light, or with `integrator="cost"` of what the same rays cost.
    ///
    /// `checkpoint` names a file that keeps what is finished while it takes long, and is removed at
    /// the end; with `resume` the rendering goes on with it. A ValueError says that it is of another.
    #[pyo3(signature = (
        *, size = None, spp = 1, threads = None, accel = "auto", crop = None, view = None,
        max_depth = None, threshold = None, seed = 0, progress = None, preview = None,
        on_interrupt = "raise", integrator = "whitted", checkpoint = None, resume = false
    ))]
    #[expect(clippy::too_many_arguments, reason = "all by keyword")]
    fn render(
        slf: &Bound<'_, Self>,
        size: Option<(u32, u32)>,
        spp: u32,
        threads: Option<usize>,
        accel: &str,
        crop: Option<(u32, u32, u32, u32)>,
        view: Option<&str>,
        max_depth: Option<u32>,
        threshold: Option<f64>,
        seed: u64,
        progress: Option<&Bound<'_, PyAny>>,
        preview: Option<&Bound<'_, PyAny>>,
        on_interrupt: &str,
        integrator: &str,
        checkpoint: Option<PathBuf>,
        resume: bool,
    ) -> PyResult<Image> {
        let request = Request {
            size,
            spp,
            threads,
            accel,
            crop,
            view,
            max_depth,
            threshold,
            seed,
            progress,
            preview,
            on_interrupt,
            integrator,
            checkpoint,
            resume,
        };
        render::render(slf, &request)
    }

    /// The nearest surface on each ray of an array (..., 6): origin and direction. `t` counts in
    /// units of the direction; only t > 0 counts; a ray with NaN or without direction misses.
    #[pyo3(signature = (rays, *, accel = "auto", threads = None))]
    fn cast_rays(
        slf: &Bound<'_, Self>,
        rays: &Bound<'_, PyAny>,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Hits> {
        queries::cast_rays(slf, rays, (accel, threads))
    }

    /// Every interval of every ray of an array (..., 6) inside every solid, ordered by ray and then by
    /// where it begins. Sheets have no inside and no intervals. A ray that starts inside has an
    /// interval from t = 0, one that never leaves ends at infinity; with `whole_line` t counts from
    /// -inf. A ray with NaN or without direction has no interval.
    ///
    /// Where solids overlap, `overlaps` says whose intervals count: "regions", of the one solid that
    /// a point belongs to (higher priority, then the smaller solid, then the later one), so that
    /// intervals never overlap; "priorities", of the solids of highest priority; "objects", of every
    /// solid as if it were alone.
    #[pyo3(signature = (
        rays, *, whole_line = false, overlaps = "regions", accel = "auto", threads = None
    ))]
    fn list_intersections(
        slf: &Bound<'_, Self>,
        rays: &Bound<'_, PyAny>,
        whole_line: bool,
        overlaps: &str,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Intersections> {
        queries::list_intersections(slf, rays, whole_line, overlaps, (accel, threads))
    }

    /// `list_intersections` for more rays than memory holds: yields the `Intersections` of at most
    /// `chunk` rays at a time. `rays` is an array (N, 6), which may be a memory-mapped file, or an
    /// iterator of such arrays.
    #[pyo3(signature = (
        rays, *, chunk = 65536, whole_line = false, overlaps = "regions", accel = "auto",
        threads = None
    ))]
    fn iter_intersections<'py>(
        slf: &Bound<'py, Self>,
        rays: &Bound<'py, PyAny>,
        chunk: isize,
        whole_line: bool,
        overlaps: &str,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let options = PyDict::new(py);
        options.set_item("whole_line", whole_line)?;
        options.set_item("overlaps", overlaps)?;
        options.set_item("accel", accel)?;
        options.set_item("threads", threads)?;
        let module = py.import("octray._chunks")?;
        module.call_method1("iter_intersections", (slf, rays, chunk, options))
    }

    /// How many boundaries each ray of an array (..., 6) crosses at t > 0, or with `whole_line` at any
    /// t: each entry into a solid, each exit from one, and each sheet. Two solids that touch count
    /// as two. int64, the rays' leading axes.
    #[pyo3(signature = (rays, *, whole_line = false, accel = "auto", threads = None))]
    fn count_intersections<'py>(
        slf: &Bound<'py, Self>,
        rays: &Bound<'py, PyAny>,
        whole_line: bool,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        queries::count_intersections(slf, rays, whole_line, (accel, threads))
    }

    /// Whether each ray of an array (..., 6) meets any surface, transparent or not, at 0 < t < tfar.
    /// bool, the rays' leading axes.
    #[pyo3(signature = (rays, *, tfar = f64::INFINITY, accel = "auto", threads = None))]
    fn test_occlusions<'py>(
        slf: &Bound<'py, Self>,
        rays: &Bound<'py, PyAny>,
        tfar: f64,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        queries::test_occlusions(slf, rays, tfar, (accel, threads))
    }

    /// Whether each point of an array (..., 3) lies in a solid: bool, the points' leading axes. On a
    /// boundary it is decided for one of the sides. A point with NaN is outside.
    #[pyo3(signature = (points, *, accel = "auto", threads = None))]
    fn compute_occupancy<'py>(
        slf: &Bound<'py, Self>,
        points: &Bound<'py, PyAny>,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        queries::compute_occupancy(slf, points, (accel, threads))
    }

    /// The solid that each point of an array (..., 3) belongs to, -1 outside: int64, the points' leading
    /// axes. Of several solids it is the one of higher priority, then the smaller, then the later.
    #[pyo3(signature = (points, *, accel = "auto", threads = None))]
    fn locate<'py>(
        slf: &Bound<'py, Self>,
        points: &Bound<'py, PyAny>,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        queries::locate(slf, points, (accel, threads))
    }

    /// The same questions under the names that trimesh gives them.
    #[getter]
    fn ray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let module = slf.py().import("octray.ray")?;
        module.call_method1("RayIntersector", (slf,))
    }

    /// For `octray.ray`: ray, number of the face, and t of the first `limit` surfaces on each ray.
    #[pyo3(signature = (rays, limit = None))]
    fn _crossings<'py>(
        slf: &Bound<'py, Self>,
        rays: &Bound<'py, PyAny>,
        limit: Option<usize>,
    ) -> PyResult<Crossings<'py>> {
        queries::crossings(slf, rays, limit, ("auto", None))
    }

    /// For the command line: how many of the rays are none.
    #[pyo3(signature = (rays, *, accel = "auto", threads = None))]
    fn _count_invalid_rays(
        slf: &Bound<'_, Self>,
        rays: &Bound<'_, PyAny>,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<usize> {
        queries::count_invalid_rays(slf, rays, (accel, threads))
    }

    /// Everything in the scene as plain dictionaries, lists and numbers, ready for JSON.
    fn describe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        crate::describe::scene(py, self.builder.so_far())
    }

    /// What is known of the meshes as boundaries of solids, one dictionary for each mesh of each
    /// object: whether it is `closed` and whether it bounds a `solid`, its `shells`, how many
    /// `flaws` of each kind there are, and the first `places`. Takes about a second for 500,000
    /// triangles.
    fn check_meshes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        crate::check::meshes(py, self.builder.so_far())
    }

    /// What is known of the surfaces of solids: how many distinct `surfaces` there are, how many
    /// faces were `merged` with one that was there because they coincide within the `tolerance`, and
    /// how many surfaces are farther from an earlier one than that, yet nearer than `near`
    /// (`near_count`; the first of them are `pairs`). Lengths are in the scene's unit.
    fn check_surfaces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        crate::check::surfaces(py, self.builder.so_far())
    }

    fn __len__(&self) -> usize {
        self.builder.so_far().objects().len()
    }

    fn __repr__(&self) -> String {
        let scene = self.builder.so_far();
        format!(
            "<octray.Scene of {} objects, {} lights>",
            scene.objects().len(),
            scene.lights().len()
        )
    }
}
