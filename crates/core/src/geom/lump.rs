//! Small convex solids of which large ones are made: see [`Pile`](super::Pile).

use nalgebra::{Point3, Unit, Vector3};

use super::gjk::{Ask, Convex, Gap, Pair};
use super::{Aabb, ConvexPart, RoomAsked, Separation};
use crate::Pose;

/// A convex solid that is described by a few numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lump {
    /// A ball.
    Ball {
        /// Its middle.
        centre: Point3<f64>,
        /// Metres.
        radius: f64,
    },
    /// Everything within a distance of a box.
    Box {
        /// The box.
        bounds: Aabb,
        /// The distance, metres.
        radius: f64,
    },
    /// Everything between a triangle and the level of a floor below it.
    Prism {
        /// Corners of the triangle, counter-clockwise seen from above.
        top: [Point3<f64>; 3],
        /// z of the floor.
        floor: f64,
    },
}

/// The same without what it is grown by.
struct Core<'l>(&'l Lump);

impl Convex for Core<'_> {
    fn farthest(&self, direction: &Vector3<f64>) -> Point3<f64> {
        match self.0 {
            Lump::Ball { centre, .. } => *centre,
            Lump::Box { bounds: Aabb { low, high }, .. } => {
                let side = |k: usize| if direction[k] < 0.0 { low[k] } else { high[k] };
                Point3::new(side(0), side(1), side(2))
            }
            Lump::Prism { top, floor } => {
                let up = direction.z >= 0.0;
                let corner = |p: &Point3<f64>| Point3::new(p.x, p.y, if up { p.z } else { *floor });
                let [a, b, c] = [corner(&top[0]), corner(&top[1]), corner(&top[2])];
                let height = |p: &Point3<f64>| direction.dot(&p.coords);
                let ab = if height(&b) > height(&a) { b } else { a };
                if height(&c) > height(&ab) { c } else { ab }
            }
        }
    }

    fn middle(&self) -> Point3<f64> {
        match self.0 {
            Lump::Ball { centre, .. } => *centre,
            Lump::Box { bounds, .. } => bounds.centre(),
            Lump::Prism { top: [a, b, c], floor } => {
                let top = (a.coords + b.coords + c.coords) / 3.0;
                Point3::new(top.x, top.y, 0.5 * (top.z + floor))
            }
        }
    }
}

