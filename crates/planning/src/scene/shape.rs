//! Convex parts with the bounds that most comparisons are settled by.

use nalgebra::Point3;
use robotc_core::geom::{Aabb, ConvexPart, ConvexParts};

/// One part with its bounds.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub(super) part: ConvexPart,
    pub(super) bounds: Aabb,
    /// Centre and radius of a sphere around it.
    pub(super) centre: Point3<f64>,
    pub(super) radius: f64,
}

/// The parts of one body with bounds of all.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) parts: Vec<Part>,
    pub(super) bounds: Aabb,
    pub(super) centre: Point3<f64>,
    pub(super) radius: f64,
}

impl Shape {
    pub(super) fn new(parts: &ConvexParts) -> Self {
        let origin = Aabb { low: Point3::origin(), high: Point3::origin() };
        let bounds = parts.bounds().unwrap_or(origin);
        let centre = bounds.centre();
        let radius = parts.points().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        let part = |part: &ConvexPart| {
            let (centre, radius) = part.bounding_sphere();
            Part { part: part.clone(), bounds: *part.bounds(), centre, radius }
        };
        Self { parts: parts.iter().map(part).collect(), bounds, centre, radius }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Largest distance of a point from the origin of the frame, metres.
    pub(super) fn radius_about_origin(&self) -> f64 {
        self.parts.iter().flat_map(|p| p.part.points()).map(|p| p.coords.norm()).fold(0.0, f64::max)
    }
}
