//! Solids made of very many small convex ones: what sensors see, against convex parts.

use std::sync::Arc;

use nalgebra::{Matrix3, Point3, Vector3};

use super::{Aabb, ConvexPart, HeightField, Lump, Otherwise, PointCloud, RoomAsked};
use crate::Pose;
use crate::model::{Geometry, Shape};

/// A union of very many small convex solids, its lumps, in a tree whose nodes have convex covers.
#[derive(Debug, Clone)]
pub enum Pile {
    /// The balls of a cloud.
    Cloud(Arc<PointCloud>),
    /// The prisms of a height field.
    Field(Arc<HeightField>),
}

/// How much room there is between a part and a pile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PileRoom {
    /// Metres.
    pub gap: f64,
    /// A direction along which much of the pile is apart from the part, if one was looked for.
    pub along: Option<Vector3<f64>>,
}

/// Planes between a part and lumps of a pile, the one that was of use last first.
#[derive(Default)]
struct Planes {
    /// Normals away from the part, and how high it is along them; in the frame of the pile.
    planes: [(Vector3<f64>, f64); PLANES],
    len: usize,
}

/// So many planes are remembered.
const PLANES: usize = 4;

impl Planes {
    fn add(&mut self, part: &ConvexPart, part_from_pile: &Pose, direction: &Vector3<f64>) {
        let normal = part_from_pile.inverse_transform_vector(direction);
        let highest = part_from_pile.inverse_transform_point(part.support(direction));
        self.len = (self.len + 1).min(PLANES);
        self.planes[..self.len].rotate_right(1);
        self.planes[0] = (normal, normal.dot(&highest.coords));
    }

    /// Whether a lump is farther than `far` metres beyond one of them, up to rounding.
    fn clear(&mut self, lump: &Lump, far: f64) -> bool {
        let is_beyond =
            |(normal, height): &(Vector3<f64>, f64)| lump.lowest(normal) - height > far + ROUNDING;
        match self.planes[..self.len].iter().position(is_beyond) {
            Some(used) => {
                self.planes[..=used].rotate_right(1);
                true
            }
            None => false,
        }
    }
}

/// Heights above a plane are off by no more than this, metres.
const ROUNDING: f64 = 1e-12;

impl Pile {
    /// The pile that a shape is, if it is one; in the frame of the shape.
    pub fn of_shape(shape: &Shape) -> Option<Self> {
        match shape {
            Shape::Cloud { cloud, .. } => Some(Self::Cloud(cloud.clone())),
            Shape::HeightField { field, .. } => Some(Self::Field(field.clone())),
            Shape::Box { .. }
            | Shape::Cylinder { .. }
            | Shape::Capsule { .. }
            | Shape::Sphere { .. }
            | Shape::Mesh { .. } => None,
        }
    }

    /// The piles among the elements of a body, each with its pose in the frame of the body, in their order.
    pub fn all_of(geometry: &[Geometry]) -> impl Iterator<Item = (Self, Pose)> {
        geometry.iter().filter_map(|g| Some((Self::of_shape(&g.shape)?, g.origin.pose())))
    }

