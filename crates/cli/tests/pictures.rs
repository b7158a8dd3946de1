//! Pictures of bases against exact inverse kinematics: what is drawn on the floor is where the arm can stand.

use std::path::Path;
use std::sync::Arc;

use robotc_core::spec::{self, ParameterValue};
use robotc_core::{Kinematics, LinkPoses, Pose, Sources};
use robotc_kb::kinds::GraspSet;
use robotc_kb::kinds::reachability::{ArmAlone, Placement, Scratch};
use robotc_kb::os::OsSystem;
use robotc_kb::project::OfGripperAndObject;
use robotc_kb::{Graph, Knowledge, Project, Store, compile};
use robotc_runtime::picture::{NoPicture, picture, plot};
use robotc_runtime::record::{Node, Recording};

/// The task of the transcripts, with a map fine enough to trust.
fn compiled(folder: &Path) -> Knowledge {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/tidy.task.toml");
    let table = robotc_kb::kinds::parameter_table();
    let (spec, _) = spec::load_task(&OsSystem, &mut Sources::new(), &file, &table);
    let mut spec = spec.expect("a task without errors");
    spec.parameters.set("reachability", "step", ParameterValue::Number(0.06));
    let graph = Arc::new(Graph::plan(&Project::of_task(&spec)).expect("a graph"));
    let report =
        compile(&graph, &Arc::new(Store::open(folder).expect("a store")), &()).expect("a store that works");
    assert!(report.complete());
    report.knowledge
}

/// Tips of all grasps of the block where it stands, in the frame of the robot's root.
fn root_from_tips(knowledge: &Knowledge) -> Vec<Pose> {
    let project = knowledge.graph().project();
    let (robot, task) = (project.robot(), project.task().expect("a task"));
    let mut links = LinkPoses::default();
    Kinematics::new(robot.model.clone()).link_poses(&task.start, &mut links);
    let gripper = &robot.grippers[0];
    let tip_from_tool =
        links.root_from(robot.arms[0].tip).inv_mul(links.root_from(gripper.palm)) * gripper.palm_from_tool;
    let root_from_object = task.world_from_robot.inv_mul(&task.objects[0].world_from_object);
    let grasps = knowledge.load::<GraspSet>(&OfGripperAndObject { gripper: 0, object: 0 }).expect("compiled");
    grasps.iter().map(|grasp| root_from_object * grasp.object_from_tool * tip_from_tool.inverse()).collect()
}

/// The bases that arrows of a node stand for: each is a shaft and a head of three points.
fn bases(node: &Node) -> Vec<Placement> {
    let points = &node.lines[0].points;
    assert_eq!(points.len() % 5, 0);
    let base = |arrow: &[[f32; 3]]| {
        let [from, to] = [arrow[0], arrow[1]].map(|p| p.map(f64::from));
        let yaw = (to[1] - from[1]).atan2(to[0] - from[0]);
        Placement { position: [from[0], from[1]], yaw, target: 0, mount: 0 }
    };
    points.chunks(5).map(base).collect()
}

/// The squares of the floor that are drawn, two triangles each: middle and side.
fn tiles(recording: &Recording, node: &Node) -> Vec<([f64; 2], f64)> {
    let mut tiles = Vec::new();
    for part in &node.parts {
        let surface = &recording.surfaces()[part.surface];
        for pair in surface.triangles.chunks(2) {
            let corners =
                pair.iter().flatten().map(|&corner| surface.positions[corner as usize].map(f64::from));
            let range = |k: usize| {
                let along = corners.clone().map(|corner| corner[k]);
                (along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max))
            };
            let ((left, right), (near, far)) = (range(0), range(1));
            tiles.push(([0.5 * (left + right), 0.5 * (near + far)], right - left));
        }
    }
    tiles
}

#[test]
fn bases_are_drawn_where_the_arm_reaches() {
    let folder = tempfile::tempdir().expect("a folder");
    let knowledge = compiled(folder.path());
    let recording = picture(&knowledge, "base_placement", "block").expect("a picture");
    let node = recording.nodes().iter().find(|node| node.name == "bases for block").expect("a node of bases");
    assert!(recording.nodes().iter().any(|node| node.name == "block"), "the object is drawn too");

    // Exact inverse kinematics reaches some grasp from the bases that are drawn.
    let arm = ArmAlone::load(&knowledge, 0).expect("compiled");
    let (tips, mut scratch) = (root_from_tips(&knowledge), Scratch::default());
    let mut reaches = |base: &Placement| {
        let base_from_root = base.world_from_mobile().inverse();
        tips.iter().any(|tip| arm.reach(&(base_from_root * tip), 1, &mut scratch).is_some())
    };
    let drawn = bases(node);
    assert_eq!(drawn.len(), 24);
    let good = drawn.iter().filter(|base| reaches(base)).count();
    assert!(good >= 22, "{good} of {} bases reach", drawn.len());

    // They stand on squares that are drawn.
    let tiles = tiles(&recording, node);
    let on = |base: &Placement| {
        let near = |(middle, side): &([f64; 2], f64)| {
            (0..2).all(|k| (middle[k] - base.position[k]).abs() < 1.6 * side)
        };
        tiles.iter().any(near)
    };
    assert!(drawn.iter().all(on), "a base stands beside all squares");

    // The plot has the same squares, and all of the weight.
    let panels = plot(&knowledge, "base_placement", "block").expect("a plot").expect("bases have one");
    let [panel] = &panels[..] else { panic!("{} panels", panels.len()) };
    let weight: f64 = panel.values.iter().sum();
    assert!((weight - 1.0).abs() < 1e-9, "{weight}");
    let shown = panel.values.iter().filter(|value| **value > 0.0).count();
    assert_eq!(shown, tiles.len());
    let text = robotc_runtime::picture::plot::svg(&panels);
    assert!(text.contains("grasps of block") && text.contains("robot"), "{text}");

    let kettle = |error| matches!(error, NoPicture::Subject { subject, .. } if subject == "kettle");
    assert!(kettle(picture(&knowledge, "base_placement", "kettle").expect_err("no kettle")));
    assert!(kettle(plot(&knowledge, "base_placement", "kettle").expect_err("no kettle")));
}
