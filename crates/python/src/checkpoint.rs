//! The file that keeps what a rendering has finished, while it goes on.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use octray::math::bytes::ContentHash;
use octray::render::{Checkpoint, JobId, Plan, Tile, TileFilm, checkpoint_records, tile_record};
use octray::scene::{Camera, Scene};
use octray::world::World;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::files;
use crate::image::os_error;

/// From the beginning of one write to that of the next. With the time of a write itself, what an
/// abrupt end loses stays below two seconds.
const INTERVAL: Duration = Duration::from_millis(1500);

/// Which picture this is: of the scene as it is seen by `camera`, else by its own.
pub(crate) fn job_id(scene: &Scene, camera: Option<&Camera>, plan: &Plan) -> JobId {
    let mut builder = scene.clone().into_builder();
    if let Some(camera) = camera {
        builder.set_camera(*camera);
    }
    let bytes = builder.so_far().to_bytes();
    JobId {
        scene: Scene::hash_of_bytes(&bytes).unwrap_or_else(|_| ContentHash::of(&bytes)),
        settings: plan.hash(),
    }
}

/// What is in the file at `path`, if there is one.
pub(crate) fn read(path: &Path) -> PyResult<Option<Vec<u8>>> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(os_error(path, &error)),
    }
}

/// The records in it, if it is of this job.
pub(crate) fn records<'a>(path: &Path, bytes: &'a [u8], job: &JobId) -> PyResult<&'a [u8]> {
    checkpoint_records(bytes, job).map_err(|error| unusable(path, &error))
}

pub(crate) fn unusable(path: &Path, error: &octray::render::CheckpointError) -> PyErr {
    PyValueError::new_err(format!("{}: {error}", path.display()))
}

/// Collects finished tiles from all threads and writes them now and then, on a thread of its own.
pub(crate) struct Keeper {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    path: PathBuf,
    state: Mutex<State>,
    ended: Condvar,
}

#[derive(Default)]
struct State {
    /// Records that the file does not have yet.
    new: Vec<Vec<u8>>,
    /// How it ended: whether the file is still needed.
    end: Option<bool>,
    /// Whether there is a file of ours.
    exists: bool,
    error: Option<String>,
}

impl Keeper {
    /// Begins to keep a picture of `world` in the file at `path`, with the records that it had.
    pub(crate) fn start(
        path: PathBuf,
        world: Arc<World>,
        camera: Option<Camera>,
        plan: Plan,
        before: Option<Vec<u8>>,
    ) -> io::Result<Self> {
        let state = State {
            exists: before.is_some(),
            new: before.into_iter().collect(),
            ..State::default()
        };
        let shared = Arc::new(Shared {
            path,
            state: Mutex::new(state),
            ended: Condvar::new(),
        });
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("octray checkpoint".to_owned())
            .stack_size(crate::task::STACK_BYTES)
            .spawn(move || own.run(&world, camera.as_ref(), &plan))?;
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }

    /// Takes a finished tile.
    pub(crate) fn keep(&self, tile: &Tile, light: &TileFilm) {
        let record = tile_record(tile, light);
        self.shared.lock().new.push(record);
    }

    /// Ends: writes what is new if the file is still needed, else removes it. Says what went wrong
    /// with the file meanwhile, and whether it is there.
    pub(crate) fn end(mut self, needed: bool) -> (Option<String>, bool) {
        self.stop(needed);
        let state = self.shared.lock();
        (state.error.clone(), state.exists)
    }

    fn stop(&mut self, needed: bool) {
        self.shared.lock().end.get_or_insert(needed);
        self.shared.ended.notify_all();
        if let Some(thread) = self.thread.take() {
            // If it panicked there is no file, which is what it then says.
            let _ = thread.join();
        }
    }
}

impl Drop for Keeper {
    /// An error ended the rendering: what is there may still be of use.
    fn drop(&mut self) {
        self.stop(true);
    }
}

impl Shared {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run(&self, world: &World, camera: Option<&Camera>, plan: &Plan) {
        let mut kept: Option<Checkpoint> = None;
        let mut last = Instant::now();
        loop {
            let wait = INTERVAL.saturating_sub(last.elapsed());
            let state = self.lock();
            let (mut state, _) = self
                .ended
                .wait_timeout_while(state, wait, |state| state.end.is_none())
                .unwrap_or_else(PoisonError::into_inner);
            last = Instant::now();
            let end = state.end;
            let new = std::mem::take(&mut state.new);
            drop(state);
            if end == Some(false) {
                self.remove();
                return;
            }
            if !new.is_empty() {
                let job = || job_id(world.scene(), camera, plan);
                let checkpoint = kept.get_or_insert_with(|| Checkpoint::new(&job()));
                new.iter().for_each(|record| checkpoint.add(record));
                let written = files::replace(&self.path, checkpoint.as_bytes());
                let mut state = self.lock();
                state.exists |= written.is_ok();
                state.error = written.err().map(|error| error.to_string());
            }
            if end.is_some() {
                return;
            }
        }
    }

    fn remove(&self) {
        let mut state = self.lock();
        if state.exists {
            match std::fs::remove_file(&self.path) {
                Ok(()) => state.exists = false,
                Err(error) if error.kind() == io::ErrorKind::NotFound => state.exists = false,
                Err(error) => state.error = Some(error.to_string()),
            }
        }
    }
}
