//! The store under ordinary and hostile treatment: damage, loss, archives, garbage, several processes' worth of handles.

mod support;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use robotc_kb::depot::{self, Depot};
use robotc_kb::explain::Reason;
use robotc_kb::kinds::ChainReach;
use robotc_kb::project::OfArm;
use robotc_kb::store::{ArchiveError, Finding, Rebuilt, Repair};
use robotc_kb::{CompileReport, Graph, Knowledge, Locked, Project, Store, compile};

fn graph(project: &Project) -> Arc<Graph> {
    Arc::new(Graph::plan(project).expect("a graph"))
}

fn open(folder: &Path) -> Arc<Store> {
    Arc::new(Store::open(folder).expect("a store"))
}

fn run(project: &Project, store: &Arc<Store>) -> CompileReport {
    let report = compile(&graph(project), store, &()).expect("the store works");
    let errors: Vec<String> = report.failed().map(|(_, e)| e.to_string()).collect();
    assert!(report.complete(), "{errors:?}");
    report
}

#[test]
fn what_was_computed_is_found_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = support::spec().project();
    let first = run(&project, &open(folder.path()));
    assert_eq!(first.built().count(), first.outcomes.len());
    let second = run(&project, &open(folder.path()));
    assert_eq!(second.built().count(), 0);
    assert_eq!(Locked::of(&first.knowledge), Locked::of(&second.knowledge));
    let reach = second.knowledge.load::<ChainReach>(&OfArm(0)).expect("it is there");
    assert!((reach.radius - 0.8).abs() < 1e-9 && (reach.centre_in_base.z - 0.3).abs() < 1e-9, "{reach:?}");
}

#[test]
fn what_one_machine_computed_others_find() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = support::spec().project();
    let place = folder.path().join("depot");
    let depot = || Box::new(depot::Folder::open(&place).expect("a depot"));
    let machine = |name: &str| {
        let store = Store::open(&folder.path().join(name)).expect("a store");
        Arc::new(store.shared_in(depot()))
    };
    let first = run(&project, &machine("first"));
    let all = first.outcomes.len();
    assert_eq!(first.built().count(), all);
    let second = run(&project, &machine("second"));
    assert_eq!(second.built().count(), 0);
    assert_eq!(Locked::of(&first.knowledge), Locked::of(&second.knowledge));
    let third = Knowledge::resolve(&graph(&project), &machine("third")).expect("the depot opens");
    assert!(third.missing().is_empty());

    let entries = depot::catalogue(&*depot()).expect("the depot opens");
    assert_eq!(entries.len(), all);
    assert_eq!(depot::verify(&*depot()).expect("the depot opens").whole, all);
    // What is damaged there is computed again, and whole again.
    let name = format!("artefacts/{}", entries[0].key);
    depot().put(&name, b"nonsense").expect("the depot opens");
    assert_eq!(depot::verify(&*depot()).expect("the depot opens").damaged, [entries[0].key]);
    let fourth = run(&project, &machine("fourth"));
    assert_eq!(fourth.built().count(), 1);
    assert_eq!(depot::verify(&*depot()).expect("the depot opens").damaged, []);
    assert_eq!(Locked::of(&first.knowledge), Locked::of(&fourth.knowledge));
    // Everything can be fetched, and removed.
    let all_of_it = Store::open(&folder.path().join("fifth")).expect("a store");
    assert_eq!(depot::bring_all(&all_of_it, &*depot()).expect("the depot opens"), 0);
    assert_eq!(all_of_it.list().expect("a list").len(), all);
    depot::remove(&*depot(), &entries[1].key).expect("the depot opens");
    assert_eq!(depot::catalogue(&*depot()).expect("the depot opens").len(), all - 1);
}

#[test]
fn damage_is_found_reported_and_mended() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = support::spec().project();
    let before = run(&project, &open(folder.path()));
    let lock = Locked::of(&before.knowledge);
    let count = before.outcomes.len();
    drop(before);
    damage_everything(folder.path());

    let store = open(folder.path());
    let found = store.verify().expect("the store opens");
    assert!(found.findings.iter().all(|f| matches!(f, Finding::Damaged(..))), "{:?}", found.findings);
    assert_eq!(found.findings.len(), count);
    let knowledge = Knowledge::resolve(&graph(&project), &store).expect("the store opens");
    let error = knowledge.load::<ChainReach>(&OfArm(0)).expect_err("it is damaged");
    assert!(error.to_string().contains("damaged"), "{error}");

    let report = run(&project, &store);
    assert!(report.built().all(|(_, reason)| *reason == Reason::Damaged));
    assert_eq!(Locked::of(&report.knowledge), lock);
    assert!(store.verify().expect("the store opens").findings.is_empty());
}

