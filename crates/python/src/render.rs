//! Rendering from Python: arguments, progress, Ctrl-C, the report.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use octray::render::{
    CheckpointError, Crop, HeatMap, Observer, Plan, RenderConfig, RenderError, RenderJob,
    Rendering, Shows, Tile, TileFilm,
};
use octray::scene::{Camera, Settings, View};
use octray::world::World;
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::checkpoint::{self, Keeper};
use crate::convert::value_error;
use crate::image::{Image, view_named};
use crate::pool::pool;
use crate::report;
use crate::scene::Scene;
use crate::task::{Event, Task};
use crate::world::prepared;

/// The arguments of `Scene.render` as they come.
#[derive(Debug)]
pub(crate) struct Request<'a, 'py> {
    pub(crate) size: Option<(u32, u32)>,
    pub(crate) spp: u32,
    pub(crate) threads: Option<usize>,
    pub(crate) accel: &'a str,
    pub(crate) crop: Option<(u32, u32, u32, u32)>,
    pub(crate) view: Option<&'a str>,
    pub(crate) max_depth: Option<u32>,
    pub(crate) threshold: Option<f64>,
    pub(crate) seed: u64,
    pub(crate) progress: Option<&'a Bound<'py, PyAny>>,
    pub(crate) preview: Option<&'a Bound<'py, PyAny>>,
    pub(crate) on_interrupt: &'a str,
    pub(crate) integrator: &'a str,
    /// Where finished tiles are kept while it goes on.
    pub(crate) checkpoint: Option<PathBuf>,
    /// Whether to go on with what is there.
    pub(crate) resume: bool,
}

/// Pictures of scenes that name no size.
pub(crate) const DEFAULT_SIZE: (u32, u32) = (1280, 720);

impl Request<'_, '_> {
    pub(crate) fn config(&self, settings: &Settings) -> PyResult<RenderConfig> {
        let crop = match self.crop {
            None => None,
            Some((x0, y0, x1, y1)) if x0 < x1 && y0 < y1 => Some(Crop {
                x: x0,
                y: y0,
                width: x1 - x0,
                height: y1 - y0,
            }),
            Some(crop) => {
                return Err(PyValueError::new_err(format!(
                    "crop must be (x0, y0, x1, y1) with x0 < x1 and y0 < y1, not {crop:?}"
                )));
            }
        };
        let shows = self.shows()?;
        if shows == Shows::Cost && self.view.is_some() {
            return Err(PyValueError::new_err(
                "a picture of costs is no light: leave the view out",
            ));
        }
        Ok(RenderConfig {
            shows,
            size: self.size.or(settings.size).or(Some(DEFAULT_SIZE)),
            spp: self.spp,
            crop,
            max_generations: self.max_depth,
            contribution_threshold: self.threshold,
            seed: self.seed,
            progressive: self.preview.is_some(),
            ..RenderConfig::default()
        })
    }

    fn shows(&self) -> PyResult<Shows> {
        match self.integrator {
            "whitted" => Ok(Shows::Light),
            "cost" => Ok(Shows::Cost),
            other => Err(PyValueError::new_err(format!(
                "integrator must be \"whitted\" or \"cost\", not {other:?}"
            ))),
        }
    }

    fn keeps_partial(&self) -> PyResult<bool> {
        match self.on_interrupt {
            "raise" => Ok(false),
            "return" => Ok(true),
            other => Err(PyValueError::new_err(format!(
                "on_interrupt must be \"raise\" or \"return\", not {other:?}"
            ))),
        }
    }
}

/// Checks the size of a picture before a scene is read; nothing is allocated.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "all by keyword")]
#[pyo3(signature = (*, size = None, spp = 1, threads = None, crop = None, max_depth = None, threshold = None, view = None, integrator = "whitted"))]
pub(crate) fn check_request(
    size: Option<(u32, u32)>,
    spp: u32,
    threads: Option<usize>,
    crop: Option<(u32, u32, u32, u32)>,
    max_depth: Option<u32>,
    threshold: Option<f64>,
    view: Option<&str>,
    integrator: &str,
) -> PyResult<()> {
    let request = Request {
        size,
        spp,
        threads,
        accel: "auto",
        // Whether it lies in the picture is known with the picture's size.
        crop: crop.filter(|_| size.is_some()),
        view,
        max_depth,
        threshold,
        seed: 0,
        progress: None,
        preview: None,
        on_interrupt: "raise",
        integrator,
        checkpoint: None,
        resume: false,
    };
    pool(threads)?;
    let settings = Settings::default();
    let config = request.config(&settings)?;
    config.plan(&settings).map(|_| ()).map_err(value_error)
}

