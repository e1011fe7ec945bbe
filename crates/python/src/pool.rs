//! Threads: the pools are made here, everything below runs in the one it is called in.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::task::STACK_BYTES;

/// More threads than any machine has use for.
const MAX_THREADS: usize = 1024;

/// The pool used last, with its process: threads do not survive a fork.
static POOL: Mutex<Option<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(None);

/// How many threads are used when nothing is said: as many as the process may run on.
pub(crate) fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Leaves the pool to work that nobody waits for any more; the next caller gets another one.
pub(crate) fn discard() {
    *POOL.lock().unwrap_or_else(PoisonError::into_inner) = None;
}

/// A pool of `threads` threads; the same one as long as the number stays the same.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let threads = threads.unwrap_or_else(default_threads);
    if !(1..=MAX_THREADS).contains(&threads) {
        return Err(PyValueError::new_err(format!(
            "threads must be 1 to {MAX_THREADS}, not {threads}"
        )));
    }
    let process = std::process::id();
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((owner, count, pool)) = known.as_ref() {
        if (*owner, *count) == (process, threads) {
            return Ok(Arc::clone(pool));
        }
        if *owner != process {
            // Its threads are in the other process; to drop it would wait for them.
            std::mem::forget(known.take());
        }
    }
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|index| format!("octray {index}"))
        .stack_size(STACK_BYTES)
        .build()
        .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))?;
    let pool = Arc::new(pool);
    *known = Some((process, threads, Arc::clone(&pool)));
    Ok(pool)
}
