//! Do two parts touch, how far apart are they, how deep in each other.

use nalgebra::{Point3, Translation3, Unit, Vector3};

use super::gjk::{Ask, Gap, Pair};
use super::penetration::shortest_exit;
use super::{ConvexPart, ConvexParts};
use crate::Pose;

/// The distance of two parts with their nearest points, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Metres; zero when the parts touch or overlap.
    pub distance: f64,
    /// Nearest point of a; a common point when they overlap.
    pub on_a: Point3<f64>,
    /// Nearest point of b; the same common point when they overlap.
    pub on_b: Point3<f64>,
}

/// How two parts touch, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// On the surface of a: where b leaves it when moved along `normal`, or the nearest point when they are apart.
    pub on_a: Point3<f64>,
    /// On the surface of b: `on_a - depth * normal`.
    pub on_b: Point3<f64>,
    /// Unit direction from a to b: moving b along it by `depth` ends the overlap.
    pub normal: Unit<Vector3<f64>>,
    /// Metres; negative when the parts are apart.
    pub depth: f64,
}

/// Whether the parts share a point. Exact up to rounding; doubt counts as touching.
pub fn intersects(a: &ConvexPart, world_from_a: &Pose, b: &ConvexPart, world_from_b: &Pose) -> bool {
    within(a, world_from_a, b, world_from_b, 0.0)
}

/// Whether the parts are not more than `margin` metres apart. "No" is certain; doubt counts as "yes".
pub fn within(a: &ConvexPart, world_from_a: &Pose, b: &ConvexPart, world_from_b: &Pose, margin: f64) -> bool {
    let pair = Pair::new(a, b, &world_from_a.inv_mul(world_from_b));
    match pair.gap(margin, Ask::Whether) {
        Gap::Far => false,
        Gap::Overlap { .. } | Gap::Near | Gap::Apart { .. } => true,
    }
}

/// Whether some part of `a` and some part of `b` are not more than `margin` metres apart. "No" is certain; doubt counts
/// as "yes". Parts of which the sphere around one is far from the box around the other are not looked at.
pub fn any_within(
    a: &ConvexParts,
    world_from_a: &Pose,
    b: &ConvexParts,
    world_from_b: &Pose,
    margin: f64,
) -> bool {
    let a_from_b = world_from_a.inv_mul(world_from_b);
    let rotation = *a_from_b.rotation.to_rotation_matrix().matrix();
    let shift = a_from_b.translation.vector;
    b.iter().any(|part_b| {
        let (centre, radius_b) = part_b.bounding_sphere();
        let centre = Point3::from(rotation * centre.coords + shift);
        a.iter().any(|part_a| {
            // A nanometre more than the margin, for rounding.
            let reach = margin + 1e-9;
            if part_a.bounds().distance_to(&centre) > radius_b + reach {
                return false;
            }
            // The sphere of something long, such as a counter, says little; its box says more.
            let (centre_a, radius_a) = part_a.bounding_sphere();
            let centre_a = Point3::from(rotation.tr_mul(&(centre_a.coords - shift)));
            if part_b.bounds().distance_to(&centre_a) > radius_a + reach {
                return false;
            }
            let pair = Pair::with_matrix(part_a, part_b, rotation, shift);
            !matches!(pair.gap(margin, Ask::Whether), Gap::Far)
        })
    })
}

/// The distance of the parts and their nearest points, good to a nanometre.
pub fn distance(a: &ConvexPart, world_from_a: &Pose, b: &ConvexPart, world_from_b: &Pose) -> Distance {
    let pair = Pair::new(a, b, &world_from_a.inv_mul(world_from_b));
    match pair.gap(f64::INFINITY, Ask::Distance) {
        Gap::Apart { distance, on_a, on_b } => {
            Distance { distance, on_a: world_from_a * on_a, on_b: world_from_a * on_b }
        }
        Gap::Overlap { common } => {
            Distance { distance: 0.0, on_a: world_from_a * common, on_b: world_from_a * common }
        }
        Gap::Near | Gap::Far => unreachable!("a distance without a limit is found"),
    }
}

/// A direction along which two parts are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// From a to b, in the frame of a.
    pub direction: Unit<Vector3<f64>>,
    /// Metres between the parts along it; not more than their distance.
    pub gap: f64,
}

