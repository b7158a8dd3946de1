//! The knowledge base: what `robotc` computes ahead of time, and how it knows what to compute again.
//!
//! A [`Project`] (a checked robot, perhaps with a task) is planned into a [`Graph`] of artefacts. Each node belongs to
//! a [`Kind`] (one file in [`kinds`]), sees a narrow projection of the project and other artefacts, and is named by
//!
//! - a [`RecipeId`], known before anything is built: what would be computed, from which recipes;
//! - a [`Key`], known once the inputs are built: the same with the contents of the inputs, so that an input which was
//!   rebuilt with equal bytes stops the change there;
//! - a [`ContentHash`]: the bytes that came out.
//!
//! A [`Store`] keeps artefacts by content and remembers which key gave which content. Keys are functions of numbers
//! as they were written in the specifications, of all parameters, and of the kind's revision: no path, time, host name or
//! environment variable takes part.
//!
//! The feature `build` adds the generators ([`compile()`], [`Build`]); without it the crate plans, resolves, loads and
//! verifies, and links no generator.

pub mod codec;
#[cfg(feature = "build")]
pub mod compile;
#[cfg(feature = "build")]
pub mod context;
pub mod depot;
pub mod explain;
pub mod formats;
pub mod graph;
pub mod key;
pub mod kind;
pub mod kinds;
pub mod lock;
#[cfg(feature = "build")]
pub mod observer;
pub mod os;
pub mod parameters;
pub mod project;
pub mod projection;
pub mod record;
pub mod resolve;
pub mod store;

#[cfg(feature = "build")]
pub use compile::{CompileReport, Outcome, build_node, compile};
#[cfg(feature = "build")]
pub use context::Shard;
pub use depot::Depot;
pub use graph::{Dep, Graph, NodeIdx, PlanError, Planner};
pub use key::{ContentHash, Key, RecipeId};
#[cfg(feature = "build")]
pub use kind::{Build, BuildError, Context};
pub use kind::{DecodeError, Kind, Portability};
pub use lock::{LockFile, Locked};
#[cfg(feature = "build")]
pub use observer::{Event, Observer};
pub use parameters::{Given, Parameters};
pub use project::Project;
pub use resolve::{Knowledge, LoadError};
pub use store::{Store, StoreError};
