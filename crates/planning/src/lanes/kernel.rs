//! One look at as many configurations of a motion as there are lanes.
//!
//! Each lane stands for a stretch of the motion: a middle and a half length. A lane is free when no point of the robot can
//! reach anything within its stretch, and hit when the robot touches something in its middle. What is neither stays open.

use pulp::Simd;

use super::apart::Apart;
use super::frames::{FrameMemory, Frames};
use super::glance::Standing;
use super::lane::{Lanes, Mask, Vector, cross, dot, minus, plus, times};
use super::mechanism::{LaneRobot, Sphere};
use super::obstacle::Obstacle;
use super::pile::Question;

/// What a motion looks like to the kernel: numbers that are the same in all lanes.
#[derive(Debug, Default)]
pub(super) struct Motion {
    /// For each step, its value at the start and its change over the whole motion.
    pub(super) steps: Vec<(f32, f32)>,
    /// For each body, half of a bound on the acceleration of its points, per motion squared.
    pub(super) bends: Vec<f32>,
    /// Pairs of bodies that may touch, each with a bound on the speed at which points of the two come together, per motion.
    pub(super) pairs: Vec<(u32, f32)>,
    /// Longer half lengths are halved when their lane stays open; what is close matters only in the others.
    pub(super) halvable: f32,
}

/// What surrounds the robot.
#[derive(Debug)]
pub(super) struct Around<'a> {
    pub(super) obstacles: &'a [Obstacle],
    /// For each group of bodies, the obstacles that it can come near to, with the room that it keeps from them: negative where it
    /// may be in them, by so much.
    pub(super) near: &'a [Vec<(u32, f32)>],
}

/// The motion itself: its start, and the difference to its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) from: &'a [f64],
    pub(super) difference: &'a [f64],
}

/// Two things that are close: a body, and an obstacle or the body of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Close {
    Obstacle { body: u32, obstacle: u32 },
    Pair(u32),
}

/// Memory of the kernel, kept between calls.
#[derive(Debug)]
pub(super) struct Scratch {
    pub(super) frames: FrameMemory,
    /// For each frame, angular and linear velocity: six values.
    velocities: Vec<f32>,
    /// For each body, how far its points may move within the stretch.
    travel: Vec<f32>,
    pub(super) stack: Vec<(u32, u32)>,
    /// For each pair of bodies, what a look knows of it.
    pub(super) standings: Vec<Standing>,
    /// What is close in open lanes that are not halved any more.
    pub(super) close: Vec<Close>,
    /// Something that some lane was left open for.
    pub(super) widest: Close,
    /// One for each open lane, zero for others.
    pub(super) open: [f32; MOST_LANES],
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            frames: FrameMemory::default(),
            velocities: Vec::new(),
            travel: Vec::new(),
            stack: Vec::new(),
            standings: Vec::new(),
            close: Vec::new(),
            widest: Close::Pair(0),
            open: [0.0; MOST_LANES],
        }
    }
}

/// Parts of a pile that are smaller than this fraction of a sphere are not told apart, unless the sphere is a leaf.
pub(super) const COARSE: f32 = 0.25;

/// The most lanes of any processor.
pub(super) const MOST_LANES: usize = 16;

/// Velocities of each frame.
const VELOCITY: usize = 6;

/// Something touches in the middle of some lane: which lane, and what.
pub(super) type Hit = (usize, Close);

/// The kernel during one call.
struct Kernel<'a, S: Simd> {
    simd: S,
    robot: &'a LaneRobot,
    travel: &'a mut [S::f32s],
    frames: Frames<'a, S>,
    velocities: &'a mut [S::f32s],
    stack: &'a mut Vec<(u32, u32)>,
    close: &'a mut Vec<Close>,
    widest: &'a mut Close,
    /// Lanes that are neither free nor hit.
    open: Mask<S>,
    /// Lanes that are halved when they stay open.
    halvable: Mask<S>,
    rounding: f32,
    line: Line<'a>,
    /// Of the stretches of the lanes.
    middles: &'a [f32],
    halves: &'a [f32],
}

/// Looks at one configuration in each lane; middles and half lengths of the stretches are along the motion, from 0 to 1.
#[inline(always)]
pub(super) fn look<S: Simd>(
    simd: S,
    robot: &LaneRobot,
    around: &Around<'_>,
    motion: &Motion,
    line: Line<'_>,
    (middles, halves): (&[f32], &[f32]),
    scratch: &mut Scratch,
) -> Option<Hit> {
    let lanes = S::F32_LANES;
    scratch.velocities.resize((robot.steps.len() + 1) * VELOCITY * lanes, 0.0);
    scratch.travel.resize(robot.bodies.len() * lanes, 0.0);
    scratch.close.clear();
    let middle = Lanes::new(simd, simd.partial_load_f32s(middles));
    let half = Lanes::new(simd, simd.partial_load_f32s(halves));
    let mut kernel = Kernel {
        simd,
        robot,
        travel: S::as_mut_simd_f32s(&mut scratch.travel).0,
        frames: Frames::place(simd, robot, &motion.steps, middle, &mut scratch.frames),
        velocities: S::as_mut_simd_f32s(&mut scratch.velocities).0,
        stack: &mut scratch.stack,
        close: &mut scratch.close,
        widest: &mut scratch.widest,
        open: Mask::none(simd),
        halvable: Lanes::splat(simd, motion.halvable).less(half),
        rounding: robot.rounding as f32,
        line,
        middles,
        halves,
    };
    kernel.frames.reach(robot.steps.len());
    kernel.set_in_motion(motion);
    kernel.measure(motion, half);
    let hit = kernel.against_obstacles(around).or_else(|| kernel.against_itself(motion, half));
    let open = kernel.open;
    let numbers = open.as_numbers();
    simd.partial_store_f32s(&mut scratch.open[..lanes], numbers);
    hit
}