/// A direction with a gap of at least `1 - relative` times the distance of the parts: what a motion of b may safely use up.
/// Cheaper than [`distance`] when `relative` is large. `None` when the parts touch or overlap, or are too near to tell.
pub fn separation(a: &ConvexPart, b: &ConvexPart, a_from_b: &Pose, relative: f64) -> Option<Separation> {
    let (direction, gap) = Pair::new(a, b, a_from_b).separation(relative)?;
    Some(Separation { direction: Unit::new_unchecked(direction), gap })
}

/// What is asked about the room between two things.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoomAsked {
    /// They have to be farther apart than this, metres.
    pub least: f64,
    /// How much farther than this they are does not matter, metres.
    pub enough: f64,
    /// What is of use where it is less.
    pub otherwise: Otherwise,
    /// A direction, as [`Separation::direction`], that is looked along first: one that was of use not long ago.
    pub along: Option<Vector3<f64>>,
}

/// Of what use a gap is that is less than enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Otherwise {
    /// At least nine tenths of the distance are found.
    Roughly,
    /// It does not matter how far things are apart, as long as they are.
    Anything,
}

/// A direction along which two parts are farther apart than asked at least; `None` when there is none, or when that cannot be
/// told.
///
/// Its gap is more than enough, or else what [`Otherwise`] says. Cheaper than [`separation`] where little is asked.
pub fn room(a: &ConvexPart, b: &ConvexPart, a_from_b: &Pose, asked: &RoomAsked) -> Option<Separation> {
    let (direction, gap) = Pair::new(a, b, a_from_b).room(0.0, asked)?;
    Some(Separation { direction: Unit::new_unchecked(direction), gap })
}

/// How the parts touch; `None` when they are more than `margin` metres apart.
pub fn contact(
    a: &ConvexPart,
    world_from_a: &Pose,
    b: &ConvexPart,
    world_from_b: &Pose,
    margin: f64,
) -> Option<Contact> {
    let pair = Pair::new(a, b, &world_from_a.inv_mul(world_from_b));
    match pair.gap(margin, Ask::Distance) {
        Gap::Far => None,
        Gap::Apart { distance, on_a, on_b } => {
            let (on_a, on_b) = (world_from_a * on_a, world_from_a * on_b);
            match Unit::try_new(on_b - on_a, 1e-9) {
                Some(normal) => Some(Contact { on_a, on_b, normal, depth: -distance }),
                None => Some(overlap(a, world_from_a, b, world_from_b)),
            }
        }
        Gap::Overlap { .. } | Gap::Near => Some(overlap(a, world_from_a, b, world_from_b)),
    }
}

