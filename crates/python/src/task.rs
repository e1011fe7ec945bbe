//! Long work beside the interpreter: it is released meanwhile, and Ctrl-C gets through.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often signals are looked at.
const TICK: Duration = Duration::from_millis(40);
/// Enough for walks over the deepest solids, also where nothing is optimised.
pub(crate) const STACK_BYTES: usize = 16 << 20;

/// Work on a thread of its own that sends messages `M` and ends with a `T`.
pub(crate) struct Task<T, M> {
    results: Receiver<Sent<T, M>>,
    thread: Option<JoinHandle<()>>,
    cancel: Arc<AtomicBool>,
}

enum Sent<T, M> {
    Message(M),
    Result(T),
}

/// What the main thread learns while it waits.
pub(crate) enum Event<T, M> {
    Message(M),
    Tick,
    Result(T),
}

impl<T: Send + 'static, M: Send + 'static> Task<T, M> {
    /// Starts `work`. It gets a flag that says when to stop early, and a function that sends.
    pub(crate) fn start(
        work: impl FnOnce(&AtomicBool, &dyn Fn(M)) -> T + Send + 'static,
    ) -> PyResult<Self> {
        let (sender, results) = channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&cancel);
        let thread = std::thread::Builder::new()
            .name("octray".to_owned())
            .stack_size(STACK_BYTES)
            .spawn(move || {
                // Nobody listens any more after an interruption: that is fine.
                let result = work(&flag, &|message| {
                    let _ = sender.send(Sent::Message(message));
                });
                let _ = sender.send(Sent::Result(result));
            })?;
        Ok(Self {
            results,
            thread: Some(thread),
            cancel,
        })
    }

    /// Asks the work to stop early.
    pub(crate) fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Waits for the next thing to happen, with the interpreter released.
    pub(crate) fn next(&mut self, py: Python<'_>) -> PyResult<Event<T, M>> {
        let results = &mut self.results;
        match py.detach(move || results.recv_timeout(TICK)) {
            Ok(Sent::Message(message)) => Ok(Event::Message(message)),
            Ok(Sent::Result(result)) => Ok(Event::Result(result)),
            Err(RecvTimeoutError::Timeout) => Ok(Event::Tick),
            Err(RecvTimeoutError::Disconnected) => Err(self.panic_error()),
        }
    }

    fn panic_error(&mut self) -> PyErr {
        let payload = self.thread.take().map(JoinHandle::join);
        let text = match &payload {
            Some(Err(panic)) => panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied()),
            _ => None,
        };
        PyRuntimeError::new_err(format!(
            "an error inside octray, please report it: {}",
            text.unwrap_or("no message")
        ))
    }
}

/// Runs `work` to its end. On Ctrl-C the error is raised at once, and the work is told to stop.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    let mut task = Task::<T, ()>::start(move |cancel, _| work(cancel))?;
    loop {
        match task.next(py)? {
            Event::Result(result) => return Ok(result),
            Event::Message(()) | Event::Tick => {
                if let Err(error) = py.check_signals() {
                    task.cancel();
                    return Err(error);
                }
            }
        }
    }
}