/// Passes progress out of, and the wish to stop into, the threads that render.
struct Watch<'a> {
    cancel: &'a AtomicBool,
    done: &'a AtomicU64,
    total: &'a AtomicU64,
    keeper: Option<&'a Keeper>,
}

impl Observer for Watch<'_> {
    fn progress(&self, done: u64, total: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
    }

    fn finished(&self, tile: &Tile, light: &TileFilm) {
        if let Some(keeper) = self.keeper {
            keeper.keep(tile, light);
        }
    }

    fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

/// Everything the thread that renders needs.
struct Job {
    world: Arc<World>,
    camera: Option<Camera>,
    config: RenderConfig,
    pool: Arc<rayon::ThreadPool>,
    done: Arc<AtomicU64>,
    total: Arc<AtomicU64>,
    keeper: Option<Keeper>,
    /// Records of a checkpoint of this picture.
    before: Option<Vec<u8>>,
}

/// What became of the picture, and of its checkpoint.
struct Done {
    rendering: Rendering,
    duration: Duration,
    resumed_pixels: u64,
    /// What went wrong with the file, and whether it is there.
    checkpoint: Option<(Option<String>, bool)>,
}

/// Why there is no picture.
enum Failure {
    Request(RenderError),
    Checkpoint(CheckpointError),
}

type Outcome = Result<Done, Failure>;

impl Job {
    fn run(mut self, cancel: &AtomicBool, send: &dyn Fn(octray::render::Image)) -> Outcome {
        let keeper = self.keeper.take();
        let watch = Watch {
            cancel,
            done: &self.done,
            total: &self.total,
            keeper: keeper.as_ref(),
        };
        let start = Instant::now();
        let mut job = RenderJob::new(&self.world, self.camera.as_ref(), &self.config)
            .map_err(Failure::Request)?;
        if let Some(before) = &self.before {
            job.resume(before).map_err(Failure::Checkpoint)?;
        }
        let resumed_pixels = job.film().complete_pixels();
        while self.pool.install(|| job.run_pass(&watch)) {
            send(job.preview());
        }
        let (rendering, duration) = (job.finish(), start.elapsed());
        let needed = !rendering.is_complete();
        Ok(Done {
            resumed_pixels,
            duration,
            checkpoint: keeper.map(|keeper| keeper.end(needed)),
            rendering,
        })
    }
}

/// Renders the scene.
pub(crate) fn render(scene: &Bound<'_, Scene>, request: &Request<'_, '_>) -> PyResult<Image> {
    let py = scene.py();
    let keeps_partial = request.keeps_partial()?;
    let view = request.view.map(view_named).transpose()?;
    let (settings, camera) = {
        let scene = scene.try_borrow()?;
        (scene.settings().clone(), scene.own_camera())
    };
    let config = request.config(&settings)?;
    let plan = config.plan(&settings).map_err(value_error)?;
    if request.checkpoint.is_some() && plan.shows == Shows::Cost {
        return Err(PyValueError::new_err(
            "costs depend on the method: a picture of them has no checkpoint",
        ));
    }
    let view = view.unwrap_or(settings.view);
    let prepared = prepared(scene, request.accel, request.threads)?;

    let pool = pool(request.threads)?;
    let threads = pool.current_num_threads();
    let (done, total) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
    let before = match &request.checkpoint {
        Some(path) if request.resume => before(py, path, &prepared.world, camera, &plan)?,
        _ => None,
    };
    let keeper = match &request.checkpoint {
        Some(path) => {
            let world = Arc::clone(&prepared.world);
            Some(Keeper::start(
                path.clone(),
                world,
                camera,
                plan,
                before.clone(),
            )?)
        }
        None => None,
    };
    let job = Job {
        keeper,
        before,
        world: Arc::clone(&prepared.world),
        camera,
        config,
        pool,
        done: Arc::clone(&done),
        total: Arc::clone(&total),
    };
    let mut task: Task<Outcome, _> = Task::start(move |cancel, send| job.run(cancel, send))?;

    let watcher = Watcher::new(request, view)?;
    let mut stopped = None;
    let outcome = loop {
        let event = task.next(py)?;
        let told = match event {
            Event::Result(outcome) => break outcome,
            _ if stopped.is_some() => continue,
            Event::Message(image) => watcher.preview(py, image),
            Event::Tick => {
                let share = done.load(Ordering::Relaxed) as f64
                    / total.load(Ordering::Relaxed).max(1) as f64;
                py.check_signals().and_then(|()| watcher.progress(share))
            }
        };
        if let Err(error) = told {
            task.cancel();
            stopped = Some(error);
        }
    };
    let Done {
        rendering,
        duration,
        resumed_pixels,
        checkpoint,
    } = outcome.map_err(|failure| match failure {
        Failure::Request(error) => value_error(error),
        Failure::Checkpoint(error) => {
            let path = request.checkpoint.clone().unwrap_or_default();
            checkpoint::unusable(&path, &error)
        }
    })?;
    match stopped {
        Some(error) if !(keeps_partial && error.is_instance_of::<PyKeyboardInterrupt>(py)) => {
            return Err(error);
        }
        Some(_) => {}
        None => watcher.progress(1.0)?,
    }
    let complete = rendering.is_complete();
    let (picture, heat) = py.detach(|| {
        let picture = if complete {
            rendering.image()
        } else {
            rendering.coarse_image()
        };
        let heat = heat_map(&rendering.plan, &picture);
        (picture, heat)
    });
    let high = heat.as_ref().map(|heat| heat.top);
    let report = report::rendering(py, &rendering, &prepared, duration, threads, high)?;
    let about = PyDict::new(py);
    if let (Some(path), Some((error, exists))) = (&request.checkpoint, checkpoint) {
        about.set_item("path", path.display().to_string())?;
        about.set_item("exists", exists)?;
        about.set_item("error", error)?;
        about.set_item("resumed_pixels", resumed_pixels)?;
    }
    report.bind(py).set_item("checkpoint", about)?;
    let image = Image::new(picture, view, complete, Some(report));
    Ok(match heat {
        Some(heat) => image.with_heat(heat.image),
        None => image,
    })
}

