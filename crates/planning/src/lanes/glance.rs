//! A first look at a motion: configurations along it, and only those, by spheres inside of the robot alone.
//!
//! What is hit is certainly blocked. What is not may still be: between the looks, or where spheres around the robot touch
//! something and spheres inside of it do not. Most motions that are blocked are so at a first look, at a tenth of the cost
//! of a proof.
//!
//! A wary look takes the robot for somewhat larger than these spheres are. It is not certain of anything, but most of what it finds free is.

use pulp::{Simd, WithSimd};

use super::apart::Apart;
use super::frames::Frames;
use super::kernel::{MOST_LANES, Motion, Scratch, children};
use super::lane::{Lanes, Mask, dot, minus};
use super::mechanism::{LaneRobot, Trust};
use super::obstacle::Obstacle;
use super::suspects::Suspect;

/// What a first look hits.
pub(super) enum Hit {
    Obstacle(Suspect),
    /// Two links touch: a pair of the robot.
    Pair(u32),
}

/// What is known of a pair of bodies during one look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    Unknown,
    /// The table of the pair says that the two stay apart.
    Apart,
    /// It does not, or there is none.
    Doubtful,
}

/// A motion and what is around it.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) robot: &'a LaneRobot,
    pub(super) obstacles: &'a [Obstacle],
    /// Groups of bodies with obstacles that they can come near to and the room that they keep, in the order in which they
    /// are looked at.
    pub(super) meetings: &'a [Meeting],
    pub(super) motion: &'a Motion,
    pub(super) trust: Trust,
    /// Start of the motion, and its difference to the end.
    pub(super) from: &'a [f64],
    pub(super) difference: &'a [f64],
}

/// A group of bodies and an obstacle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting {
    pub(super) group: u32,
    pub(super) obstacle: u32,
    /// How far apart the two have to be; negative where they may be in each other, by so much.
    pub(super) room: f32,
}

/// A first look at a motion: at the ends of `count` equal pieces of it, a multiple of [`MOST_LANES`].
pub(super) struct Look<'a> {
    pub(super) view: View<'a>,
    pub(super) count: usize,
    pub(super) scratch: &'a mut Scratch,
}

impl WithSimd for Look<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<Hit> {
        let Self { view, count, scratch } = self;
        let robot = view.robot;
        scratch.standings.clear();
        scratch.standings.resize(robot.pairs.len(), Standing::Unknown);
        for block in (0..count / S::F32_LANES).rev() {
            let along = along(simd, count, block);
            let mut frames = Frames::place(simd, robot, &view.motion.steps, along, &mut scratch.frames);
            frames.reach(robot.steps.len());
            let mut eye = Eye {
                simd,
                view: &view,
                frames,
                along,
                stack: &mut scratch.stack,
                standings: &mut scratch.standings,
                rounding: robot.rounding as f32,
            };
            let hit = eye.against_obstacles().map(Hit::Obstacle);
            if let Some(hit) = hit.or_else(|| eye.against_itself().map(Hit::Pair)) {
                return Some(hit);
            }
        }
        None
    }
}

/// Where along a motion the states of a block are, as fractions of it: each block is all over the motion.
#[inline(always)]
pub(super) fn along<S: Simd>(simd: S, count: usize, block: usize) -> Lanes<S> {
    let lanes = S::F32_LANES;
    let (blocks, share) = (count / lanes, 1.0 / count as f32);
    let mut along = [0.0; MOST_LANES];
    for (lane, along) in along.iter_mut().enumerate() {
        *along = (lane * blocks + block + 1) as f32 * share;
    }
    Lanes::new(simd, simd.partial_load_f32s(&along[..lanes]))
}

/// One configuration in each lane.
struct Eye<'a, S: Simd> {
    simd: S,
    view: &'a View<'a>,
    frames: Frames<'a, S>,
    /// Where along the motion they are.
    along: Lanes<S>,
    stack: &'a mut Vec<(u32, u32)>,
    standings: &'a mut [Standing],
    rounding: f32,
}

