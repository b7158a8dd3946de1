//! Any bytes as a joint limit file: findings, never a panic; limits that are given are usable.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use robotc_core::diag::Sources;
use robotc_core::joint_limits;
use robotc_core::system::MemorySystem;

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("joint_limits.yaml");
    let mut system = MemorySystem::new();
    system.insert(path, bytes);
    let mut sources = Sources::new();
    let (limits, found) = joint_limits::load(&system, &mut sources, path);
    found.to_plain_text(&sources);
    for joint in limits.values() {
        let speeds = [joint.velocity, joint.acceleration, joint.jerk];
        assert!(speeds.into_iter().flatten().all(|x| x > 0.0 && x.is_finite()));
    }
});
