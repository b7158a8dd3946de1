//! The edge checker of a robot in a scene.

use robotc_core::{Configuration, DofIdx, LinkIdx, LinkPoses};

use super::{Rules, Scene};
use crate::constraint::Constraint;
use crate::edge::{EdgeChecker, Obstruction};
use crate::space::Space;
use crate::travel::TravelBounds;

/// Checks motions of some degrees of freedom of a robot; the others stay as they are.
pub struct RobotChecker<'a> {
    scene: &'a Scene,
    space: &'a Space,
    dofs: &'a [DofIdx],
    /// Links that these degrees of freedom move and that have a shape.
    links: Vec<LinkIdx>,
    bounds: TravelBounds,
    resolution: f64,
    rules: Rules,
    constraint: Option<&'a dyn Constraint>,
    q: Configuration,
    poses: LinkPoses,
    states: u64,
}

impl<'a> RobotChecker<'a> {
    /// Motions of `dofs`, the coordinates of `space`, from configuration `q` on; bodies travel no more than
    /// `resolution` metres between two checked states.
    pub fn new(
        scene: &'a Scene,
        space: &'a Space,
        dofs: &'a [DofIdx],
        q: &Configuration,
        rules: Rules,
        resolution: f64,
    ) -> Self {
        let model = scene.kinematics.model();
        let moved = |link: &LinkIdx| {
            !scene.links[*link].is_empty() && model.dofs_moving(*link).iter().any(|d| dofs.contains(d))
        };
        Self {
            links: model.links().indices().filter(moved).collect(),
            bounds: scene.travel_bounds(dofs, rules.held.as_ref()),
            scene,
            space,
            dofs,
            resolution,
            rules,
            constraint: None,
            q: q.clone(),
            poses: LinkPoses::default(),
            states: 0,
        }
    }

    /// The same checker that also refuses states that violate `constraint`.
    pub fn with_constraint(mut self, constraint: Option<&'a dyn Constraint>) -> Self {
        self.constraint = constraint;
        self
    }

    /// Number of states looked at so far.
    pub fn states(&self) -> u64 {
        self.states
    }
}

impl EdgeChecker for RobotChecker<'_> {
    fn space(&self) -> &Space {
        self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        self.states += 1;
        if !self.space.contains(q) {
            return Err(Obstruction::Bounds);
        }
        if self.constraint.is_some_and(|c| !c.holds(q)) {
            return Err(Obstruction::Constraint);
        }
        self.q.set(self.dofs, q);
        self.scene.kinematics.link_poses(&self.q, &mut self.poses);
        let around =
            self.scene.against_bodies(&self.scene.world_from_robot, &self.poses, &self.links, &self.rules)?;
        let between = self.scene.against_self(&self.poses, &self.rules)?;
        // A constraint says nothing about the states around.
        Ok(if self.constraint.is_some() { 0.0 } else { around.min(between) })
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        let travel = self.bounds.travel(difference);
        self.constraint.map_or(travel, |c| travel.max(self.resolution * c.size(difference)))
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    fn describe(&self, obstruction: Obstruction) -> String {
        match obstruction {
            Obstruction::Bounds => "a joint limit is exceeded".into(),
            Obstruction::Constraint => "the held object tilts too far".into(),
            Obstruction::Contact(n) => {
                self.scene.describe(obstruction).unwrap_or_else(|| format!("contact {n}"))
            }
        }
    }
}
