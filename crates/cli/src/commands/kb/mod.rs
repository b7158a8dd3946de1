//! `robotc kb`: looking into the knowledge base and looking after it.

mod shared;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use robotc_kb::record::Source;
use robotc_kb::store::{ArchiveError, Finding, Listed, Rebuilt};
use robotc_kb::{Key, Store, kinds};

use crate::commands::compile::{read_lock, write_whole};
use crate::knowledge::StoreArgs;
use crate::output::{Failure, Outcome, count, print, say, size};

/// Inspect, verify, clean and move the knowledge base
#[derive(Args)]
#[command(
    after_help = "Examples:\n  robotc kb ls grasp_set\n  robotc kb show 3fa0\n  robotc kb verify\n  robotc kb export everything.rkb"
)]
pub(crate) struct Kb {
    #[command(subcommand)]
    command: KbCommand,
    #[command(flatten)]
    store: StoreArgs,
}

#[derive(Subcommand)]
enum KbCommand {
    /// List artefacts
    Ls {
        /// Only those whose kind or subject contains this
        filter: Option<String>,
    },
    /// Show an artefact: what is in it, what it was computed from, and why
    Show {
        /// The first digits of its key, or a part of its subject; for a kind, its artefacts are listed
        artefact: String,
    },
    /// Check every artefact against its key and its hash
    Verify {
        /// Forget what is damaged, so that compiling makes it again
        #[arg(long)]
        repair: bool,
    },
    /// Make the database again from the files beside it, when it is damaged
    Rebuild,
    /// Remove what no specification used last
    Gc {
        /// Only say what would be removed
        #[arg(long)]
        dry_run: bool,
        /// Keep the artefacts of these lock files too
        #[arg(long, value_name = "LOCK")]
        keep: Vec<PathBuf>,
    },
    /// Write artefacts to one file
    Export {
        /// The file
        file: PathBuf,
        /// Only the artefacts of this lock file, with all they were computed from
        #[arg(long, value_name = "LOCK")]
        lock: Option<PathBuf>,
    },
    /// Read artefacts from a file written by `kb export`; all of it is verified first
    Import {
        /// The file
        file: PathBuf,
    },
}

pub(crate) fn run(args: &Kb) -> Outcome {
    if let KbCommand::Rebuild = args.command {
        return rebuild(&args.store.folder()?);
    }
    let store = args.store.open()?;
    match (&args.command, store.shared()) {
        (KbCommand::Ls { filter }, Some(depot)) => shared::list(depot, filter.as_deref().unwrap_or_default()),
        (KbCommand::Verify { repair }, Some(depot)) => shared::verify(depot, *repair),
        (KbCommand::Gc { dry_run, keep }, Some(depot)) => shared::collect(&store, depot, *dry_run, keep),
        (command, depot) => {
            if let (KbCommand::Show { .. } | KbCommand::Export { .. }, Some(depot)) = (command, depot) {
                robotc_kb::depot::bring_all(&store, depot)?;
            }
            near(command, &store)
        }
    }
}

/// What is done in the folder of the knowledge base.
fn near(command: &KbCommand, store: &Store) -> Outcome {
    match command {
        KbCommand::Ls { filter } => list(store, filter.as_deref().unwrap_or_default()),
        KbCommand::Show { artefact } => show(store, artefact),
        KbCommand::Verify { repair } => verify(store, *repair),
        KbCommand::Rebuild => rebuild(store.folder()),
        KbCommand::Gc { dry_run, keep } => collect(store, *dry_run, keep),
        KbCommand::Export { file, lock } => {
            let roots = lock.as_deref().map(read_lock).transpose()?.map(|lock| lock.keys());
            let (bytes, moved) = store.export(roots.as_deref())?;
            write_whole(file, &bytes)?;
            print(&format!(
                "{}: {}, {}",
                file.display(),
                count(moved.artefacts, "artefact"),
                size(moved.bytes)
            ));
            Ok(())
        }
        KbCommand::Import { file } => {
            let bytes =
                std::fs::read(file).map_err(|e| Failure::Environment(format!("{}: {e}", file.display())))?;
            let moved = store.import(&store.writer()?, &bytes).map_err(|error| match error {
                ArchiveError::Store(error) => Failure::Environment(error.to_string()),
                error => Failure::Input(format!("{}: {error}", file.display())),
            })?;
            if let Some(depot) = store.shared() {
                shared::put_away_all(store, depot)?;
            }
            let all = count(moved.artefacts, "artefact");
            print(&format!("{}: {all}, {} new, {}", file.display(), moved.new, size(moved.bytes)));
            Ok(())
        }
    }
}

fn list(store: &Store, filter: &str) -> Outcome {
    let matches = |a: &&Listed| a.kind.contains(filter) || a.subject.contains(filter);
    for a in store.list()?.iter().filter(matches) {
        print(&format!("{}  {:>9}  {:<20}  {}", a.key.short(), size(a.size), a.kind, a.subject));
    }
    Ok(())
}

