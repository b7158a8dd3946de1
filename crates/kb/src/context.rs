//! What a build may use besides its inputs and parameters: other artefacts, a seed, progress, and parallel maps.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use robotc_core::Seed;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::codec;
use crate::depot::{Depot, pieces};
use crate::graph::Dep;
use crate::key::Key;
use crate::kind::Kind;
use crate::observer::{BuildError, Event, Observer};
use crate::resolve::Knowledge;

/// How often a parallel map reports its progress, at most.
const REPORTS: u64 = 256;

/// Pieces that the results of [`Context::map_in_pieces`] are kept in. A property of the work, not of who does it:
/// pieces made by three processes serve seven.
pub const PIECES: usize = 64;

/// A shard of a build: every `of`-th piece, beginning with number `index`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    of: usize,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { index: 0, of: 1 };

    fn has(&self, piece: usize) -> bool {
        piece % self.of == self.index
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

/// From `i/n`, with `i` below `n`.
impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "expected i/n with 0 <= i < n, such as 0/4";
        let (index, of) = text.split_once('/').ok_or(EXPECTED)?;
        let (index, of) = (index.parse().map_err(|_| EXPECTED)?, of.parse().map_err(|_| EXPECTED)?);
        if index < of { Ok(Self { index, of }) } else { Err(EXPECTED) }
    }
}

/// What a build may use besides its inputs and parameters.
pub struct Context<'a> {
    pub(crate) knowledge: &'a Knowledge,
    pub(crate) key: Key,
    pub(crate) kind: &'static str,
    pub(crate) subject: &'a str,
    pub(crate) depot: &'a dyn Depot,
    pub(crate) shard: Shard,
    pub(crate) observer: &'a dyn Observer,
}

impl Context<'_> {
    /// An artefact that this one is computed from.
    pub fn load<K: Kind>(&self, dep: &Dep<K>) -> Result<Arc<K::Artefact>, BuildError> {
        Ok(self.knowledge.load_node(dep)?)
    }

    /// The root of all randomness: a function of the key.
    pub fn seed(&self) -> Seed {
        Seed::from_bytes(*self.key.as_bytes())
    }

    /// Reports that `done` of `total` items are computed.
    pub fn progress(&self, done: u64, total: u64) {
        self.observer.event(Event::Progress { kind: self.kind, subject: self.subject, done, total });
    }

    /// Tells the user something that the artefact does not say. Nothing is kept: who computes it hears it.
    pub fn warn(&self, message: &str) {
        self.observer.event(Event::Warning { kind: self.kind, subject: self.subject, message });
    }

    /// Stops a build that nobody waits for any more.
    pub fn checkpoint(&self) -> Result<(), BuildError> {
        if self.observer.cancelled() { Err(BuildError::Cancelled) } else { Ok(()) }
    }

    /// Computes `f(i, items[i])` for all items in parallel, with progress; the results are in order.
    pub fn map<T: Sync, R: Send>(
        &self,
        items: &[T],
        f: impl Fn(usize, &T) -> R + Sync,
    ) -> Result<Vec<R>, BuildError> {
        self.try_map(items, |i, item| Ok(f(i, item)))
    }

    /// As [`map`](Self::map), for work that can fail. The error is that of the first item that failed in time.
    pub fn try_map<T: Sync, R: Send>(
        &self,
        items: &[T],
        f: impl Fn(usize, &T) -> Result<R, BuildError> + Sync,
    ) -> Result<Vec<R>, BuildError> {
        let done = AtomicUsize::new(0);
        let one = |(i, item): (usize, &T)| {
            self.checkpoint()?;
            let result = f(i, item)?;
            self.advance(&done, 1, items.len());
            Ok(result)
        };
        items.par_iter().enumerate().map(one).collect()
    }

    /// As [`map`](Self::map), for long work: results are kept in pieces as they come, so that a build which was stopped goes
    /// on, and several processes can each do a shard.
    ///
    /// `name` tells the maps of one build apart. The results do not depend on who made which piece. The error is
    /// [`BuildError::Unfinished`] when this process has done its shard and pieces of others are missing.
    pub fn map_in_pieces<T: Sync, R: Serialize + DeserializeOwned + Send>(
        &self,
        name: &str,
        items: &[T],
        f: impl Fn(usize, &T) -> R + Sync,
    ) -> Result<Vec<R>, BuildError> {
        let count = PIECES.min(items.len());
        let done = AtomicUsize::new(0);
        let span = |piece: usize| piece * items.len() / count..(piece + 1) * items.len() / count;
        let file = |piece: usize| format!("{name}-{piece}");
        let kept = |piece: usize| -> Result<Option<Vec<R>>, BuildError> {
            let bytes = pieces::get(self.depot, &self.key, &file(piece))?;
            let results = bytes.and_then(|bytes| codec::decode::<Vec<R>>(&bytes).ok());
            let results = results.filter(|results| results.len() == span(piece).len());
            if results.is_some() {
                self.advance(&done, span(piece).len(), items.len());
            }
            Ok(results)
        };
        let make = |piece: usize| -> Result<Option<Vec<R>>, BuildError> {
            if let Some(results) = kept(piece)? {
                return Ok(Some(results));
            }
            if !self.shard.has(piece) {
                return Ok(None);
            }
            let results = span(piece).into_par_iter().map(|i| {
                self.checkpoint()?;
                let result = f(i, &items[i]);
                self.advance(&done, 1, items.len());
                Ok(result)
            });
            let results: Vec<R> = results.collect::<Result<_, BuildError>>()?;
            pieces::put(self.depot, &self.key, &file(piece), &codec::encode(&results))?;
            Ok(Some(results))
        };
        let mut made: Vec<Option<Vec<R>>> =
            (0..count).into_par_iter().map(make).collect::<Result<_, BuildError>>()?;
        // Looked for once more now that all of our own are there: of processes that finish at the same time, one sees all.
        for (piece, results) in made.iter_mut().enumerate().filter(|(_, results)| results.is_none()) {
            *results = kept(piece)?;
        }
        let missing = made.iter().filter(|piece| piece.is_none()).count();
        if missing > 0 {
            return Err(BuildError::Unfinished { missing, pieces: count });
        }
        Ok(made.into_iter().flatten().flatten().collect())
    }

    /// Counts finished items. A few hundred reports are enough for a smooth display, and cost nothing.
    fn advance(&self, done: &AtomicUsize, by: usize, total: usize) {
        let (by, total) = (by as u64, total as u64);
        let count = done.fetch_add(by as usize, Ordering::Relaxed) as u64 + by;
        if count * REPORTS / total != (count - by) * REPORTS / total {
            self.progress(count, total);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_read_and_part_the_pieces() {
        for wrong in ["", "1", "1/1", "3/2", "-1/2", "a/b", "0/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        let shards: Vec<Shard> = (0..7).map(|i| format!("{i}/7").parse().unwrap()).collect();
        for piece in 0..PIECES {
            assert_eq!(shards.iter().filter(|shard| shard.has(piece)).count(), 1);
            assert!(Shard::WHOLE.has(piece));
        }
    }
}