/// The contact of parts that overlap or touch.
fn overlap(a: &ConvexPart, world_from_a: &Pose, b: &ConvexPart, world_from_b: &Pose) -> Contact {
    let a_from_b = world_from_a.inv_mul(world_from_b);
    let exit = shortest_exit(a, b, &a_from_b);
    // Moved apart along the exit by a little, the nearest points are those that were deepest.
    let gap = 0.01 * (a.bounding_sphere().1 + b.bounding_sphere().1);
    let moved = Translation3::from(exit.normal * (exit.depth + gap)) * a_from_b;
    let (on_a, on_b) = match Pair::new(a, b, &moved).gap(f64::INFINITY, Ask::Distance) {
        Gap::Apart { on_a, on_b, .. } => (on_a, on_b - exit.normal * (exit.depth + gap)),
        _ => {
            let on_a = *a.support(&exit.normal);
            (on_a, on_a - exit.normal * exit.depth)
        }
    };
    Contact {
        on_a: world_from_a * on_a,
        on_b: world_from_a * on_b,
        normal: Unit::new_normalize(world_from_a.rotation * exit.normal),
        depth: exit.depth,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{box_part, cylinder_part, sphere_part};
    use super::*;
    use crate::rng::{Rng, Seed};
    use parry3d_f64::math::{Pose3, Vector};
    use parry3d_f64::query as reference;
    use parry3d_f64::shape::ConvexPolyhedron;

    fn random_part(rng: &mut Rng) -> ConvexPart {
        match rng.below(4) {
            0 => box_part(Vector3::new(rng.range(0.01, 1.0), rng.range(0.01, 1.0), rng.range(0.01, 1.0))),
            1 => cylinder_part(rng.range(0.01, 0.5), rng.range(0.01, 1.0)),
            2 => sphere_part(rng.range(0.01, 0.5)),
            _ => {
                let n = 4 + rng.below(25);
                let points: Vec<_> = (0..n)
                    .map(|_| Point3::from(rng.direction().into_inner() * rng.range(0.1, 0.5)))
                    .collect();
                ConvexPart::hull_of(&points).expect("finite")
            }
        }
    }

    fn random_pose(rng: &mut Rng) -> Pose {
        Pose::from_parts(
            Translation3::new(rng.range(-0.6, 0.6), rng.range(-0.6, 0.6), rng.range(-0.6, 0.6)),
            rng.rotation(),
        )
    }

    fn theirs(part: &ConvexPart) -> ConvexPolyhedron {
        let points: Vec<_> = part.points().iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
        ConvexPolyhedron::from_convex_hull(&points).expect("a proper polytope")
    }

    #[test]
    fn distances_and_depths_agree_with_the_library() {
        let mut rng = Seed::new(11).rng();
        let (mut apart, mut deep) = (0, 0);
        for _ in 0..1500 {
            let (a, b) = (random_part(&mut rng), random_part(&mut rng));
            let (world_from_a, world_from_b) = (random_pose(&mut rng), random_pose(&mut rng));
            let poses: [Pose3; 2] = [world_from_a.into(), world_from_b.into()];
            let expected = reference::distance(&poses[0], &theirs(&a), &poses[1], &theirs(&b));
            let expected = expected.expect("polytopes are supported").distance;
            let found = distance(&a, &world_from_a, &b, &world_from_b);
            assert!((found.distance - expected).abs() < 1e-6, "{} {expected}", found.distance);
            let touching = intersects(&a, &world_from_a, &b, &world_from_b);
            assert_eq!(touching, found.distance == 0.0);
            let heights = (
                a.height(&(world_from_a.inverse() * found.on_a)),
                b.height(&(world_from_b.inverse() * found.on_b)),
            );
            assert!(heights.0 < 1e-8 && heights.1 < 1e-8, "{heights:?} {found:?} {expected}");
            for relative in [1e-6, 0.1] {
                let found = separation(&a, &b, &world_from_a.inv_mul(&world_from_b), relative);
                assert_eq!(found.is_none(), touching);
                let Some(Separation { direction, gap }) = found else { continue };
                assert!(gap <= expected + 1e-6 && gap >= (1.0 - relative) * expected - 1e-6);
                let n = world_from_a.rotation * direction;
                let extent = |part: &ConvexPart, pose: &Pose, n: Vector3<f64>| {
                    n.dot(&(pose * part.support(&(pose.rotation.inverse() * n))).coords)
                };
                let between = -extent(&b, &world_from_b, -n.into_inner()) - extent(&a, &world_from_a, *n);
                assert!((between - gap).abs() < 1e-9, "{between} {gap}");
            }
            for (least, enough) in
                [(0.0, f64::INFINITY), (0.0, 0.05), (0.03, 0.2), (0.5 * expected, 0.7 * expected)]
            {
                for otherwise in [Otherwise::Roughly, Otherwise::Anything] {
                    let along = rng.unit() < 0.5;
                    let along = along.then(|| rng.direction().into_inner());
                    let asked = RoomAsked { least, enough, otherwise, along };
                    let found = room(&a, &b, &world_from_a.inv_mul(&world_from_b), &asked);
                    assert_eq!(found.is_some(), expected > least, "{expected} {asked:?}");
                    let Some(Separation { direction, gap }) = found else { continue };
                    let n = (world_from_a.rotation * direction).into_inner();
                    let reach = |part: &ConvexPart, pose: &Pose, n: Vector3<f64>| {
                        n.dot(&(pose * part.support(&(pose.rotation.inverse() * n))).coords)
                    };
                    let between = -reach(&b, &world_from_b, -n) - reach(&a, &world_from_a, n);
                    assert!((between - gap).abs() < 1e-9 && gap > least, "{between} {gap} {asked:?}");
                    let is_rough = gap >= 0.9 * expected - 1e-6;
                    assert!(
                        gap > enough
                            || is_rough
                            || otherwise == Otherwise::Anything && expected <= enough / 0.9
                    );
                }
            }
            if touching {
                deep += 1;
                let c = contact(&a, &world_from_a, &b, &world_from_b, 0.0).expect("they touch");
                assert!(c.depth >= 0.0);
                // Out by the depth is out, by a little less is not.
                let out = Translation3::from(c.normal.into_inner() * (c.depth + 1e-7)) * world_from_b;
                assert!(!intersects(&a, &world_from_a, &b, &out));
                let still = Translation3::from(c.normal.into_inner() * (c.depth - 1e-7)) * world_from_b;
                assert!(c.depth < 1e-6 || intersects(&a, &world_from_a, &b, &still));
                assert!(a.height(&(world_from_a.inverse() * c.on_a)).abs() < 1e-7);
                assert!(b.height(&(world_from_b.inverse() * c.on_b)).abs() < 1e-7);
                assert!((c.on_a - c.on_b - c.normal.into_inner() * c.depth).norm() < 1e-7);
                for i in 0..200 {
                    // No direction leads out on a shorter way, near the normal in particular.
                    let spread = 10.0_f64.powi(-(i % 6));
                    let n =
                        Unit::new_normalize(c.normal.into_inner() + rng.direction().into_inner() * spread);
                    let reach = |part: &ConvexPart, pose: &Pose, n: Vector3<f64>| {
                        n.dot(&(pose * part.support(&(pose.rotation.inverse() * n))).coords)
                    };
                    let n = n.into_inner();
                    let way = reach(&a, &world_from_a, n) + reach(&b, &world_from_b, -n);
                    assert!(way > c.depth - 1e-9, "{way} {}", c.depth);
                }
            } else {
                apart += 1;
                let d = found.distance;
                assert!(within(&a, &world_from_a, &b, &world_from_b, d * (1.0 + 1e-8)));
                assert!(!within(&a, &world_from_a, &b, &world_from_b, d * (1.0 - 1e-8) - 1e-9));
                assert!(contact(&a, &world_from_a, &b, &world_from_b, d * 0.9).is_none());
                let c = contact(&a, &world_from_a, &b, &world_from_b, d * 1.1).expect("within the margin");
                assert!((c.depth + d).abs() < 1e-9);
            }
        }
        assert!(apart > 300 && deep > 300, "{apart} {deep}");
    }

    #[test]
    fn lists_of_parts_touch_when_some_pair_does() {
        let mut rng = Seed::new(12).rng();
        let mut touching = 0;
        for _ in 0..300 {
            let mut draw = || {
                let n = rng.below(4);
                let mut parts = ConvexParts::default();
                for _ in 0..n {
                    let pose = random_pose(&mut rng);
                    let part = random_part(&mut rng);
                    parts.extend(ConvexParts::new(vec![part]).transformed(&pose));
                }
                (parts, random_pose(&mut rng))
            };
            let ((a, world_from_a), (b, world_from_b)) = (draw(), draw());
            let margin = rng.range(0.0, 0.2);
            let one = |p: &ConvexPart, q: &ConvexPart| within(p, &world_from_a, q, &world_from_b, margin);
            let expected = a.iter().any(|p| b.iter().any(|q| one(p, q)));
            assert_eq!(any_within(&a, &world_from_a, &b, &world_from_b, margin), expected);
            touching += usize::from(expected);
        }
        assert!(touching > 50 && touching < 250, "{touching}");
    }

    #[test]
    fn touching_faces_count_as_touching() {
        let part = box_part(Vector3::repeat(1.0));
        let beside = |x: f64| Pose::translation(x, 0.2, 0.0);
        assert!(intersects(&part, &Pose::identity(), &part, &beside(1.0)));
        assert!(!intersects(&part, &Pose::identity(), &part, &beside(1.0 + 1e-9)));
        let c = contact(&part, &Pose::identity(), &part, &beside(0.9), 0.0).expect("they overlap");
        assert!((c.depth - 0.1).abs() < 1e-12 && (c.normal.x - 1.0).abs() < 1e-12);
    }
}
