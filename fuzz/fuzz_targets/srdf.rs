//! Any bytes as an SRDF file: findings, never a panic.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use robotc_core::diag::Sources;
use robotc_core::srdf;
use robotc_core::system::MemorySystem;

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("robot.srdf");
    let mut system = MemorySystem::new();
    system.insert(path, bytes);
    let mut sources = Sources::new();
    let (_, found) = srdf::load(&system, &mut sources, path, None);
    found.to_plain_text(&sources);
});
