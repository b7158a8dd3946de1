//! Stored forms of the knowledge base: every kind of artefact, key records, lock files, archives.

use robotc_kb::key::{ContentHash, Key};
use robotc_kb::kind::AnyKind;
use robotc_kb::record::KeyRecord;
use robotc_kb::store::{Archive, Archived};
use robotc_kb::{LockFile, kinds};

/// An input of the target: the first line names what the rest is, a kind of artefact, `record`, `lock` or `archive`.
///
/// Names and not positions, so that a corpus keeps its meaning when kinds are added.
pub fn wrapped(name: &str, bytes: &[u8]) -> Vec<u8> {
    [name.as_bytes(), b"\n", bytes].concat()
}

/// Any bytes as the stored form that their first line names: an error, or a value with one stored form from then on.
pub(crate) fn artefact(bytes: &[u8]) {
    let Some(line) = bytes.iter().position(|&byte| byte == b'\n') else { return };
    let (name, bytes) = (&bytes[..line], &bytes[line + 1..]);
    match name {
        b"record" => record(bytes),
        b"lock" => lock(bytes),
        b"archive" => {
            archive(bytes);
            // The same behind a right seal, which no mutation finds by itself.
            archive(&Archive::sealed(bytes));
        }
        _ => {
            if let Some(kind) = kinds::ALL.iter().find(|kind| kind.info().name.as_bytes() == name) {
                of_kind(*kind, bytes);
            }
        }
    }
}

fn of_kind(kind: &dyn AnyKind, bytes: &[u8]) {
    let info = kind.info();
    let decoded = kind.recode(bytes);
    if let Ok(again) = &decoded {
        assert!(kind.recode(again).as_ref() == Ok(again), "{} has two stored forms", info.name);
        assert!(kind.summary(bytes).is_ok());
    }
    // In an archive, which is how foreign artefacts come in, the same bytes get the same answer.
    let record = KeyRecord {
        kind: info.name.to_owned(),
        format: info.format,
        algorithm: info.algorithm,
        target: None,
        parts: Vec::new(),
    };
    let (subject, provenance) = ("subject".to_owned(), String::new());
    let archive = Archive::new(vec![Archived { record, subject, provenance, bytes: bytes.into() }]);
    match Archive::read(&archive.encode()) {
        Ok(read) => {
            assert!(decoded.is_ok());
            assert_eq!(&*read.artefacts()[0].bytes, bytes);
        }
        Err(_) => assert!(decoded.is_err()),
    }
}

fn record(bytes: &[u8]) {
    let Ok(record) = KeyRecord::decode(bytes) else { return };
    record.parts.iter().for_each(|part| drop(part.label()));
    let (key, recipe) = (record.key(), record.recipe());
    assert_ne!(key.as_bytes(), recipe.as_bytes());
    let again = KeyRecord::decode(&record.encode()).expect("what was written is read");
    assert_eq!((again.key(), again.encode()), (key, record.encode()));
    assert_eq!(key.to_string().parse::<Key>().ok(), Some(key));
}

fn lock(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match LockFile::parse(text) {
        Ok(lock) => assert_eq!(LockFile::parse(&lock.to_text()), Ok(lock)),
        Err(error) => assert!(error.line >= 1 && error.line <= text.lines().count()),
    }
    if let Ok(content) = text.trim().parse::<ContentHash>() {
        assert_eq!(content.to_string().parse::<ContentHash>().ok(), Some(content));
    }
}

fn archive(bytes: &[u8]) {
    let Ok(archive) = Archive::read(bytes) else { return };
    let file = archive.encode();
    let again = Archive::read(&file).expect("what was written is read");
    assert!(again == archive && again.encode() == file);
}
