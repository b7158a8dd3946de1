//! One look at as many configurations of a motion as there are lanes.
//!
//! Each lane stands for a stretch of the motion: a middle and a half length. A lane is free when no point of the robot can
//! reach anything within its stretch, and hit when the robot touches something in its middle. What is neither stays open.

use pulp::Simd;

use super::lane::{Lanes, Mask, Vector, cross, dot, minus, plus, scaled, times};
use super::mechanism::{LaneRobot, Sphere};
use super::obstacle::Obstacle;

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
    /// For each body, the obstacles that it can come near to, with the room that it keeps from them.
    pub(super) near: &'a [Vec<(u32, f32)>],
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
    /// For each frame, rotation (nine), origin, angular and linear velocity: eighteen values.
    frames: Vec<f32>,
    /// For each body, how far its points may move within the stretch.
    travel: Vec<f32>,
    /// Middles of all spheres in the root frame.
    centres: Vec<f32>,
    /// The call for which a middle was computed.
    stamps: Vec<u32>,
    call: u32,
    stack: Vec<(u32, u32)>,
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
            frames: Vec::new(),
            travel: Vec::new(),
            centres: Vec::new(),
            stamps: Vec::new(),
            call: 0,
            stack: Vec::new(),
            close: Vec::new(),
            widest: Close::Pair(0),
            open: [0.0; MOST_LANES],
        }
    }
}

/// The most lanes of any processor.
pub(super) const MOST_LANES: usize = 16;

/// Values for each frame.
const FRAME: usize = 18;

/// Something touches in the middle of some lane: which lane, and what.
pub(super) type Hit = (usize, Close);

/// The kernel during one call.
struct Kernel<'a, S: Simd> {
    simd: S,
    robot: &'a LaneRobot,
    travel: &'a mut [S::f32s],
    frames: &'a mut [S::f32s],
    centres: &'a mut [S::f32s],
    stamps: &'a mut [u32],
    call: u32,
    stack: &'a mut Vec<(u32, u32)>,
    close: &'a mut Vec<Close>,
    widest: &'a mut Close,
    /// Lanes that are neither free nor hit.
    open: Mask<S>,
    /// Lanes that are halved when they stay open.
    halvable: Mask<S>,
    rounding: f32,
}

