//! Configurations that have nothing to do with each other, one in each lane: which of them are free.
//!
//! A search asks about motions; where to stand, and with which posture, are questions about many single states, most of which touch
//! something. As for motions, spheres inside of the robot and spheres around it settle most of them, and the convex parts the others.

use pulp::{Simd, WithSimd};

use super::checker::{LaneChecker, LaneMemory};
use super::frames::Frames;
use super::kernel::{COARSE, Close, MOST_LANES, Scratch, children};
use super::lane::{Lanes, Mask, dot, minus};
use super::mechanism::{LaneRobot, Trust};
use super::obstacle::Obstacle;
use super::pile::Question;
use crate::edge::Obstruction;

/// What spheres tell of a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sight {
    /// It is free: spheres around the robot touch nothing.
    Free,
    /// It is not: spheres inside of the robot touch something, or a coordinate is out of bounds.
    Blocked(Obstruction),
    /// Only the convex parts can tell.
    Open,
}

/// What spheres look for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Care {
    /// Obstacles that are certainly touched, and not only with something small: what is not blocked may be anything.
    Glance,
    /// All that there is to know of links that touch each other.
    Itself,
    /// All that there is to know.
    Full,
}

/// Obstacles smaller than this, and spheres below those of this radius, are not glanced at, metres.
const SMALL: f32 = 0.07;

/// States that are looked at together before all that lanes take, where the first free one will do: often one of them is, and a few take
/// less time than many.
const FEW: usize = 4;

/// Lanes are filled from the first state on, and every state is looked at.
const ALL: (usize, fn(&[Sight]) -> bool) = (MOST_LANES, |_| false);

impl LaneChecker<'_> {
    /// In which of these states the robot is certainly in an obstacle, as far as a few spheres inside of it tell. The others are
    /// [open](Sight::Open): nothing is said of links that touch each other, nor of what is touched slightly. Meant for states that are
    /// only near those that matter.
    pub fn glances<'q>(&mut self, states: impl IntoIterator<Item = &'q [f64]>) -> Vec<Sight> {
        self.look_at_each(states, Care::Glance, ALL, |_, _, _| None)
    }

    /// Whether links stay apart from each other in each of these states; obstacles are not looked at.
    pub fn apart<'q>(&mut self, states: impl IntoIterator<Item = &'q [f64]>) -> Vec<bool> {
        let settled = |checker: &mut Self, q: &[f64], lane: usize| Some(checker.settle_state(q, lane));
        let sights = self.look_at_each(states, Care::Itself, ALL, settled);
        sights.into_iter().map(|sight| sight == Sight::Free).collect()
    }

    /// Whether each of these states is free; if not, why. The same as asking one after another.
    pub fn states<'q>(
        &mut self,
        states: impl IntoIterator<Item = &'q [f64]>,
    ) -> Vec<Result<(), Obstruction>> {
        let settled = |checker: &mut Self, q: &[f64], lane: usize| Some(checker.settle_state(q, lane));
        let outcome = |sight| match sight {
            Sight::Blocked(by) => Err(by),
            Sight::Free | Sight::Open => Ok(()),
        };
        self.look_at_each(states, Care::Full, ALL, settled).into_iter().map(outcome).collect()
    }

    /// The first of these states that is free, and what blocks those before it: all of them when none is free.
    pub fn first_free<'q>(
        &mut self,
        states: impl IntoIterator<Item = &'q [f64]>,
    ) -> (Option<usize>, Vec<Obstruction>) {
        let mut found = false;
        // What comes after the first free one is not settled.
        let settled = |checker: &mut Self, q: &[f64], lane: usize| {
            (!found).then(|| {
                let sight = checker.settle_state(q, lane);
                found = sight == Sight::Free;
                sight
            })
        };
        let sights =
            self.look_at_each(states, Care::Full, (FEW, |seen| seen.contains(&Sight::Free)), settled);
        let free = sights.iter().position(|sight| *sight == Sight::Free);
        let before = sights[..free.unwrap_or(sights.len())].iter();
        let why = before.filter_map(|sight| if let Sight::Blocked(by) = sight { Some(*by) } else { None });
        (free, why.collect())
    }

    /// What spheres tell of each state, or of those that they leave open, `settle` for a state and its lane. No more than `first` are
    /// looked at together at first; no more are looked at when what was seen is `enough`.
    fn look_at_each<'q>(
        &mut self,
        states: impl IntoIterator<Item = &'q [f64]>,
        care: Care,
        (first, enough): (usize, fn(&[Sight]) -> bool),
        mut settle: impl FnMut(&mut Self, &[f64], usize) -> Option<Sight>,
    ) -> Vec<Sight> {
        let mut sights = Vec::new();
        let mut states = states.into_iter();
        loop {
            let mut block: [&[f64]; MOST_LANES] = [&[]; MOST_LANES];
            let mut count = 0;
            // Blocks end where lanes do.
            let most = if sights.is_empty() { first.min(self.width.lanes()) } else { self.width.lanes() };
            for state in states.by_ref().take(most) {
                block[count] = state;
                count += 1;
            }
            if count == 0 || enough(&sights) {
                return sights;
            }
            self.statistics.looks += count as u64;
            let block = &block[..count];
            let LaneMemory { joints, scratch, crowded, .. } = &mut *self.work;
            let (robot, obstacles, near) = (self.robot, &self.obstacles, &self.near);
            let crowd = Crowd { robot, obstacles, near, states: block, care, joints, scratch, crowded };
            let Seen { open, blocked } = self.width.dispatch(crowd);
            for (lane, q) in block.iter().enumerate() {
                let sight = match blocked[lane] {
                    _ if !self.space.contains(q) => Sight::Blocked(Obstruction::Bounds),
                    Some(close) => Sight::Blocked(self.obstruction(close)),
                    None if care == Care::Glance => Sight::Open,
                    None if open >> lane & 1 == 0 => Sight::Free,
                    None => settle(self, q, lane).unwrap_or(Sight::Open),
                };
                sights.push(sight);
            }
        }
    }

    /// What the convex parts say of the state that was in a lane.
    fn settle_state(&mut self, q: &[f64], lane: usize) -> Sight {
        self.work.stay(self.robot, q.len());
        for i in 0..self.work.crowded.len() {
            let (close, lanes) = self.work.crowded[i];
            if lanes >> lane & 1 == 1
                && let Err(blocked) = self.settle(q, 0.5, 0.5 * (1.0 + 1e-6), close)
            {
                return Sight::Blocked(blocked.by);
            }
        }
        Sight::Free
    }
}