#[test]
fn a_lost_or_damaged_database_is_made_again_from_the_files_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = support::spec().project();
    let before = run(&project, &open(folder.path()));
    let (lock, count) = (Locked::of(&before.knowledge), before.outcomes.len());
    let listed = before.knowledge.store().list().expect("a list");
    drop(before);

    // Lost: opening the store is enough.
    std::fs::remove_file(folder.path().join("robotc.db")).expect("a file");
    let store = open(folder.path());
    assert_eq!(store.list().expect("a list"), listed);
    let again = run(&project, &store);
    assert_eq!(again.built().count(), 0);
    assert_eq!(Locked::of(&again.knowledge), lock);
    let whole = store.verify().expect("the store opens");
    assert!(whole.findings.is_empty() && whole.leftovers == 0, "{whole:?}");
    assert!(store.garbage(&[]).expect("it works").artefacts.is_empty(), "all is in use");
    drop((again, store));

    // Damaged: the error says what to do.
    std::fs::write(folder.path().join("robotc.db"), [b'?'; 4096]).expect("a file");
    let error = Store::open(folder.path()).err().expect("it is damaged");
    assert!(error.to_string().contains("robotc kb rebuild"), "{error}");
    assert_eq!(Store::rebuild(folder.path()).expect("it works"), Rebuilt { artefacts: count, lost: 0 });
    assert_eq!(run(&project, &open(folder.path())).built().count(), 0);

    // What is damaged beside it is noticed: that artefact is computed again, and its card written.
    let card = card(folder.path(), &listed[0].key);
    std::fs::write(&card, b"nothing").expect("a file");
    let store = open(folder.path());
    let findings = store.verify().expect("the store opens").findings;
    assert_eq!(findings, [Finding::NoCard(listed[0].key)]);
    let writer = store.writer().expect("free");
    assert_eq!(store.repair(&writer, &findings).expect("it works"), Repair { cards: 1, forgotten: 0 });
    assert!(store.verify().expect("the store opens").findings.is_empty());
    drop((writer, store));
    std::fs::write(&card, b"nothing").expect("a file");
    assert_eq!(Store::rebuild(folder.path()).expect("it works"), Rebuilt { artefacts: count - 1, lost: 1 });
    let mended = run(&project, &open(folder.path()));
    assert_eq!((mended.built().count(), Locked::of(&mended.knowledge)), (1, lock));
}

/// The file with the card of a key.
fn card(folder: &Path, key: &robotc_kb::Key) -> PathBuf {
    let name = key.to_string();
    folder.join("cards").join(&name[..2]).join(&name[2..])
}

/// Flips a bit of every content, in the database and in files, behind the store's back.
fn damage_everything(folder: &Path) {
    for shelf in std::fs::read_dir(folder.join("blobs")).expect("a folder") {
        for file in std::fs::read_dir(shelf.expect("an entry").path()).expect("a folder") {
            let path = file.expect("an entry").path();
            let mut bytes = std::fs::read(&path).expect("a file");
            bytes[0] ^= 1;
            std::fs::write(&path, bytes).expect("a file");
        }
    }
    let database = rusqlite::Connection::open(folder.join("robotc.db")).expect("the database");
    let rows: Vec<(Vec<u8>, Vec<u8>)> = database
        .prepare("SELECT content, bytes FROM blob WHERE bytes IS NOT NULL")
        .and_then(|mut q| q.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?.collect())
        .expect("rows");
    for (content, mut bytes) in rows {
        bytes[0] ^= 1;
        database
            .execute("UPDATE blob SET bytes = ?2 WHERE content = ?1", rusqlite::params![content, bytes])
            .expect("an update");
    }
}

#[test]
fn archives_are_deterministic_complete_and_verified() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = support::spec().project();
    let (here, there) = (open(&folder.path().join("a")), open(&folder.path().join("b")));
    let report = run(&project, &here);
    run(&project, &there);
    let (file, moved) = here.export(None).expect("an archive");
    assert_eq!(moved.artefacts, here.list().expect("a list").len());
    assert_eq!(file, there.export(None).expect("an archive").0, "equal stores give equal archives");
    let roots = Locked::of(&report.knowledge).keys();
    assert_eq!(file, here.export(Some(&roots)).expect("an archive").0);

    let fresh = open(&folder.path().join("c"));
    let writer = fresh.writer().expect("nobody else writes");
    let imported = fresh.import(&writer, &file).expect("a good archive");
    assert_eq!((imported.artefacts, imported.new), (moved.artefacts, moved.artefacts));
    assert_eq!(fresh.import(&writer, &file).expect("a good archive").new, 0);
    drop(writer);
    assert_eq!(run(&project, &fresh).built().count(), 0);
    let collected = fresh.collect(&fresh.writer().expect("free"), &[]).expect("it works");
    assert_eq!(collected.artefacts.len(), 0, "imported artefacts are in use");

    let empty = open(&folder.path().join("d"));
    let writer = empty.writer().expect("nobody else writes");
    for at in (0..file.len()).step_by(file.len() / 97 + 1) {
        let mut bad = file.clone();
        bad[at] ^= 0x10;
        let refused = empty.import(&writer, &bad);
        assert!(matches!(refused, Err(ArchiveError::NotAnArchive | ArchiveError::Damaged)), "byte {at}");
        assert!(empty.import(&writer, &file[..at]).is_err(), "cut at {at}");
    }
    assert!(empty.list().expect("a list").is_empty());
}

