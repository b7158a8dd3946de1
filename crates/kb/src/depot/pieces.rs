//! Parts of artefacts that are being computed. They are no promise: one that is missing or damaged is computed again.

use super::{Depot, DepotError};
use crate::key::Key;

/// Bytes of the hash that ends each piece.
const SEAL: usize = 32;

/// A piece of the artefact that `key` will give; `None` when it is not there or not whole.
pub(crate) fn get(depot: &dyn Depot, key: &Key, name: &str) -> Result<Option<Vec<u8>>, DepotError> {
    let Some(mut bytes) = depot.get(&format!("pieces/{key}/{name}"))? else { return Ok(None) };
    let Some(length) = bytes.len().checked_sub(SEAL) else { return Ok(None) };
    let seal = bytes.split_off(length);
    Ok((blake3::hash(&bytes).as_bytes()[..] == seal).then_some(bytes))
}

/// Keeps a piece.
pub(crate) fn put(depot: &dyn Depot, key: &Key, name: &str, bytes: &[u8]) -> Result<(), DepotError> {
    let sealed = [bytes, blake3::hash(bytes).as_bytes()].concat();
    depot.put(&format!("pieces/{key}/{name}"), &sealed)
}

/// Removes the pieces of a key, which nobody needs once its artefact is stored.
pub(crate) fn remove(depot: &dyn Depot, key: &Key) -> Result<(), DepotError> {
    depot.remove_all(&format!("pieces/{key}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depot::open;

    #[test]
    fn damaged_pieces_are_not_there() {
        let folder = tempfile::tempdir().unwrap();
        let depot = open(folder.path().to_str().unwrap(), &[]).unwrap();
        let key = Key::from_bytes([7; 32]);
        assert_eq!(get(&*depot, &key, "rows-0").unwrap(), None);
        put(&*depot, &key, "rows-0", b"abc").unwrap();
        assert_eq!(get(&*depot, &key, "rows-0").unwrap().as_deref(), Some(&b"abc"[..]));
        let name = format!("pieces/{key}/rows-0");
        let whole = depot.get(&name).unwrap().unwrap();
        for damaged in [&whole[..whole.len() - 1], &whole[1..], b"", b"abc"] {
            depot.put(&name, damaged).unwrap();
            assert_eq!(get(&*depot, &key, "rows-0").unwrap(), None);
        }
        remove(&*depot, &key).unwrap();
        assert_eq!(depot.get(&name).unwrap(), None);
        remove(&*depot, &key).unwrap();
    }
}
