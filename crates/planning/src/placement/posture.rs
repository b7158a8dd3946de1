//! Configurations in which a robot may drive: all limbs, and what it holds, above its footprint (thesis algorithm 3.12).

use nalgebra::Point3;
use robotc_core::rng::Rng;
use robotc_core::{Configuration, DofIdx, Kinematics, LinkIdx, Seed};
use serde::{Deserialize, Serialize};

use crate::budget::{Budget, Interrupt};
use crate::constraint::Constraint;
use crate::edge::EdgeChecker;
use crate::goal::{GoalDraw, GoalSampler};
use crate::jitter::Ball;

/// The space above a footprint.
#[derive(Debug, Clone, PartialEq)]
pub struct Prism {
    /// Corners of a convex outline on the floor, counter-clockwise, in the frame of the base; metres.
    pub footprint: Vec<[f64; 2]>,
    /// Lowest and highest point.
    pub heights: (f64, f64),
}

impl Prism {
    /// How far a point is outside, metres; not positive inside.
    pub fn excess(&self, p_in_base: &Point3<f64>) -> f64 {
        let vertical = (self.heights.0 - p_in_base.z).max(p_in_base.z - self.heights.1);
        let count = self.footprint.len();
        (0..count)
            .map(|i| {
                let ([ax, ay], [bx, by]) = (self.footprint[i], self.footprint[(i + 1) % count]);
                let (ex, ey) = (bx - ax, by - ay);
                let length = ex.hypot(ey).max(f64::MIN_POSITIVE);
                // Outside is to the right of a counter-clockwise edge.
                ((p_in_base.x - ax) * ey - (p_in_base.y - ay) * ex) / length
            })
            .fold(vertical, f64::max)
    }
}

/// Points on links that must be in a prism. A convex body is inside when its corners are.
#[derive(Clone)]
pub struct PrismBodies<'a> {
    /// The robot's kinematics. The prism is in the frame of its root.
    pub kinematics: &'a Kinematics,
    /// The joints that are not planned for.
    pub q: Configuration,
    /// Those that are, in the order of the configuration space.
    pub dofs: &'a [DofIdx],
    /// Links with corners of what is on them, in link frames; a held body counts as part of the link that carries it.
    pub corners: Vec<(LinkIdx, Vec<Point3<f64>>)>,
}

impl PrismBodies<'_> {
    /// How far the farthest corner is outside of the prism at `q`; not positive when all are inside.
    pub fn excess(&self, prism: &Prism, q: &[f64]) -> f64 {
        let mut all = self.q.clone();
        all.set(self.dofs, q);
        let mut worst = f64::NEG_INFINITY;
        for (link, corners) in &self.corners {
            let root_from_link = self.kinematics.root_from_link(&all, *link);
            for corner in corners {
                worst = worst.max(prism.excess(&(root_from_link * corner)));
            }
        }
        worst
    }
}

/// Parameters of [`NavigationPosture`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PostureOptions {
    /// Radius of the first ball around the preset posture, in the unit of [`EdgeChecker::travel`].
    pub smallest: f64,
    /// Radius of the last one.
    pub largest: f64,
    /// Samples after which there are no more goals; the radius grows evenly with their number.
    pub samples: u32,
    /// Steps of the descent that moves a sample into the prism.
    pub descent: u32,
}

impl Default for PostureOptions {
    fn default() -> Self {
        Self { smallest: 0.05, largest: 3.0, samples: 500, descent: 60 }
    }
}

/// Free configurations inside of the prism, first the preset one, then others farther and farther away from it.
///
/// Self-collisions, and those of a held body with the robot, are the checker's.
pub struct NavigationPosture<'a, C: ?Sized> {
    checker: &'a mut C,
    /// How far a configuration is outside of the prism.
    excess: &'a dyn Fn(&[f64]) -> f64,
    preset: Vec<f64>,
    constraint: Option<&'a dyn Constraint>,
    options: PostureOptions,
    rng: Rng,
    /// Samples looked at so far.
    pub sampled: u32,
    /// How many of them could not be moved into the prism.
    pub outside: u32,
    /// How many of them were not free.
    pub blocked: u32,
}

impl<'a, C: EdgeChecker + ?Sized> NavigationPosture<'a, C> {
    /// Postures around `preset`; `excess` is not positive inside of the prism, see [`PrismBodies::excess`].
    pub fn new(
        checker: &'a mut C,
        excess: &'a dyn Fn(&[f64]) -> f64,
        preset: &[f64],
        options: PostureOptions,
        seed: Seed,
    ) -> Self {
        let (preset, rng) = (preset.to_vec(), seed.rng());
        Self { checker, excess, preset, constraint: None, options, rng, sampled: 0, outside: 0, blocked: 0 }
    }

    /// The same sampler of postures that satisfy a constraint: a cup that is held upright.
    pub fn with_constraint(self, constraint: Option<&'a dyn Constraint>) -> Self {
        Self { constraint, ..self }
    }

    /// Moves a configuration into the limits and onto the constraint; `false` when it cannot be.
    fn settle(&self, q: &mut [f64]) -> bool {
        self.checker.space().clamp(q);
        self.constraint.is_none_or(|c| c.project(q) && self.checker.space().contains(q))
    }

    /// Moves a configuration into the prism, one coordinate at a time.
    fn descend(&mut self, q: &mut Vec<f64>) -> bool {
        let mut excess = (self.excess)(q);
        let mut reach = 0.4;
        for _ in 0..self.options.descent {
            if excess <= 0.0 {
                return true;
            }
            let coordinate = self.rng.below(q.len());
            let mut moved = q.clone();
            moved[coordinate] += self.rng.range(-reach, reach);
            let settled = self.settle(&mut moved);
            let then = (self.excess)(&moved);
            if settled && then < excess {
                (*q, excess) = (moved, then);
            } else {
                // Near the minimum of a coordinate only short steps help.
                reach = (0.95 * reach).max(0.02);
            }
        }
        excess <= 0.0
    }
}

impl<C: EdgeChecker + ?Sized> GoalSampler for NavigationPosture<'_, C> {
    fn draw(&mut self, budget: &Budget<'_>) -> Result<GoalDraw, Interrupt> {
        budget.check()?;
        if self.sampled >= self.options.samples.max(1) {
            return Ok(GoalDraw::Exhausted);
        }
        let share = f64::from(self.sampled) / f64::from(self.options.samples.max(1));
        self.sampled += 1;
        let mut q = self.preset.clone();
        if self.sampled > 1 {
            let radius = self.options.smallest + share * (self.options.largest - self.options.smallest);
            q = Ball::new(&*self.checker).within(&*self.checker, &q, radius, &mut self.rng);
        }
        if !self.settle(&mut q) || !self.descend(&mut q) {
            self.outside += 1;
            return Ok(GoalDraw::Pending);
        }
        if self.checker.state(&q).is_err() {
            self.blocked += 1;
            return Ok(GoalDraw::Pending);
        }
        Ok(GoalDraw::Goal(q))
    }
}
