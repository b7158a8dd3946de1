//! Artefact kinds: what every file in [`kinds`](crate::kinds) implements.
//!
//! A kind is written in two halves. [`Kind`] says what an artefact is about, what it reads and how it is stored; it is
//! all that loading needs. `Build`, behind the feature `build`, computes it and checks it.
//!
//! What a build may read is `Kind::Inputs` and the parameters, nothing else: it never sees the robot, so that a key which
//! covers the inputs covers everything. Keep the inputs narrow (see [`projection`](crate::projection)); an edit of what
//! is not in them rebuilds nothing.

use std::any::Any;
use std::sync::Arc;

use robotc_core::spec::Parameter;

pub use crate::codec::DecodeError;
use crate::graph::{PlanError, Planner};
use crate::parameters::Parameters;
use crate::project::{Project, Subject};
use crate::record::Parts;

#[cfg(feature = "build")]
pub use crate::context::Context;
#[cfg(feature = "build")]
pub use crate::observer::BuildError;

/// On which machines equal keys give equal bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Portability {
    /// On all.
    Portable,
    /// On those with the same processor architecture and system; both are part of the key.
    SameTarget,
}

/// A kind of artefact.
pub trait Kind: Send + Sync + 'static {
    /// Unique name, in snake case; users see it.
    const NAME: &'static str;
    /// Version of the stored form. Raise it when `encode` changes.
    const FORMAT: u32;
    /// Revision of the algorithm. Raise it when `build` gives other artefacts than before.
    const ALGORITHM: u32;
    /// Where its bytes repeat.
    const PORTABILITY: Portability;
    /// Whether its build keeps pieces, so that several processes can share it: see `Context::map_in_pieces`.
    const IN_PIECES: bool = false;
    /// One or two sentences for users: what it is, and what for.
    const DOC: &'static str;

    /// What an artefact is about.
    type Subject: Subject;
    /// What it is computed from: projections of the project, and [`Dep`](crate::Dep)s on other artefacts.
    type Inputs: Send + Sync + 'static;
    /// What users can set.
    type Parameters: Parameters;
    /// The artefact.
    type Artefact: Send + Sync + 'static;

    /// Subjects that have such an artefact; all of their type unless a kind is pickier.
    fn subjects(project: &Project) -> Vec<Self::Subject> {
        Self::Subject::all(project)
    }

    /// Projects what the artefact is computed from.
    fn inputs(planner: &mut Planner<'_>, subject: &Self::Subject) -> Result<Self::Inputs, PlanError>;

    /// Adds every projection in `inputs` to the key, artefacts excepted: the planner adds those itself. Take `inputs`
    /// apart with a pattern that names all fields, so that the compiler tells when one is forgotten.
    fn key_parts(inputs: &Self::Inputs, parts: &mut Parts);

    /// The parameters where nothing is given. They follow from measures of the inputs, computed by + - * / and roots.
    fn defaults(inputs: &Self::Inputs) -> Self::Parameters;

    /// What a default is taken over from as it stands, such as an object for its friction, as people call it; for
    /// messages.
    fn default_from(_project: &Project, _subject: &Self::Subject, _parameter: &str) -> Option<String> {
        None
    }

    /// The stored form; equal artefacts give equal bytes.
    fn encode(artefact: &Self::Artefact) -> Vec<u8>;

    /// The artefact of a stored form. Total: any bytes give an artefact or an error, and never a panic.
    fn decode(bytes: &[u8]) -> Result<Self::Artefact, DecodeError>;

    /// One line that tells people what is in it.
    fn summary(artefact: &Self::Artefact) -> String;
}

/// A kind whose artefacts can be computed.
#[cfg(feature = "build")]
pub trait Build: Kind {
    /// Computes the artefact. Deterministic for any number of threads; call [`Context::checkpoint`] often.
    fn build(
        inputs: &Self::Inputs,
        parameters: &Self::Parameters,
        context: &Context<'_>,
    ) -> Result<Self::Artefact, BuildError>;

    /// Checks the artefact by other means than those that made it, before it is stored. The error says what is wrong.
    fn check(
        artefact: &Self::Artefact,
        inputs: &Self::Inputs,
        parameters: &Self::Parameters,
        context: &Context<'_>,
    ) -> Result<(), BuildError>;
}

