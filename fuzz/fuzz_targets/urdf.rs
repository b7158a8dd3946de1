//! Any bytes as a URDF file: findings or a model, never a panic.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use robotc_core::diag::Sources;
use robotc_core::system::MemorySystem;
use robotc_core::urdf::{self, LoadOptions};

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("robot.urdf");
    let mut system = MemorySystem::new();
    system.insert(path, bytes);
    let mut sources = Sources::new();
    let (model, found) = urdf::load(&system, &mut sources, path, &LoadOptions::default());
    assert_eq!(model.is_none(), found.has_errors());
    found.to_plain_text(&sources);
});
