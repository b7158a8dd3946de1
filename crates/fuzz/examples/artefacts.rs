//! Seeds of the target `artefact`: `artefacts FOLDER` compiles a small task and writes a file for each stored form of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, ensure};
use robotc_core::diag::Sources;
use robotc_core::spec::{ParameterValue, load_task};
use robotc_fuzz::wrapped;
use robotc_kb::lock::Locked;
use robotc_kb::os::OsSystem;
use robotc_kb::{Graph, LockFile, Project, Store, compile, kinds};

/// Longest seed: fuzzing changes few bytes of longer ones.
const LONGEST: usize = 8000;

/// Parameters that make artefacts small enough for a seed.
const COARSE: &[(&str, &str, ParameterValue)] = &[
    ("reachability", "step", ParameterValue::Number(2.0)),
    ("reachability", "free_samples", ParameterValue::Integer(1)),
    ("grasp_set", "spacing", ParameterValue::Number(0.03)),
    ("grasp_set", "most_grasps", ParameterValue::Integer(4)),
    ("caging_set", "approaches", ParameterValue::Integer(400)),
    ("caging_set", "most", ParameterValue::Integer(4)),
    ("self_collision_pairs", "samples", ParameterValue::Integer(100)),
    ("self_collision_pairs", "boxes", ParameterValue::Integer(100)),
];

fn main() -> anyhow::Result<()> {
    let out = PathBuf::from(std::env::args().nth(1).context("usage: artefacts FOLDER")?);
    std::fs::create_dir_all(&out)?;
    let task = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/tasks/mug_and_cabinet.task.toml");
    let mut sources = Sources::new();
    let (spec, found) = load_task(&OsSystem, &mut sources, &task, &kinds::parameter_table());
    let mut spec = spec.with_context(|| found.to_plain_text(&sources))?;
    for (kind, name, value) in COARSE {
        spec.parameters.set(kind, name, value.clone());
    }
    let graph = Arc::new(Graph::plan(&Project::of_task(&spec))?);
    let folder = tempfile::tempdir()?;
    let store = Arc::new(Store::open(folder.path())?);
    let report = compile(&graph, &store, &())?;
    ensure!(report.complete(), "the seeds compile");

    let mut count = std::collections::BTreeMap::new();
    let mut write = |name: &str, bytes: &[u8]| -> anyhow::Result<()> {
        if bytes.len() <= LONGEST {
            let number: &mut usize = count.entry(name.to_owned()).or_default();
            *number += 1;
            std::fs::write(out.join(format!("{name}-{number}")), wrapped(name, bytes))?;
        }
        Ok(())
    };
    for artefact in store.list()? {
        write(&artefact.kind, &store.read(&artefact.content)?)?;
        let record = store.record(&artefact.key)?.context("listed artefacts have records")?;
        write("record", &record.encode())?;
        let (archive, _) = store.export(Some(&[artefact.key]))?;
        write("archive", &archive)?;
        let (_, body) = archive.split_at(archive.iter().position(|&b| b == b'\n').context("a header")? + 1);
        write("archive", &body[..body.len() - 32])?;
    }
    let mut lock = LockFile::default();
    lock.set("specs/mug.task.toml", Locked::of(&report.knowledge));
    write("lock", lock.to_text().as_bytes())?;
    for kind in kinds::ALL {
        let name = kind.info().name;
        ensure!(count.contains_key(name), "the task has no {name} that is short enough for a seed");
    }
    Ok(())
}
