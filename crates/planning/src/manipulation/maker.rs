//! From paths to segments with times.

use robotc_core::task::Article;
use robotc_core::{Configuration, DofIdx, Trajectory};

use super::driving::Drive;
use super::plan::{ArticleMotion, Event, Held, Segment, SegmentKind};
use super::problem::{GoalContext, motion_limits};
use crate::scene::{RobotChecker, Rules, Scene};
use crate::timing::{MotionLimits, time_path};

/// Turns paths into segments, one after the other.
pub(super) struct Maker<'c, 'a> {
    cx: &'c GoalContext<'a>,
    /// Where the robot is after the segments so far.
    pub(super) q: Configuration,
    finger_limits: MotionLimits,
    pub(super) segments: Vec<Segment>,
}

impl<'c, 'a> Maker<'c, 'a> {
    /// Nothing yet, from configuration `q` on.
    pub(super) fn new(cx: &'c GoalContext<'a>, q: &Configuration) -> Self {
        let finger_limits = motion_limits(&cx.robot().model, &cx.gripper().dofs);
        Self { cx, q: q.clone(), finger_limits, segments: Vec::new() }
    }

    /// A motion of the arm.
    pub(super) fn arm(
        &mut self,
        kind: SegmentKind,
        path: &[Vec<f64>],
        scene: &Scene,
        rules: Rules,
        held: Option<&Held>,
    ) {
        let arm = self.cx.problem.arm;
        // Continuous joints go on from where they are, not from an alias.
        let mut path = path.to_vec();
        path[0] = self.q.select(arm.dofs());
        let resolution = self.cx.options.fine_resolution;
        let mut checker = RobotChecker::new(scene, arm.space(), arm.dofs(), &self.q, rules, resolution);
        let timed = time_path(&mut checker, &path, arm.limits(), &self.cx.options.timing);
        let trajectory = timed
            .into_trajectory(arm.dofs().to_vec(), arm.names().to_vec())
            .expect("times of a timed path grow");
        self.push(kind, trajectory, held);
    }

    /// A motion of the base.
    pub(super) fn drive(
        &mut self,
        drive: &Drive,
        path: &[Vec<f64>],
        scene: &Scene,
        rules: Rules,
        held: Option<&Held>,
    ) {
        let cx = self.cx;
        let (dofs, resolution) = (drive.dofs.to_vec(), cx.options.resolution);
        // The heading goes on from where it is as well.
        let mut path = path.to_vec();
        path[0] = self.q.select(&dofs);
        let mut checker = RobotChecker::new(scene, &drive.space, &dofs, &self.q, rules, resolution);
        let timed = time_path(&mut checker, &path, &drive.limits, &cx.options.timing);
        let model = &cx.robot().model;
        let names = dofs.iter().map(|&d| model.dofs()[d].name.clone()).collect();
        let trajectory = timed.into_trajectory(dofs, names).expect("times of a timed path grow");
        self.push(SegmentKind::Drive, trajectory, held);
    }

    /// A straight motion of the fingers.
    pub(super) fn fingers(
        &mut self,
        kind: SegmentKind,
        from: &[f64],
        to: &[f64],
        scene: &Scene,
        held: Option<&Held>,
    ) {
        let cx = self.cx;
        let dofs = &cx.gripper().dofs;
        let rules = cx.touching();
        let resolution = cx.options.fine_resolution;
        let mut checker = RobotChecker::new(scene, cx.finger_space, dofs, &self.q, rules, resolution);
        let path = [from.to_vec(), to.to_vec()];
        let timed = time_path(&mut checker, &path, &self.finger_limits, &cx.options.timing);
        let model = &cx.robot().model;
        let names = dofs.iter().map(|&d| model.dofs()[d].name.clone()).collect();
        let trajectory = timed.into_trajectory(dofs.clone(), names).expect("times of a timed path grow");
        self.push(kind, trajectory, held);
    }

    fn push(&mut self, kind: SegmentKind, trajectory: Trajectory, held: Option<&Held>) {
        self.q.set(trajectory.dofs(), trajectory.end());
        let goal = self.cx.number;
        let held = held.cloned();
        self.segments.push(Segment { kind, goal, trajectory, held, article: None, event: None });
    }

    /// A motion of arm and fingers (`dofs`, named `names`) and an article at once: states of `checker`.
    pub(super) fn with_article(
        &mut self,
        checker: &mut RobotChecker<'_>,
        path: &[Vec<f64>],
        (dofs, names): (Vec<DofIdx>, Vec<String>),
        (number, article): (usize, &Article),
    ) {
        let mut path = path.to_vec();
        let now = self.q.select(&dofs);
        path[0][..now.len()].copy_from_slice(&now);
        let mut limits = motion_limits(&self.cx.robot().model, &dofs);
        let of_article = motion_limits(&article.model, &[article.dof]);
        limits.velocity.extend(of_article.velocity);
        limits.acceleration.extend(of_article.acceleration);
        limits.jerk.extend(of_article.jerk);
        let timed = time_path(checker, &path, &limits, &self.cx.options.timing);
        let (joints, value) = timed.split(dofs.len());
        let trajectory = joints.into_trajectory(dofs, names).expect("times of a timed path grow");
        let name = article.model.dofs()[article.dof].name.clone();
        let values = value.into_trajectory(vec![article.dof], vec![name]).expect("the same times grow");
        self.push(SegmentKind::Open, trajectory, None);
        if let Some(segment) = self.segments.last_mut() {
            segment.article = Some(ArticleMotion { article: number, values });
        }
    }

    /// What happens at the end of the last segment.
    pub(super) fn event(&mut self, event: Event) {
        if let Some(segment) = self.segments.last_mut() {
            segment.event = Some(event);
        }
    }
}
