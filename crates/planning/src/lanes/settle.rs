//! Where spheres do not tell: the convex parts themselves, by conservative advancement.
//!
//! Parts are apart at a moment by a gap along some direction. It lasts for as long as no point can use it up: to first order by how
//! fast the points go along that direction, which is little when a link slides past something, to second order by a bound on
//! their acceleration (Taylor's theorem; advancement by directed motion bounds is due to Mirtich, "Impulse-based dynamic
//! simulation of rigid body systems", 1996).

use nalgebra::Vector3;
use robotc_core::Pose;
use robotc_core::geom::{ConvexPart, Pile, contact, distance, separation};

use super::checker::{LaneChecker, LaneMemory};
use super::kernel::Close;
use crate::edge::Blocked;

/// Distances are found to within this fraction: they only tell how long two things stay apart.
const RELATIVE: f64 = 0.1;

/// Bodies this close to each other count as touching, metres: conservative advancement would not get past them.
const TOUCH: f64 = 2e-5;

impl LaneChecker<'_> {
    /// Decides by the convex parts whether two things that are close stay apart within a stretch.
    pub(super) fn settle(
        &mut self,
        from: &[f64],
        middle: f64,
        half: f64,
        close: Close,
    ) -> Result<(), Blocked> {
        let mut pieces = std::mem::take(&mut self.work.pieces);
        pieces.clear();
        pieces.push((middle - half, middle + half));
        self.work.directions.clear();
        let speed = self.speed(close);
        let mut outcome = Ok(());
        while let Some((start, end)) = pieces.pop() {
            let inside =
                |&(first, last, of): &(f64, f64, Close)| of == close && first <= start && end <= last;
            if self.work.proven.iter().any(inside) || self.is_known_apart(from, start, end, close) {
                continue;
            }
            let middle = 0.5 * (start + end);
            self.statistics.distances += 1;
            let room = self.room(from, middle, 0.5 * (end - start), speed, close);
            if room.gap <= TOUCH {
                outcome = Err(Blocked { fraction: middle, by: self.obstruction(close) });
                break;
            }
            let (first, last) = (middle - room.before, middle + room.after);
            if first < start && end < last {
                self.work.proven.push((first, last, close));
                continue;
            }
            if start <= first {
                pieces.push((start, first));
            }
            if last <= end {
                pieces.push((last, end));
            }
        }
        self.work.pieces = pieces;
        outcome
    }

    /// Whether the table of a pair says that the two stay apart within a stretch.
    fn is_known_apart(&self, from: &[f64], start: f64, end: f64, close: Close) -> bool {
        let Close::Pair(pair) = close else { return false };
        let table = self.robot.pairs[pair as usize].apart.as_ref();
        table.is_some_and(|table| table.holds_within(from, &self.work.difference, start, end))
    }

    /// A bound on how fast two things come together, metres per motion.
    fn speed(&self, close: Close) -> f64 {
        let sum = |chain: &[(usize, f64)]| -> f64 {
            let change = |step| self.robot.change(step, &self.work.difference);
            chain.iter().map(|&(step, distance)| change(step) * distance).sum()
        };
        match close {
            Close::Obstacle { body, .. } => sum(&self.robot.bodies[body as usize].chain),
            Close::Pair(pair) => sum(&self.robot.pairs[pair as usize].closing),
        }
    }

    /// How long two things that are where they are at a fraction of the motion stay apart, at least: not much longer than `enough` is
    /// looked for. `speed` is that at which they come together at most.
    fn room(&mut self, from: &[f64], fraction: f64, enough: f64, speed: f64, close: Close) -> Room {
        let robot = self.robot;
        let LaneMemory { values, difference, frames, motion, directions, .. } = &mut *self.work;
        // Often the next question is about the same state.
        let state = || from.iter().zip(difference.iter()).map(|(a, d)| a + fraction * d);
        if frames.is_empty() || !state().eq(values.iter().copied()) {
            values.clear();
            values.extend(state());
            robot.poses(values, frames);
        }
        let scene = self.scene;
        let link = |body: usize| {
            let body = &robot.bodies[body];
            let of_link = body.link.map(|link| scene.link_parts(link));
            let of_held = robot.held.filter(|_| body.link.is_none()).map(|held| scene.body_parts(held));
            let parts = of_link.into_iter().flatten().chain(of_held.into_iter().flatten());
            (frames[body.frame] * body.frame_from_body, parts)
        };
        let most = 4.0 * enough;
        let mut all = Room { gap: f64::INFINITY, before: most, after: most };
        let mut number = 0;
        match close {
            Close::Obstacle { body, obstacle } => {
                let owner = self.owners[obstacle as usize];
                let root_from_other = scene.world_from_robot().inv_mul(scene.world_from_body(owner));
                let body = body as usize;
                let keeps = self.near[robot.bodies[body].group].iter().find(|(i, _)| *i == obstacle);
                let keeps = keeps.map_or(0.0, |(_, room)| f64::from(*room));
                let bend = f64::from(motion.bends[body]);
                let (root_from_body, parts) = link(body);
                let (own, piles) = scene.made_of(owner);
                let own: Vec<&ConvexPart> = own.collect();
                for part in parts {
                    let (centre, radius) = part.bounding_sphere();
                    let twist = || robot.twist(body, &(root_from_body * centre), difference, frames);
                    let pace = Pace { speed, radius, bend, twist: &twist };
                    for placed in piles {
                        let root_from_pile = root_from_other * placed.body_from_pile;
                        let pile = PileBeside { part, root_from_part: &root_from_body, pile: &placed.pile };
                        pile.narrow(&mut all, &root_from_pile, keeps, &pace, enough);
                    }
                    for &other in &own {
                        let pair = PartPair {
                            a: part,
                            root_from_a: &root_from_body,
                            b: other,
                            root_from_b: &root_from_other,
                        };
                        all.narrow(pair.room(keeps, &pace, &all, enough, hint(directions, &mut number)));
                    }
                }
            }
            Close::Pair(pair) => {
                let pair = &robot.pairs[pair as usize];
                let ((root_from_a, parts_a), (root_from_b, _)) = (link(pair.a), link(pair.b));
                let bend = robot.bend(&pair.between, |step| robot.change(step, difference));
                for part in parts_a {
                    for other in link(pair.b).1 {
                        let (centre, radius) = other.bounding_sphere();
                        // As the one sees the other.
                        let twist = || {
                            let point = root_from_b * centre;
                            let (velocity_a, spin_a) = robot.twist(pair.a, &point, difference, frames);
                            let (velocity_b, spin_b) = robot.twist(pair.b, &point, difference, frames);
                            (velocity_a - velocity_b, spin_a - spin_b)
                        };
                        let pace = Pace { speed, radius, bend, twist: &twist };
                        let parts = PartPair {
                            a: part,
                            root_from_a: &root_from_a,
                            b: other,
                            root_from_b: &root_from_b,
                        };
                        all.narrow(parts.room(0.0, &pace, &all, enough, hint(directions, &mut number)));
                    }
                }
            }
        }
        all
    }
}

