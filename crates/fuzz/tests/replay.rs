//! The corpus that fuzzing left behind, and every input that once broke something, once more.

use std::collections::BTreeSet;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

use robotc_fuzz::{TARGETS, Target};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz").join(name)
}

/// The files of a folder, by name; none when there is no folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    files.sort();
    files
}

/// The inputs of a target that break it.
fn broken(target: &Target) -> Vec<String> {
    let inputs = ["corpus", "findings"].map(|kind| files(&folder(kind).join(target.name)));
    assert!(!inputs[0].is_empty(), "{} has no corpus", target.name);
    let breaks = |file: &&PathBuf| {
        let bytes = std::fs::read(file).expect("a readable file");
        catch_unwind(|| (target.run)(&bytes)).is_err()
    };
    inputs.iter().flatten().filter(breaks).map(|file| file.display().to_string()).collect()
}

#[test]
fn no_input_of_the_corpus_breaks_anything() {
    let broken: Vec<String> = std::thread::scope(|scope| {
        let threads: Vec<_> = TARGETS.iter().map(|target| scope.spawn(|| broken(target))).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("panics are caught")).collect()
    });
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn every_target_is_driven() {
    let stem = |file: PathBuf| file.file_stem().and_then(|s| s.to_str()).unwrap_or_default().to_owned();
    let driven: BTreeSet<String> = files(&folder("fuzz_targets")).into_iter().map(stem).collect();
    let known: BTreeSet<String> = TARGETS.iter().map(|target| target.name.to_owned()).collect();
    assert_eq!(driven, known);
}
