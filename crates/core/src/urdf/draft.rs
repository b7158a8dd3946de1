//! A description as written, each part with its place: between the XML tree and the robot model.

use crate::diag::Span;
use crate::model::{Inertial, Origin};

/// A name and where it is written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Name {
    pub(super) text: String,
    pub(super) span: Span,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum ShapeDraft {
    Box { size: [f64; 3] },
    Cylinder { radius: f64, length: f64 },
    Capsule { radius: f64, length: f64 },
    Sphere { radius: f64 },
    Mesh { uri: Name, scale: [f64; 3] },
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct GeometryDraft {
    pub(super) origin: Origin,
    pub(super) shape: ShapeDraft,
    pub(super) colour: Option<[f64; 4]>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct LinkDraft {
    pub(super) name: Name,
    pub(super) visuals: Vec<GeometryDraft>,
    pub(super) collisions: Vec<GeometryDraft>,
    pub(super) inertial: Option<Inertial>,
}

impl LinkDraft {
    /// A link of which only the name is known.
    pub(super) fn bare(name: Name) -> Self {
        Self { name, visuals: Vec::new(), collisions: Vec::new(), inertial: None }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum JointKind {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    Floating,
    Planar,
}

impl JointKind {
    pub(super) const NAMES: [(&'static str, Self); 6] = [
        ("fixed", Self::Fixed),
        ("revolute", Self::Revolute),
        ("continuous", Self::Continuous),
        ("prismatic", Self::Prismatic),
        ("floating", Self::Floating),
        ("planar", Self::Planar),
    ];

    pub(super) fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, kind)| *kind == self).map_or("fixed", |(name, _)| name)
    }

    pub(super) fn moves(self) -> bool {
        self != Self::Fixed
    }
}

/// Position and speed limits as far as the file gives them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct LimitsDraft {
    pub(super) lower: Option<f64>,
    pub(super) upper: Option<f64>,
    pub(super) velocity: Option<f64>,
    pub(super) effort: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct MimicDraft {
    pub(super) joint: Name,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointDraft {
    pub(super) name: Name,
    pub(super) kind: JointKind,
    pub(super) parent: Name,
    pub(super) child: Name,
    pub(super) origin: Origin,
    pub(super) axis: [f64; 3],
    pub(super) axis_span: Span,
    pub(super) limits: LimitsDraft,
    pub(super) limits_span: Span,
    /// Lower and upper of the safety controller.
    pub(super) soft_limits: (Option<f64>, Option<f64>),
    pub(super) mimic: Option<MimicDraft>,
}

/// A whole description.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Draft {
    pub(super) name: String,
    pub(super) span: Span,
    pub(super) links: Vec<LinkDraft>,
    pub(super) joints: Vec<JointDraft>,
}
