//! How far joints can move links, and links against each other: found once for each choice of joints.

use std::sync::{Arc, Mutex, PoisonError};

use robotc_core::{DofIdx, JointIdx, LinkIdx, TypedVec};

use super::{Grip, Scene};
use crate::travel::TravelBounds;

/// Bounds on what motions of some degrees of freedom do, in any configuration: metres for each unit of each of them.
#[derive(Debug)]
pub(super) struct Rows {
    dofs: Vec<DofIdx>,
    /// How far points of each link travel; zeros for links without shape.
    pub(super) links: TypedVec<LinkIdx, Vec<f64>>,
    /// How fast two links come together, for each pair that is compared and that these degrees of freedom move.
    pub(super) pairs: Vec<(LinkIdx, LinkIdx, Vec<f64>)>,
    /// The joints that move each link, with the degree of freedom that drives them.
    above: TypedVec<LinkIdx, Vec<(JointIdx, usize)>>,
    pub(super) bounds: TravelBounds,
}

/// Rows that were asked for before.
#[derive(Debug, Default)]
pub(super) struct KnownRows(Mutex<Vec<Arc<Rows>>>);

impl KnownRows {
    /// The rows of these degrees of freedom of the robot of `scene`.
    pub(super) fn of(&self, scene: &Scene, dofs: &[DofIdx]) -> Arc<Rows> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(rows) = known.iter().find(|rows| rows.dofs == dofs) {
            return rows.clone();
        }
        let rows = Arc::new(Rows::new(scene, dofs));
        known.push(rows.clone());
        rows
    }
}

impl Rows {
    fn new(scene: &Scene, dofs: &[DofIdx]) -> Self {
        let model = scene.kinematics.model();
        let mut bounds = TravelBounds::new(dofs);
        let row = |(link, shape): (LinkIdx, &super::Shape)| match shape.is_empty() {
            true => vec![0.0; dofs.len()],
            false => bounds.add(&scene.kinematics, link, shape.radius_about_origin()),
        };
        let links: TypedVec<LinkIdx, Vec<f64>> = scene.links.enumerate().map(row).collect();
        let driven = |joint: JointIdx| {
            let dof = model.driving_dof(joint)?;
            Some((joint, dofs.iter().position(|own| *own == dof)?))
        };
        let above = |link| {
            let joints = model.joints_between(model.root(), link).unwrap_or_default();
            joints.into_iter().filter_map(driven).collect()
        };
        let above = model.links().indices().map(above).collect();
        let mut rows = Self { dofs: dofs.to_vec(), links, pairs: Vec::new(), above, bounds };
        let pair = |&(a, b): &(LinkIdx, LinkIdx)| {
            let row = rows.relative((a, &rows.links[a]), (b, &rows.links[b]));
            row.iter().any(|r| *r > 0.0).then_some((a, b, row))
        };
        rows.pairs = scene.self_pairs.iter().filter_map(pair).collect();
        rows
    }

    /// How far each degree of freedom moves a body on one link seen from the other; one that moves both as one does not.
    fn relative(&self, a: (LinkIdx, &[f64]), b: (LinkIdx, &[f64])) -> Vec<f64> {
        let (above_a, above_b) = (&self.above[a.0], &self.above[b.0]);
        let mut row = vec![0.0; self.dofs.len()];
        for (own, others, travel) in [(above_a, above_b, a.1), (above_b, above_a, b.1)] {
            let mut counted = vec![false; row.len()];
            for (_, column) in own.iter().filter(|joint| !others.contains(joint)) {
                if !std::mem::replace(&mut counted[*column], true) {
                    row[*column] += travel[*column];
                }
            }
        }
        row
    }

    /// The row of a held body, and those of the links that it moves against, the gripper's left out.
    pub(super) fn of_held(
        &self,
        scene: &Scene,
        grip: &Grip,
        gripper: &[LinkIdx],
        bounds: &mut TravelBounds,
    ) -> (Vec<f64>, Vec<(LinkIdx, Vec<f64>)>) {
        let offset = grip.link_from_body.translation.vector.norm();
        let radius = scene.bodies[grip.body].shape.radius_about_origin() + offset;
        let held = bounds.add(&scene.kinematics, grip.link, radius);
        let shaped = self.links.enumerate().filter(|(link, _)| !scene.links[*link].is_empty());
        let beside =
            shaped.filter(|(link, _)| gripper.binary_search(link).is_err()).filter_map(|(link, row)| {
                let row = self.relative((link, row), (grip.link, &held));
                row.iter().any(|r| *r > 0.0).then_some((link, row))
            });
        let beside = beside.collect();
        (held, beside)
    }
}
