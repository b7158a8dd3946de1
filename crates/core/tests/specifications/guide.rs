//! The guide to specifications: its tables of keys are generated, and its examples are read.

use std::path::{Path, PathBuf};

use robotc_core::diag::Sources;
use robotc_core::spec::{SpecKind, json_schema, load_robot, load_task, reference};
use robotc_core::system::{MemorySystem, System};

use super::disk::{Disk, compare, parameters};

fn guide() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guides/specs.md")
}

/// The text with everything between the two markers replaced.
fn with_keys(text: &str, kind: &str, keys: &str) -> String {
    let begin = format!("<!-- keys: {kind} -->\n");
    let (before, rest) = text.split_once(&begin).expect("the guide has a place for the keys");
    let (_, after) = rest.split_once("<!-- end of keys -->").expect("the place has an end");
    format!("{before}{begin}\n{keys}\n<!-- end of keys -->{after}")
}

#[test]
fn tables_of_keys_are_those_of_the_schema() {
    let text = std::fs::read_to_string(guide()).unwrap();
    let text = with_keys(&text, "robot", &reference(SpecKind::Robot));
    let text = with_keys(&text, "task", &reference(SpecKind::Task));
    compare(&guide(), &text).unwrap();
}

#[test]
fn examples_of_the_guide_load() {
    let text = std::fs::read_to_string(guide()).unwrap();
    let examples: Vec<&str> =
        text.split("```toml\n").skip(1).map(|rest| rest.split_once("```").unwrap().0).collect();
    let [robot, task] = examples[..] else { panic!("a robot and a task: {}", examples.len()) };
    let disk = Disk::of_checkout("tests/specs/files");
    let mut system = MemorySystem::new();
    system.insert("robots/arm.urdf", disk.read(Path::new("arm.urdf")).unwrap());
    system.insert("robots/small.robot.toml", robot);
    system.insert("tasks/mug.task.toml", task);
    system.insert(
        "tasks/mug.obj",
        "v 0 0 0\nv 80 0 0\nv 0 80 0\nv 0 0 90\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    );
    let mut sources = Sources::new();
    let (spec, found) =
        load_robot(&system, &mut sources, Path::new("robots/small.robot.toml"), &parameters());
    assert!(spec.is_some(), "{}", found.to_plain_text(&sources));
    let mut sources = Sources::new();
    let (spec, found) = load_task(&system, &mut sources, Path::new("tasks/mug.task.toml"), &parameters());
    assert!(spec.is_some(), "{}", found.to_plain_text(&sources));
}

#[test]
fn json_schemas_are_as_reviewed() {
    let folder = Disk::of_checkout("tests/specs/schema").root;
    for (kind, file) in [(SpecKind::Robot, "robot.schema.json"), (SpecKind::Task, "task.schema.json")] {
        compare(&folder.join(file), &json_schema(kind, &parameters())).unwrap();
    }
}
