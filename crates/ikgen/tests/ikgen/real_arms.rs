//! Real descriptions, one for each class.

use std::path::{Path, PathBuf};

use robotc_core::Seed;
use robotc_core::system::{ReadError, System};
use robotc_core::urdf::{LoadOptions, MeshPolicy, load};
use robotc_core::{Kinematics, SerialChain, Sources};
use robotc_ikgen::report::complete::completeness;
use robotc_ikgen::report::{ProofOptions, poses, prove};
use robotc_ikgen::{Options, compile};

struct Files;

impl System for Files {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        std::fs::read(path).map_err(|e| ReadError::Unreadable(e.to_string()))
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }
}

/// The chain of an arm of the shared data; `None`, and said so, where the data are not.
pub(crate) fn real(file: &str, base: &str, tip: &str) -> Option<SerialChain> {
    let folder = std::env::var_os("ROBOTC_SHARED_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    if !folder.join("arms").exists() {
        println!("skipped: shared data not present");
        return None;
    }
    let options = LoadOptions { meshes: MeshPolicy::Ignore, ..LoadOptions::default() };
    let path = folder.join("arms").join(format!("{file}.urdf"));
    let (model, _) = load(&Files, &mut Sources::new(), &path, &options);
    let kinematics = Kinematics::new(model.unwrap().into());
    let link = |name| kinematics.model().link_named(name).unwrap();
    Some(SerialChain::between(&kinematics, link(base), link(tip)).unwrap())
}

#[test]
fn real_arms_are_solved() {
    for (file, base, tip, class) in [
        ("kuka_kr10r1420", "base_link", "tool0", "6R spherical wrist, axes 2 and 3 parallel"),
        ("ur_ur5e", "world", "tool0", "6R three parallel axes 2-3-4"),
        ("franka_panda", "panda_link0", "panda_link8", "7R spherical shoulder, axes 1 and 2 meeting"),
        ("fetch_fetch", "torso_lift_link", "gripper_link", "7R spherical wrist, general shoulder"),
    ] {
        let Some(chain) = real(file, base, tip) else { return };
        let compiled = compile(&chain, &Options::default()).unwrap_or_else(|r| panic!("{file}: {r}"));
        assert!(compiled.class.starts_with(class), "{file}: {}", compiled.class);
        let report = prove(&compiled, 0.0, &ProofOptions { poses: 200, seed: 1 }, &|| 0.0);
        assert!(report.emitted, "{file}: {}", report.reason);
        for set in &report.sets {
            assert_eq!((set.solved, set.wrong), (set.poses, 0), "{file}: {set:?}");
        }
    }
}

#[test]
fn no_solution_is_lost_on_the_grid_of_right_angles_but_near_singular_ones() {
    // At many of these poses orders of elimination break down, or solutions share two of the angles.
    for (file, base, tip) in [
        ("niryo_ned2", "base_link", "tool_link"),
        ("ufactory_xarm6", "link_base", "link6"),
        ("neuromeka_indy7", "link0", "tcp"),
    ] {
        let Some(chain) = real(file, base, tip) else { return };
        let compiled = compile(&chain, &Options::default()).unwrap_or_else(|r| panic!("{file}: {r}"));
        let sets = poses::sets(&chain, &[], 60, Seed::new(7));
        let grid = sets.iter().find(|set| set.name == "grid90").unwrap();
        let found = completeness(&chain, &compiled.solver(), &grid.vectors, 0.02);
        assert!(found.solutions > 200 && found.lost == 0, "{file}: {found:?}");
    }
}
