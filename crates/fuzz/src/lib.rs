//! What fuzzing calls: one function from bytes for each format that `robotc` reads.
//!
//! Each hands any bytes to a reader and asserts what the reader promises: findings or a value and never a panic, and that
//! what was read is written and read again alike. `fuzz/` drives them with libFuzzer (`cargo xtask fuzz`); the tests of this
//! crate replay the corpus that it left behind, with the stable compiler.

mod artefact;
mod description;
mod grasps;
mod program;
mod scan;
mod spec;
mod surroundings;

pub use artefact::wrapped;

/// A format that is fuzzed.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Name of the target and of its corpus.
    pub name: &'static str,
    /// Reads the bytes; panics where the reader breaks a promise.
    pub run: fn(&[u8]),
}

/// All of them, by name.
pub const TARGETS: &[Target] = &[
    Target { name: "artefact", run: artefact::artefact },
    Target { name: "grasps", run: grasps::grasps },
    Target { name: "joint_limits", run: description::joint_limits },
    Target { name: "mesh", run: description::mesh },
    Target { name: "program", run: program::program },
    Target { name: "scan", run: scan::scan },
    Target { name: "spec", run: spec::spec },
    Target { name: "srdf", run: description::srdf },
    Target { name: "urdf", run: description::urdf },
    Target { name: "xacro", run: description::xacro },
];

/// Runs the target of this name.
///
/// # Panics
///
/// When there is none, and when the reader breaks a promise.
pub fn run(name: &str, bytes: &[u8]) {
    let target = TARGETS.iter().find(|target| target.name == name).expect("a target of this name");
    (target.run)(bytes);
}
