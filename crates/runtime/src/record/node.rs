//! Nodes of a scene: what moves as one, and how it looks.

use std::sync::Arc;

use robotc_core::Pose;
use robotc_core::ids::Idx;

use super::{LineSet, Track};

macro_rules! scene_idx {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(u32);

        impl Idx for $name {
            fn new(position: usize) -> Self {
                Self(u32::try_from(position).expect("tables hold fewer than 2^32 entries"))
            }
            fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

scene_idx!(
    /// A node of a recording.
    NodeIdx);
scene_idx!(
    /// A surface of a recording.
    SurfaceIdx);

/// What a node is, for switching on and off and for choosing its looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// A link of a robot.
    Robot,
    /// Something that can be moved.
    Object,
    /// Something that stays.
    Obstacle,
    /// Where the tool went.
    Path,
    /// Where an object can be grasped.
    Grasp,
    /// Where fingers press on an object.
    Contact,
    /// Where the tip of an arm, or its base, can be.
    Reach,
    /// What planners searched.
    Tree,
    /// Coordinate axes.
    Frame,
}

impl Group {
    /// All groups, in the order they are listed to people.
    pub const ALL: [Self; 9] = [
        Self::Robot,
        Self::Object,
        Self::Obstacle,
        Self::Path,
        Self::Grasp,
        Self::Contact,
        Self::Reach,
        Self::Tree,
        Self::Frame,
    ];

    /// The name people read.
    pub fn title(self) -> &'static str {
        match self {
            Self::Robot => "Robot",
            Self::Object => "Objects",
            Self::Obstacle => "Obstacles",
            Self::Path => "Tool path",
            Self::Grasp => "Grasps",
            Self::Contact => "Contacts",
            Self::Reach => "Reach",
            Self::Tree => "Search trees",
            Self::Frame => "Frames",
        }
    }

    /// Whether it is shown before anyone switches it.
    pub fn shown_at_first(self) -> bool {
        !matches!(self, Self::Grasp | Self::Tree | Self::Frame)
    }
}

/// How a surface takes light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Red, green, blue, opacity in 0..=1; sRGB as colours are written, not linear light.
    pub colour: [f32; 4],
    /// 0 polished to 1 matt.
    pub roughness: f32,
    /// 0 for plastic, wood, paint; 1 for bare metal.
    pub metallic: f32,
}

impl Material {
    /// Painted or moulded: not metallic, a soft sheen.
    pub fn painted(colour: [f32; 4]) -> Self {
        Self { colour, roughness: 0.45, metallic: 0.0 }
    }

    /// Matt, like wood or board.
    pub fn matt(colour: [f32; 4]) -> Self {
        Self { colour, roughness: 0.8, metallic: 0.0 }
    }
}

/// A surface in a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The surface.
    pub surface: SurfaceIdx,
    /// How it looks.
    pub material: Material,
    /// Where the surface's frame sits in the node.
    pub node_from_part: Pose,
}

/// What moves as one: surfaces and lines with a name and a track of poses.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Name, for people.
    pub name: String,
    /// What it is.
    pub group: Group,
    /// The node whose frame its poses are given in; `None`: the world.
    pub parent: Option<NodeIdx>,
    /// Its surfaces.
    pub parts: Vec<Part>,
    /// Its lines, in the node's frame.
    pub lines: Vec<Arc<LineSet>>,
    /// `parent_from_node` over time.
    pub track: Track,
}

impl Node {
    /// A node that holds nothing yet.
    pub fn new(name: impl Into<String>, group: Group, parent_from_node: Pose) -> Self {
        Self {
            name: name.into(),
            group,
            parent: None,
            parts: Vec::new(),
            lines: Vec::new(),
            track: Track::still(parent_from_node),
        }
    }

    /// The same node in the frame of another.
    pub fn child_of(mut self, parent: NodeIdx) -> Self {
        self.parent = Some(parent);
        self
    }

    /// The same node with these lines as well.
    pub fn with_lines(mut self, lines: LineSet) -> Self {
        self.lines.push(Arc::new(lines));
        self
    }
}
