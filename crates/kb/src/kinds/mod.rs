//! The artefact kinds: one file each, one line each in [`ALL`].

mod chain_reach;

pub use chain_reach::{ChainReach, ReachSphere};

use robotc_core::spec::{KindParameters, ParameterTable};

use crate::kind::{AnyKind, Entry};

/// All kinds, in the order in which documentation lists them.
pub const ALL: &[&dyn AnyKind] = &[&Entry::<ChainReach>::new()];

/// The kind of this name.
pub fn find(name: &str) -> Option<&'static dyn AnyKind> {
    ALL.iter().copied().find(|kind| kind.info().name == name)
}

/// The parameters of all kinds, for checking specifications.
pub fn parameter_table() -> ParameterTable {
    let row = |kind: &&dyn AnyKind| {
        let info = kind.info();
        KindParameters { kind: info.name, doc: info.doc, parameters: info.parameters }
    };
    ParameterTable { kinds: ALL.iter().map(row).collect() }
}