/// How near two things are, and how long they stay apart before and after: fractions of the motion.
#[derive(Debug, Clone, Copy)]
struct Room {
    /// Metres.
    gap: f64,
    before: f64,
    after: f64,
}

impl Room {
    /// What is left when other parts of the same things have this room.
    fn narrow(&mut self, other: Room) {
        self.gap = self.gap.min(other.gap);
        self.before = self.before.min(other.before);
        self.after = self.after.min(other.after);
    }
}

/// The direction that is remembered for the next two parts.
fn hint<'d>(
    directions: &'d mut Vec<Option<Vector3<f64>>>,
    number: &mut usize,
) -> &'d mut Option<Vector3<f64>> {
    *number += 1;
    if directions.len() < *number {
        directions.resize(*number, None);
    }
    &mut directions[*number - 1]
}

/// How fast two things may come together: nowhere faster than `speed`, and along a direction no faster than points that are within
/// `radius` of one that has the velocity and spin of `twist`, none of which is sped up by more than twice the `bend`.
struct Pace<'t> {
    speed: f64,
    radius: f64,
    bend: f64,
    twist: &'t dyn Fn() -> (Vector3<f64>, Vector3<f64>),
}

impl Pace<'_> {
    /// How long a gap lasts, and one along a direction in the root frame.
    fn room(&self, gap: f64, direction: Option<Vector3<f64>>) -> Room {
        let plain = gap / self.speed;
        let mut room = Room { gap, before: plain, after: plain };
        if let Some(direction) = direction {
            let (velocity, spin) = (self.twist)();
            let (turning, along) = (spin.cross(&direction).norm() * self.radius, velocity.dot(&direction));
            room.before = room.before.max(lasts(gap, turning - along, self.bend));
            room.after = room.after.max(lasts(gap, turning + along, self.bend));
        }
        room
    }
}

/// Two parts, each where it is.
struct PartPair<'p> {
    a: &'p ConvexPart,
    root_from_a: &'p Pose,
    b: &'p ConvexPart,
    root_from_b: &'p Pose,
}

