//! Malformed and odd files: each loads with a warning, or is refused with a place and a reason.

use robotc_core::urdf::MeshPolicy;

use crate::data::{files, load, shared};

#[test]
fn every_broken_file_has_a_clear_outcome() {
    let Some(folder) = shared().map(|s| s.join("broken-urdf")) else { return };
    for path in files(&folder, "urdf") {
        let (model, _, text) = load(&path, MeshPolicy::Ignore);
        println!("{} {}", path.display(), model.is_some());
        println!("{}", text.lines().take(8).collect::<Vec<_>>().join("\n"));
    }
}
