//! Following the tool's tree from a configuration to a goal (thesis algorithm 3.14).

use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use super::forward::Forward;
use super::goal_tree::GoalTree;
use super::workspace::Workspace;
use crate::budget::{Budget, Interrupt};
use crate::edge::EdgeChecker;
use crate::space::Space;

/// Parameters of following.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FollowOptions {
    /// Steps after which it ends.
    pub steps: u32,
    /// Configurations sampled for each step that cannot be pulled.
    pub samples: u32,
    /// Largest change of a coordinate in a step, as a fraction of its range.
    pub radius: f64,
    /// A step may make the distance to the tool's next pose this many times as long: more than one (the
    /// thesis has 1.4) gets over small hills, but with the pull that comes first it measured slower.
    pub inflation: f64,
    /// Steps without getting nearer to a pose after which the next pose is tried.
    pub patience: u32,
    /// Poses given up in a row after which following ends.
    pub stalls: u32,
}

impl Default for FollowOptions {
    fn default() -> Self {
        Self { steps: 150, samples: 2, radius: 0.05, inflation: 1.0, patience: 2, stalls: 0 }
    }
}

/// Goes from node `node` along the poses from `pose` to its goal, adding nodes; returns the last one.
///
/// Each step is pulled by the transposed Jacobian where that is free and helps; elsewhere it changes one coordinate at random,
/// because descent by coordinates needs far fewer samples than the whole neighbourhood does. Poses on the way count as
/// reached within `passing`, the goal within `tolerance`.
pub(super) fn follow<W: Workspace + ?Sized, C: EdgeChecker + ?Sized>(
    workspace: &W,
    checker: &mut C,
    forward: &mut Forward<'_, W::Point>,
    goals: &mut GoalTree<W::Point>,
    node: usize,
    pose: usize,
    options: &FollowOptions,
    tolerance: f64,
    passing: f64,
    budget: &Budget<'_>,
    rng: &mut Rng,
) -> Result<usize, Interrupt> {
    let (mut node, mut pose) = (node, pose);
    let radii: Vec<f64> = checker
        .space()
        .axes()
        .iter()
        .map(|axis| options.radius * if axis.wraps { std::f64::consts::TAU } else { axis.upper - axis.lower })
        .collect();
    // The smallest distance to the pose so far, steps since then, and poses given up in a row.
    let (mut least, mut idle, mut stalled) = (f64::INFINITY, 0, 0);
    for _ in 0..options.steps {
        budget.check()?;
        let from = forward.tree.state(node).to_vec();
        let target = goals.point(pose);
        let here = workspace.distance(&workspace.point(&from), target);
        let mut best: Option<Vec<f64>> = None;
        // At a pose there is nothing more to gain from it; on the way, nearby is good enough.
        let near_enough = if goals.parent(pose).is_some() { passing } else { tolerance };
        idle += 1;
        if here < least {
            (least, idle) = (here, 0);
        }
        let reached = here < near_enough;
        if !reached && idle <= options.patience {
            let pulled = shortened(&workspace.pull(&from, target), &radii, &from, checker.space());
            let gain = here - workspace.distance(&workspace.point(&pulled), target);
            if gain > LEAST_GAIN * here && forward.is_free(checker, &from, &pulled) {
                best = Some(pulled);
            }
            let mut nearest = options.inflation * here;
            let samples = if best.is_some() { 0 } else { options.samples };
            for _ in 0..samples {
                let coordinate = rng.below(from.len());
                let mut q = from.clone();
                q[coordinate] += rng.range(-radii[coordinate], radii[coordinate]);
                checker.space().clamp(&mut q);
                let distance = workspace.distance(&workspace.point(&q), target);
                if distance < nearest && forward.is_free(checker, &from, &q) {
                    nearest = distance;
                    best = Some(q);
                }
            }
        }
        if let Some(q) = best {
            node = forward.push(workspace, node, &q);
            continue;
        }
        if reached {
            stalled = 0;
        } else {
            stalled += 1;
            goals.note_dead_end(pose);
        }
        match goals.parent(pose) {
            Some(parent) if stalled <= options.stalls => pose = parent,
            _ => break,
        }
        (least, idle) = (f64::INFINITY, 0);
    }
    Ok(node)
}

/// Less than this part of the distance is no progress.
const LEAST_GAIN: f64 = 0.02;

/// The configuration `pull` away from `from`, or in its direction as far as no coordinate changes by more than its radius.
fn shortened(pull: &[f64], radii: &[f64], from: &[f64], space: &Space) -> Vec<f64> {
    let excess = pull.iter().zip(radii).map(|(d, r)| d.abs() / r).fold(1.0, f64::max);
    let mut q: Vec<f64> = from.iter().zip(pull).map(|(x, d)| x + d / excess).collect();
    space.clamp(&mut q);
    q
}