impl LaneMemory {
    /// A motion that goes nowhere.
    fn stay(&mut self, robot: &LaneRobot, coordinates: usize) {
        self.difference.clear();
        self.difference.resize(coordinates, 0.0);
        self.motion.bends.clear();
        self.motion.bends.resize(robot.bodies.len(), 0.0);
        self.proven.clear();
        self.frames.clear();
    }
}

/// States to look at, no more than there are lanes.
struct Crowd<'a> {
    robot: &'a LaneRobot,
    obstacles: &'a [Obstacle],
    /// For each group of bodies, the obstacles that it can come near to, with the room that it keeps from them.
    near: &'a [Vec<(u32, f32)>],
    states: &'a [&'a [f64]],
    care: Care,
    joints: &'a mut Vec<f32>,
    scratch: &'a mut Scratch,
    crowded: &'a mut Vec<(Close, u32)>,
}

/// What was seen in each lane.
struct Seen {
    /// Those that spheres leave open, a bit for each.
    open: u32,
    /// What touches there.
    blocked: [Option<Close>; MOST_LANES],
}

impl WithSimd for Crowd<'_> {
    type Output = Seen;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Seen {
        let Self { robot, obstacles, near, states, care, joints, scratch, crowded } = self;
        let lanes = S::F32_LANES;
        joints.clear();
        joints.resize(robot.steps.len() * lanes, 0.0);
        for (step, values) in robot.steps.iter().zip(joints.chunks_exact_mut(lanes)) {
            for (value, state) in values.iter_mut().zip(states) {
                *value = step.value(state) as f32;
            }
        }
        let mut live = [0.0; MOST_LANES];
        live[..states.len()].fill(1.0);
        let live = Lanes::new(simd, simd.partial_load_f32s(&live[..lanes]));
        let mut frames = Frames::place_each(simd, robot, joints, &mut scratch.frames);
        frames.reach(robot.steps.len());
        crowded.clear();
        let mut eye = Eye {
            simd,
            robot,
            states,
            care,
            frames,
            stack: &mut scratch.stack,
            crowded,
            live: Lanes::splat(simd, 0.0).less(live),
            open: Mask::none(simd),
            blocked: [None; MOST_LANES],
            rounding: robot.rounding as f32,
        };
        if care != Care::Itself {
            eye.against_obstacles(obstacles, near);
        }
        if care != Care::Glance {
            eye.against_itself();
        }
        Seen { open: bits(simd, eye.open.and(eye.live)), blocked: eye.blocked }
    }
}

