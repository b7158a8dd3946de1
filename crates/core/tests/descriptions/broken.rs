//! Malformed and odd files: each loads with a warning, or is refused with a place and a reason.

use robotc_core::urdf::MeshPolicy;

use crate::data::{index, load, shared};

/// File, whether it loads, and the first finding that matters: line, column and code.
const OUTCOMES: [(&str, bool, &str); 19] = [
    ("Klampt-examples__human_hand.urdf", false, "344:3: error[R0201]"),
    ("bullet3__diff_ring.urdf", true, "2:1: warning[R0202]"),
    ("bullet3__humanoid.urdf", false, "40:28: error[R0220]"),
    ("bullet3__nao.urdf", true, ""),
    ("bullet3__sphere_small.urdf", true, "1:1: warning[R0202]"),
    ("bullet3__torus_deform.urdf", false, "2:1: error[R0207]"),
    ("example-robot-data__falcon.urdf", false, "182:38: error[R0212]"),
    ("example-robot-data__romeo_laas_small.urdf", true, ""),
    ("example-robot-data__ur3.urdf", false, "6:1: error[R0207]"),
    ("icub-models__model.urdf", true, ""),
    ("mycobot_ros__mycobot_280m5_with_gripper_parallel.urdf", false, "1:1: error[R0204]"),
    ("mycobot_ros__mycobot_pro_600_moveit.urdf", false, "11:1: error[R0204]"),
    ("mycobot_ros__mycobot_pro_630.urdf", false, "1:1: error[R0204]"),
    ("mycobot_ros__mycobot_with_vision_copy.urdf", true, "4:3: warning[R0211]"),
    ("rbpodo_ros2__rb_6dof.ros2_control.urdf", false, "6:1: error[R0207]"),
    ("rtmros_nextage__NextageOpen.urdf", true, "16:3: warning[R0211]"),
    ("unitree_ros__as2.urdf", true, "8:16: warning[R0221]"),
    ("unitree_ros__b2_description.urdf", true, "8:16: warning[R0221]"),
    ("urdf_files_dataset__fetch.urdf", true, "655:5: warning[R0203]"),
];

/// Names a link twice and hangs it on two joints: several errors, all told.
const SEVERAL: &str = "urdf_files_dataset__r2_left_gripper.urdf";

#[test]
fn every_broken_file_has_its_outcome() {
    let Some(folder) = shared().map(|s| s.join("broken-urdf")) else { return };
    let mut seen = 0;
    for (file, loads, first) in OUTCOMES {
        let path = folder.join(file);
        let (model, _, text) = load(&path, MeshPolicy::Ignore);
        assert_eq!(model.is_some(), loads, "{file}: {text}");
        let place = format!("{}:{first}", path.display());
        assert!(
            first.is_empty() == text.is_empty() && (first.is_empty() || text.contains(&place)),
            "{file}: {text}"
        );
        seen += 1;
    }
    let (model, _, text) = load(&folder.join(SEVERAL), MeshPolicy::Ignore);
    assert!(
        model.is_none() && text.contains(":57:19: error[R0212]") && text.contains(":58:18: error[R0214]"),
        "{text}"
    );
    let listed: std::collections::BTreeSet<String> =
        index(&folder).iter().map(|row| row.get("file").to_owned()).collect();
    assert_eq!(seen + 1, listed.len(), "the index lists a file that is not tried here");
}
