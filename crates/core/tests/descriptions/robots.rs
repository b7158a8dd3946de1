//! Complete robots with their meshes.

use robotc_core::urdf::MeshPolicy;

use crate::data::{files, load, shared};

#[test]
fn every_robot_loads_with_its_meshes() {
    let Some(folder) = shared().map(|s| s.join("robots")) else { return };
    for path in files(&folder, "urdf") {
        let (model, _, text) = load(&path, MeshPolicy::Load);
        println!("{} {}", path.display(), model.is_some());
        println!("{text}");
    }
}
