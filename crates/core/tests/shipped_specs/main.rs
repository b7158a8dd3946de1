//! The robots and tasks in `specs/`: they load without a finding, what a robot touches with contains what is seen of
//! it, robots start free, objects stand on something, and frames agree with the vendors' descriptions.
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

mod shapes;
mod tasks;
mod vendors;

use std::path::{Path, PathBuf};

use robotc_core::diag::Sources;
use robotc_core::model::RobotModel;
use robotc_core::spec::{self, ParameterTable, TaskSpec};
use robotc_core::system::{ReadError, System};
use robotc_core::urdf::{self, LoadOptions, MeshPolicy};

/// The files of this machine.
pub(crate) struct Disk;

impl System for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        std::fs::read(path).map_err(|error| ReadError::Unreadable(error.to_string()))
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }
}

pub(crate) fn specs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs")
}

/// Files below `folder` whose name ends with `ending`, in order.
pub(crate) fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("specs are part of the repository") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

pub(crate) fn load(path: &Path, meshes: MeshPolicy) -> RobotModel {
    let mut sources = Sources::default();
    let (model, found) =
        urdf::load(&Disk, &mut sources, path, &LoadOptions { meshes, ..LoadOptions::default() });
    model.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)))
}

pub(crate) fn load_task(path: &Path) -> TaskSpec {
    let mut sources = Sources::default();
    let (task, found) = spec::load_task(&Disk, &mut sources, path, &ParameterTable::default());
    assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
    task.expect("no finding, so a task")
}

/// The folder of real files, or `None` (told on the terminal) where there is none.
pub(crate) fn shared() -> Option<PathBuf> {
    let given = std::env::var_os("ROBOTC_SHARED_DATA").map(PathBuf::from);
    let folder = given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"));
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: shared data not present");
    None
}
