//! `robotc kb` on a knowledge base that is shared: what is in a bucket or a database, not what is near.

use std::collections::BTreeSet;
use std::path::PathBuf;

use robotc_kb::depot::{self, Depot, Entry};
use robotc_kb::{Key, Store};

use crate::commands::compile::read_lock;
use crate::output::{Failure, Outcome, count, print, say, size};

pub(super) fn list(depot: &dyn Depot, filter: &str) -> Outcome {
    let matches = |e: &&Entry| e.kind.contains(filter) || e.subject.contains(filter);
    depot::catalogue(depot)?.iter().filter(matches).for_each(line);
    Ok(())
}

fn line(e: &Entry) {
    print(&format!("{}  {:>9}  {:<20}  {}", e.key.short(), size(e.size), e.kind, e.subject));
}

/// Compares every object with its key and its hash; `repair` removes what is damaged.
pub(super) fn verify(depot: &dyn Depot, repair: bool) -> Outcome {
    let report = depot::verify(depot)?;
    for key in &report.damaged {
        say(&format!("{}: damaged", key.short()));
    }
    for key in &report.missing {
        say(&format!("{}: in the catalogue, and not there", key.short()));
    }
    let checked = format!("{}, {}", count(report.whole, "artefact"), size(report.bytes));
    let wrong: Vec<&Key> = report.damaged.iter().chain(&report.missing).collect();
    if wrong.is_empty() {
        print(&format!("whole: {checked}"));
        return Ok(());
    }
    let problems = count(wrong.len(), "problem");
    if !repair {
        let hint = "`robotc kb verify --repair` removes what is damaged";
        return Err(Failure::Environment(format!("{problems} beside {checked}; {hint}")));
    }
    for key in wrong {
        depot::remove(depot, key)?;
    }
    print(&format!("{problems} beside {checked}: removed; compiling makes it again"));
    Ok(())
}

/// Removes what no lock file names. Nothing here tells which specifications others have, so that lock files have to.
pub(super) fn collect(store: &Store, depot: &dyn Depot, dry_run: bool, keep: &[PathBuf]) -> Outcome {
    if keep.is_empty() {
        let why = "a shared knowledge base does not know who uses it: name every lock file with --keep LOCK";
        return Err(Failure::Input(why.into()));
    }
    let mut kept: BTreeSet<Key> = BTreeSet::new();
    for lock in keep {
        kept.extend(read_lock(lock)?.keys());
    }
    let garbage: Vec<Entry> =
        depot::catalogue(depot)?.into_iter().filter(|entry| !kept.contains(&entry.key)).collect();
    for entry in &garbage {
        line(entry);
        if !dry_run {
            depot::remove(depot, &entry.key)?;
        }
    }
    if !dry_run {
        // What is near is what was there.
        store.collect(&store.writer()?, &kept.into_iter().collect::<Vec<_>>())?;
    }
    let verb = if dry_run { "would be removed" } else { "removed" };
    let bytes = garbage.iter().map(|entry| entry.size).sum();
    print(&format!("{} {verb}, {}", count(garbage.len(), "artefact"), size(bytes)));
    Ok(())
}

/// Puts everything that is near into the depot.
pub(super) fn put_away_all(store: &Store, depot: &dyn Depot) -> Outcome {
    for artefact in store.list()? {
        depot::put_away(store, depot, &artefact.key)?;
    }
    Ok(())
}