impl<S: Simd> Kernel<'_, S> {
    #[inline(always)]
    fn splat(&self, x: f32) -> Lanes<S> {
        Lanes::splat(self.simd, x)
    }

    /// Angular velocity of a frame, and linear velocity of its origin.
    #[inline(always)]
    fn velocity(&self, frame: usize) -> (Vector<S>, Vector<S>) {
        let values = &self.velocities[frame * VELOCITY..(frame + 1) * VELOCITY];
        let at = |k: usize| Lanes::new(self.simd, values[k]);
        ([at(0), at(1), at(2)], [at(3), at(4), at(5)])
    }

    /// Velocities of all frames.
    #[inline(always)]
    fn set_in_motion(&mut self, motion: &Motion) {
        let still = self.splat(0.0).raw;
        self.velocities[..VELOCITY].fill(still);
        let robot = self.robot;
        for (i, (step, &(_, change))) in robot.steps.iter().zip(&motion.steps).enumerate() {
            let (mut spin, mut speed) = self.velocity(step.parent);
            let arm = minus(&self.frames.origin(i + 1), &self.frames.origin(step.parent));
            speed = plus(&speed, &cross(&spin, &arm));
            let own = times(&self.frames.axis(i + 1), self.splat(change));
            if step.slides {
                speed = plus(&speed, &own);
            } else {
                spin = plus(&spin, &own);
            }
            let values = &mut self.velocities[(i + 1) * VELOCITY..(i + 2) * VELOCITY];
            for k in 0..3 {
                (values[k], values[k + 3]) = (spin[k].raw, speed[k].raw);
            }
        }
    }

    /// How far points of each body may move within the stretch: to first order by their speed in its middle, to second
    /// order by the bound on their acceleration (Taylor's theorem).
    #[inline(always)]
    fn measure(&mut self, motion: &Motion, half: Lanes<S>) {
        let robot = self.robot;
        let half_squared = half * half;
        for (i, body) in robot.bodies.iter().enumerate() {
            let root = body.spheres.start;
            let centre = self.frames.centre(root, body.frame);
            let (spin, speed) = self.velocity(body.frame);
            let arm = minus(&centre, &self.frames.origin(body.frame));
            let at_centre = plus(&speed, &cross(&spin, &arm));
            let radius = robot.spheres[root].outer;
            let fastest = dot(&at_centre, &at_centre).sqrt() + dot(&spin, &spin).sqrt() * radius;
            // A hair more, for rounding.
            let travel = (fastest * half + half_squared * motion.bends[i]) * (1.0 + 1e-5);
            self.travel[i] = travel.raw;
        }
    }

    #[inline(always)]
    fn against_obstacles(&mut self, around: &Around<'_>) -> Option<Hit> {
        let robot = self.robot;
        for (i, body) in robot.bodies.iter().enumerate() {
            let travel = Lanes::new(self.simd, self.travel[i]);
            for &(obstacle, room) in &around.near[body.group] {
                let solid = &around.obstacles[obstacle as usize];
                // How deep two parts are in each other, spheres do not tell: they only prove them apart.
                let slack = self.rounding + solid.pad + room.max(0.0);
                let reach = travel + self.splat(slack);
                let mut at = body.spheres.start;
                let close = Close::Obstacle { body: i as u32, obstacle };
                let mut is_close = false;
                while at < body.spheres.end {
                    let sphere = &robot.spheres[at];
                    let leaf = sphere.next as usize == at + 1;
                    let centre = self.frames.centre(at, body.frame);
                    let outer = reach + self.splat(sphere.outer);
                    let coarse = if leaf { 0.0 } else { COARSE * sphere.outer };
                    let question = Question { limit: outer, coarse };
                    let (least, most) = solid.squared_distance(self.simd, &centre, question);
                    let maybe = least.less_equal(outer * outer);
                    if !maybe.any() {
                        at = sphere.next as usize;
                        continue;
                    }
                    let here = self.splat(sphere.outer + slack);
                    let (deeper, final_here) = self.keep_open(maybe, sphere.outer, travel, leaf, close);
                    is_close |= final_here;
                    if !deeper && !least.less_equal(here * here).any() {
                        at = sphere.next as usize;
                        continue;
                    }
                    let inner = sphere.inner + room - self.rounding;
                    if sphere.inner > self.rounding && room >= 0.0 {
                        let hit = most.less_equal(self.splat(inner * inner));
                        if hit.any() {
                            return Some((hit.first(), close));
                        }
                    }
                    at += 1;
                }
                if is_close {
                    self.close.push(close);
                }
            }
        }
        None
    }

    #[inline(always)]
    fn against_itself(&mut self, motion: &Motion, half: Lanes<S>) -> Option<Hit> {
        let robot = self.robot;
        for &(i, closing) in &motion.pairs {
            let pair = &robot.pairs[i as usize];
            let close = Close::Pair(i);
            let (a, b) = (&robot.bodies[pair.a], &robot.bodies[pair.b]);
            // Each moves by no more than it may, and the two together by no more than the joints between them move them.
            let both =
                Lanes::new(self.simd, self.travel[pair.a]) + Lanes::new(self.simd, self.travel[pair.b]);
            let travel = (half * closing).min(both);
            let reach = travel + self.splat(2.0 * self.rounding);
            self.stack.clear();
            self.stack.push((a.spheres.start as u32, b.spheres.start as u32));
            let mut is_close = false;
            // Lanes in which the table of the pair does not tell that the two stay apart.
            let mut doubtful = None;
            while let Some((at_a, at_b)) = self.stack.pop() {
                let (of_a, of_b) = (&robot.spheres[at_a as usize], &robot.spheres[at_b as usize]);
                let apart = minus(
                    &self.frames.centre(at_a as usize, a.frame),
                    &self.frames.centre(at_b as usize, b.frame),
                );
                let squared = dot(&apart, &apart);
                let outer = reach + self.splat(of_a.outer + of_b.outer);
                let maybe = squared.less_equal(outer * outer);
                if !maybe.any() {
                    continue;
                }
                // Only now is the table worth its time.
                let maybe = match &pair.apart {
                    Some(table) => maybe.and(*doubtful.get_or_insert_with(|| self.doubtful(table))),
                    None => maybe,
                };
                if !maybe.any() {
                    continue;
                }
                let (leaf_a, leaf_b) = (of_a.next == at_a + 1, of_b.next == at_b + 1);
                let here = self.splat(of_a.outer + of_b.outer + 2.0 * self.rounding);
                let (deeper, final_here) =
                    self.keep_open(maybe, of_a.outer + of_b.outer, travel, leaf_a && leaf_b, close);
                is_close |= final_here;
                if !deeper && !squared.less_equal(here * here).any() {
                    continue;
                }
                let inner = of_a.inner + of_b.inner - 2.0 * self.rounding;
                if of_a.inner > self.rounding && of_b.inner > self.rounding {
                    let hit = squared.less_equal(self.splat(inner * inner));
                    if hit.any() {
                        return Some((hit.first(), close));
                    }
                }
                if leaf_a && leaf_b {
                    continue;
                }
                if leaf_b || (!leaf_a && of_a.outer >= of_b.outer) {
                    children(&robot.spheres, at_a, |child| self.stack.push((child, at_b)));
                } else {
                    children(&robot.spheres, at_b, |child| self.stack.push((at_a, child)));
                }
            }
            if is_close {
                self.close.push(close);
            }
        }
        None
    }

    /// Lanes in whose stretches a pair is not known to stay apart.
    #[inline(always)]
    fn doubtful(&self, table: &Apart) -> Mask<S> {
        let mut numbers = [0.0; MOST_LANES];
        for (number, (middle, half)) in numbers.iter_mut().zip(self.middles.iter().zip(self.halves)) {
            let (start, end) = (f64::from(middle - half), f64::from(middle + half));
            *number =
                if table.holds_within(self.line.from, self.line.difference, start, end) { 0.0 } else { 1.0 };
        }
        let numbers = Lanes::new(self.simd, self.simd.partial_load_f32s(&numbers[..self.middles.len()]));
        self.splat(0.0).less(numbers)
    }

    /// Opens the lanes that a node leaves open for good: at a leaf all that it may touch, above one those to be halved in
    /// which the robot moves by more than the node is large. Whether other lanes ask for a closer look, and whether
    /// something is close in a lane that is not halved.
    ///
    /// A ball contains those below it, so that what comes of a lane does not depend on where others lead.
    #[inline(always)]
    fn keep_open(
        &mut self,
        maybe: Mask<S>,
        outer: f32,
        travel: Lanes<S>,
        leaf: bool,
        close: Close,
    ) -> (bool, bool) {
        if leaf {
            self.open = self.open.or(maybe);
            *self.widest = close;
            return (false, maybe.and_not(self.halvable).any());
        }
        let coarse = self.splat(outer).less_equal(travel).and(self.halvable).and(maybe);
        self.open = self.open.or(coarse);
        let settled = self.open.and(self.halvable);
        (maybe.and_not(settled).any(), false)
    }
}

#[inline(always)]
pub(super) fn children(spheres: &[Sphere], of: u32, mut each: impl FnMut(u32)) {
    let mut child = of + 1;
    while child < spheres[of as usize].next {
        each(child);
        child = spheres[child as usize].next;
    }
}
