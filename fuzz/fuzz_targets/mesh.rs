//! Any bytes as a mesh file of each format: an error or a sound mesh, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use robotc_core::mesh;

fuzz_target!(|bytes: &[u8]| {
    for extension in ["stl", "obj", "dae"] {
        if let Ok(loaded) = mesh::read(bytes, extension) {
            let count = loaded.mesh.vertices.len();
            assert!(loaded.mesh.faces.iter().flatten().all(|&v| (v as usize) < count));
            assert!(loaded.mesh.vertices.iter().all(|v| v.coords.iter().all(|x| x.is_finite())));
        }
    }
});
