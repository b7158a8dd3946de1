//! The graph of artefacts of a project: what there is to know, before any of it is computed.

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use robotc_core::model::ChainError;
use robotc_core::spec::ParameterValue;
use thiserror::Error;

use crate::key::{ContentHash, RecipeId};
use crate::kind::{AnyKind, Entry, Kind, Portability, Work};
use crate::parameters::{self, ParameterError, Parameters};
use crate::project::{Project, Subject};
use crate::record::{KeyRecord, Part, Parts, Source, digest};

/// A node of a [`Graph`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeIdx(u32);

impl NodeIdx {
    /// Position in [`Graph::nodes`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Another artefact that an artefact is computed from.
pub struct Dep<K> {
    node: NodeIdx,
    kind: PhantomData<fn() -> K>,
}

impl<K> Dep<K> {
    /// The node.
    pub fn node(&self) -> NodeIdx {
        self.node
    }
}

impl<K> Clone for Dep<K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K> Copy for Dep<K> {}

impl<K> fmt::Debug for Dep<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "n{}", self.node.0)
    }
}

/// Why a project gives no graph.
#[derive(Debug, Clone, Error, PartialEq)]
pub enum PlanError {
    /// A parameter given by hand was refused.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A number that a key cannot hold.
    #[error("{kind} of {subject}: {part} is not a finite number")]
    NotFinite {
        /// The kind.
        kind: &'static str,
        /// What it is about.
        subject: String,
        /// The part that holds the number.
        part: String,
    },
    /// The links of an arm give no chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// An artefact to be known.
pub struct Node {
    /// Its kind.
    pub kind: &'static dyn AnyKind,
    /// What it is about, as people call it. Several when equal inputs make them share one artefact.
    pub subjects: Vec<String>,
    /// What it is made of by recipe; the artefact parts hold recipe ids.
    pub recipe_record: KeyRecord,
    /// Hash of the above.
    pub recipe: RecipeId,
    /// The artefacts it is computed from, in the order in which its kind asked for them; they come earlier in the graph.
    pub inputs: Vec<NodeIdx>,
    /// Values of the parameters, in the order of the kind's table.
    pub parameters: Vec<ParameterValue>,
    /// The values they would have if none were given.
    pub defaults: Vec<ParameterValue>,
    #[cfg_attr(not(feature = "build"), expect(dead_code, reason = "only builds read it"))]
    pub(crate) work: Box<dyn Any + Send + Sync>,
}

impl Node {
    /// Name of the kind.
    pub fn kind_name(&self) -> &'static str {
        self.kind.info().name
    }

    /// `kind of subject`, for messages.
    pub fn title(&self) -> String {
        format!("{} of {}", self.kind_name(), self.subjects[0])
    }

    /// What its key is made of, once the contents of its inputs are known (in the order of `inputs`).
    pub fn key_record(&self, contents: &[ContentHash]) -> KeyRecord {
        let mut record = self.recipe_record.clone();
        let artefacts = record.parts.iter_mut().filter(|part| part.source == Source::Artefact);
        for (part, content) in artefacts.zip(contents) {
            part.digest = *content.as_bytes();
        }
        record
    }
}

impl fmt::Debug for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.title(), self.recipe.short())
    }
}

/// All artefacts of a project, inputs before what is computed from them.
pub struct Graph {
    project: Project,
    nodes: Vec<Node>,
    by_subject: BTreeMap<(&'static str, String), NodeIdx>,
}

impl Graph {
    /// Plans the artefacts of all registered kinds for all their subjects.
    pub fn plan(project: &Project) -> Result<Self, PlanError> {
        Self::plan_kinds(project, crate::kinds::ALL)
    }

