//! Several convex parts that cover one shape.

use nalgebra::Point3;

use super::{Aabb, ConvexPart};
use crate::Pose;

/// Convex parts in one frame; their union covers a shape. May be empty: a shape without extent in space.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ConvexParts {
    parts: Vec<ConvexPart>,
}

impl ConvexParts {
    /// These parts, in this order.
    pub fn new(parts: Vec<ConvexPart>) -> Self {
        Self { parts }
    }

    /// The parts as a slice.
    pub fn as_slice(&self) -> &[ConvexPart] {
        &self.parts
    }

    /// The parts, in order.
    pub fn iter(&self) -> std::slice::Iter<'_, ConvexPart> {
        self.parts.iter()
    }

    /// Number of parts.
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// Whether there is no part.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Box around all parts; `None` when there is none.
    pub fn bounds(&self) -> Option<Aabb> {
        self.parts.iter().map(|p| *p.bounds()).reduce(|a, b| a.union(&b))
    }

    /// Whether some part contains the point.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        self.parts.iter().any(|p| p.contains(point))
    }

    /// Smallest [`ConvexPart::height`] of the point over all parts: not positive exactly when some part contains
    /// it; infinite without parts. Metres.
    pub fn height(&self, point: &Point3<f64>) -> f64 {
        self.parts.iter().map(|p| p.height(point)).fold(f64::INFINITY, f64::min)
    }

    /// All parts moved by `target_from_parts`.
    pub fn transformed(&self, target_from_parts: &Pose) -> Self {
        Self { parts: self.parts.iter().map(|p| p.transformed(target_from_parts)).collect() }
    }

    /// Appends the parts of `other`, which are in the same frame.
    pub fn extend(&mut self, other: Self) {
        self.parts.extend(other.parts);
    }

    /// All corners of all parts.
    pub fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.parts.iter().flat_map(|p| p.points())
    }
}

impl FromIterator<ConvexPart> for ConvexParts {
    fn from_iter<I: IntoIterator<Item = ConvexPart>>(parts: I) -> Self {
        Self { parts: parts.into_iter().collect() }
    }
}

impl<'a> IntoIterator for &'a ConvexParts {
    type Item = &'a ConvexPart;
    type IntoIter = std::slice::Iter<'a, ConvexPart>;
    fn into_iter(self) -> Self::IntoIter {
        self.parts.iter()
    }
}