/// The records of a checkpoint of this picture, if there is one.
fn before(
    py: Python<'_>,
    path: &Path,
    world: &World,
    camera: Option<Camera>,
    plan: &Plan,
) -> PyResult<Option<Vec<u8>>> {
    let Some(bytes) = checkpoint::read(path)? else {
        return Ok(None);
    };
    let job = py.detach(|| checkpoint::job_id(world.scene(), camera.as_ref(), plan));
    let records = checkpoint::records(path, &bytes, &job)?;
    Ok(Some(records.to_vec()))
}

/// The heat map of a picture of costs.
pub(crate) fn heat_map(plan: &Plan, picture: &octray::render::Image) -> Option<HeatMap> {
    (plan.shows == Shows::Cost).then(|| HeatMap::of_costs(picture))
}

/// The Python functions that want to know how far it is.
struct Watcher<'py> {
    progress: Option<Bound<'py, PyAny>>,
    preview: Option<Bound<'py, PyAny>>,
    bar: Option<Bound<'py, PyAny>>,
    view: View,
    /// Whether pictures are of costs.
    costs: bool,
}

impl<'py> Watcher<'py> {
    fn new(request: &Request<'_, 'py>, view: View) -> PyResult<Self> {
        let given = request.progress.filter(|p| !p.is_none());
        let (progress, bar) = match given.map(|p| (p, p.extract::<bool>())) {
            None | Some((_, Ok(false))) => (None, None),
            Some((given, Ok(true))) => {
                let module = given.py().import("octray.cli.progress")?;
                let bar = module.call_method1("Progress", ("render", "auto"))?;
                bar.call_method0("__enter__")?;
                (Some(bar.clone()), Some(bar))
            }
            Some((given, Err(_))) => (Some(given.clone()), None),
        };
        Ok(Self {
            progress,
            preview: request.preview.cloned().filter(|p| !p.is_none()),
            bar,
            view,
            costs: request.shows()? == Shows::Cost,
        })
    }

    fn progress(&self, share: f64) -> PyResult<()> {
        if let Some(progress) = &self.progress {
            progress.call1((share,))?;
        }
        Ok(())
    }

    fn preview(&self, py: Python<'py>, image: octray::render::Image) -> PyResult<()> {
        if let Some(preview) = &self.preview {
            let heat = self.costs.then(|| HeatMap::of_costs(&image));
            let mut image = Image::new(image, self.view, false, None);
            if let Some(heat) = heat {
                image = image.with_heat(heat.image);
            }
            preview.call1((Bound::new(py, image)?,))?;
        }
        Ok(())
    }
}

impl Drop for Watcher<'_> {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            let py = bar.py();
            // Only the line on the terminal is at stake here.
            let _ = bar.call_method1("__exit__", (py.None(), py.None(), py.None()));
        }
    }
}