    /// Box around all of it.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Cloud(cloud) => cloud.bounds(),
            Self::Field(field) => field.bounds(),
        }
    }

    /// Goes through the tree, about from what is near to a point to what is far from it. `visit` is shown a node as a convex cover of
    /// all that is below it and says whether to go on below; it is shown single lumps with `true`, and what it says of these does
    /// not matter.
    pub fn walk(&self, from: &Point3<f64>, mut visit: impl FnMut(&Lump, bool) -> bool) {
        match self {
            Self::Cloud(cloud) => cloud.walk(from, &mut visit),
            Self::Field(field) => field.walk(from, &mut visit),
        }
    }

    /// At least nine tenths of the distance of a part, or `far` when it is farther away; never more than the distance. Zero when
    /// they touch. Metres.
    pub fn gap(&self, part: &ConvexPart, part_from_pile: &Pose, far: f64) -> f64 {
        let asked = RoomAsked { least: 0.0, enough: far, otherwise: Otherwise::Roughly, along: None };
        self.room(part, part_from_pile, &asked).map_or(0.0, |room| room.gap)
    }

    /// How far away a part is: more than is asked at least, no more than its distance or enough, and otherwise as [`Otherwise`]
    /// says. `None` when it is nearer, or when that cannot be told. Directions are from the part to the pile, as the part sees
    /// them.
    ///
    /// A plane between the part and one lump has many more on its other side: each plane that was found is tried on nodes and
    /// lumps before they are looked at for themselves.
    pub fn room(&self, part: &ConvexPart, part_from_pile: &Pose, asked: &RoomAsked) -> Option<PileRoom> {
        let query = Query::new(part, part_from_pile);
        let mut planes = Planes::default();
        if let Some(along) = &asked.along {
            planes.add(part, part_from_pile, along);
        }
        // What is asked about lumps that are still to come.
        let mut now = RoomAsked { enough: asked.enough.max(asked.least), along: None, ..*asked };
        let mut touches = false;
        self.walk(&query.centre, |lump, leaf| {
            let bound = if touches { f64::INFINITY } else { query.bound(lump) };
            if bound > now.enough || planes.clear(lump, now.enough) {
                return false;
            }
            // What is apart along no face is hardly ever apart.
            let turned = query.bound_turned(&lump.bounds());
            if turned > now.enough {
                return false;
            }
            if !leaf && bound.max(turned) <= 0.0 {
                return true;
            }
            // Of a node it matters only whether it can be left out.
            let least = if leaf { now.least } else { now.enough };
            match lump.room(part, part_from_pile, &RoomAsked { least, ..now }) {
                Some(apart) if apart.gap > now.enough => planes.add(part, part_from_pile, &apart.direction),
                Some(apart) if leaf => {
                    planes.add(part, part_from_pile, &apart.direction);
                    now.enough = match now.otherwise {
                        Otherwise::Roughly => apart.gap,
                        Otherwise::Anything => now.least,
                    };
                }
                None if leaf => touches = true,
                Some(_) | None => return true,
            }
            false
        });
        let along = planes.planes[..planes.len].first().map(|plane| part_from_pile * plane.0);
        (!touches).then_some(PileRoom { gap: now.enough, along })
    }

    /// Whether a part is not more than `margin` metres away. "No" is certain; doubt counts as "yes".
    pub fn is_within(&self, part: &ConvexPart, part_from_pile: &Pose, margin: f64) -> bool {
        let query = Query::new(part, part_from_pile);
        let mut found = false;
        self.walk(&query.centre, |lump, leaf| {
            // A nanometre more, for rounding.
            if found || query.bound(lump) > margin + 1e-9 || !lump.is_within(part, part_from_pile, margin) {
                return false;
            }
            found |= leaf;
            true
        });
        found
    }

    /// How deep a part is in the lump that it is deepest in, metres, as [`Lump::depth`] counts it: not zero exactly when they touch, and a
    /// motion by some distance makes it deeper by no more than that.
    pub fn depth(&self, part: &ConvexPart, part_from_pile: &Pose) -> f64 {
        let query = Query::new(part, part_from_pile);
        let mut deepest: f64 = 0.0;
        self.walk(&query.centre, |lump, leaf| {
            // Apart along an axis is not deep, while what is apart along others may count as deep.
            if lump.bounds().distance_between(&query.bounds) > 0.0 {
                return false;
            }
            if leaf {
                deepest = deepest.max(lump.depth(part, part_from_pile));
            }
            true
        });
        deepest
    }
}

/// A part as a pile sees it.
struct Query {
    bounds: Aabb,
    centre: Point3<f64>,
    radius: f64,
    /// The box around the part in its own frame, which fits more closely; and how the part sees the pile.
    own: Aabb,
    part_from_pile: Matrix3<f64>,
    pile_in_part: Vector3<f64>,
}

impl Query {
    fn new(part: &ConvexPart, part_from_pile: &Pose) -> Self {
        let pile_from_part = part_from_pile.inverse();
        let (centre, radius) = part.bounding_sphere();
        Self {
            bounds: part.bounds().transformed(&pile_from_part),
            centre: pile_from_part * centre,
            radius,
            own: *part.bounds(),
            part_from_pile: *part_from_pile.rotation.to_rotation_matrix().matrix(),
            pile_in_part: part_from_pile.translation.vector,
        }
    }

    fn bound(&self, lump: &Lump) -> f64 {
        lump.bound(&self.bounds, &self.centre, self.radius)
    }