impl Lump {
    /// A box around it.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Ball { centre, radius } => Aabb { low: *centre, high: *centre }.padded(*radius),
            Self::Box { bounds, radius } => bounds.padded(*radius),
            Self::Prism { top, floor } => {
                let mut bounds = Aabb::of_points(top).expect("three points");
                bounds.low.z = bounds.low.z.min(*floor);
                bounds
            }
        }
    }

    fn radius(&self) -> f64 {
        match self {
            Self::Ball { radius, .. } | Self::Box { radius, .. } => *radius,
            Self::Prism { .. } => 0.0,
        }
    }

    /// No more than the distance to anything that is inside both a box and a ball, at small cost; may be negative.
    pub fn bound(&self, within: &Aabb, centre: &Point3<f64>, radius: f64) -> f64 {
        let (bounds, grown) = match self {
            Self::Ball { centre: own, radius } => (Aabb { low: *own, high: *own }, *radius),
            Self::Box { bounds, radius } => (*bounds, *radius),
            Self::Prism { .. } => (self.bounds(), 0.0),
        };
        bounds.distance_between(within).max(bounds.distance_to(centre) - radius) - grown
    }

    /// The distance of a part, good to a nanometre; zero when they touch.
    pub fn distance(&self, part: &ConvexPart, part_from_lump: &Pose) -> f64 {
        match Pair::new(part, &Core(self), part_from_lump).gap(f64::INFINITY, Ask::Distance) {
            Gap::Apart { distance, .. } => (distance - self.radius()).max(0.0),
            Gap::Overlap { .. } | Gap::Near | Gap::Far => 0.0,
        }
    }

    /// Whether a part is not more than `margin` metres away. "No" is certain; doubt counts as "yes".
    pub fn is_within(&self, part: &ConvexPart, part_from_lump: &Pose, margin: f64) -> bool {
        let gap = Pair::new(part, &Core(self), part_from_lump).gap(margin + self.radius(), Ask::Whether);
        !matches!(gap, Gap::Far)
    }

    /// How deep a part is in it, metres; zero or less when they are apart along what is looked at. Of a ball this is the shortest
    /// way out; of a prism the shortest along an axis or square to one of its faces, which may be longer, and is no less than nothing for some
    /// that pass an edge without touching. A motion by some distance makes it deeper by no more than that.
    pub fn depth(&self, part: &ConvexPart, part_from_lump: &Pose) -> f64 {
        // What is there along the outward normal of a face, beyond the lowest point of the part.
        let along = |normal: Vector3<f64>, height: f64| {
            let lowest = part.support(&(part_from_lump.rotation * -normal));
            height - normal.dot(&part_from_lump.inverse_transform_point(lowest).coords)
        };
        let of_box = |bounds: &Aabb| {
            let of_axis = |k: usize| {
                let axis = Vector3::ith(k, 1.0);
                along(axis, bounds.high[k]).min(along(-axis, -bounds.low[k]))
            };
            of_axis(0).min(of_axis(1)).min(of_axis(2))
        };
        match self {
            Self::Ball { centre, radius } => {
                let height = part.height(&(part_from_lump * centre));
                match height <= 0.0 {
                    true => radius - height,
                    false => {
                        radius - Self::Ball { centre: *centre, radius: 0.0 }.distance(part, part_from_lump)
                    }
                }
            }
            Self::Box { .. } => of_box(&self.bounds()),
            Self::Prism { top: [a, b, c], .. } => {
                let up = (b - a).cross(&(c - a)).normalize();
                let side = |p: &Point3<f64>, q: &Point3<f64>| {
                    let normal = Vector3::new(q.y - p.y, p.x - q.x, 0.0).normalize();
                    along(normal, normal.dot(&p.coords))
                };
                let sides = side(a, b).min(side(b, c)).min(side(c, a));
                sides.min(along(up, up.dot(&a.coords))).min(of_box(&self.bounds()))
            }
        }
    }

    /// A direction, as the part sees it, from the part to this with a gap as asked: see [`room`](super::room()).
    pub fn room(&self, part: &ConvexPart, part_from_lump: &Pose, asked: &RoomAsked) -> Option<Separation> {
        let (direction, gap) = Pair::new(part, &Core(self), part_from_lump).room(self.radius(), asked)?;
        Some(Separation { direction: Unit::new_unchecked(direction), gap })
    }

    /// How far the lump is above the origin along a direction, all of it: metres.
    #[inline]
    pub(super) fn lowest(&self, direction: &Vector3<f64>) -> f64 {
        direction.dot(&Core(self).farthest(&-direction).coords) - self.radius()
    }

    /// A direction, as the part sees it, from the part to this along which there is a gap: see [`separation`](super::separation).
    /// `relative` counts the whole distance to the middle of what is round. `None` also when that leaves no gap.
    pub fn separation(&self, part: &ConvexPart, part_from_lump: &Pose, relative: f64) -> Option<Separation> {
        let (direction, gap) = Pair::new(part, &Core(self), part_from_lump).separation(relative)?;
        let gap = gap - self.radius();
        (gap > 0.0).then(|| Separation { direction: Unit::new_unchecked(direction), gap })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{box_part, contact, distance, sphere_part};
    use crate::rng::{Rng, Seed};

    fn point(rng: &mut Rng, size: f64) -> Point3<f64> {
        Point3::new(rng.range(-size, size), rng.range(-size, size), rng.range(-size, size))
    }

    /// The lump as a polytope, without what it is grown by.
    fn polytope(lump: &Lump) -> Option<ConvexPart> {
        let corners: Vec<Point3<f64>> = match lump {
            Lump::Ball { .. } => return None,
            Lump::Box { bounds: Aabb { low, high }, .. } => {
                let side = |i: usize, k: usize| if i >> k & 1 == 0 { low[k] } else { high[k] };
                (0..8).map(|i| Point3::new(side(i, 0), side(i, 1), side(i, 2))).collect()
            }
            Lump::Prism { top, floor } => {
                top.iter().flat_map(|p| [*p, Point3::new(p.x, p.y, *floor)]).collect()
            }
        };
        Some(ConvexPart::hull_of(&corners).expect("finite"))
    }

    #[test]
    fn distances_are_those_of_polytopes() {
        let mut rng = Seed::new(41).rng();
        let (mut apart, mut deep) = (0, 0);
        for trial in 0..1200 {
            let part = match trial % 2 {
                0 => box_part(Vector3::new(rng.range(0.05, 0.4), rng.range(0.05, 0.4), rng.range(0.05, 0.4))),
                _ => sphere_part(rng.range(0.05, 0.3)),
            };
            let radius = rng.range(0.0, 0.1);
            let (p, q, r) = (point(&mut rng, 0.6), point(&mut rng, 0.6), point(&mut rng, 0.6));
            let lump = match trial % 3 {
                0 => Lump::Ball { centre: p, radius },
                1 => Lump::Box { bounds: Aabb { low: p.inf(&q), high: p.sup(&q) }, radius },
                _ if (q - p).cross(&(r - p)).z > 0.0 => Lump::Prism { top: [p, q, r], floor: -0.8 },
                _ => Lump::Prism { top: [p, r, q], floor: -0.8 },
            };
            let is_flat = match &lump {
                Lump::Ball { .. } => false,
                Lump::Box { bounds, .. } => bounds.size().min() < 0.1,
                Lump::Prism { top: [a, b, c], .. } => (b - a).cross(&(c - a)).z < 0.1,
            };
            if is_flat {
                continue;
            }
            let lump_from_part = Pose::from_parts(point(&mut rng, 0.8).coords.into(), rng.rotation());
            let part_from_lump = lump_from_part.inverse();
            let expected = match polytope(&lump) {
                Some(own) => distance(&part, &lump_from_part, &own, &Pose::identity()).distance,
                None => {
                    let dot = box_part(Vector3::repeat(1e-9));
                    distance(&part, &lump_from_part, &dot, &Pose::from(p.coords)).distance
                }
            };
            let expected = (expected - lump.radius()).max(0.0);
            let found = lump.distance(&part, &part_from_lump);
            // A hull of points at one place is thickened by a little.
            assert!((found - expected).abs() < 2e-6, "{lump:?}: {found} {expected}");
            assert!(lump.is_within(&part, &part_from_lump, found + 1e-7));
            assert!(found < 1e-6 || !lump.is_within(&part, &part_from_lump, found - 1e-6));
            let (centre, around) = part.bounding_sphere();
            let bounds = part.bounds().transformed(&lump_from_part);
            assert!(lump.bound(&bounds, &(lump_from_part * centre), around) <= found + 1e-9);
            assert!(lump.bounds().distance_between(&bounds) <= found + 1e-9);
            if let Some(Separation { direction, gap }) = lump.separation(&part, &part_from_lump, 0.1) {
                apart += 1;
                assert!(gap <= found + 1e-9 && gap >= found - 0.1 * (found + lump.radius()) - 1e-9);
                // Moved by less than the gap along it, they are still apart.
                let shift = part_from_lump.inverse_transform_vector(&direction) * (gap - 1e-9);
                let moved = part_from_lump * nalgebra::Translation3::from(-shift);
                assert!(lump.distance(&part, &moved) > 0.0);
            } else {
                assert!(found <= 0.12 * lump.radius() + 1e-9, "{found}");
            }
            if found == 0.0 {
                let depth = lump.depth(&part, &part_from_lump);
                deep += 1;
                let least = match polytope(&lump) {
                    Some(own) if lump.radius() == 0.0 => {
                        let found = contact(&part, &lump_from_part, &own, &Pose::identity(), 1e-6);
                        found.expect("they touch").depth
                    }
                    _ => 0.0,
                };
                assert!(depth >= least - 1e-6, "{depth} {least}");
            }
            let by = rng.range(0.0, 0.1);
            let moved = part_from_lump * nalgebra::Translation3::from(rng.direction().into_inner() * by);
            let depths = (lump.depth(&part, &part_from_lump), lump.depth(&part, &moved));
            assert!(depths.1.max(0.0) <= depths.0.max(0.0) + by + 1e-9, "{lump:?} {depths:?} {by}");
        }
        assert!(deep > 50, "{deep}");
        assert!(apart > 150, "{apart}");
    }
}
