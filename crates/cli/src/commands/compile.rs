//! `robotc compile`: from specifications to a knowledge base that has everything they need.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use rayon::prelude::*;
use robotc_kb::lock::Difference;
use robotc_kb::{Graph, LockFile, Locked};

use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, count, print, say};
use crate::settings::Settings;

/// Compile robot and task specifications into the knowledge base
#[derive(Args)]
#[command(
    after_help = "Examples:\n  robotc compile mug.task.toml\n  robotc compile --locked specs/tasks/*.task.toml\n\n\
    What was computed before is reused. The artefacts are listed in robotc.lock beside each specification."
)]
pub(crate) struct Compile {
    /// `*.robot.toml` and `*.task.toml` files
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Fail when robotc.lock would change, and say how; keys are compared before anything is computed
    #[arg(long)]
    locked: bool,
    /// The lock file [default: robotc.lock in the folder of each specification]
    #[arg(long, value_name = "FILE")]
    lock: Option<PathBuf>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    store: StoreArgs,
}

/// A specification to be compiled, and where it is locked.
struct Item<'a> {
    file: &'a Path,
    graph: Arc<Graph>,
    lock: PathBuf,
    section: String,
}

pub(crate) fn run(args: &Compile) -> Outcome {
    let store = args.store.open()?;
    let projects = crate::input::projects(&args.files, &args.settings)?;
    let graphs: Vec<Outcome<Arc<Graph>>> = projects.par_iter().map(knowledge::plan).collect();
    let mut items = Vec::new();
    for (file, graph) in args.files.iter().zip(graphs) {
        let lock = match &args.lock {
            Some(path) => path.clone(),
            None => file.parent().unwrap_or(Path::new("")).join("robotc.lock"),
        };
        let section = section_name(&lock, file)?;
        items.push(Item { file, graph: graph?, lock, section });
    }
    if args.locked {
        accept(&items, |i, locked| locked.differences(&items[i].graph))?;
    }
    let mut computed = Vec::new();
    for item in &items {
        let start = Instant::now();
        let report = knowledge::compile(&item.graph, &store)?;
        let (all, built) = (item.graph.nodes().len(), report.built().count());
        let seconds = start.elapsed().as_secs_f64();
        let done = if built == 0 { "all up to date".to_owned() } else { format!("{built} computed") };
        print(&format!("{}: {}, {done}, {seconds:.2} s", item.file.display(), count(all, "artefact")));
        let now = Locked::of(&report.knowledge);
        if !args.locked {
            write_section(item, &now)?;
        }
        computed.push(now);
    }
    if args.locked {
        accept(&items, |i, locked| locked.changes(&computed[i]))?;
    }
    Ok(())
}

/// Fails when `differ` finds a difference between any specification (by position) and its section, and says which.
fn accept(items: &[Item<'_>], differ: impl Fn(usize, &Locked) -> Vec<Difference>) -> Outcome {
    let mut differences = Vec::new();
    for lock in items.iter().map(|item| item.lock.as_path()).collect::<BTreeSet<&Path>>() {
        for section in read_lock(lock)?.prune(|section| exists(lock, section)) {
            differences.push(format!("{}: {section}: the specification is gone", lock.display()));
        }
    }
    for (i, item) in items.iter().enumerate() {
        let file = read_lock(&item.lock)?;
        let found = differ(i, file.section(&item.section).unwrap_or(&Locked::default()));
        let named = |d: &Difference| format!("{}: {}: {d}", item.lock.display(), item.section);
        differences.extend(found.iter().map(named));
    }
    differences.iter().for_each(|line| say(line));
    match differences.len() {
        0 => Ok(()),
        n => Err(Failure::Input(format!("the lock file is out of date: {}", count(n, "difference")))),
    }
}

/// Brings the section of a specification up to date, and drops those of specifications that are gone.
fn write_section(item: &Item<'_>, now: &Locked) -> Outcome {
    let before = read_lock(&item.lock)?;
    let mut after = before.clone();
    after.prune(|section| exists(&item.lock, section));
    after.set(&item.section, now.clone());
    if after == before {
        return Ok(());
    }
    write_whole(&item.lock, after.to_text().as_bytes())?;
    let verb = if before == LockFile::default() { "written" } else { "updated" };
    print(&format!("{}: {verb}", item.lock.display()));
    Ok(())
}

/// How a lock file calls a specification: by its path from the lock file's folder, with `/` between names.
fn section_name(lock: &Path, file: &Path) -> Outcome<String> {
    let (lock, file) = (std::path::absolute(lock)?, std::path::absolute(file)?);
    let folder: Vec<_> = lock.parent().unwrap_or(Path::new("")).components().collect();
    let names: Vec<_> = file.components().collect();
    let shared = folder.iter().zip(&names).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n("..".to_owned(), folder.len() - shared);
    let down = names[shared..].iter().map(|name| name.as_os_str().to_string_lossy().into_owned());
    Ok(up.chain(down).collect::<Vec<_>>().join("/"))
}

/// Whether the specification of a section is there.
fn exists(lock: &Path, section: &str) -> bool {
    lock.parent().unwrap_or(Path::new("")).join(section).exists()
}

/// Reads a lock file; an empty one where there is no file.
pub(super) fn read_lock(path: &Path) -> Outcome<LockFile> {
    match std::fs::read_to_string(path) {
        Ok(text) => {
            let wrong = |error| format!("{}: {error}; delete it and compile again", path.display());
            LockFile::parse(&text).map_err(|error| Failure::Input(wrong(error)))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(LockFile::default()),
        Err(error) => Err(Failure::Environment(format!("{}: {error}", path.display()))),
    }
}

/// Writes a file whole or not at all.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> Outcome {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let write = || -> std::io::Result<()> {
        let mut builder = tempfile::Builder::new();
        // Temporary files are private; this one becomes an ordinary file, within the user's mask.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.tempfile_in(folder)?;
        std::io::Write::write_all(&mut file, bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    write().map_err(|error| Failure::Environment(format!("{}: {error}", path.display())))
}