fn show(store: &Store, wanted: &str) -> Outcome {
    let all = store.list()?;
    let by_key: Vec<&Listed> = all.iter().filter(|a| a.key.to_string().starts_with(wanted)).collect();
    let found = match by_key.is_empty() {
        true => all.iter().filter(|a| a.subject.contains(wanted)).collect(),
        false => by_key,
    };
    if found.is_empty() && kinds::find(wanted).is_some() {
        return list(store, wanted);
    }
    if found.is_empty() {
        return Err(Failure::Input(format!(
            "no artefact has key, subject or kind `{wanted}`; `robotc kb ls` lists them"
        )));
    }
    for (i, artefact) in found.iter().enumerate() {
        if i > 0 {
            print("");
        }
        describe(store, artefact)?;
    }
    Ok(())
}

fn describe(store: &Store, a: &Listed) -> Outcome {
    print(&format!("{} of {}", a.kind, a.subject));
    print(&format!("  key      {}", a.key));
    print(&format!("  content  {} ({})", a.content, size(a.size)));
    print(&format!("  made by  {}", a.provenance));
    print(&format!("  because  {}", a.reason));
    let summary = match (kinds::find(&a.kind), store.read(&a.content)) {
        (Some(kind), Ok(bytes)) => kind.summary(&bytes).unwrap_or_else(|error| error.to_string()),
        (None, Ok(_)) => "a kind that this program does not know".to_owned(),
        (_, Err(error)) => error.to_string(),
    };
    print(&format!("  holds    {summary}"));
    let Some(record) = store.record(&a.key)? else { return Ok(()) };
    for part in &record.parts {
        let value = match (&part.shown, part.source) {
            (Some(value), _) => value.clone(),
            (None, Source::Artefact) => format!("content {}", short(part.digest)),
            (None, _) => short(part.digest),
        };
        print(&format!("  from     {} = {value}", part.label()));
    }
    Ok(())
}

fn short(digest: [u8; 32]) -> String {
    Key::from_bytes(digest).short()
}

fn verify(store: &Store, repair: bool) -> Outcome {
    let result = store.verify()?;
    for finding in &result.findings {
        let text = match finding {
            Finding::Database(text) => {
                format!("the database is damaged, `robotc kb rebuild` makes it again: {text}")
            }
            Finding::Missing(key, content) => {
                format!("{}: content {} is missing", key.short(), content.short())
            }
            Finding::Damaged(key, content) => {
                format!("{}: content {} is damaged", key.short(), content.short())
            }
            Finding::WrongKey(key) => format!("{}: what it is made of gives another key", key.short()),
            Finding::Undecodable(key, why) => format!("{}: {why}", key.short()),
            Finding::NoCard(key) => {
                format!("{}: its card is missing or damaged; it is whole in the database", key.short())
            }
        };
        say(&text);
    }
    let leftovers = match result.leftovers {
        0 => String::new(),
        n => format!(", {} that nothing refers to (`robotc kb gc` removes them)", count(n, "file")),
    };
    let checked = format!("{}, {}{leftovers}", count(result.artefacts, "artefact"), size(result.bytes));
    if result.findings.is_empty() {
        print(&format!("whole: {checked}"));
        return Ok(());
    }
    let problems = count(result.findings.len(), "problem");
    if !repair {
        return Err(Failure::Environment(format!(
            "{problems} in {checked}; `robotc kb verify --repair` forgets what is damaged"
        )));
    }
    let done = store.repair(&store.writer()?, &result.findings)?;
    let (cards, forgotten) = (count(done.cards, "card"), count(done.forgotten, "artefact"));
    print(&format!("{problems} in {checked}: {cards} written again, {forgotten} forgotten"));
    if done.forgotten > 0 {
        print("compiling makes forgotten artefacts again");
    }
    Ok(())
}

fn rebuild(folder: &Path) -> Outcome {
    let Rebuilt { artefacts, lost } = Store::rebuild(folder)?;
    let lost = match lost {
        0 => String::new(),
        n => format!(", {} damaged", count(n, "card")),
    };
    print(&format!("the database was made again: {}{lost}", count(artefacts, "artefact")));
    Ok(())
}

fn collect(store: &Store, dry_run: bool, keep: &[PathBuf]) -> Outcome {
    let mut roots = Vec::new();
    for lock in keep {
        roots.extend(read_lock(lock)?.keys());
    }
    let garbage = if dry_run { store.garbage(&roots)? } else { store.collect(&store.writer()?, &roots)? };
    for a in &garbage.artefacts {
        print(&format!("{}  {:>9}  {:<20}  {}", a.key.short(), size(a.size), a.kind, a.subject));
    }
    let verb = if dry_run { "would be removed" } else { "removed" };
    let (artefacts, files) =
        (count(garbage.artefacts.len(), "artefact"), count(garbage.leftovers, "stray file"));
    print(&format!("{artefacts} and {files} {verb}, {}", size(garbage.bytes)));
    Ok(())
}