/// What the registry tells about a kind.
#[derive(Debug, Clone, Copy)]
pub struct KindInfo {
    /// Unique name.
    pub name: &'static str,
    /// Version of the stored form.
    pub format: u32,
    /// Revision of the algorithm.
    pub algorithm: u32,
    /// Where its bytes repeat.
    pub portability: Portability,
    /// Whether several processes can share a build.
    pub in_pieces: bool,
    /// What it is, for users.
    pub doc: &'static str,
    /// What users can set.
    pub parameters: &'static [Parameter],
}

/// A kind with its types erased: what the registry holds. Every [`Kind`] (with `build`, every `Build`) has one.
pub trait AnyKind: Send + Sync {
    /// Its description.
    fn info(&self) -> KindInfo;

    /// Plans the artefacts of all subjects of a project.
    fn plan_all(&self, planner: &mut Planner<'_>) -> Result<(), PlanError>;

    /// Decodes an artefact.
    fn decode(&self, bytes: &[u8]) -> Result<Arc<dyn Any + Send + Sync>, DecodeError>;

    /// Decodes an artefact and encodes it again: equal bytes mean a canonical stored form.
    fn recode(&self, bytes: &[u8]) -> Result<Vec<u8>, DecodeError>;

    /// One line about an artefact.
    fn summary(&self, bytes: &[u8]) -> Result<String, DecodeError>;

    /// Computes, checks and encodes an artefact; `work` is the inputs and parameters of a node of this kind.
    #[cfg(feature = "build")]
    fn build(&self, work: &(dyn Any + Send + Sync), context: &Context<'_>) -> Result<Vec<u8>, BuildError>;
}

/// What a node of kind `K` is computed from.
#[cfg_attr(not(feature = "build"), expect(dead_code, reason = "only builds read it"))]
pub(crate) struct Work<K: Kind> {
    pub(crate) inputs: K::Inputs,
    pub(crate) parameters: K::Parameters,
}

/// The registry entry of a kind.
pub struct Entry<K>(std::marker::PhantomData<fn() -> K>);

impl<K> Entry<K> {
    /// The entry.
    pub const fn new() -> Self {
        Self(std::marker::PhantomData)
    }
}

impl<K> Default for Entry<K> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(feature = "build")]
use Build as Registrable;
#[cfg(not(feature = "build"))]
use Kind as Registrable;

impl<K: Registrable> AnyKind for Entry<K> {
    fn info(&self) -> KindInfo {
        KindInfo {
            name: K::NAME,
            format: K::FORMAT,
            algorithm: K::ALGORITHM,
            portability: K::PORTABILITY,
            in_pieces: K::IN_PIECES,
            doc: K::DOC,
            parameters: K::Parameters::TABLE,
        }
    }

    fn plan_all(&self, planner: &mut Planner<'_>) -> Result<(), PlanError> {
        for subject in K::subjects(planner.project()) {
            planner.need::<K>(&subject)?;
        }
        Ok(())
    }

    fn decode(&self, bytes: &[u8]) -> Result<Arc<dyn Any + Send + Sync>, DecodeError> {
        Ok(Arc::new(K::decode(bytes)?))
    }

    fn recode(&self, bytes: &[u8]) -> Result<Vec<u8>, DecodeError> {
        Ok(K::encode(&K::decode(bytes)?))
    }

    fn summary(&self, bytes: &[u8]) -> Result<String, DecodeError> {
        Ok(K::summary(&K::decode(bytes)?))
    }

    #[cfg(feature = "build")]
    fn build(&self, work: &(dyn Any + Send + Sync), context: &Context<'_>) -> Result<Vec<u8>, BuildError> {
        let work = work.downcast_ref::<Work<K>>().expect("a node holds the work of its own kind");
        let artefact = K::build(&work.inputs, &work.parameters, context)?;
        context.checkpoint()?;
        let bytes = K::encode(&artefact);
        // What is stored is what is checked.
        let stored = K::decode(&bytes).map_err(|e| BuildError::Check(e.to_string()))?;
        if K::encode(&stored) != bytes {
            return Err(BuildError::Check("the stored form does not read back as it was written".into()));
        }
        K::check(&stored, &work.inputs, &work.parameters, context)?;
        Ok(bytes)
    }
}
