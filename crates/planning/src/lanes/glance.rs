//! A first look at a motion: configurations along it, and only those, by spheres alone.
//!
//! What is hit is certainly blocked. What is not may still be: between the looks, or where spheres around the robot touch
//! something and spheres inside of it do not. Most motions that are blocked are so at a first look, at a tenth of the cost
//! of a proof.

use pulp::Simd;

use super::frames::Frames;
use super::kernel::{COARSE, Close, MOST_LANES, Motion, Scratch, children};
use super::lane::{Lanes, Mask, dot, minus};
use super::mechanism::LaneRobot;
use super::obstacle::Obstacle;
use super::pile::Question;

/// What a first look finds.
pub(super) enum Glance {
    /// Something touches.
    Hit(Close),
    /// Nothing is touched as far as spheres tell; whether they leave something open.
    Passed { open: bool },
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
pub(super) struct View<'a> {
    pub(super) robot: &'a LaneRobot,
    pub(super) obstacles: &'a [Obstacle],
    /// Groups of bodies with obstacles that they can come near to and the room that they keep, in the order in which they
    /// are looked at.
    pub(super) meetings: &'a [Meeting],
    pub(super) motion: &'a Motion,
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

/// Looks at the configurations at the ends of `count` equal pieces of a motion, a multiple of [`MOST_LANES`] or less than it.
#[inline(always)]
pub(super) fn glance<S: Simd>(simd: S, view: &View<'_>, count: usize, scratch: &mut Scratch) -> Glance {
    let lanes = S::F32_LANES;
    let blocks = count.div_ceil(lanes);
    let mut open = false;
    scratch.standings.clear();
    scratch.standings.resize(view.robot.pairs.len(), Standing::Unknown);
    let share = 1.0 / count as f32;
    for block in (0..blocks).rev() {
        let mut along = [1.0; MOST_LANES];
        for lane in 0..lanes.min(count) {
            // Each time all over the motion.
            along[lane] = (lane * blocks + block + 1) as f32 * share;
        }
        let along = Lanes::new(simd, simd.partial_load_f32s(&along[..lanes]));
        let frames = Frames::place(simd, view.robot, &view.motion.steps, along, &mut scratch.frames);
        let mut eye = Eye {
            simd,
            view,
            frames,
            stack: &mut scratch.stack,
            standings: &mut scratch.standings,
            open: Mask::none(simd),
            rounding: view.robot.rounding as f32,
        };
        let hit = eye.against_obstacles().or_else(|| eye.against_itself());
        if let Some(close) = hit {
            return Glance::Hit(close);
        }
        open |= eye.open.any();
    }
    Glance::Passed { open }
}

/// One configuration in each lane.
struct Eye<'a, S: Simd> {
    simd: S,
    view: &'a View<'a>,
    frames: Frames<'a, S>,
    stack: &'a mut Vec<(u32, u32)>,
    standings: &'a mut [Standing],
    /// Lanes in which spheres do not tell.
    open: Mask<S>,
    rounding: f32,
}

impl<S: Simd> Eye<'_, S> {
    #[inline(always)]
    fn splat(&self, x: f32) -> Lanes<S> {
        Lanes::splat(self.simd, x)
    }

    #[inline(always)]
    fn against_obstacles(&mut self) -> Option<Close> {
        let View { robot, obstacles, meetings, .. } = *self.view;
        {
            for &Meeting { group, obstacle, room } in meetings {
                let group = &robot.groups[group as usize];
                let solid = &obstacles[obstacle as usize];
                let slack = self.rounding + solid.pad + room.max(0.0);
                if group.bodies.len() > 1 {
                    let centre = self.frames.centre(group.ball, group.frame);
                    let outer = robot.spheres[group.ball].outer + slack;
                    let question = Question { limit: self.splat(outer), coarse: COARSE * outer };
                    let least = solid.squared_distance(self.simd, &centre, question).0;
                    if !least.less_equal(self.splat(outer * outer)).any() {
                        continue;
                    }
                }
                for &i in &group.bodies {
                    let body = &robot.bodies[i];
                    let mut at = body.spheres.start;
                    while at < body.spheres.end {
                        let sphere = &robot.spheres[at];
                        let centre = self.frames.centre(at, body.frame);
                        let outer = sphere.outer + slack;
                        let leaf = sphere.next as usize == at + 1;
                        let coarse = if leaf { 0.0 } else { COARSE * sphere.outer };
                        let question = Question { limit: self.splat(outer), coarse };
                        let (least, most) = solid.squared_distance(self.simd, &centre, question);
                        let maybe = least.less_equal(self.splat(outer * outer));
                        if !maybe.any() {
                            at = sphere.next as usize;
                            continue;
                        }
                        let inner = sphere.inner + room - self.rounding;
                        let tells = sphere.inner > self.rounding && room >= 0.0;
                        if tells && most.less_equal(self.splat(inner * inner)).any() {
                            return Some(Close::Obstacle { body: i as u32, obstacle });
                        }
                        at += 1;
                        if leaf {
                            self.open = self.open.or(maybe);
                        }
                    }
                }
            }
        }
        None
    }

    #[inline(always)]
    fn against_itself(&mut self) -> Option<Close> {
        let View { robot, from, difference, .. } = *self.view;
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
                    let reach = robot.spheres[one.ball].outer + robot.spheres[other.ball].outer;
                    let reach = reach + 2.0 * self.rounding;
                    !dot(&between, &between).less_equal(self.splat(reach * reach)).any()
                };
            }
            if apart || self.standings[i] == Standing::Apart {
                continue;
            }
            self.stack.clear();
            self.stack.push((a.spheres.start as u32, b.spheres.start as u32));
            while let Some((at_a, at_b)) = self.stack.pop() {
                let (of_a, of_b) = (&robot.spheres[at_a as usize], &robot.spheres[at_b as usize]);
                let between = minus(
                    &self.frames.centre(at_a as usize, a.frame),
                    &self.frames.centre(at_b as usize, b.frame),
                );
                let squared = dot(&between, &between);
                let outer = of_a.outer + of_b.outer + 2.0 * self.rounding;
                let maybe = squared.less_equal(self.splat(outer * outer));
                if !maybe.any() {
                    continue;
                }
                // Only now is the table worth its time.
                if self.standings[i] == Standing::Unknown {
                    let table = pair.apart.as_ref();
                    let holds = table.is_some_and(|table| table.holds(from, difference));
                    self.standings[i] = if holds { Standing::Apart } else { Standing::Doubtful };
                    if holds {
                        break;
                    }
                }
                let inner = of_a.inner + of_b.inner - 2.0 * self.rounding;
                if of_a.inner > self.rounding
                    && of_b.inner > self.rounding
                    && squared.less_equal(self.splat(inner * inner)).any()
                {
                    return Some(Close::Pair(i as u32));
                }
                let (leaf_a, leaf_b) = (of_a.next == at_a + 1, of_b.next == at_b + 1);
                if leaf_a && leaf_b {
                    self.open = self.open.or(maybe);
                } else if leaf_b || (!leaf_a && of_a.outer >= of_b.outer) {
                    children(&robot.spheres, at_a, |child| self.stack.push((child, at_b)));
                } else {
                    children(&robot.spheres, at_b, |child| self.stack.push((at_a, child)));
                }
            }
        }
        None
    }
}
