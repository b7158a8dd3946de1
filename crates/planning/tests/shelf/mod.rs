//! A six-joint arm in front of a shelf.

use std::sync::Arc;

use robotc_core::Pose;
use robotc_core::model::{DynamicLimits, Geometry, JointMotion, Origin, RobotBuilder, RobotModel, Shape};
use robotc_core::srdf::Srdf;
use robotc_planning::bench::{BenchRobot, Obstacle, Problem};

fn geometry(xyz: [f64; 3], size: [f64; 3]) -> Vec<Geometry> {
    vec![Geometry { origin: Origin { xyz, rpy: [0.0; 3] }, shape: Shape::Box { size }, colour: None }]
}

/// Six links in a row, joints about z and y in turn.
fn arm() -> RobotModel {
    let mut builder = RobotBuilder::new("arm");
    builder.link("base", vec![], geometry([0.0, 0.0, 0.05], [0.2, 0.2, 0.1]), None);
    for i in 0..6 {
        let (parent, child) =
            if i == 0 { ("base".into(), "l0".into()) } else { (format!("l{}", i - 1), format!("l{i}")) };
        builder.link(&*child, vec![], geometry([0.0, 0.0, 0.12], [0.05, 0.05, 0.14]), None);
        let origin = Origin { xyz: [0.0, 0.0, 0.24], rpy: [0.0; 3] };
        let axis = if i % 2 == 0 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
        let limits = (-2.0, 2.0, false, DynamicLimits::DEFAULT);
        builder.moving(&format!("j{i}"), JointMotion::Revolute, &parent, &child, origin, axis, limits, None);
    }
    builder.build().unwrap()
}

/// From one compartment of a shelf to another one.
pub(crate) fn problem() -> Problem {
    let board = |i: usize, centre: [f64; 3], size: [f64; 3]| Obstacle {
        name: format!("board {i}"),
        geometry: Arc::new(geometry([0.0; 3], size)),
        root_from_obstacle: Pose::translation(centre[0], centre[1], centre[2]),
    };
    let boards = [
        ([0.75, 0.0, 0.85], [0.4, 1.2, 0.03]),
        ([0.75, 0.0, 0.45], [0.4, 1.2, 0.03]),
        ([0.75, 0.0, 0.65], [0.4, 0.03, 0.4]),
        ([0.75, 0.6, 0.65], [0.4, 0.03, 0.4]),
        ([0.75, -0.6, 0.65], [0.4, 0.03, 0.4]),
    ];
    Problem {
        scene: "shelf".into(),
        index: 0,
        start: vec![0.45, 1.2, 0.0, 0.4, 0.0, 0.0],
        goal: vec![-0.45, 1.2, 0.0, 0.4, 0.0, 0.0],
        other_joints: vec![],
        obstacles: boards.iter().enumerate().map(|(i, (centre, size))| board(i, *centre, *size)).collect(),
    }
}

/// The arm, all of its joints planned for.
pub(crate) fn robot() -> BenchRobot {
    let srdf = Srdf {
        name: "arm".into(),
        groups: vec![],
        end_effectors: vec![],
        states: vec![],
        disabled_pairs: vec![],
        passive_joints: vec![],
    };
    let joints: Vec<String> = (0..6).map(|i| format!("j{i}")).collect();
    BenchRobot::new(Arc::new(arm()), &srdf, &joints).unwrap()
}
