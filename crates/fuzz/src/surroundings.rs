//! What stands around the bytes of a description or a specification, and what is asked of every finding about them.

use robotc_core::diag::{Diagnostics, Sources};
use robotc_core::spec::ParameterTable;
use robotc_core::system::MemorySystem;

/// Files beside the specification, by the names that those of `tests/specs` use.
const FILES: &[(&str, &str)] = &[
    ("files/arm.urdf", include_str!("../../../tests/specs/files/arm.urdf")),
    ("files/arm.srdf", include_str!("../../../tests/specs/files/arm.srdf")),
    ("files/joint_limits.yaml", include_str!("../../../tests/specs/files/joint_limits.yaml")),
    ("files/small.robot.toml", include_str!("../../../tests/specs/files/small.robot.toml")),
    ("files/semantic.robot.toml", include_str!("../../../tests/specs/files/semantic.robot.toml")),
    ("files/two_arms.robot.toml", include_str!("../../../tests/specs/files/two_arms.robot.toml")),
    ("files/wedge.obj", include_str!("../../../tests/specs/files/wedge.obj")),
    ("files/flat.obj", include_str!("../../../tests/specs/files/flat.obj")),
];

/// A table of parameters in which no kind is known.
pub(crate) fn no_parameters() -> ParameterTable {
    ParameterTable { kinds: Vec::new() }
}

/// The files that descriptions and specifications can refer to.
pub(crate) fn surroundings() -> MemorySystem {
    let mut system = MemorySystem::new();
    for (name, text) in FILES {
        system.insert(*name, *text);
    }
    system
}

/// Every finding has a place that can be shown.
pub(crate) fn shown(found: &Diagnostics, sources: &Sources) {
    assert!(found.is_empty() || !found.to_plain_text(sources).is_empty());
}
