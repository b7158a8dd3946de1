//! What a compilation tells while it runs, and how it is stopped.

use thiserror::Error;

use crate::depot::{DepotError, TransferError};
use crate::explain::Reason;
use crate::resolve::LoadError;
use crate::store::StoreError;

/// Why an artefact could not be computed.
#[derive(Debug, Error)]
pub enum BuildError {
    /// The caller asked to stop.
    #[error("interrupted")]
    Cancelled,
    /// The inputs have no such artefact; the text says why.
    #[error("{0}")]
    Impossible(String),
    /// The artefact failed its own check: a bug of the kind, and nothing was stored.
    #[error("the result failed its check and was not stored: {0}")]
    Check(String),
    /// Other processes have not done their shards yet.
    #[error("{missing} of {pieces} pieces are still to be computed by others")]
    Unfinished {
        /// Pieces that are not there.
        missing: usize,
        /// Pieces in all.
        pieces: usize,
    },
    /// An input could not be loaded.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The depot of pieces failed.
    #[error(transparent)]
    Depot(#[from] DepotError),
    /// The depot of finished artefacts failed.
    #[error(transparent)]
    Transfer(#[from] TransferError),
}

/// What happens while compiling.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// Another process is computing; this one waits for it.
    Waiting,
    /// An artefact is being computed.
    Started {
        /// Name of the kind.
        kind: &'static str,
        /// What it is about.
        subject: &'a str,
        /// Why.
        reason: &'a Reason,
    },
    /// So much of an artefact is computed. Events may come from several threads and out of order.
    Progress {
        /// Name of the kind.
        kind: &'static str,
        /// What it is about.
        subject: &'a str,
        /// Items done.
        done: u64,
        /// Items in all.
        total: u64,
    },
    /// Something about an artefact that is being computed which its user should know.
    Warning {
        /// Name of the kind.
        kind: &'static str,
        /// What it is about.
        subject: &'a str,
        /// What, as a sentence.
        message: &'a str,
    },
    /// An artefact was brought from the depot that the store is shared in.
    Brought {
        /// Name of the kind.
        kind: &'static str,
        /// What it is about.
        subject: &'a str,
    },
    /// An artefact is stored.
    Stored {
        /// Name of the kind.
        kind: &'static str,
        /// What it is about.
        subject: &'a str,
        /// Number of bytes.
        size: usize,
    },
    /// An artefact could not be computed.
    Failed {
        /// Name of the kind.
        kind: &'static str,
        /// What it is about.
        subject: &'a str,
        /// Why.
        error: &'a BuildError,
    },
}

/// Watches a compilation and may stop it. Called from several threads.
pub trait Observer: Sync {
    /// Something happened.
    fn event(&self, event: Event<'_>);

    /// Whether to stop; asked often.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Watches nothing.
impl Observer for () {
    fn event(&self, _event: Event<'_>) {}
}