    /// No more than the distance of the part from a box, along the axes of the part.
    fn bound_turned(&self, of_pile: &Aabb) -> f64 {
        let centre = Point3::from(self.part_from_pile * of_pile.centre().coords + self.pile_in_part);
        let half = self.part_from_pile.abs() * (of_pile.size() * 0.5);
        self.own.distance_between(&Aabb { low: centre - half, high: centre + half }) - ROUNDING
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{box_part, cylinder_part, sphere_part};
    use crate::rng::{Rng, Seed};
    use nalgebra::Translation3;

    fn point(rng: &mut Rng, size: f64) -> Point3<f64> {
        Point3::new(rng.range(-size, size), rng.range(-size, size), rng.range(-size, size))
    }

    fn part(rng: &mut Rng) -> ConvexPart {
        match rng.below(3) {
            0 => box_part(Vector3::new(rng.range(0.02, 0.3), rng.range(0.02, 0.3), rng.range(0.02, 0.3))),
            1 => cylinder_part(rng.range(0.02, 0.1), rng.range(0.05, 0.4)),
            _ => sphere_part(rng.range(0.02, 0.2)),
        }
    }

    fn pile(rng: &mut Rng) -> Pile {
        if rng.below(2) == 0 {
            let n = 1 + rng.below(200);
            let points = (0..n).map(|_| point(rng, 0.5)).collect();
            return Pile::Cloud(Arc::new(PointCloud::new(points, rng.range(0.002, 0.05)).unwrap()));
        }
        let (rows, columns) = (2 + rng.below(9), 2 + rng.below(9));
        let mut height = || if rng.below(12) == 0 { f64::NAN } else { rng.range(-0.3, 0.1) };
        let heights = (0..rows * columns).map(|_| height()).collect();
        match HeightField::new(columns, heights, [0.12, 0.1], Some(-0.5)) {
            Ok(field) => Pile::Field(Arc::new(field)),
            Err(_) => pile(rng),
        }
    }

    fn lumps(pile: &Pile) -> Vec<Lump> {
        let mut all = Vec::new();
        pile.walk(&Point3::origin(), |lump, leaf| {
            all.extend(leaf.then_some(*lump));
            true
        });
        all
    }

    #[test]
    fn answers_are_those_of_looking_at_every_lump() {
        let mut rng = Seed::new(42).rng();
        let (mut apart, mut deep) = (0, 0);
        for _ in 0..700 {
            let (pile, part) = (pile(&mut rng), part(&mut rng));
            let lumps = lumps(&pile);
            assert!(lumps.iter().all(|l| pile.bounds().padded(1e-9).distance_between(&l.bounds()) == 0.0));
            let pile_from_part = Pose::from_parts(point(&mut rng, 0.8).coords.into(), rng.rotation());
            let part_from_pile = pile_from_part.inverse();
            let distances = lumps.iter().map(|lump| lump.distance(&part, &part_from_pile));
            let expected = distances.fold(f64::INFINITY, f64::min);
            for far in [f64::INFINITY, 0.2] {
                let found = pile.gap(&part, &part_from_pile, far);
                assert!(found <= expected.min(far) + 1e-9, "{found} {expected}");
                assert!(found >= 0.9 * expected.min(far) - 1e-9, "{found} {expected}");
            }
            for (least, enough) in
                [(0.0, 0.1), (0.5 * expected, 0.8 * expected), (0.9 * expected, 2.0 * expected)]
            {
                let asked = RoomAsked { least, enough, otherwise: Otherwise::Anything, along: None };
                let found = pile.room(&part, &part_from_pile, &asked);
                assert_eq!(found.is_some(), expected > least, "{expected} {asked:?}");
                let Some(PileRoom { gap: found, .. }) = found else { continue };
                assert!(found <= expected + 1e-9 && found >= least, "{found} {expected} {asked:?}");
                assert_eq!(found >= enough, expected > enough, "{found} {expected} {asked:?}");
            }
            assert!(pile.is_within(&part, &part_from_pile, expected + 1e-7));
            assert!(expected < 1e-6 || !pile.is_within(&part, &part_from_pile, expected - 1e-6));
            let depth = pile.depth(&part, &part_from_pile);
            let touches = expected == 0.0;
            apart += usize::from(!touches);
            deep += usize::from(depth > 1e-3);
            assert!(!touches || depth > -1e-9);
            let brute = lumps.iter().map(|lump| lump.depth(&part, &part_from_pile));
            assert!((brute.fold(0.0, f64::max) - depth).abs() < 1e-9);
            let by = rng.range(0.0, 0.05);
            let moved = part_from_pile * Translation3::from(rng.direction().into_inner() * by);
            let then = pile.depth(&part, &moved);
            assert!(then <= depth + by + 1e-6, "{depth} {then} {by}");
        }
        assert!(apart > 100 && deep > 50, "{apart} {deep}");
    }

    #[test]
    fn what_is_in_a_ball_is_as_deep_as_its_way_out() {
        let cloud = PointCloud::new(vec![Point3::origin()], 0.02).unwrap();
        let pile = Pile::Cloud(Arc::new(cloud));
        let part = box_part(Vector3::new(0.2, 0.2, 0.1));
        let depth = |z: f64| pile.depth(&part, &Pose::translation(0.0, 0.0, z));
        for (z, expected) in [(0.0, 0.07), (0.04, 0.03), (0.06, 0.01), (0.08, 0.0)] {
            assert!((depth(z) - expected).abs() < 1e-9, "{z}: {}", depth(z));
        }
    }
}
