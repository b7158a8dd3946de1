//! The shipped descriptions beside the vendors', and specifications over the vendors' files.

use std::path::Path;
use std::sync::Arc;

use robotc_core::Pose;
use robotc_core::diag::Sources;
use robotc_core::model::{Configuration, Kinematics, LinkPoses, RobotModel};
use robotc_core::spec::{self, ParameterTable};
use robotc_core::urdf::MeshPolicy;

use crate::shapes::corners;
use crate::tasks::lifted_gaps;
use crate::{Disk, files, load, shared, specs};

/// A shipped robot, a real description, links and joints of both that are the same.
struct Twin {
    ours: &'static str,
    theirs: &'static str,
    links: &'static [(&'static str, &'static str)],
    joints: &'static [(&'static str, &'static str)],
}

const TWINS: &[Twin] = &[
    Twin {
        ours: "panda/panda.urdf",
        theirs: "robots/franka_panda_hand/panda.urdf",
        links: &[
            ("panda_link0", "panda_link0"),
            ("panda_link1", "panda_link1"),
            ("panda_link2", "panda_link2"),
            ("panda_link3", "panda_link3"),
            ("panda_link4", "panda_link4"),
            ("panda_link5", "panda_link5"),
            ("panda_link6", "panda_link6"),
            ("panda_link7", "panda_link7"),
            ("panda_link8", "panda_link8"),
            ("panda_hand", "panda_hand"),
            ("panda_leftfinger", "panda_leftfinger"),
        ],
        joints: &[
            ("panda_joint1", "panda_joint1"),
            ("panda_joint2", "panda_joint2"),
            ("panda_joint3", "panda_joint3"),
            ("panda_joint4", "panda_joint4"),
            ("panda_joint5", "panda_joint5"),
            ("panda_joint6", "panda_joint6"),
            ("panda_joint7", "panda_joint7"),
            ("panda_finger_joint1", "panda_finger_joint1"),
        ],
    },
    Twin {
        ours: "ur5e/ur5e.urdf",
        theirs: "arms/ur_ur5e.urdf",
        links: &[
            ("base_link", "base_link"),
            ("shoulder_link", "shoulder_link"),
            ("upper_arm_link", "upper_arm_link"),
            ("forearm_link", "forearm_link"),
            ("wrist_1_link", "wrist_1_link"),
            ("wrist_2_link", "wrist_2_link"),
            ("wrist_3_link", "wrist_3_link"),
            ("tool0", "tool0"),
        ],
        joints: &[
            ("shoulder_pan_joint", "shoulder_pan_joint"),
            ("shoulder_lift_joint", "shoulder_lift_joint"),
            ("elbow_joint", "elbow_joint"),
            ("wrist_1_joint", "wrist_1_joint"),
            ("wrist_2_joint", "wrist_2_joint"),
            ("wrist_3_joint", "wrist_3_joint"),
        ],
    },
    Twin {
        ours: "wam/wam.urdf",
        theirs: "robots/barrett_wam7_bhand/wam7_bhand.urdf",
        links: &[
            ("base_link", "wam/base_link"),
            ("shoulder_yaw_link", "wam/shoulder_yaw_link"),
            ("shoulder_pitch_link", "wam/shoulder_pitch_link"),
            ("upper_arm_link", "wam/upper_arm_link"),
            ("forearm_link", "wam/forearm_link"),
            ("wrist_yaw_link", "wam/wrist_yaw_link"),
            ("wrist_pitch_link", "wam/wrist_pitch_link"),
            ("wrist_palm_link", "wam/wrist_palm_link"),
            ("hand_palm", "wam/bhand/bhand_palm_link"),
            ("finger_1_inner_link", "wam/bhand/finger_1/med_link"),
            ("finger_3_inner_link", "wam/bhand/finger_3/med_link"),
        ],
        joints: &[
            ("base_yaw_joint", "wam/base_yaw_joint"),
            ("shoulder_pitch_joint", "wam/shoulder_pitch_joint"),
            ("shoulder_yaw_joint", "wam/shoulder_yaw_joint"),
            ("elbow_pitch_joint", "wam/elbow_pitch_joint"),
            ("wrist_yaw_joint", "wam/wrist_yaw_joint"),
            ("wrist_pitch_joint", "wam/wrist_pitch_joint"),
            ("palm_yaw_joint", "wam/palm_yaw_joint"),
            ("finger_1_spread_joint", "wam/bhand/finger_1/prox_joint"),
            ("finger_1_inner_joint", "wam/bhand/finger_1/med_joint"),
            ("finger_3_inner_joint", "wam/bhand/finger_3/med_joint"),
        ],
    },
];

/// Poses of named links, relative to the first of them, with named joints at given values.
fn poses(model: &Arc<RobotModel>, joints: &[(&str, f64)], links: &[&str]) -> Vec<Pose> {
    let mut q = Configuration::neutral(model);
    for (joint, value) in joints {
        q.set(&[model.dof_named(joint).expect(joint)], &[*value]);
    }
    let mut poses = LinkPoses::default();
    Kinematics::new(Arc::clone(model)).link_poses(&q, &mut poses);
    let of = |name: &str| *poses.root_from(model.link_named(name).expect(name));
    links.iter().map(|link| of(links[0]).inverse() * of(link)).collect()
}

#[test]
fn frames_agree_with_the_vendors() {
    let Some(shared) = shared() else { return };
    for twin in TWINS {
        let ours = Arc::new(load(&specs().join("robots").join(twin.ours), MeshPolicy::Ignore));
        let theirs = Arc::new(load(&shared.join(twin.theirs), MeshPolicy::Ignore));
        for round in 0..8 {
            let value = |i: usize| 1.4 * ((3 * i + 5 * round) as f64 * 0.7).sin();
            let values = |pick: fn(&(&'static str, &'static str)) -> &'static str| -> Vec<(&str, f64)> {
                twin.joints.iter().enumerate().map(|(i, pair)| (pick(pair), value(i))).collect()
            };
            let names = |pick: fn(&(&'static str, &'static str)) -> &'static str| -> Vec<&str> {
                twin.links.iter().map(pick).collect()
            };
            let a = poses(&ours, &values(|pair| pair.0), &names(|pair| pair.0));
            let b = poses(&theirs, &values(|pair| pair.1), &names(|pair| pair.1));
            for ((a, b), (name, _)) in a.iter().zip(&b).zip(twin.links) {
                let gap = (a.to_homogeneous() - b.to_homogeneous()).abs().max();
                assert!(gap < 1e-8, "{}: {name} is {gap} off", twin.ours);
            }
        }
    }
}

#[test]
fn vendor_specifications_load() {
    // They name the shared folder by a path relative to themselves.
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if shared().is_none() || !beside.is_dir() {
        return;
    }
    let tasks = files(&specs().join("../tests/vendor"), ".task.toml");
    assert_eq!(tasks.len(), 4);
    for path in tasks {
        let mut sources = Sources::default();
        let (task, found) = spec::load_task(&Disk, &mut sources, &path, &ParameterTable::default());
        let task = task.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources))).task;
        for object in &task.objects {
            let lowest = object.geometry.iter().flat_map(corners).map(|p| (object.world_from_object * p).z);
            let lowest = lowest.fold(f64::INFINITY, f64::min);
            assert!((lowest - 0.6).abs() < 0.009, "{} starts at height {lowest}", object.name);
        }
        for (name, gap) in lifted_gaps(&task, 0.003) {
            assert!(gap > 0.001, "{}: {name} sticks in something", path.display());
        }
    }
}
