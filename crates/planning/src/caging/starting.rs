//! The same task from where the gripper can get to the handle.

use super::task::{ArticulatedTask, CagedState};
use crate::edge::Obstruction;
use crate::space::Space;

/// A task that begins in one of some given states.
pub struct StartingAt<'t, T: ?Sized> {
    task: &'t mut T,
    starts: &'t [CagedState],
}

impl<'t, T: ArticulatedTask + ?Sized> StartingAt<'t, T> {
    /// The same task, at the first step in no other states than `starts`, which must be free.
    pub fn new(task: &'t mut T, starts: &'t [CagedState]) -> Self {
        Self { task, starts }
    }
}

impl<T: ArticulatedTask + ?Sized> ArticulatedTask for StartingAt<'_, T> {
    fn arm_space(&self) -> &Space {
        self.task.arm_space()
    }

    fn steps(&self) -> usize {
        self.task.steps()
    }

    fn grasps(&self) -> usize {
        self.task.grasps()
    }

    fn is_usable(&self, grasp: usize) -> bool {
        self.task.is_usable(grasp)
    }

    fn is_contact(&self, grasp: usize) -> bool {
        self.task.is_contact(grasp)
    }

    fn adjacent(&self, grasp: usize) -> &[usize] {
        self.task.adjacent(grasp)
    }

    fn solutions(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        match step {
            0 => self.starts.iter().filter(|s| s.grasp == grasp).map(|s| s.q.clone()).collect(),
            _ => self.task.solutions(step, grasp, near),
        }
    }

    fn candidates(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        match step {
            0 => self.solutions(step, grasp, near),
            _ => self.task.candidates(step, grasp, near),
        }
    }

    fn take_candidate(
        &mut self,
        step: usize,
        grasp: usize,
        near: &[f64],
        take: &mut dyn FnMut(Vec<f64>) -> bool,
    ) -> bool {
        match step {
            0 => self.solutions(step, grasp, Some(near)).into_iter().any(take),
            _ => self.task.take_candidate(step, grasp, near, take),
        }
    }

    fn free(&mut self, state: &CagedState) -> Result<(), Obstruction> {
        self.task.free(state)
    }

    fn motion(&mut self, from: &CagedState, to: &CagedState) -> Result<(), Obstruction> {
        self.task.motion(from, to)
    }

    fn longest_motion(&self) -> f64 {
        self.task.longest_motion()
    }

    fn neighbours(&self, step: usize) -> Vec<usize> {
        self.task.neighbours(step)
    }

    fn remaining(&self, step: usize) -> usize {
        self.task.remaining(step)
    }
}
