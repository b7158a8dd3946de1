//! The specifications that ship.

use std::path::Path;

use robotc_core::diag::Sources;
use robotc_core::spec::{load_robot, load_task};
use robotc_core::task::{Destination, Goal};

use super::disk::{Disk, parameters};

/// All files of a folder of specifications with this ending.
fn files(disk: &Disk, folder: &str, ending: &str) -> Vec<String> {
    let mut files: Vec<String> = std::fs::read_dir(disk.root.join(folder))
        .unwrap()
        .map(|entry| format!("{folder}/{}", entry.unwrap().file_name().into_string().unwrap()))
        .filter(|name| name.ends_with(ending))
        .collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

#[test]
fn robots_load_without_findings() {
    let disk = Disk::of_checkout("specs");
    for file in files(&disk, "robots", ".robot.toml") {
        let mut sources = Sources::new();
        let (spec, found) = load_robot(&disk, &mut sources, Path::new(&file), &parameters());
        assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
        let robot = spec.unwrap().robot;
        assert!(robot.arms.iter().all(|arm| arm.gripper.is_some() && arm.home.is_some()), "{file}");
        assert!(robot.model.dofs().iter().all(|dof| dof.dynamics.given == [true; 3]), "{file}");
    }
}

#[test]
fn tasks_load_without_findings() {
    let disk = Disk::of_checkout("specs");
    for file in files(&disk, "tasks", ".task.toml") {
        let mut sources = Sources::new();
        let (spec, found) = load_task(&disk, &mut sources, Path::new(&file), &parameters());
        assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
        let task = spec.unwrap().task;
        assert!(!task.goals.is_empty(), "{file}");
        for target in task.goals.iter().flat_map(Goal::targets) {
            if let Destination::Region { origin_height, .. } = &target.destination {
                assert!(origin_height.abs() < 1.0, "{file}: stands {origin_height} m above the surface");
            }
        }
    }
}
