//! A robot as rigid bodies between moving joints, and what their names hint at.

use crate::ids::{Idx, JointIdx, LinkIdx};
use crate::model::{JointMotion, RobotModel};

/// Words in names of links and joints that belong to a gripper.
pub(super) const HAND: &[&str] =
    &["finger", "gripper", "jaw", "claw", "thumb", "knuckle", "grip", "pinch", "digit"];

/// Words in names of fingers.
pub(super) const FINGER: &[&str] = &["finger", "jaw", "claw", "thumb", "knuckle", "digit"];

/// Words in names of parts that are neither arm nor hand.
pub(super) const NEITHER: &[&str] = &[
    "head", "neck", "eye", "leg", "foot", "feet", "ankle", "knee", "hip", "toe", "wheel", "caster", "camera",
    "laser", "tilt", "lidar", "bellows",
];

/// Words in names of wheels.
pub(super) const WHEEL: &[&str] = &["wheel", "caster"];

/// Links that move as one, below one moving joint.
#[derive(Debug, Clone)]
pub(super) struct Body {
    /// Its links; the first is the one that the joint moves, parents come before children.
    pub(super) links: Vec<LinkIdx>,
    /// The moving joint above; `None` for the root body.
    pub(super) joint: Option<JointIdx>,
    /// The body above.
    pub(super) parent: Option<usize>,
    /// The bodies below.
    pub(super) children: Vec<usize>,
    /// Length of the way along joint origins from the root to its joint; metres.
    way: f64,
}

/// All bodies of a robot, parents before children; the root is the first.
#[derive(Debug, Clone)]
pub(super) struct Bodies<'a> {
    pub(super) model: &'a RobotModel,
    pub(super) all: Vec<Body>,
}

impl<'a> Bodies<'a> {
    pub(super) fn of(model: &'a RobotModel) -> Self {
        let root =
            Body { links: vec![model.root()], joint: None, parent: None, children: Vec::new(), way: 0.0 };
        let mut all = vec![root];
        let mut of_link = vec![0; model.links().len()];
        let mut way_to_link = vec![0.0; model.links().len()];
        for &index in model.topological_order() {
            let joint = &model.joints()[index];
            let above = of_link[joint.parent.index()];
            let way = way_to_link[joint.parent.index()] + joint.parent_from_joint().translation.vector.norm();
            way_to_link[joint.child.index()] = way;
            if joint.motion == JointMotion::Fixed {
                of_link[joint.child.index()] = above;
                all[above].links.push(joint.child);
            } else {
                let body = all.len();
                of_link[joint.child.index()] = body;
                all[above].children.push(body);
                all.push(Body {
                    links: vec![joint.child],
                    joint: Some(index),
                    parent: Some(above),
                    children: Vec::new(),
                    way,
                });
            }
        }
        Self { model, all }
    }

    /// Bodies from just below `top` down to `body`; from the root's children when `top` is not above `body`.
    pub(super) fn path(&self, top: usize, body: usize) -> Vec<usize> {
        let mut path = Vec::new();
        let mut at = body;
        while at != top {
            let Some(parent) = self.all[at].parent else { break };
            path.push(at);
            at = parent;
        }
        path.reverse();
        path
    }

    /// `body` and all below it, parents first.
    pub(super) fn subtree(&self, body: usize) -> Vec<usize> {
        let mut found = vec![body];
        let mut next = 0;
        while next < found.len() {
            found.extend(&self.all[found[next]].children);
            next += 1;
        }
        found
    }

    /// Most driven joints one below the other under `body`.
    pub(super) fn depth(&self, body: usize) -> usize {
        // Parents come before children, so each body finds the depth of its parent.
        let mut depths = vec![0; self.all.len()];
        let mut deepest = 0;
        for &below in self.subtree(body).iter().skip(1) {
            let above = self.all[below].parent.map_or(0, |parent| depths[parent]);
            depths[below] = above + usize::from(self.is_driven(below));
            deepest = deepest.max(depths[below]);
        }
        deepest
    }

    /// Whether the joint above a body has a value of its own.
    pub(super) fn is_driven(&self, body: usize) -> bool {
        let joint = self.all[body].joint;
        joint.is_some_and(|j| matches!(self.model.joints()[j].drive, crate::model::Drive::Dof(_)))
    }

    /// Whether the joint above a body, or the link it moves, has one of these words in its name. Links fixed to that one do
    /// not count: they are sensors and frames of all sorts.
    pub(super) fn mentions(&self, body: usize, words: &[&str]) -> bool {
        let has = |name: &str| {
            let name = name.to_lowercase();
            words.iter().any(|word| name.contains(word))
        };
        let body = &self.all[body];
        body.joint.is_some_and(|j| has(&self.model.joints()[j].name))
            || has(&self.model.links()[body.links[0]].name)
    }

    /// Whether a body has a shape to see or to touch.
    pub(super) fn has_shape(&self, body: usize) -> bool {
        self.all[body].links.iter().any(|&l| {
            let link = &self.model.links()[l];
            !link.visuals.is_empty() || !link.collisions.is_empty()
        })
    }

    /// Length of the way along joint origins from `top` down to `body`; metres.
    pub(super) fn reach(&self, top: usize, body: usize) -> f64 {
        self.all[body].way - self.all[top].way
    }
}
