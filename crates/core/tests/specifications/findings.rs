//! Each broken specification of `tests/specs` with all that is said about it.

use std::path::Path;

use robotc_core::diag::{Diagnostics, Sources};
use robotc_core::spec::{load_robot, load_task};

use super::disk::{Disk, compare, parameters};

#[test]
fn broken_specifications_are_explained() {
    let disk = Disk::of_checkout("tests/specs");
    let mut files: Vec<String> = std::fs::read_dir(&disk.root)
        .unwrap()
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().is_file())
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect();
    files.sort();
    let cases: Vec<&str> = files.iter().filter_map(|f| f.strip_suffix(".toml")).collect();
    assert!(cases.len() >= 40);
    let mut failures = Vec::new();
    for case in &cases {
        let (loaded, found, text) = load(&disk, &format!("{case}.toml"));
        if loaded == found.has_errors() {
            failures.push(format!("{case}: a value exactly when there is no error"));
        }
        if found.is_empty() {
            failures.push(format!("{case}: nothing is said about it"));
        }
        failures.extend(compare(&disk.root.join(format!("{case}.txt")), &text).err());
    }
    for file in files.iter().filter(|f| !f.ends_with(".toml")) {
        if !file.strip_suffix(".txt").is_some_and(|case| cases.contains(&case)) {
            failures.push(format!("{file} belongs to no case"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn what_the_cases_are_made_from_is_right() {
    let disk = Disk::of_checkout("tests/specs");
    for file in ["files/small.robot.toml", "files/two_arms.robot.toml"] {
        let (loaded, _, text) = load(&disk, file);
        assert!(loaded && text.is_empty(), "{text}");
    }
}

/// Whether a value came out, the findings, and the findings as text.
pub(crate) fn load(disk: &Disk, file: &str) -> (bool, Diagnostics, String) {
    let mut sources = Sources::new();
    let (loaded, found) = if file.ends_with(".robot.toml") {
        let (spec, found) = load_robot(disk, &mut sources, Path::new(file), &parameters());
        (spec.is_some(), found)
    } else {
        let (spec, found) = load_task(disk, &mut sources, Path::new(file), &parameters());
        (spec.is_some(), found)
    };
    let text = found.to_plain_text(&sources);
    (loaded, found, text)
}
