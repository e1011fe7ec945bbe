//! A picture in pieces: who has the film, and who renders tiles for it.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use octray::render::{
    Checkpoint, CheckpointError, Film, HeatMap, Image as Picture, JobId, Plan, Shows, Tile,
    checkpoint_records, place_records, render_tiles,
};
use octray::scene::{Encoding, View};
use octray::world::World;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::checkpoint::job_id;
use crate::convert::value_error;
use crate::files;
use crate::image::{Image, os_error, view_named};
use crate::pool::pool;
use crate::render::{Request, heat_map};
use crate::report;
use crate::scene::Scene;
use crate::task;
use crate::world::prepared;

/// A picture of a scene that is put together from tiles, whoever renders them.
///
/// Tiles are numbered from 0 to `tiles - 1`. Taking a tile twice changes nothing.
#[pyclass(frozen, module = "octray")]
pub(crate) struct TiledPicture {
    plan: Plan,
    job: JobId,
    view: View,
    encoding: Encoding,
    tiles: Vec<Tile>,
    state: Mutex<State>,
}

struct State {
    film: Film,
    checkpoint: Checkpoint,
    has: Vec<bool>,
}

/// What both sides of a picture in pieces are asked.
struct Settings {
    size: Option<(u32, u32)>,
    spp: u32,
    crop: Option<(u32, u32, u32, u32)>,
    view: Option<String>,
    max_depth: Option<u32>,
    threshold: Option<f64>,
    seed: u64,
    integrator: String,
}

impl Settings {
    fn plan(&self, scene: &octray::scene::Scene) -> PyResult<Plan> {
        let request = Request {
            size: self.size,
            spp: self.spp,
            threads: None,
            accel: "auto",
            crop: self.crop,
            view: self.view.as_deref(),
            max_depth: self.max_depth,
            threshold: self.threshold,
            seed: self.seed,
            progress: None,
            preview: None,
            on_interrupt: "raise",
            integrator: &self.integrator,
            checkpoint: None,
            resume: false,
        };
        let config = request.config(scene.settings())?;
        config.plan(scene.settings()).map_err(value_error)
    }
}

impl TiledPicture {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The number of a tile, if it is one of this picture's.
    fn id(&self, tile: &Tile) -> Option<usize> {
        let edge = self.plan.tile_edge();
        let columns = self.plan.crop.width.div_ceil(edge) as usize;
        let id = (tile.y / edge) as usize * columns + (tile.x / edge) as usize;
        (self.tiles.get(id) == Some(tile)).then_some(id)
    }

    fn take(&self, records: &[u8]) -> Result<Vec<u32>, CheckpointError> {
        let mut state = self.lock();
        let State {
            film,
            checkpoint,
            has,
        } = &mut *state;
        let mut new = Vec::new();
        let mut others = false;
        for (tile, record) in place_records(records, film)? {
            match self.id(&tile) {
                Some(id) if has[id] => continue,
                Some(id) => {
                    has[id] = true;
                    new.push(id as u32);
                }
                // A local rendering with previews has others.
                None => others = true,
            }
            checkpoint.add(record);
        }
        if others {
            for (id, tile) in self.tiles.iter().enumerate() {
                if !has[id] && film.has(tile) {
                    has[id] = true;
                    new.push(id as u32);
                }
            }
        }
        Ok(new)
    }
}

