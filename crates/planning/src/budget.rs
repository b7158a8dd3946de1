//! How long a search may run. The library reads no clock: the caller does, through a closure.

use std::fmt;

/// Why a search was told to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interrupt {
    /// The time is up.
    TimeUp,
    /// The caller no longer wants the result.
    Cancelled,
}

impl fmt::Display for Interrupt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TimeUp => "the time limit was reached",
            Self::Cancelled => "the search was cancelled",
        })
    }
}

/// Asked every iteration by all searches, so it should be cheap: a clock read or an atomic load.
///
/// A run that was never interrupted depends on its inputs and seed alone.
#[derive(Clone, Copy)]
pub struct Budget<'a> {
    interrupt: &'a dyn Fn() -> Option<Interrupt>,
}

impl<'a> Budget<'a> {
    /// Stops when `interrupt` says so.
    pub fn new(interrupt: &'a dyn Fn() -> Option<Interrupt>) -> Self {
        Self { interrupt }
    }

    /// Never stops; searches end by their own limits.
    pub fn unlimited() -> Budget<'static> {
        Budget { interrupt: &|| None }
    }

    /// `Err` when the search must stop now.
    pub fn check(&self) -> Result<(), Interrupt> {
        (self.interrupt)().map_or(Ok(()), Err)
    }
}

impl fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Budget")
    }
}