impl<S: Simd> Eye<'_, S> {
    #[inline(always)]
    fn splat(&self, x: f32) -> Lanes<S> {
        Lanes::splat(self.simd, x)
    }

    #[inline(always)]
    fn against_obstacles(&mut self) -> Option<Suspect> {
        let View { robot, obstacles, meetings, trust, .. } = *self.view;
        for &Meeting { group, obstacle, room } in meetings {
            let group = &robot.groups[group as usize];
            let solid = &obstacles[obstacle as usize];
            if group.bodies.len() > 1 && !self.compare(group.ball, group.frame, solid, room).0 {
                continue;
            }
            for &i in &group.bodies {
                let body = &robot.bodies[i];
                let mut at = body.spheres.start;
                while at < body.spheres.end {
                    let sphere = &robot.spheres[at];
                    let inside = sphere.inside(trust);
                    if inside.core <= self.rounding {
                        at = sphere.next as usize;
                        continue;
                    }
                    let (near, most) = self.compare(at, body.frame, solid, room);
                    if !near {
                        at = sphere.next as usize;
                        continue;
                    }
                    if inside.radius > self.rounding && inside.touches(most, room, self.rounding) {
                        return Some(Suspect { body: i as u32, sphere: at as u32, obstacle, room });
                    }
                    at += 1;
                }
            }
        }
        None
    }

    /// Whether a sphere inside of the robot, this one or one below it, may touch; and the square of how far this one is away at most.
    #[inline(always)]
    fn compare(&mut self, sphere: usize, frame: usize, solid: &Obstacle, room: f32) -> (bool, Lanes<S>) {
        let View { robot, trust, .. } = *self.view;
        let question = robot.question(self.simd, sphere, room, trust);
        let (least, most) = solid.squared_distance(self.simd, &self.frames.centre(sphere, frame), question);
        (least.less_equal(question.limit * question.limit).any(), most)
    }

    #[inline(always)]
    fn against_itself(&mut self) -> Option<u32> {
        let View { robot, from, difference, trust, .. } = *self.view;
        let (mut groups, mut apart) = ((usize::MAX, usize::MAX), false);
        for (i, pair) in robot.pairs.iter().enumerate() {
            let (a, b) = (&robot.bodies[pair.a], &robot.bodies[pair.b]);
            if (a.group, b.group) != groups {
                groups = (a.group, b.group);
                let (one, other) = (&robot.groups[a.group], &robot.groups[b.group]);
                let several = one.bodies.len() + other.bodies.len() > 2;
                apart = several && {
                    let between = minus(
                        &self.frames.centre(one.ball, one.frame),
                        &self.frames.centre(other.ball, other.frame),
                    );
                    let reach = robot.spheres[one.ball].inside(trust).core
                        + robot.spheres[other.ball].inside(trust).core;
                    !dot(&between, &between).less_equal(self.splat(reach * reach)).any()
                };
            }
            if apart || self.standings[i] == Standing::Apart {
                continue;
            }
            // Lanes in which the table of the pair does not tell that the two are apart.
            let mut doubtful = None;
            self.stack.clear();
            self.stack.push((a.spheres.start as u32, b.spheres.start as u32));
            while let Some((at_a, at_b)) = self.stack.pop() {
                let (of_a, of_b) = (&robot.spheres[at_a as usize], &robot.spheres[at_b as usize]);
                let (in_a, in_b) = (of_a.inside(trust), of_b.inside(trust));
                if in_a.core.min(in_b.core) <= self.rounding {
                    continue;
                }
                let between = minus(
                    &self.frames.centre(at_a as usize, a.frame),
                    &self.frames.centre(at_b as usize, b.frame),
                );
                let squared = dot(&between, &between);
                let core = in_a.core + in_b.core;
                let near = squared.less_equal(self.splat(core * core));
                if !near.any() {
                    continue;
                }
                // Only now is the table worth its time.
                if let Some(table) = &pair.apart {
                    if self.standings[i] == Standing::Unknown {
                        let holds = table.holds(from, difference);
                        self.standings[i] = if holds { Standing::Apart } else { Standing::Doubtful };
                    }
                    if self.standings[i] == Standing::Apart {
                        break;
                    }
                    if !near.and(*doubtful.get_or_insert_with(|| self.doubtful(table))).any() {
                        continue;
                    }
                    if trust == Trust::Wary && table.is_fine() {
                        return Some(i as u32);
                    }
                }
                let inner = in_a.radius + in_b.radius - 2.0 * self.rounding;
                if in_a.radius > self.rounding
                    && in_b.radius > self.rounding
                    && squared.less_equal(self.splat(inner * inner)).any()
                {
                    return Some(i as u32);
                }
                let (leaf_a, leaf_b) = (of_a.next == at_a + 1, of_b.next == at_b + 1);
                if leaf_a && leaf_b {
                    continue;
                }
                if leaf_b || (!leaf_a && of_a.outer >= of_b.outer) {
                    children(&robot.spheres, at_a, |child| self.stack.push((child, at_b)));
                } else {
                    children(&robot.spheres, at_b, |child| self.stack.push((at_a, child)));
                }
            }
        }
        None
    }

    /// Lanes in which a pair is not known to be apart.
    #[inline(always)]
    fn doubtful(&self, table: &Apart) -> Mask<S> {
        let View { from, difference, .. } = *self.view;
        let (mut along, mut numbers) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
        self.simd.partial_store_f32s(&mut along[..S::F32_LANES], self.along.raw);
        for (number, &at) in numbers.iter_mut().zip(&along[..S::F32_LANES]) {
            let at = f64::from(at);
            *number = if table.holds_within(from, difference, at, at) { 0.0 } else { 1.0 };
        }
        let numbers = Lanes::new(self.simd, self.simd.partial_load_f32s(&numbers[..S::F32_LANES]));
        self.splat(0.0).less(numbers)
    }
}
