//! Convex parts and piles with the bounds that most comparisons are settled by.

use nalgebra::{Point3, Vector3};
use robotc_core::Pose;
use robotc_core::geom::{self, Aabb, ConvexPart, ConvexParts, Pile, RoomAsked, box_part, contact};
use robotc_core::model::Geometry;

use super::between::Hint;

/// One part with its bounds.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub(super) part: ConvexPart,
    pub(super) bounds: Aabb,
    /// Centre and radius of a sphere around it.
    pub(super) centre: Point3<f64>,
    pub(super) radius: f64,
}

/// A cloud or a height field where it is in its body.
#[derive(Debug, Clone)]
pub(crate) struct PlacedPile {
    pub(crate) pile: Pile,
    pub(crate) body_from_pile: Pose,
    /// In the frame of the body.
    pub(super) bounds: Aabb,
}

/// One of the things that a body is made of.
#[derive(Clone, Copy)]
pub(super) enum Solid<'s> {
    Part(&'s Part),
    Pile(&'s PlacedPile),
}

/// The parts and piles of one body with bounds of all.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) parts: Vec<Part>,
    pub(super) piles: Vec<PlacedPile>,
    /// A box around each pile.
    boxes: Vec<Part>,
    pub(super) bounds: Aabb,
    pub(super) centre: Point3<f64>,
    pub(super) radius: f64,
}

impl Part {
    fn new(part: &ConvexPart) -> Self {
        let (centre, radius) = part.bounding_sphere();
        Self { part: part.clone(), bounds: *part.bounds(), centre, radius }
    }
}

impl Shape {
    /// Convex parts, and the piles among some elements.
    pub(super) fn new(parts: &ConvexParts, elements: &[Geometry]) -> Self {
        let placed = |(pile, body_from_pile): (Pile, Pose)| {
            let bounds = pile.bounds().transformed(&body_from_pile);
            PlacedPile { pile, body_from_pile, bounds }
        };
        let piles: Vec<PlacedPile> = Pile::all_of(elements).map(placed).collect();
        let around = |pile: &PlacedPile| {
            let size = pile.bounds.size().sup(&Vector3::repeat(1e-6));
            Part::new(&box_part(size).transformed(&Pose::from(pile.bounds.centre().coords)))
        };
        let parts: Vec<Part> = parts.iter().map(Part::new).collect();
        let boxes: Vec<Part> = piles.iter().map(around).collect();
        let mut shape = Self {
            parts,
            piles,
            boxes,
            bounds: Aabb { low: Point3::origin(), high: Point3::origin() },
            centre: Point3::origin(),
            radius: 0.0,
        };
        let bounds = shape.cover().map(|part| part.bounds).reduce(|a, b| a.union(&b));
        shape.bounds = bounds.unwrap_or(shape.bounds);
        shape.centre = shape.bounds.centre();
        shape.radius = shape.points().map(|p| (p - shape.centre).norm()).fold(0.0, f64::max);
        shape
    }

    pub(super) fn is_empty(&self) -> bool {
        self.parts.is_empty() && self.piles.is_empty()
    }

    /// Convex parts that cover all of it: what counts when it moves. A pile is in its box.
    pub(super) fn cover(&self) -> impl Iterator<Item = &Part> {
        self.parts.iter().chain(&self.boxes)
    }

    /// What it is made of.
    pub(super) fn solids(&self) -> impl Iterator<Item = Solid<'_>> {
        self.parts.iter().map(Solid::Part).chain(self.piles.iter().map(Solid::Pile))
    }

    fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.cover().flat_map(|part| part.part.points())
    }

    /// Largest distance of a point from the origin of the frame, metres.
    pub(super) fn radius_about_origin(&self) -> f64 {
        self.points().map(|p| p.coords.norm()).fold(0.0, f64::max)
    }
}

impl Solid<'_> {
    /// A box around it, in the frame of the body.
    pub(super) fn bounds(&self) -> &Aabb {
        match self {
            Self::Part(part) => &part.bounds,
            Self::Pile(pile) => &pile.bounds,
        }
    }

    /// How far away a part of another body is, metres: see [`room`](geom::room()).
    pub(super) fn room(
        &self,
        part: &ConvexPart,
        body_from_part: &Pose,
        part_from_body: &Pose,
        asked: &RoomAsked,
        hint: &mut Hint,
    ) -> Option<f64> {
        match self {
            Self::Part(own) => {
                let apart = geom::room(&own.part, part, body_from_part, asked)?;
                *hint = Some(apart.direction.into_inner());
                Some(apart.gap)
            }
            Self::Pile(own) => {
                // A pile is looked at from the part.
                let along = asked.along.map(|along| -(part_from_body * along));
                let asked = RoomAsked { along, ..*asked };
                let room = own.pile.room(part, &own.seen_by(part_from_body), &asked)?;
                *hint = room.along.map(|along| -(body_from_part * along)).or(*hint);
                Some(room.gap)
            }
        }
    }

    /// How deep it and a part of another body are in each other, metres.
    pub(super) fn depth(&self, part: &ConvexPart, body_from_part: &Pose, part_from_body: &Pose) -> f64 {
        match self {
            Self::Part(own) => contact(part, body_from_part, &own.part, &Pose::identity(), 0.0)
                .map_or(0.0, |found| found.depth),
            Self::Pile(own) => own.pile.depth(part, &own.seen_by(part_from_body)),
        }
    }
}

impl PlacedPile {
    /// The pile as a part sees it that sees the body like this.
    pub(crate) fn seen_by(&self, part_from_body: &Pose) -> Pose {
        part_from_body * self.body_from_pile
    }
}
