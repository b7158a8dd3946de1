//! `robotc compile`: from specifications to a knowledge base that has everything they need.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use robotc_kb::LockFile;

use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, count, print, say};

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
    /// Fail when robotc.lock would change, and say how
    #[arg(long)]
    locked: bool,
    /// The lock file [default: robotc.lock in the folder of each specification]
    #[arg(long, value_name = "FILE")]
    lock: Option<PathBuf>,
    #[command(flatten)]
    store: StoreArgs,
}

pub(crate) fn run(args: &Compile) -> Outcome {
    let store = args.store.open()?;
    let mut unlocked = 0;
    for file in &args.files {
        let start = Instant::now();
        let project = crate::input::project(file)?;
        let graph = knowledge::plan(&project)?;
        let report = knowledge::compile(&graph, &store)?;
        let (all, built) = (graph.nodes().len(), report.built().count());
        let seconds = start.elapsed().as_secs_f64();
        let done = if built == 0 { "all up to date".to_owned() } else { format!("{built} computed") };
        print(&format!("{}: {}, {done}, {seconds:.2} s", file.display(), count(all, "artefact")));

        let path = match &args.lock {
            Some(path) => path.clone(),
            None => file.parent().unwrap_or(Path::new("")).join("robotc.lock"),
        };
        let before = read_lock(&path)?;
        let now = LockFile::of(&report.knowledge);
        let changes = before.changes(&now);
        if args.locked {
            unlocked += changes.len();
            for change in &changes {
                let hash = |known: Option<robotc_kb::resolve::Known>| match known {
                    None => "nothing".to_owned(),
                    Some(known) => format!("key {} content {}", known.key.short(), known.content.short()),
                };
                let (before, now) = (hash(change.before), hash(change.now));
                say(&format!("{}: {} {}: {before} -> {now}", path.display(), change.kind, change.subject));
            }
        } else if !changes.is_empty() {
            write_whole(&path, before.updated(&now).to_text().as_bytes())?;
        }
    }
    if unlocked > 0 {
        let lines = count(unlocked, "line");
        return Err(Failure::Input(format!("the lock file is out of date: {lines} would change")));
    }
    Ok(())
}

/// Reads a lock file; an empty one where there is no file.
pub(super) fn read_lock(path: &Path) -> Outcome<LockFile> {
    match std::fs::read_to_string(path) {
        Ok(text) => {
            LockFile::parse(&text).map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
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