/// Looks at one configuration in each lane; `middles` and `halves` are along the motion, from 0 to 1.
#[inline(always)]
pub(super) fn look<S: Simd>(
    simd: S,
    robot: &LaneRobot,
    around: &Around<'_>,
    motion: &Motion,
    middles: &[f32],
    halves: &[f32],
    scratch: &mut Scratch,
) -> Option<Hit> {
    let lanes = S::F32_LANES;
    scratch.frames.resize((robot.steps.len() + 1) * FRAME * lanes, 0.0);
    scratch.travel.resize(robot.bodies.len() * lanes, 0.0);
    scratch.centres.resize(robot.spheres.len() * 3 * lanes, 0.0);
    scratch.stamps.resize(robot.spheres.len(), 0);
    scratch.call = scratch.call.wrapping_add(1);
    if scratch.call == 0 {
        scratch.stamps.fill(0);
        scratch.call = 1;
    }
    scratch.close.clear();
    let middle = Lanes::new(simd, simd.partial_load_f32s(middles));
    let half = Lanes::new(simd, simd.partial_load_f32s(halves));
    let mut kernel = Kernel {
        simd,
        robot,
        travel: S::as_mut_simd_f32s(&mut scratch.travel).0,
        frames: S::as_mut_simd_f32s(&mut scratch.frames).0,
        centres: S::as_mut_simd_f32s(&mut scratch.centres).0,
        stamps: &mut scratch.stamps,
        call: scratch.call,
        stack: &mut scratch.stack,
        close: &mut scratch.close,
        widest: &mut scratch.widest,
        open: Mask::none(simd),
        halvable: Lanes::splat(simd, motion.halvable).less(half),
        rounding: robot.rounding as f32,
    };
    kernel.place(motion, middle);
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

    #[inline(always)]
    fn vector(&self, frame: usize, at: usize) -> Vector<S> {
        let values = &self.frames[frame * FRAME + at..frame * FRAME + at + 3];
        [Lanes::new(self.simd, values[0]), Lanes::new(self.simd, values[1]), Lanes::new(self.simd, values[2])]
    }

    #[inline(always)]
    fn set(&mut self, frame: usize, at: usize, value: &Vector<S>) {
        let values = &mut self.frames[frame * FRAME + at..frame * FRAME + at + 3];
        (values[0], values[1], values[2]) = (value[0].raw, value[1].raw, value[2].raw);
    }

    /// Columns of the rotation of a frame.
    #[inline(always)]
    fn columns(&self, frame: usize) -> [Vector<S>; 3] {
        [self.vector(frame, 0), self.vector(frame, 3), self.vector(frame, 6)]
    }

    /// Poses and velocities of all frames.
    #[inline(always)]
    fn place(&mut self, motion: &Motion, middle: Lanes<S>) {
        let (zero, one) = (self.splat(0.0), self.splat(1.0));
        for (at, value) in [
            (0, [one, zero, zero]),
            (3, [zero, one, zero]),
            (6, [zero, zero, one]),
            (9, [zero; 3]),
            (12, [zero; 3]),
            (15, [zero; 3]),
        ] {
            self.set(0, at, &value);
        }
        let robot = self.robot;
        for (i, (step, &(start, change))) in robot.steps.iter().zip(&motion.steps).enumerate() {
            let value = self.splat(start) + middle * change;
            let [x, y, z] = self.columns(step.parent);
            // A column of the joint's rotation, and its shift, are mixtures of the parent's columns.
            let [row_x, row_y, row_z] = step.rows;
            let joint_x = mix(&x, &y, &z, [row_x[0], row_y[0], row_z[0]], zero);
            let joint_y = mix(&x, &y, &z, [row_x[1], row_y[1], row_z[1]], zero);
            let axis = mix(&x, &y, &z, [row_x[2], row_y[2], row_z[2]], zero);
            let arm = mix(&x, &y, &z, step.shift, zero);
            let (spin, speed) = (self.vector(step.parent, 12), self.vector(step.parent, 15));
            let origin = plus(&self.vector(step.parent, 9), &arm);
            let speed = plus(&speed, &cross(&spin, &arm));
            if step.slides {
                let slid = times(&axis, value);
                let pushed = plus(&cross(&spin, &slid), &times(&axis, self.splat(change)));
                self.set(i + 1, 0, &joint_x);
                self.set(i + 1, 3, &joint_y);
                self.set(i + 1, 9, &plus(&origin, &slid));
                self.set(i + 1, 12, &spin);
                self.set(i + 1, 15, &plus(&speed, &pushed));
            } else {
                let (sine, cosine) = value.sin_cos();
                self.set(i + 1, 0, &plus(&times(&joint_x, cosine), &times(&joint_y, sine)));
                self.set(i + 1, 3, &minus(&times(&joint_y, cosine), &times(&joint_x, sine)));
                self.set(i + 1, 9, &origin);
                self.set(i + 1, 12, &plus(&spin, &times(&axis, self.splat(change))));
                self.set(i + 1, 15, &speed);
            }
            self.set(i + 1, 6, &axis);
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
            let centre = self.centre(root, body.frame);
            let (spin, speed) = (self.vector(body.frame, 12), self.vector(body.frame, 15));
            let arm = minus(&centre, &self.vector(body.frame, 9));
            let at_centre = plus(&speed, &cross(&spin, &arm));
            let radius = robot.spheres[root].outer;
            let fastest = dot(&at_centre, &at_centre).sqrt() + dot(&spin, &spin).sqrt() * radius;
            // A hair more, for rounding.
            let travel = (fastest * half + half_squared * motion.bends[i]) * (1.0 + 1e-5);
            self.travel[i] = travel.raw;
        }
    }

    /// The middle of a sphere in the root frame, computed once for each call.
    #[inline(always)]
    fn centre(&mut self, sphere: usize, frame: usize) -> Vector<S> {
        let at = 3 * sphere;
        if self.stamps[sphere] != self.call {
            self.stamps[sphere] = self.call;
            let [x, y, z] = self.columns(frame);
            let origin = self.vector(frame, 9);
            let [cx, cy, cz] = self.robot.spheres[sphere].centre;
            for k in 0..3 {
                let value = origin[k] + x[k] * cx + y[k] * cy + z[k] * cz;
                self.centres[at + k] = value.raw;
            }
        }
        let (simd, values) = (self.simd, &self.centres[at..at + 3]);
        [Lanes::new(simd, values[0]), Lanes::new(simd, values[1]), Lanes::new(simd, values[2])]
    }

    #[inline(always)]
    fn against_obstacles(&mut self, around: &Around<'_>) -> Option<Hit> {
        let robot = self.robot;
        for (i, body) in robot.bodies.iter().enumerate() {
            let travel = Lanes::new(self.simd, self.travel[i]);
            for &(obstacle, room) in &around.near[i] {
                let solid = &around.obstacles[obstacle as usize];
                let slack = self.rounding + solid.pad + room;
                let reach = travel + self.splat(slack);
                let mut at = body.spheres.start;
                let close = Close::Obstacle { body: i as u32, obstacle };
                let mut is_close = false;
                while at < body.spheres.end {
                    let sphere = &robot.spheres[at];
                    let leaf = sphere.next as usize == at + 1;
                    let centre = self.centre(at, body.frame);
                    let (least, most) = solid.squared_distance(self.simd, &centre);
                    let outer = reach + self.splat(sphere.outer);
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
                    if sphere.inner > self.rounding {
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
            while let Some((at_a, at_b)) = self.stack.pop() {
                let (of_a, of_b) = (&robot.spheres[at_a as usize], &robot.spheres[at_b as usize]);
                let apart = minus(&self.centre(at_a as usize, a.frame), &self.centre(at_b as usize, b.frame));
                let squared = dot(&apart, &apart);
                let outer = reach + self.splat(of_a.outer + of_b.outer);
                let maybe = squared.less_equal(outer * outer);
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

/// A mixture of three vectors. Factors of zero are frequent.
#[inline(always)]
fn mix<S: Simd>(x: &Vector<S>, y: &Vector<S>, z: &Vector<S>, factors: [f32; 3], zero: Lanes<S>) -> Vector<S> {
    let mut sum = [zero; 3];
    if factors[0] != 0.0 {
        sum = scaled(x, factors[0]);
    }
    if factors[1] != 0.0 {
        sum = plus(&sum, &scaled(y, factors[1]));
    }
    if factors[2] != 0.0 {
        sum = plus(&sum, &scaled(z, factors[2]));
    }
    sum
}

#[inline(always)]
fn children(spheres: &[Sphere], of: u32, mut each: impl FnMut(u32)) {
    let mut child = of + 1;
    while child < spheres[of as usize].next {
        each(child);
        child = spheres[child as usize].next;
    }
}