/// A bit for each lane that says yes.
#[inline(always)]
fn bits<S: Simd>(simd: S, mask: Mask<S>) -> u32 {
    let mut numbers = [0.0; MOST_LANES];
    let lanes = &mut numbers[..S::F32_LANES];
    simd.partial_store_f32s(lanes, mask.as_numbers());
    lanes.iter().enumerate().map(|(lane, &x)| u32::from(x > 0.0) << lane).sum()
}

struct Eye<'a, S: Simd> {
    simd: S,
    robot: &'a LaneRobot,
    states: &'a [&'a [f64]],
    care: Care,
    frames: Frames<'a, S>,
    stack: &'a mut Vec<(u32, u32)>,
    crowded: &'a mut Vec<(Close, u32)>,
    /// Lanes that are not known to be blocked.
    live: Mask<S>,
    /// Lanes in which something is so close that spheres do not tell.
    open: Mask<S>,
    blocked: [Option<Close>; MOST_LANES],
    rounding: f32,
}

impl<S: Simd> Eye<'_, S> {
    #[inline(always)]
    fn splat(&self, x: f32) -> Lanes<S> {
        Lanes::splat(self.simd, x)
    }

    /// Something touches in these lanes. Whether others are left.
    #[inline(always)]
    fn block(&mut self, hit: Mask<S>, close: Close) -> bool {
        let hits = bits(self.simd, hit.and(self.live));
        for (lane, blocked) in self.blocked.iter_mut().enumerate() {
            if hits >> lane & 1 == 1 {
                *blocked = Some(close);
            }
        }
        self.live = self.live.and_not(hit);
        self.live.any()
    }

    /// Something is close in these lanes.
    #[inline(always)]
    fn leave_open(&mut self, maybe: Mask<S>, close: Close) {
        if maybe.any() {
            self.open = self.open.or(maybe);
            self.crowded.push((close, bits(self.simd, maybe)));
        }
    }

    #[inline(always)]
    fn against_obstacles(&mut self, obstacles: &[Obstacle], near: &[Vec<(u32, f32)>]) {
        let robot = self.robot;
        // What is farther out touches more often.
        for (group, near) in robot.groups.iter().zip(near).rev() {
            for &(number, room) in near {
                let solid = &obstacles[number as usize];
                let (middle, radius) = (solid.ball.0.map(|x| x as f32), solid.ball.1 as f32);
                // How deep two things are in each other, spheres do not tell.
                if self.care == Care::Glance && (room < 0.0 || radius < SMALL) {
                    continue;
                }
                let slack = self.rounding + solid.pad + room.max(0.0);
                let ball = &robot.spheres[group.ball];
                // Most are far from each other, which balls tell sooner than faces.
                let centre = self.frames.centre(group.ball, group.frame);
                let between = minus(&centre, &middle.map(|x| self.splat(x)));
                let reach = self.splat((ball.outer + slack + radius) * (1.0 + 1e-5));
                if !dot(&between, &between).less_equal(reach * reach).and(self.live).any() {
                    continue;
                }
                if group.bodies.len() > 1 {
                    let limit = self.splat(ball.outer + slack);
                    let question = Question { limit, coarse: COARSE * ball.outer };
                    let least = solid.squared_distance(self.simd, &centre, question).0;
                    if !least.less_equal(limit * limit).and(self.live).any() {
                        continue;
                    }
                }
                for &i in &group.bodies {
                    let close = Close::Obstacle { body: i as u32, obstacle: number };
                    if !self.body_against(i, solid, room, slack, close) {
                        return;
                    }
                }
            }
        }
    }

    /// One body and one obstacle. Whether lanes are left that are not blocked.
    #[inline(always)]
    fn body_against(&mut self, body: usize, solid: &Obstacle, room: f32, slack: f32, close: Close) -> bool {
        let robot = self.robot;
        let body = &robot.bodies[body];
        let mut open = Mask::none(self.simd);
        let mut at = body.spheres.start;
        while at < body.spheres.end {
            let sphere = &robot.spheres[at];
            if self.care == Care::Glance && sphere.inside(Trust::Certain).core <= self.rounding {
                at = sphere.next as usize;
                continue;
            }
            let question = match self.care {
                Care::Glance => robot.question(self.simd, at, room, Trust::Certain),
                Care::Full | Care::Itself => {
                    let leaf = sphere.next as usize == at + 1;
                    let coarse = if leaf { 0.0 } else { COARSE * sphere.outer };
                    Question { limit: self.splat(sphere.outer + slack), coarse }
                }
            };
            let limit = question.limit;
            let centre = self.frames.centre(at, body.frame);
            let (least, most) = solid.squared_distance(self.simd, &centre, question);
            let maybe = least.less_equal(limit * limit).and(self.live);
            if !maybe.any() {
                at = sphere.next as usize;
                continue;
            }
            let inner = sphere.inner + room - self.rounding;
            if sphere.inner > self.rounding && room >= 0.0 {
                let hit = most.less_equal(self.splat(inner * inner)).and(maybe);
                if hit.any() && !self.block(hit, close) {
                    return false;
                }
            }
            if self.care == Care::Glance {
                at = if sphere.outer > SMALL { at + 1 } else { sphere.next as usize };
                continue;
            }
            if sphere.next as usize == at + 1 {
                open = open.or(maybe);
            }
            at += 1;
        }
        self.leave_open(open.and(self.live), close);
        true
    }

    #[inline(always)]
    fn against_itself(&mut self) {
        let robot = self.robot;
        for (i, pair) in robot.pairs.iter().enumerate() {
            if !self.live.any() {
                return;
            }
            let (a, b) = (&robot.bodies[pair.a], &robot.bodies[pair.b]);
            let close = Close::Pair(i as u32);
            let (mut open, mut doubtful) = (Mask::none(self.simd), None);
            self.stack.clear();
            self.stack.push((a.spheres.start as u32, b.spheres.start as u32));
            while let Some((at_a, at_b)) = self.stack.pop() {
                let (of_a, of_b) = (&robot.spheres[at_a as usize], &robot.spheres[at_b as usize]);
                let reach = of_a.outer + of_b.outer + 2.0 * self.rounding;
                let between = minus(
                    &self.frames.centre(at_a as usize, a.frame),
                    &self.frames.centre(at_b as usize, b.frame),
                );
                let squared = dot(&between, &between);
                let mut maybe = squared.less_equal(self.splat(reach * reach)).and(self.live);
                if !maybe.any() {
                    continue;
                }
                // Only now is the table worth its time.
                if let Some(table) = &pair.apart {
                    let in_doubt = *doubtful.get_or_insert_with(|| {
                        let mut numbers = [0.0; MOST_LANES];
                        for (number, state) in numbers.iter_mut().zip(self.states) {
                            *number = if table.holds_at(state) { 0.0 } else { 1.0 };
                        }
                        let numbers = self.simd.partial_load_f32s(&numbers[..S::F32_LANES]);
                        Lanes::splat(self.simd, 0.0).less(Lanes::new(self.simd, numbers))
                    });
                    maybe = maybe.and(in_doubt);
                    if !maybe.any() {
                        continue;
                    }
                }
                let inner = of_a.inner + of_b.inner - 2.0 * self.rounding;
                if of_a.inner > self.rounding && of_b.inner > self.rounding {
                    let hit = squared.less_equal(self.splat(inner * inner)).and(maybe);
                    if hit.any() && !self.block(hit, close) {
                        return;
                    }
                }
                let (leaf_a, leaf_b) = (of_a.next == at_a + 1, of_b.next == at_b + 1);
                if leaf_a && leaf_b {
                    open = open.or(maybe);
                } else if leaf_b || (!leaf_a && of_a.outer >= of_b.outer) {
                    children(&robot.spheres, at_a, |child| self.stack.push((child, at_b)));
                } else {
                    children(&robot.spheres, at_b, |child| self.stack.push((at_a, child)));
                }
            }
            self.leave_open(open.and(self.live), close);
        }
    }
}