    /// Plans the artefacts of these kinds, and of those they are computed from.
    pub fn plan_kinds(project: &Project, kinds: &[&'static dyn AnyKind]) -> Result<Self, PlanError> {
        for (kind, values) in &project.given().kinds {
            let known = crate::kinds::find(kind).or(kinds.iter().copied().find(|k| k.info().name == kind));
            let known = known.ok_or_else(|| ParameterError::UnknownKind(kind.clone()))?;
            for (name, value) in values {
                parameters::check(known.info().parameters, kind, name, value)?;
            }
        }
        let mut planner = Planner {
            project,
            nodes: Vec::new(),
            by_subject: BTreeMap::new(),
            by_recipe: BTreeMap::new(),
            open: Vec::new(),
        };
        for kind in kinds {
            kind.plan_all(&mut planner)?;
        }
        Ok(Self { project: project.clone(), nodes: planner.nodes, by_subject: planner.by_subject })
    }

    /// The project.
    pub fn project(&self) -> &Project {
        &self.project
    }

    /// The nodes, inputs first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// A node.
    pub fn node(&self, node: NodeIdx) -> &Node {
        &self.nodes[node.index()]
    }

    /// All indices, inputs first.
    pub fn indices(&self) -> impl ExactSizeIterator<Item = NodeIdx> + use<> {
        (0..self.nodes.len() as u32).map(NodeIdx)
    }

    /// The artefact of kind `K` about a subject, or `None` when none was planned.
    pub fn find<K: Kind>(&self, subject: &K::Subject) -> Option<Dep<K>> {
        let node = *self.by_subject.get(&(K::NAME, subject.label(&self.project)))?;
        Some(Dep { node, kind: PhantomData })
    }

    /// The nodes whose recipe begins with these hexadecimal digits.
    pub fn with_recipe(&self, digits: &str) -> Vec<NodeIdx> {
        self.indices().filter(|&node| self.node(node).recipe.to_string().starts_with(digits)).collect()
    }

    /// The length of the longest chain of inputs below each node: those of one level do not need each other.
    pub fn levels(&self) -> Vec<usize> {
        let mut levels: Vec<usize> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            levels.push(node.inputs.iter().map(|input| levels[input.index()] + 1).max().unwrap_or(0));
        }
        levels
    }

    /// The graph in the language of Graphviz: one box per artefact, arrows from inputs to what is computed from them.
    pub fn to_dot(&self) -> String {
        let mut text =
            String::from("digraph robotc {\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\"];\n");
        for (i, node) in self.nodes.iter().enumerate() {
            let subjects: Vec<String> = node.subjects.iter().map(|s| escape(s)).collect();
            let (kind, recipe) = (node.kind_name(), node.recipe.short());
            text += &format!("  n{i} [label=\"{kind}\\n{}\\n{recipe}\"];\n", subjects.join("\\n"));
        }
        for (i, node) in self.nodes.iter().enumerate() {
            for input in &node.inputs {
                text += &format!("  n{} -> n{i};\n", input.0);
            }
        }
        text + "}\n"
    }
}

fn escape(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"")
}

/// Plans nodes on demand; each kind asks it for the artefacts it is computed from.
pub struct Planner<'a> {
    project: &'a Project,
    nodes: Vec<Node>,
    by_subject: BTreeMap<(&'static str, String), NodeIdx>,
    by_recipe: BTreeMap<RecipeId, NodeIdx>,
    /// Nodes being planned, outermost first.
    open: Vec<Open>,
}

struct Open {
    kind: &'static str,
    subject: String,
    inputs: Vec<(NodeIdx, String)>,
}

