//! A gripper without its arm, beside what it takes.

use robotc_core::ids::{Idx, LinkIdx};
use robotc_core::model::LinkPoses;
use robotc_core::robot::{Gripper, Robot};
use robotc_core::{Configuration, Kinematics, Pose};

use crate::record::{Group, Material, Node, NodeIdx, Recording};

/// The links of a gripper.
pub(super) struct Hand<'a> {
    /// The gripper.
    pub(super) gripper: &'a Gripper,
    kinematics: Kinematics,
    rest: Configuration,
    links: Vec<(LinkIdx, NodeIdx)>,
}

impl<'a> Hand<'a> {
    /// Adds the links of a gripper, by position, to a picture; they move against `beside`, or in the world.
    pub(super) fn add(
        recording: &mut Recording,
        robot: &'a Robot,
        gripper: usize,
        beside: Option<NodeIdx>,
    ) -> Self {
        let gripper = &robot.grippers[gripper];
        let model = &robot.model;
        let rest = Configuration::neutral(model);
        let links = model.subtree(gripper.palm).into_iter().map(|index| {
            let link = &model.links()[index];
            let shown = if link.visuals.is_empty() { &link.collisions } else { &link.visuals };
            let grey = 0.55 + 0.2 * (index.index() % 2) as f32;
            let mut node = Node::new(&link.name, Group::Robot, Pose::identity());
            node.parent = beside;
            for geometry in shown {
                let colour = geometry.colour.unwrap_or([grey, grey, grey + 0.03, 1.0]);
                node.parts.push(recording.part(geometry, Material::painted(colour)));
            }
            (index, recording.add_node(node))
        });
        let links = links.collect();
        Self { gripper, kinematics: Kinematics::new(model.clone()), rest, links }
    }

    /// At this moment the tool is there, and the fingers have these values; `beside_from_tool` is against what the hand was added
    /// beside.
    pub(super) fn stand(
        &self,
        recording: &mut Recording,
        time: f64,
        beside_from_tool: &Pose,
        fingers: &[f64],
    ) {
        let mut q = self.rest.clone();
        q.set(&self.gripper.dofs, fingers);
        let mut root_from_links = LinkPoses::default();
        self.kinematics.link_poses(&q, &mut root_from_links);
        let beside_from_palm = beside_from_tool * self.gripper.palm_from_tool.inverse();
        let beside_from_root = beside_from_palm * root_from_links.root_from(self.gripper.palm).inverse();
        let poses = self.links.iter();
        let frame = poses.map(|&(link, node)| (node, beside_from_root * root_from_links.root_from(link)));
        recording.push_frame(time, frame.collect::<Vec<_>>());
    }
}
