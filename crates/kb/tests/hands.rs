//! Real hands and real objects, a few of each: a grasp set or a clear message, never a panic; what is wrong with a mesh is said.
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use std::path::Path;
use std::sync::Arc;

use robotc_core::Sources;
use robotc_core::spec::{ParameterValue, load_task};
use robotc_kb::kind::{AnyKind, Entry};
use robotc_kb::kinds::{GraspSet, parameter_table};
use robotc_kb::os::OsSystem;
use robotc_kb::project::OfGripperAndObject;
use robotc_kb::{Graph, Project, Store, compile};

/// A robot of `tests/vendor`, a mesh below `objects/` with how to read it, and whether its surface is sound. All of them with all:
/// `examples/grasp_campaign.rs`.
const PAIRS: &[(&str, &str, &str, bool)] = &[
    ("panda", "household/mug.obj", "", false),
    ("xarm6_gripper", "industrial/ariac_regulator_collision.stl", "", true),
    ("fetch", "industrial/ariac_battery_collision.stl", "", true),
    ("wam", "household/bowl.dae", "", false),
    ("tiago", "household/tray_textured.obj", "scale = 0.2", true),
];

/// Of each grasp set; the default is many more.
const APPROACHES: i64 = 300;

#[test]
fn hands_and_objects_give_grasps_or_a_clear_message() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    // The specifications name the shared folder by a path relative to themselves.
    let Ok(data) = root.join("../shared/data").canonicalize() else {
        eprintln!("skipped: shared data not present");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let store = Arc::new(Store::open(&folder.path().join("store")).expect("a store"));
    let mut some = 0;
    for (robot, object, reading, sound) in PAIRS {
        let path = folder.path().join("object.task.toml");
        let robot = root.join(format!("tests/vendor/{robot}.robot.toml")).canonicalize().expect("a robot");
        let text = format!(
            "format = 1\nname = \"t\"\nrobot = \"{}\"\n[[object]]\nname = \"o\"\nmesh = \"{}\"\n{reading}\nmass = 0.3\n[[goal]]\n\
             place = \"o\"\nat = {{ xyz = [0.5, 0.0, 0.0] }}\n",
            robot.display(),
            data.join("objects").join(object).display(),
        );
        std::fs::write(&path, text).expect("a file");
        let mut sources = Sources::new();
        let (spec, found) = load_task(&OsSystem, &mut sources, &path, &parameter_table());
        let mut spec = spec.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)));
        let warned = found.to_plain_text(&sources).contains(object.rsplit('/').next().expect("a name"));
        assert_eq!(warned, !sound, "{object}: {}", found.to_plain_text(&sources));
        for (name, value) in [("approaches", APPROACHES), ("repeats", 4), ("most_grasps", 20)] {
            spec.parameters.set("grasp_set", name, ParameterValue::Integer(value));
        }
        let project = Project::of_task(&spec);
        static GRASPS: Entry<GraspSet> = Entry::new();
        let graph = Graph::plan_kinds(&project, &[&GRASPS as &'static dyn AnyKind]).expect("a graph");
        let report = compile(&Arc::new(graph), &store, &()).expect("a store that works");
        if let Some((_, error)) = report.failed().next() {
            assert!(error.to_string().len() > 10, "{robot:?} and {object}: {error}");
            continue;
        }
        let gripper = spec.task.robot.arms[spec.task.arm].gripper.expect("a task has a gripper");
        let grasps = report.knowledge.load::<GraspSet>(&OfGripperAndObject { gripper, object: 0 });
        for grasp in grasps.expect("a set").iter() {
            assert!(grasp.epsilon > 0.0 && grasp.contacts.len() >= 2);
            some += 1;
        }
    }
    assert!(some > 20, "{some} grasps");
}