impl<'a> Planner<'a> {
    /// What is planned for.
    pub fn project(&self) -> &'a Project {
        self.project
    }

    /// The artefact of kind `K` about a subject. Asked while a node is being planned, it becomes an input of that node
    /// and a part of its key.
    pub fn need<K: Kind>(&mut self, subject: &K::Subject) -> Result<Dep<K>, PlanError>
    where
        Entry<K>: AnyKind,
    {
        let label = subject.label(self.project);
        let node = match self.by_subject.get(&(K::NAME, label.clone())) {
            Some(&node) => node,
            None => self.plan::<K>(subject, &label)?,
        };
        if let Some(open) = self.open.last_mut() {
            open.inputs.push((node, label));
        }
        Ok(Dep { node, kind: PhantomData })
    }

    fn plan<K: Kind>(&mut self, subject: &K::Subject, label: &str) -> Result<NodeIdx, PlanError>
    where
        Entry<K>: AnyKind,
    {
        let circular = self.open.iter().any(|open| open.kind == K::NAME && open.subject == label);
        assert!(!circular, "kinds are computed from each other in a circle: {} of {label}", K::NAME);
        self.open.push(Open { kind: K::NAME, subject: label.to_owned(), inputs: Vec::new() });
        let inputs = K::inputs(self, subject);
        let edges = self.open.pop().expect("pushed above").inputs;
        let inputs = inputs?;

        let mut parameters = K::defaults(&inputs);
        let defaults = parameters.values();
        for (name, value) in self.project.given().kinds.get(K::NAME).into_iter().flatten() {
            parameters.set(K::NAME, name, value)?;
        }
        let given = |name: &str| self.project.given().get(K::NAME, name).is_some();
        let origin = |name: &str| K::default_from(self.project, subject, name).filter(|_| !given(name));
        let parts = self.parts::<K>(&inputs, &parameters, origin, &edges, label)?;
        let recipe_record = KeyRecord {
            kind: K::NAME.to_owned(),
            format: K::FORMAT,
            algorithm: K::ALGORITHM,
            target: (K::PORTABILITY == Portability::SameTarget).then(|| TARGET.to_owned()),
            parts,
        };
        let recipe = recipe_record.recipe();
        let next = NodeIdx(u32::try_from(self.nodes.len()).expect("a graph has fewer than 2^32 nodes"));
        let node = *self.by_recipe.entry(recipe).or_insert(next);
        if node == next {
            self.nodes.push(Node {
                kind: const { &Entry::<K>::new() },
                subjects: Vec::new(),
                recipe_record,
                recipe,
                inputs: edges.iter().map(|(input, _)| *input).collect(),
                parameters: parameters.values(),
                defaults,
                work: Box::new(Work::<K> { inputs, parameters }),
            });
        }
        self.nodes[node.index()].subjects.push(label.to_owned());
        self.by_subject.insert((K::NAME, label.to_owned()), node);
        Ok(node)
    }

    fn parts<K: Kind>(
        &self,
        inputs: &K::Inputs,
        parameters: &K::Parameters,
        origin: impl Fn(&str) -> Option<String>,
        edges: &[(NodeIdx, String)],
        label: &str,
    ) -> Result<Vec<Part>, PlanError> {
        let refused = |part| PlanError::NotFinite { kind: K::NAME, subject: label.to_owned(), part };
        let mut specification = Parts::default();
        K::key_parts(inputs, &mut specification);
        let mut parts = specification.finish().map_err(refused)?;
        for (info, value) in K::Parameters::TABLE.iter().zip(parameters.values()) {
            parts.push(Part {
                source: Source::Parameter,
                role: info.name.to_owned(),
                name: origin(info.name).unwrap_or_default(),
                shown: Some(parameters::show(&value)),
                digest: digest(&value).map_err(|_| refused(format!("parameter {}", info.name)))?,
            });
        }
        for (input, name) in edges {
            let input = &self.nodes[input.index()];
            parts.push(Part {
                source: Source::Artefact,
                role: input.kind_name().to_owned(),
                name: name.clone(),
                shown: None,
                digest: *input.recipe.as_bytes(),
            });
        }
        Ok(parts)
    }
}

/// Processor architecture and system: part of the keys of kinds whose bytes depend on them.
const TARGET: &str = if cfg!(all(target_arch = "x86_64", target_os = "linux")) {
    "x86_64-linux"
} else if cfg!(all(target_arch = "aarch64", target_os = "linux")) {
    "aarch64-linux"
} else if cfg!(all(target_arch = "aarch64", target_os = "macos")) {
    "aarch64-macos"
} else if cfg!(all(target_arch = "x86_64", target_os = "windows")) {
    "x86_64-windows"
} else {
    "other"
};