#[pymethods]
impl TiledPicture {
    /// A picture of `scene` of which nothing is there yet; the settings are those of `Scene.render`.
    #[new]
    #[pyo3(signature = (
        scene, *, size = None, spp = 1, crop = None, view = None, max_depth = None,
        threshold = None, seed = 0, integrator = "whitted"
    ))]
    #[expect(clippy::too_many_arguments, reason = "all by keyword")]
    fn new(
        scene: &Bound<'_, Scene>,
        size: Option<(u32, u32)>,
        spp: u32,
        crop: Option<(u32, u32, u32, u32)>,
        view: Option<String>,
        max_depth: Option<u32>,
        threshold: Option<f64>,
        seed: u64,
        integrator: &str,
    ) -> PyResult<Self> {
        let py = scene.py();
        let settings = Settings {
            size,
            spp,
            crop,
            view,
            max_depth,
            threshold,
            seed,
            integrator: integrator.to_owned(),
        };
        let plain = scene.try_borrow()?.complete(py)?;
        let plan = settings.plan(&plain)?;
        let view = settings.view.as_deref().map(view_named).transpose()?;
        let job = py.detach(|| job_id(&plain, None, &plan));
        let tiles = plan.tiles();
        let encoding = match plan.shows {
            Shows::Light => plain.settings().encoding,
            Shows::Cost => Encoding::Linear,
        };
        let state = State {
            film: Film::new(plan.crop, plan.spp),
            checkpoint: Checkpoint::new(&job),
            has: vec![false; tiles.len()],
        };
        Ok(Self {
            plan,
            job,
            view: view.unwrap_or(plain.settings().view),
            encoding,
            tiles,
            state: Mutex::new(state),
        })
    }

    /// How many tiles the picture has.
    #[getter]
    fn tiles(&self) -> usize {
        self.tiles.len()
    }

    /// Width and height of the whole picture in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        self.plan.size
    }

    /// Which picture this is: hexadecimal digits that say scene and settings.
    #[getter]
    fn job(&self) -> String {
        format!("{}-{}", self.job.scene, self.job.settings)
    }

    /// The numbers of the tiles that are missing.
    fn missing(&self) -> Vec<u32> {
        let state = self.lock();
        let ids = 0..self.tiles.len() as u32;
        ids.filter(|id| !state.has[*id as usize]).collect()
    }

    /// Takes tiles that a `TileRenderer` made; gives the numbers of those that were missing.
    /// A ValueError says what is damaged.
    fn take_records(&self, py: Python<'_>, records: &[u8]) -> PyResult<Vec<u32>> {
        py.detach(|| self.take(records)).map_err(value_error)
    }

    /// The bytes of a checkpoint of what is there.
    fn checkpoint<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.lock().checkpoint.as_bytes())
    }

    /// Writes a checkpoint of what is there. The file appears complete or not at all.
    #[expect(clippy::needless_pass_by_value, reason = "how PyO3 takes paths")]
    fn save_checkpoint(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let bytes = self.lock().checkpoint.as_bytes().to_vec();
        py.detach(|| files::replace(&path, &bytes))
            .map_err(|error| os_error(&path, &error))
    }

    /// Takes what is in a checkpoint; gives the numbers of the tiles that were missing. A ValueError
    /// says that it is of another scene or of other settings, or damaged.
    fn resume(&self, py: Python<'_>, checkpoint: &[u8]) -> PyResult<Vec<u32>> {
        let records = checkpoint_records(checkpoint, &self.job).map_err(value_error)?;
        py.detach(|| self.take(records)).map_err(value_error)
    }

    /// The picture as far as it is there; the rest is black. `report` becomes its report.
    #[pyo3(signature = (report = None))]
    fn image(&self, py: Python<'_>, report: Option<Py<PyDict>>) -> PyResult<Image> {
        let film = self.lock().film.clone();
        let (picture, heat) = py.detach(|| {
            let picture = Picture::from_film(&film, self.encoding);
            let heat: Option<HeatMap> = heat_map(&self.plan, &picture);
            (picture, heat)
        });
        let complete = self.lock().has.iter().all(|has| *has);
        if let (Some(report), Some(heat)) = (&report, &heat) {
            let scale = report::heat_scale(py, heat.top)?;
            report.bind(py).set_item("cost", scale)?;
        }
        let image = Image::new(picture, self.view, complete, report);
        Ok(match heat {
            Some(heat) => image.with_heat(heat.image),
            None => image,
        })
    }
}

/// Renders tiles of a picture for a `TiledPicture`, perhaps in another process.
#[pyclass(frozen, module = "octray")]
pub(crate) struct TileRenderer {
    plan: Plan,
    job: JobId,
    tiles: Arc<Vec<Tile>>,
    world: Arc<World>,
    threads: Option<usize>,
    build: Duration,
}

#[pymethods]
impl TileRenderer {
    /// Builds the trees over `scene`; the settings are those of the `TiledPicture`.
    #[new]
    #[pyo3(signature = (
        scene, *, size = None, spp = 1, crop = None, view = None, max_depth = None,
        threshold = None, seed = 0, integrator = "whitted", accel = "auto", threads = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "all by keyword")]
    fn new(
        scene: &Bound<'_, Scene>,
        size: Option<(u32, u32)>,
        spp: u32,
        crop: Option<(u32, u32, u32, u32)>,
        view: Option<String>,
        max_depth: Option<u32>,
        threshold: Option<f64>,
        seed: u64,
        integrator: &str,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let py = scene.py();
        let settings = Settings {
            size,
            spp,
            crop,
            view,
            max_depth,
            threshold,
            seed,
            integrator: integrator.to_owned(),
        };
        let prepared = prepared(scene, accel, threads)?;
        let world = prepared.world;
        let plan = settings.plan(world.scene())?;
        let job = py.detach(|| job_id(world.scene(), None, &plan));
        Ok(Self {
            plan,
            job,
            tiles: Arc::new(plan.tiles()),
            world,
            threads,
            build: prepared.duration,
        })
    }

    /// Which picture this is; tiles go into a `TiledPicture` of the same.
    #[getter]
    fn job(&self) -> String {
        format!("{}-{}", self.job.scene, self.job.settings)
    }

    /// How long the trees took to build, in seconds.
    #[getter]
    fn build_s(&self) -> f64 {
        self.build.as_secs_f64()
    }

    /// Renders the tiles of these numbers; gives their records and what they cost: `render_s`, and
    /// `rays` and `hits` by kind.
    #[expect(clippy::needless_pass_by_value, reason = "how PyO3 takes lists")]
    fn render<'py>(
        &self,
        py: Python<'py>,
        ids: Vec<u32>,
    ) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyDict>)> {
        let tiles: Option<Vec<Tile>> = ids
            .iter()
            .map(|id| self.tiles.get(*id as usize).copied())
            .collect();
        let Some(tiles) = tiles else {
            return Err(PyValueError::new_err(format!(
                "the picture has tiles 0 to {}",
                self.tiles.len() - 1
            )));
        };
        let pool = pool(self.threads)?;
        let (world, plan) = (Arc::clone(&self.world), self.plan);
        let start = Instant::now();
        let (records, stats) = task::run(py, move |_| {
            pool.install(|| render_tiles(&world, &plan, &tiles, &()))
        })?
        .map_err(value_error)?;
        let cost = PyDict::new(py);
        cost.set_item("render_s", start.elapsed().as_secs_f64())?;
        cost.set_item("rays", report::rays(py, &stats.rays)?)?;
        cost.set_item("hits", report::rays(py, &stats.hits)?)?;
        Ok((PyBytes::new(py, &records), cost))
    }
}
