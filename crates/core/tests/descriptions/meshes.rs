//! Meshes of real robots against `mesh-loader`, an independent reader, where that one can be trusted: STL and OBJ.

use robotc_core::mesh;

use crate::data::{files, shared};

#[test]
fn stl_and_obj_agree_with_another_reader() {
    let Some(folder) = shared() else { return };
    let mut compared = 0;
    for part in ["robots", "motionbenchmaker"] {
        for ending in ["stl", "obj"] {
            for path in files(&folder.join(part), ending) {
                let bytes = std::fs::read(&path).unwrap();
                let ours = mesh::read(&bytes, ending).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                let theirs = match ending {
                    "stl" => mesh_loader::stl::from_slice(&bytes),
                    _ => mesh_loader::Loader::default().load_obj_from_slice(&bytes, &path),
                };
                let Ok(theirs) = theirs else { continue };
                let faces: usize = theirs.meshes.iter().map(|m| m.faces.len()).sum();
                let kept = ours.mesh.faces.len() + ours.repairs.degenerate + ours.repairs.bad_indices;
                assert_eq!(kept, faces, "{}", path.display());
                let used = theirs
                    .meshes
                    .iter()
                    .flat_map(|m| m.faces.iter().flatten().map(|&v| m.vertices[v as usize]));
                let (low, high) = ours.mesh.bounds().unwrap();
                for axis in 0..3 {
                    let (a, b) =
                        used.clone().fold((f32::MAX, f32::MIN), |(a, b), v| (a.min(v[axis]), b.max(v[axis])));
                    let apart = (low[axis] - f64::from(a)).abs().max((high[axis] - f64::from(b)).abs());
                    assert!(apart < 1e-5 * (1.0 + f64::from(b - a)), "{}: {apart}", path.display());
                }
                compared += 1;
            }
        }
    }
    println!("{compared} meshes compared");
    assert!(compared > 100, "{compared}");
}
