//! Where the robot is in each lane: poses of its frames, and middles of its spheres.

use pulp::Simd;

use super::lane::{Lanes, Vector, minus, plus, scaled, times};
use super::mechanism::LaneRobot;

/// Memory of [`Frames`], kept between calls.
#[derive(Debug, Default)]
pub(super) struct FrameMemory {
    /// For each frame, columns of the rotation and the origin: twelve values.
    poses: Vec<f32>,
    /// Middles of all spheres in the root frame.
    centres: Vec<f32>,
    /// The call for which a middle was computed.
    stamps: Vec<u32>,
    call: u32,
}

/// Poses of all frames in the root frame, and middles of spheres as they are asked for.
pub(super) struct Frames<'a, S: Simd> {
    simd: S,
    robot: &'a LaneRobot,
    poses: &'a mut [S::f32s],
    centres: &'a mut [S::f32s],
    stamps: &'a mut [u32],
    call: u32,
    joints: Joints<'a, S>,
    /// Frames that are placed.
    placed: usize,
}

/// Where the joints are.
#[derive(Clone, Copy)]
enum Joints<'a, S: Simd> {
    /// Along a motion: of each joint, its value at the start and its change over the whole motion; and how far.
    Along(&'a [(f32, f32)], Lanes<S>),
    /// Anywhere: values of each joint.
    Each(&'a [S::f32s]),
}

/// Values for each frame.
const FRAME: usize = 12;

impl<'a, S: Simd> Frames<'a, S> {
    /// The frames at the fractions `along` of a motion; `steps` has, for each joint, its value at the start and its change
    /// over the whole motion.
    #[inline(always)]
    pub(super) fn place(
        simd: S,
        robot: &'a LaneRobot,
        steps: &'a [(f32, f32)],
        along: Lanes<S>,
        memory: &'a mut FrameMemory,
    ) -> Self {
        Self::new(simd, robot, Joints::Along(steps, along), memory)
    }

    /// The frames of configurations that have nothing to do with each other; `values` has, for each joint, where it is in each lane.
    #[inline(always)]
    pub(super) fn place_each(
        simd: S,
        robot: &'a LaneRobot,
        values: &'a [f32],
        memory: &'a mut FrameMemory,
    ) -> Self {
        Self::new(simd, robot, Joints::Each(S::as_simd_f32s(values).0), memory)
    }

    #[inline(always)]
    fn new(simd: S, robot: &'a LaneRobot, joints: Joints<'a, S>, memory: &'a mut FrameMemory) -> Self {
        let lanes = S::F32_LANES;
        let (poses, centres) = ((robot.steps.len() + 1) * FRAME * lanes, robot.spheres.len() * 3 * lanes);
        // Others may need more of it.
        let at_least = |len: usize, values: &mut Vec<f32>| values.resize(values.len().max(len), 0.0);
        at_least(poses, &mut memory.poses);
        at_least(centres, &mut memory.centres);
        memory.stamps.resize(memory.stamps.len().max(robot.spheres.len()), 0);
        memory.call = memory.call.wrapping_add(1);
        if memory.call == 0 {
            memory.stamps.fill(0);
            memory.call = 1;
        }
        let mut frames = Self {
            simd,
            robot,
            poses: S::as_mut_simd_f32s(&mut memory.poses[..poses]).0,
            centres: S::as_mut_simd_f32s(&mut memory.centres[..centres]).0,
            stamps: &mut memory.stamps,
            call: memory.call,
            joints,
            placed: 1,
        };
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        for (at, value) in
            [(0, [one, zero, zero]), (3, [zero, one, zero]), (6, [zero, zero, one]), (9, [zero; 3])]
        {
            frames.set(0, at, &value);
        }
        frames
    }

    /// Places all frames up to one.
    #[inline(always)]
    pub(super) fn reach(&mut self, frame: usize) {
        let Self { robot, joints, .. } = *self;
        let zero = Lanes::splat(self.simd, 0.0);
        while self.placed <= frame {
            let i = self.placed - 1;
            self.placed += 1;
            let step = &robot.steps[i];
            let value = match joints {
                Joints::Along(steps, along) => Lanes::splat(self.simd, steps[i].0) + along * steps[i].1,
                Joints::Each(values) => Lanes::new(self.simd, values[i]),
            };
            let [x, y, z] = self.columns(step.parent);
            // A column of the joint's rotation, and its shift, are mixtures of the parent's columns.
            let [row_x, row_y, row_z] = step.rows;
            let joint_x = mix(&x, &y, &z, [row_x[0], row_y[0], row_z[0]], zero);
            let joint_y = mix(&x, &y, &z, [row_x[1], row_y[1], row_z[1]], zero);
            let axis = mix(&x, &y, &z, [row_x[2], row_y[2], row_z[2]], zero);
            let origin = plus(&self.origin(step.parent), &mix(&x, &y, &z, step.shift, zero));
            if step.slides {
                self.set(i + 1, 0, &joint_x);
                self.set(i + 1, 3, &joint_y);
                self.set(i + 1, 9, &plus(&origin, &times(&axis, value)));
            } else {
                let (sine, cosine) = value.sin_cos();
                self.set(i + 1, 0, &plus(&times(&joint_x, cosine), &times(&joint_y, sine)));
                self.set(i + 1, 3, &minus(&times(&joint_y, cosine), &times(&joint_x, sine)));
                self.set(i + 1, 9, &origin);
            }
            self.set(i + 1, 6, &axis);
        }
    }

    #[inline(always)]
    fn vector(&self, frame: usize, at: usize) -> Vector<S> {
        let values = &self.poses[frame * FRAME + at..frame * FRAME + at + 3];
        [Lanes::new(self.simd, values[0]), Lanes::new(self.simd, values[1]), Lanes::new(self.simd, values[2])]
    }

    #[inline(always)]
    fn set(&mut self, frame: usize, at: usize, value: &Vector<S>) {
        let values = &mut self.poses[frame * FRAME + at..frame * FRAME + at + 3];
        (values[0], values[1], values[2]) = (value[0].raw, value[1].raw, value[2].raw);
    }

    /// Columns of the rotation of a frame.
    #[inline(always)]
    fn columns(&self, frame: usize) -> [Vector<S>; 3] {
        [self.vector(frame, 0), self.vector(frame, 3), self.vector(frame, 6)]
    }

    /// The axis along or about which a frame is moved.
    #[inline(always)]
    pub(super) fn axis(&self, frame: usize) -> Vector<S> {
        self.vector(frame, 6)
    }

    #[inline(always)]
    pub(super) fn origin(&self, frame: usize) -> Vector<S> {
        self.vector(frame, 9)
    }

    /// The middle of a sphere, computed once.
    #[inline(always)]
    pub(super) fn centre(&mut self, sphere: usize, frame: usize) -> Vector<S> {
        let at = 3 * sphere;
        if self.stamps[sphere] != self.call {
            self.stamps[sphere] = self.call;
            let [x, y, z] = self.columns(frame);
            let origin = self.origin(frame);
            let [cx, cy, cz] = self.robot.spheres[sphere].centre;
            for k in 0..3 {
                let value = origin[k] + x[k] * cx + y[k] * cy + z[k] * cz;
                self.centres[at + k] = value.raw;
            }
        }
        let (simd, values) = (self.simd, &self.centres[at..at + 3]);
        [Lanes::new(simd, values[0]), Lanes::new(simd, values[1]), Lanes::new(simd, values[2])]
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
