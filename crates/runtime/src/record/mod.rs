//! A scene with a timeline: what a run looked like, apart from how it was planned.
//!
//! A [`Recording`] knows nothing of planners or robots: nodes with surfaces and lines, a [`Track`] of poses for each
//! node, named stages and a few facts. It is filled from core types and written by [`crate::view`] as a page or as
//! glTF.
//!
//! ```
//! # use robotc_core::Pose;
//! # use robotc_core::model::{Geometry, Origin, Shape};
//! # use robotc_runtime::record::{Group, Recording};
//! let block = Geometry { origin: Origin::default(), shape: Shape::Box { size: [0.1; 3] }, colour: None };
//! let mut recording = Recording::new("a block slides");
//! let node = recording.add_body("block", Group::Object, &[block], Pose::identity());
//! recording.push_frame(0.0, [(node, Pose::translation(0.0, 0.0, 0.05))]);
//! recording.push_frame(1.0, [(node, Pose::translation(0.3, 0.0, 0.05))]);
//! recording.add_stage("slide", 0.0, 1.0);
//! assert_eq!(recording.duration(), 1.0);
//! ```

mod bounds;
mod build;
mod lines;
mod node;
mod surface;
mod tessellate;
mod track;

use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_core::ids::{Idx, TypedVec};
use robotc_core::model::TriMesh;

pub use bounds::Bounds;
pub use build::RobotNodes;
pub use lines::LineSet;
pub use node::{Group, Material, Node, NodeIdx, Part, SurfaceIdx};
pub use surface::Surface;
pub use track::{Sampled, Track};

/// A label fixed to a point of a node, drawn with constant size.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// What it says.
    pub text: String,
    /// The node it moves with; `None`: the world.
    pub node: Option<NodeIdx>,
    /// Where it points to, in the node's frame or the world.
    pub p_in_node: Point3<f64>,
}

/// A named section of the timeline.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// What happens, such as "approach".
    pub name: String,
    /// Seconds.
    pub start: f64,
    /// Seconds, not before `start`.
    pub end: f64,
}

/// A line of the table beside the picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// What is told, such as "seed".
    pub name: String,
    /// The value as it shall be read.
    pub value: String,
}

/// A scene and what moved in it.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// Title of page and file.
    pub title: String,
    /// A small table, in reading order.
    pub facts: Vec<Fact>,
    /// Sections of the timeline, in order of their start.
    pub stages: Vec<Stage>,
    /// Labels, in the order added.
    pub labels: Vec<Label>,
    surfaces: TypedVec<SurfaceIdx, Surface>,
    nodes: TypedVec<NodeIdx, Node>,
    /// Which surface was made from which mesh, so that a mesh used twice is stored once.
    made_from: Vec<(Arc<TriMesh>, SurfaceIdx)>,
}

impl Recording {
    /// An empty scene.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Surfaces, shared by the parts that refer to them.
    pub fn surfaces(&self) -> &TypedVec<SurfaceIdx, Surface> {
        &self.surfaces
    }

    /// Nodes; a parent comes before its children.
    pub fn nodes(&self) -> &TypedVec<NodeIdx, Node> {
        &self.nodes
    }

    /// Time of the last pose of any node or the last end of a stage, seconds; 0 when nothing moves.
    pub fn duration(&self) -> f64 {
        let tracks = self.nodes.iter().map(|n| n.track.end());
        tracks.chain(self.stages.iter().map(|s| s.end)).fold(0.0, f64::max)
    }

    /// `world_from_node` at a time, seconds; held constant before the first and after the last pose.
    pub fn world_from_node(&self, node: NodeIdx, time: f64) -> Pose {
        let node = &self.nodes[node];
        let parent_from_node = node.track.at(time);
        match node.parent {
            None => parent_from_node,
            Some(parent) => self.world_from_node(parent, time) * parent_from_node,
        }
    }

    /// Adds a line of the table.
    pub fn add_fact(&mut self, name: impl Into<String>, value: impl ToString) -> &mut Self {
        self.facts.push(Fact { name: name.into(), value: value.to_string() });
        self
    }

    /// Adds a section of the timeline, seconds. Sections are given in order.
    pub fn add_stage(&mut self, name: impl Into<String>, start: f64, end: f64) -> &mut Self {
        self.stages.push(Stage { name: name.into(), start, end: end.max(start) });
        self
    }

    /// Adds a label at a point of a node, or of the world.
    pub fn add_label(
        &mut self,
        text: impl Into<String>,
        node: Option<NodeIdx>,
        p_in_node: Point3<f64>,
    ) -> &mut Self {
        self.labels.push(Label { text: text.into(), node, p_in_node });
        self
    }

    /// Adds a surface for parts to refer to.
    pub fn add_surface(&mut self, surface: Surface) -> SurfaceIdx {
        self.surfaces.push(surface)
    }

    /// Adds a node. Its parent, if any, must have been added before.
    pub fn add_node(&mut self, node: Node) -> NodeIdx {
        if let Some(parent) = node.parent {
            assert!(parent.index() < self.nodes.len(), "a parent is added before its children");
        }
        self.nodes.push(node)
    }

    /// Records where nodes are at a time: seconds, not before the last one of the same node.
    ///
    /// Each pose is `parent_from_node`, which is `world_from_node` for a node with no parent. A node that does not
    /// move costs nothing, however often it is told.
    pub fn push_frame(&mut self, time: f64, poses: impl IntoIterator<Item = (NodeIdx, Pose)>) {
        for (node, parent_from_node) in poses {
            self.nodes[node].track.push(time, parent_from_node);
        }
    }

    /// Extent of everything solid in a set of groups over the whole timeline; `None` when there is nothing.
    pub fn bounds(&self, groups: &[Group]) -> Option<Bounds> {
        self.node_bounds(groups).into_iter().reduce(|a, b| a.join(&b))
    }

    /// Extent of each solid node of a set of groups over the whole timeline, in node order.
    pub fn node_bounds(&self, groups: &[Group]) -> Vec<Bounds> {
        bounds::of_nodes(self, groups)
    }
}