#[test]
fn garbage_is_what_no_subject_uses_and_no_root_needs() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = open(folder.path());
    let mut spec = support::spec();
    let old = Locked::of(&run(&spec.project(), &store).knowledge);
    for link in &mut spec.links {
        link.collision = support::cuboid([0.03, 0.03, 0.03], [0.0; 3]);
        if let Some(joint) = &mut link.joint {
            joint.origin.xyz[2] += 0.01;
        }
    }
    run(&spec.project(), &store);
    let stray = folder.path().join("blobs/ab");
    std::fs::create_dir_all(&stray).expect("a folder");
    std::fs::write(stray.join("cd"), b"left by a crash").expect("a file");

    assert!(store.garbage(&old.keys()).expect("it works").artefacts.is_empty());
    let before = store.list().expect("a list").len();
    let garbage = store.garbage(&[]).expect("it works");
    assert!(!garbage.artefacts.is_empty() && garbage.leftovers == 1, "{garbage:?}");
    let writer = store.writer().expect("free");
    assert_eq!(store.collect(&writer, &[]).expect("it works"), garbage);
    assert_eq!(store.list().expect("a list").len(), before - garbage.artefacts.len());
    drop(writer);
    let after = store.verify().expect("it opens");
    assert!(after.findings.is_empty() && after.leftovers == 0, "{after:?}");
    assert_eq!(run(&spec.project(), &store).built().count(), 0, "what is in use stays");
}

#[test]
fn two_writers_take_turns() {
    let folder = tempfile::tempdir().expect("a folder");
    let (one, two) = (open(folder.path()), open(folder.path()));
    let writer = one.try_writer().expect("a lock file").expect("nobody else writes");
    assert!(two.try_writer().expect("a lock file").is_none());
    drop(writer);
    assert!(two.try_writer().expect("a lock file").is_some());
    let project = support::spec().project();
    let built: usize = std::thread::scope(|scope| {
        let compilers = [&one, &two].map(|store| scope.spawn(|| run(&project, store).built().count()));
        compilers.map(|c| c.join().expect("no panic")).iter().sum()
    });
    assert_eq!(built, graph(&project).nodes().len(), "nothing is computed twice");
}

#[test]
fn large_contents_have_files_and_small_ones_do_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = open(folder.path());
    let writer = store.writer().expect("free");
    let record = robotc_kb::record::KeyRecord {
        kind: "example".into(),
        format: 1,
        algorithm: 1,
        target: None,
        parts: Vec::new(),
    };
    for (size, algorithm) in [(0, 1), (1, 2), ((64 << 10) - 1, 3), (64 << 10, 4), (1 << 20, 5)] {
        let record = robotc_kb::record::KeyRecord { algorithm, ..record.clone() };
        let bytes: Vec<u8> = (0..size).map(|i: usize| (i * 31 % 251) as u8).collect();
        let artefact = robotc_kb::store::NewArtefact {
            record: &record,
            subject: "x",
            reason: "",
            provenance: "",
            bytes: &bytes,
        };
        let content = store.publish(&writer, &artefact).expect("stored");
        assert_eq!(store.read(&content).expect("read"), bytes);
        let name = content.to_string();
        let file: PathBuf = folder.path().join("blobs").join(&name[..2]).join(&name[2..]);
        assert_eq!(file.exists(), size >= 64 << 10);
        if file.exists() {
            std::fs::write(&file, b"else").expect("a file");
            assert!(store.read(&content).is_err());
            assert_eq!(store.publish(&writer, &artefact).expect("stored again"), content);
            std::fs::remove_file(&file).expect("a file");
            assert!(store.read(&content).is_err());
            store.publish(&writer, &artefact).expect("stored again");
        }
        // The same key with other bytes is a kind that does not repeat.
        let other = robotc_kb::store::NewArtefact { bytes: b"other", ..artefact };
        assert!(store.publish(&writer, &other).is_err(), "{size}");
    }
    assert!(store.verify().expect("it opens").findings.is_empty());
}
