//! The edge checker of a robot in a scene.

use robotc_core::{Configuration, DofIdx, JointIdx, LinkIdx, LinkPoses, TypedVec};

use super::{Movers, Rules, Scene};
use crate::constraint::Constraint;
use crate::edge::{EdgeChecker, Obstruction};
use crate::space::Space;
use crate::travel::TravelBounds;

/// Checks motions of some degrees of freedom of a robot; the others stay as they are.
pub struct RobotChecker<'a> {
    scene: &'a Scene,
    space: &'a Space,
    dofs: &'a [DofIdx],
    movers: Movers,
    bounds: TravelBounds,
    resolution: f64,
    rules: Rules,
    constraint: Option<&'a dyn Constraint>,
    /// Clearance beyond this is not looked for.
    room: f64,
    q: Configuration,
    poses: LinkPoses,
    states: u64,
}

/// Clearance beyond this many times the resolution is not looked for: looking would cost more than it saves.
pub(super) const ROOM: f64 = 10.0;

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
        let (bounds, movers) = movers(scene, dofs, &rules);
        Self {
            movers,
            bounds,
            scene,
            space,
            dofs,
            resolution,
            rules,
            constraint: None,
            room: ROOM * resolution,
            q: q.clone(),
            poses: LinkPoses::default(),
            states: 0,
        }
    }

    /// The same checker that also refuses states that violate `constraint`.
    pub fn with_constraint(mut self, constraint: Option<&'a dyn Constraint>) -> Self {
        // A constraint says nothing about the states around, so their clearance is not worth finding.
        if constraint.is_some() {
            self.room = 0.0;
        }
        self.constraint = constraint;
        self
    }

    /// The same checker that looks at every state and reports no clearance.
    pub fn without_clearance(mut self) -> Self {
        self.room = 0.0;
        self
    }

    /// The same checker that lets links go through each other, and through what is held.
    pub fn without_self_collisions(mut self) -> Self {
        self.movers.pairs.clear();
        self.movers.beside_held.clear();
        self
    }

    /// The robot and the bodies around it.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Number of states looked at so far.
    pub fn states(&self) -> u64 {
        self.states
    }
}

/// What `dofs` move, with bounds on its travel. Pairs that they do not move against each other are left out.
pub(super) fn movers(scene: &Scene, dofs: &[DofIdx], rules: &Rules) -> (TravelBounds, Movers) {
    let mut bounds = TravelBounds::new(dofs);
    let rows: TypedVec<LinkIdx, Vec<f64>> = scene
        .links
        .enumerate()
        .map(|(link, shape)| match shape.is_empty() {
            true => vec![0.0; dofs.len()],
            false => bounds.add(&scene.kinematics, link, shape.radius_about_origin()),
        })
        .collect();
    let held_row = rules.held.as_ref().map(|grip| {
        let offset = grip.link_from_body.translation.vector.norm();
        let radius = scene.bodies[grip.body].shape.radius_about_origin() + offset;
        bounds.add(&scene.kinematics, grip.link, radius)
    });
    let moves = |row: &[f64]| row.iter().any(|r| *r > 0.0);
    let movers = Movers {
        links: rows.enumerate().filter(|(_, row)| moves(row)).map(|(l, row)| (l, bounds.pace(row))).collect(),
        pairs: scene
            .self_pairs
            .iter()
            .map(|&(a, b)| (a, b, relative(scene, dofs, (a, &rows[a]), (b, &rows[b]))))
            .filter(|(_, _, row)| moves(row))
            .map(|(a, b, row)| (a, b, bounds.pace(&row)))
            .collect(),
        held: held_row.as_ref().map_or(1.0, |row| bounds.pace(row)),
        beside_held: match (&rules.held, &held_row) {
            (Some(grip), Some(held)) => rows
                .enumerate()
                .filter(|(link, _)| {
                    !scene.links[*link].is_empty() && rules.gripper.binary_search(link).is_err()
                })
                .map(|(link, row)| (link, relative(scene, dofs, (link, row), (grip.link, held))))
                .filter(|(_, row)| moves(row))
                .map(|(link, row)| (link, bounds.pace(&row)))
                .collect(),
            _ => vec![],
        },
    };
    (bounds, movers)
}

/// How far each degree of freedom moves a body on one link seen from the other; one that moves both as one does not.
fn relative(scene: &Scene, dofs: &[DofIdx], a: (LinkIdx, &[f64]), b: (LinkIdx, &[f64])) -> Vec<f64> {
    let model = scene.kinematics.model();
    let above = |link| model.joints_between(model.root(), link).unwrap_or_default();
    let (joints_a, joints_b) = (above(a.0), above(b.0));
    let between = |joints: &[JointIdx], others: &[JointIdx], dof: DofIdx| {
        joints.iter().any(|j| !others.contains(j) && model.driving_dof(*j) == Some(dof))
    };
    let column = |(i, &dof): (usize, &DofIdx)| {
        let of_a = if between(&joints_a, &joints_b, dof) { a.1[i] } else { 0.0 };
        let of_b = if between(&joints_b, &joints_a, dof) { b.1[i] } else { 0.0 };
        of_a + of_b
    };
    dofs.iter().enumerate().map(column).collect()
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
        let scene = self.scene;
        let robot = &scene.world_from_robot;
        let room = scene.against_bodies(robot, &self.poses, &self.movers, &self.rules, self.room)?;
        Ok(scene.against_self(&self.poses, &self.movers, &self.rules, room)?)
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
