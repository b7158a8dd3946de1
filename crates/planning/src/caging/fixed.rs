//! The same task with a firm grasp: what relaxed planning is compared with.

use super::task::{ArticulatedTask, CagedState};
use crate::edge::Obstruction;
use crate::space::Space;

/// A task in which the grasp never changes.
pub struct FixedGrasp<'t, T: ?Sized> {
    task: &'t mut T,
    tried: Tried,
    own: Vec<[usize; 1]>,
}

/// Grasps that are tried; each counts as one in contact.
enum Tried {
    All,
    InContact,
    One(usize),
}

impl<'t, T: ArticulatedTask + ?Sized> FixedGrasp<'t, T> {
    /// The same task without changes of grasp. Every grasp is taken to be in contact, so that all of them are tried.
    pub fn new(task: &'t mut T) -> Self {
        let own = (0..task.grasps()).map(|g| [g]).collect();
        Self { task, tried: Tried::All, own }
    }

    /// The same task without changes of grasp, in grasps alone that are in contact: those that hold firmly.
    pub fn firm(task: &'t mut T) -> Self {
        Self { tried: Tried::InContact, ..Self::new(task) }
    }

    /// The same task in one grasp alone.
    pub fn one(task: &'t mut T, grasp: usize) -> Self {
        Self { tried: Tried::One(grasp), ..Self::new(task) }
    }
}

impl<T: ArticulatedTask + ?Sized> ArticulatedTask for FixedGrasp<'_, T> {
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
        self.is_contact(grasp)
    }

    fn is_contact(&self, grasp: usize) -> bool {
        match self.tried {
            Tried::All => true,
            Tried::InContact => self.task.is_contact(grasp),
            Tried::One(only) => grasp == only,
        }
    }

    fn adjacent(&self, grasp: usize) -> &[usize] {
        &self.own[grasp]
    }

    fn solutions(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        if !self.is_contact(grasp) {
            return vec![];
        }
        self.task.solutions(step, grasp, near)
    }

    fn candidates(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        if !self.is_contact(grasp) {
            return vec![];
        }
        self.task.candidates(step, grasp, near)
    }

    fn take_candidate(
        &mut self,
        step: usize,
        grasp: usize,
        near: &[f64],
        take: &mut dyn FnMut(Vec<f64>) -> bool,
    ) -> bool {
        self.is_contact(grasp) && self.task.take_candidate(step, grasp, near, take)
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
