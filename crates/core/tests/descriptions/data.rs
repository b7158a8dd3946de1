//! Where the real files are, and a `System` that reads them.

use std::path::{Path, PathBuf};

use robotc_core::diag::{Diagnostics, Sources};
use robotc_core::model::RobotModel;
use robotc_core::system::{ReadError, System};
use robotc_core::urdf::{self, LoadOptions, MeshPolicy};

/// The files of this machine.
pub(crate) struct Disk;

impl System for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        std::fs::read(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => ReadError::NotFound,
            _ => ReadError::Unreadable(error.to_string()),
        })
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }
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

/// A row of an `INDEX.tsv`, by column name.
pub(crate) struct Row {
    header: Vec<String>,
    cells: Vec<String>,
}

impl Row {
    pub(crate) fn get(&self, column: &str) -> &str {
        let at = self.header.iter().position(|h| h == column).unwrap_or_else(|| panic!("no column {column}"));
        self.cells.get(at).map_or("", String::as_str)
    }
}

pub(crate) fn index(folder: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(folder.join("INDEX.tsv")).unwrap();
    let mut lines = text.lines();
    let split = |line: &str| line.split('\t').map(str::to_owned).collect::<Vec<_>>();
    let header = split(lines.next().unwrap());
    lines.map(|line| Row { header: header.clone(), cells: split(line) }).collect()
}

/// The files below `folder` with this ending, sorted.
pub(crate) fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Loads with this policy and renders the findings as plain text.
pub(crate) fn load(path: &Path, meshes: MeshPolicy) -> (Option<RobotModel>, Diagnostics, String) {
    let mut sources = Sources::new();
    let options = LoadOptions { meshes, ..LoadOptions::default() };
    let (model, found) = urdf::load(&Disk, &mut sources, path, &options);
    assert_eq!(
        model.is_none(),
        found.has_errors(),
        "{}: a model exactly when there is no error",
        path.display()
    );
    let text = found.to_plain_text(&sources);
    (model, found, text)
}
