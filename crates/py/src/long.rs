//! Long calls: without the interpreter lock, with progress, and stopped by Ctrl-C.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// How often Python is asked whether Ctrl-C was pressed: often enough to feel immediate.
const ASK: Duration = Duration::from_millis(50);

/// Shared by a long call and the code that it runs: asks Python now and then whether to go on.
pub(crate) struct Interrupts {
    stop: AtomicBool,
    raised: Mutex<Option<PyErr>>,
    asked: Mutex<Instant>,
}

impl Interrupts {
    pub(crate) fn new() -> Self {
        Self { stop: AtomicBool::new(false), raised: Mutex::new(None), asked: Mutex::new(Instant::now()) }
    }

    /// Whether to stop. Called from any thread, with or without the interpreter lock.
    pub(crate) fn stop(&self) -> bool {
        if self.stop.load(Ordering::Relaxed) {
            return true;
        }
        if let Ok(mut asked) = self.asked.try_lock()
            && asked.elapsed() >= ASK
        {
            *asked = Instant::now();
            self.keep(Python::attach(|py| py.check_signals()));
        }
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

    /// The exception that stopped the call, if one did.
    pub(crate) fn outcome(self) -> PyResult<()> {
        match self.raised.into_inner() {
            Ok(Some(error)) => Err(error),
            _ => Ok(()),
        }
    }
}
