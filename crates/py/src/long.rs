//! Long calls: without the interpreter lock, with progress, and stopped by Ctrl-C.

use std::panic::resume_unwind;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pyo3::prelude::*;

/// How often Python is asked whether Ctrl-C was pressed: often enough to feel immediate.
const ASK: Duration = Duration::from_millis(50);

/// Whether a long call shall go on, for the code that it runs; from any thread.
#[derive(Default)]
pub(crate) struct Interrupts {
    stop: AtomicBool,
    raised: Mutex<Option<PyErr>>,
}

impl Interrupts {
    /// Whether to stop.
    pub(crate) fn stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Keeps an exception and stops; the first one counts.
    pub(crate) fn keep(&self, result: PyResult<()>) {
        if let Err(error) = result {
            self.stop.store(true, Ordering::Relaxed);
            if let Ok(mut raised) = self.raised.lock() {
                raised.get_or_insert(error);
            }
        }
    }
}

/// Runs `work` without the interpreter lock; an exception that came up meanwhile wins over its result.
///
/// The work has a thread of its own, because Python tells of Ctrl-C in its main thread only, which is mostly the one
/// that called: it waits here and asks.
pub(crate) fn run<R: Send>(py: Python<'_>, work: impl FnOnce(&Interrupts) -> R + Send) -> PyResult<R> {
    let interrupts = Interrupts::default();
    let result = py.detach(|| {
        std::thread::scope(|scope| {
            let (working, ended) = mpsc::channel::<()>();
            let interrupts = &interrupts;
            let worker = scope.spawn(move || {
                // Dropped when the work ends in whatever way, which closes the channel.
                let _working = working;
                work(interrupts)
            });
            while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(ASK) {
                interrupts.keep(Python::attach(|py| py.check_signals()));
            }
            worker.join().unwrap_or_else(|panic| resume_unwind(panic))
        })
    });
    match interrupts.raised.into_inner() {
        Ok(Some(error)) => Err(error),
        _ => Ok(result),
    }
}