impl PartPair<'_> {
    /// How long the two stay `keeps` metres apart; that of `others` when it is no less, and not much longer than `enough`. `hint` is
    /// a direction along which there may be a gap, in the frame of the first one.
    fn room(
        &self,
        keeps: f64,
        pace: &Pace<'_>,
        others: &Room,
        enough: f64,
        hint: &mut Option<Vector3<f64>>,
    ) -> Room {
        let Self { a, root_from_a, b, root_from_b } = *self;
        let a_from_b = root_from_a.inv_mul(root_from_b);
        let ((centre_a, radius_a), (centre_b, radius_b)) = (a.bounding_sphere(), b.bounding_sphere());
        let apart = (a_from_b * centre_b - centre_a).norm() - radius_a - radius_b - keeps;
        if apart > TOUCH && apart > pace.speed * others.before.max(others.after) {
            return *others;
        }
        if let Some(direction) = *hint {
            let on_b = a_from_b * b.support(&a_from_b.inverse_transform_vector(&-direction));
            let gap = direction.dot(&(on_b - a.support(&direction))) - keeps;
            if gap > TOUCH {
                let room = pace.room(gap, Some(root_from_a.rotation * direction));
                if room.before.min(room.after) > enough {
                    return room;
                }
            }
        }
        if let Some(apart) = separation(a, b, &a_from_b, RELATIVE)
            && apart.gap - keeps > TOUCH
        {
            let direction = apart.direction.into_inner();
            *hint = Some(direction);
            return pace.room(apart.gap - keeps, Some(root_from_a.rotation * direction));
        }
        // Now it matters how far exactly.
        let apart = distance(a, root_from_a, b, root_from_b).distance;
        let gap = match apart > 0.0 || keeps >= 0.0 {
            true => apart - keeps,
            false => -contact(a, root_from_a, b, root_from_b, 0.0).map_or(0.0, |found| found.depth) - keeps,
        };
        pace.room(gap, None)
    }
}

/// A part that is where it is, near a pile.
struct PileBeside<'p> {
    part: &'p ConvexPart,
    root_from_part: &'p Pose,
    pile: &'p Pile,
}

impl PileBeside<'_> {
    /// Narrows the room of others to how long the two stay `keeps` metres apart. What covers a node counts for all that is in it where
    /// that lasts for long `enough`.
    fn narrow(&self, all: &mut Room, root_from_pile: &Pose, keeps: f64, pace: &Pace<'_>, enough: f64) {
        let Self { part, root_from_part, pile } = *self;
        let part_from_pile = root_from_part.inv_mul(root_from_pile);
        let pile_from_part = part_from_pile.inverse();
        let (centre, radius) = part.bounding_sphere();
        let centre = pile_from_part * centre;
        let bounds = part.bounds().transformed(&pile_from_part);
        let mut may_touch = false;
        pile.walk(&centre, |lump, leaf| {
            let apart = lump.bound(&bounds, &centre, radius) - keeps.max(0.0);
            if apart > TOUCH && apart > pace.speed * all.before.max(all.after) {
                return false;
            }
            let found = lump.separation(part, &part_from_pile, RELATIVE);
            let room = match found.filter(|found| found.gap - keeps.max(0.0) > TOUCH) {
                Some(found) => {
                    let direction = root_from_part.rotation * found.direction.into_inner();
                    pace.room(found.gap - keeps.max(0.0), Some(direction))
                }
                None if !leaf => return true,
                // Now it matters how far exactly.
                None => pace.room(lump.distance(part, &part_from_pile) - keeps.max(0.0), None),
            };
            if !leaf && room.before.min(room.after) <= enough {
                return true;
            }
            // What may be in each other is looked at as a whole.
            if leaf && keeps < 0.0 && room.before.min(room.after) <= enough {
                may_touch = true;
                return false;
            }
            all.narrow(room);
            false
        });
        if may_touch {
            let left = -keeps - pile.depth(part, &part_from_pile);
            let gap = pile.gap(part, &part_from_pile, -keeps);
            all.narrow(pace.room(left.max(gap), None));
        }
    }
}

/// How long a gap lasts that closes at this speed and may be closed faster by twice the bend each unit of time: until
/// speed t + bend t^2 is the gap.
fn lasts(gap: f64, speed: f64, bend: f64) -> f64 {
    let root = (speed * speed + 4.0 * bend * gap).sqrt();
    // The form that does not subtract what is nearly equal.
    let time = if speed > 0.0 { 2.0 * gap / (speed + root) } else { (root - speed) / (2.0 * bend) };
    if time.is_nan() { 0.0 } else { time * (1.0 - 1e-9) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn a_gap_lasts_until_it_is_used_up() {
        let mut rng = Seed::new(6).rng();
        for _ in 0..1000 {
            let (gap, speed, bend) = (rng.range(1e-5, 1.0), rng.range(-2.0, 2.0), rng.range(1e-6, 3.0));
            let time = lasts(gap, speed, bend);
            let left = |t: f64| gap - speed * t - bend * t * t;
            assert!((0..=20).all(|i| left(time * f64::from(i) / 20.0) >= -1e-12), "{gap} {speed} {bend}");
            assert!(left(time * (1.0 + 1e-6)) < 1e-8, "no sooner: {gap} {speed} {bend}");
        }
        assert_eq!(lasts(0.5, 2.0, 0.0), 0.25 * (1.0 - 1e-9));
        assert_eq!(lasts(0.5, -2.0, 0.0), f64::INFINITY);
    }
}
