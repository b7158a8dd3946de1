//! What was hit last is looked at first.
//!
//! Most motions that a search tries are blocked, and most of those by a sphere and an obstacle that blocked another one a moment ago.
//! So these are asked before anything else, at a few states all over the motion, and frames are placed no farther than to the links
//! that they are on.

use pulp::{Simd, WithSimd};

use super::frames::{FrameMemory, Frames};
use super::glance::{View, along};

/// A sphere inside of the robot and an obstacle that it touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Suspect {
    pub(super) body: u32,
    pub(super) sphere: u32,
    pub(super) obstacle: u32,
    /// How far apart the two have to be, metres.
    pub(super) room: f32,
}

/// The last ones, latest first.
#[derive(Debug)]
pub(super) struct Suspects(Vec<Suspect>);

/// How many are remembered.
const MOST: usize = 16;

impl Suspects {
    pub(super) fn new() -> Self {
        Self(Vec::with_capacity(MOST))
    }

    /// Moves one to the front; whether it is new.
    pub(super) fn blame(&mut self, suspect: Suspect) -> bool {
        let known = self.0.iter().position(|known| *known == suspect);
        let at = known.unwrap_or_else(|| {
            self.0.truncate(MOST - 1);
            self.0.push(suspect);
            self.0.len() - 1
        });
        self.0[..=at].rotate_right(1);
        known.is_none()
    }
}

/// Asks the suspects at one of the states of a look in each lane. One that touches there, if any.
pub(super) struct Inquiry<'a> {
    pub(super) view: View<'a>,
    pub(super) suspects: &'a Suspects,
    /// States of the look, a multiple of the number of lanes.
    pub(super) count: usize,
    pub(super) frames: &'a mut FrameMemory,
}

impl WithSimd for Inquiry<'_> {
    type Output = Option<Suspect>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<Suspect> {
        let Self { view, suspects, count, frames } = self;
        let View { robot, obstacles, motion, trust, .. } = view;
        let blocks = count / S::F32_LANES;
        let mut frames = Frames::place(simd, robot, &motion.steps, along(simd, count, blocks - 1), frames);
        for &suspect in &suspects.0 {
            let frame = robot.bodies[suspect.body as usize].frame;
            frames.reach(frame);
            let at = suspect.sphere as usize;
            let centre = frames.centre(at, frame);
            let question = robot.question(simd, at, suspect.room, trust);
            let most = obstacles[suspect.obstacle as usize].squared_distance(simd, &centre, question).1;
            if robot.spheres[at].inside(trust).touches(most, suspect.room, robot.rounding as f32) {
                return Some(suspect);
            }
        }
        None
    }
}
