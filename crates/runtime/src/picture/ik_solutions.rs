//! All inverse-kinematics solutions of one pose, side by side.

use nalgebra::{Point3, Unit, UnitQuaternion, Vector3};
use robotc_core::ids::LinkIdx;
use robotc_core::model::{ChainJoint, ChainMotion, Geometry, LinkPoses, Origin, SerialChain, Shape};
use robotc_core::{Configuration, DofIdx, Kinematics, Pose};

use crate::record::{Group, LineSet, Material, Node, Recording};

/// Room between arms, as a share of the extent of the widest.
const ROOM: f64 = 1.15;
/// Radius of a joint without shape, as a share of the arm's length; its length is twice as much.
const JOINT: f64 = 0.035;
/// Length of the axes of the wanted pose, as a share of the arm's length.
const AXES: f64 = 0.15;
const BONE_COLOUR: [f32; 4] = [0.74, 0.77, 0.81, 1.0];
const JOINT_COLOUR: [f32; 4] = [0.25, 0.28, 0.32, 1.0];
/// Of arms that are beyond a joint limit.
const BEYOND_COLOUR: [f32; 4] = [0.85, 0.33, 0.24, 1.0];

/// What is drawn.
#[derive(Debug, Clone, Copy)]
pub struct IkPicture<'a> {
    /// The whole robot; joints that are not of the chain are drawn at zero.
    pub kinematics: &'a Kinematics,
    /// The chain from `base`.
    pub chain: &'a SerialChain,
    /// Link where the chain starts.
    pub base: LinkIdx,
    /// The pose that was solved.
    pub base_from_tip: Pose,
    /// The solutions: values of the chain's variables, as a solver gives them.
    pub solutions: &'a [Vec<f64>],
}

impl IkPicture<'_> {
    /// A scene with an arm for each solution, in rows, each with the axes of the wanted pose; a table of all joint values in degrees and
    /// metres. What lies beyond a joint limit is said there, and is red if it is drawn as a skeleton: that is what an arm whose
    /// description has no shapes is drawn as.
    pub fn draw(&self) -> Recording {
        let count = self.solutions.len();
        let mut recording = Recording::new(format!("{}: {count} solutions of a pose", self.chain.name));
        let columns = (1..=count).find(|n| n * n >= count).unwrap_or(1);
        let step = ROOM * self.extent();
        for (i, values) in self.solutions.iter().enumerate() {
            let (row, column) = (i / columns, i % columns);
            let world_from_base = Pose::translation(-step * row as f64, -step * column as f64, 0.0);
            self.add_arm(&mut recording, &world_from_base, values);
            let beyond = self.beyond(values);
            let marked = if beyond.is_empty() { "" } else { ", beyond limits" };
            let above =
                Point3::from(self.base_from_tip.translation.vector + Vector3::z() * AXES * self.length());
            recording.add_label(format!("{}{marked}", i + 1), None, world_from_base * above);
            recording.add_fact(format!("solution {}", i + 1), self.row(values, &beyond));
            let frame = world_from_base * self.base_from_tip;
            // With the robot, so that it is shown at first.
            let axes = LineSet::axes(AXES * self.length());
            recording.add_node(Node::new(format!("pose of {}", i + 1), Group::Path, frame).with_lines(axes));
        }
        recording
    }

    /// Joint values, degrees and metres, and which joints are beyond their limits.
    fn row(&self, values: &[f64], beyond: &[&str]) -> String {
        let shown = self.chain.variables.iter().enumerate().map(|(v, _)| {
            let slides =
                self.chain.joints.iter().any(|j| j.variable == v && j.motion == ChainMotion::Prismatic);
            if slides { format!("{:.3} m", values[v]) } else { format!("{:.1}", values[v].to_degrees()) }
        });
        let mut row = shown.collect::<Vec<_>>().join(", ");
        if !beyond.is_empty() {
            row += &format!("; beyond limits: {}", beyond.join(", "));
        }
        row
    }

    /// Variables that no alias within a turn brings into their limits.
    fn beyond(&self, values: &[f64]) -> Vec<&str> {
        use std::f64::consts::TAU;
        let slides = |v: usize| {
            self.chain.joints.iter().any(|j| j.variable == v && j.motion == ChainMotion::Prismatic)
        };
        let variables = self.chain.variables.iter().zip(values).enumerate();
        let inside = |v: usize, x: f64, low: f64, high: f64| {
            let turns: &[f64] = if slides(v) { &[0.0] } else { &[0.0, -TAU, TAU] };
            turns.iter().any(|turn| x + turn >= low - 1e-9 && x + turn <= high + 1e-9)
        };
        let outside = variables.filter(|(v, (variable, x))| !inside(*v, **x, variable.lower, variable.upper));
        outside.map(|(_, (variable, _))| variable.name.as_str()).collect()
    }

    fn add_arm(&self, recording: &mut Recording, world_from_base: &Pose, values: &[f64]) {
        let model = self.kinematics.model();
        let dofs: Vec<DofIdx> = self.chain.variables.iter().map(|v| v.dof).collect();
        let mut q = Configuration::neutral(model);
        q.set(&dofs, values);
        let mut root_from_links = LinkPoses::default();
        self.kinematics.link_poses(&q, &mut root_from_links);
        let world_from_root = world_from_base * root_from_links.root_from(self.base).inverse();
        if model.links().iter().any(|link| !link.visuals.is_empty() || !link.collisions.is_empty()) {
            recording.add_robot(model, &world_from_root, &root_from_links);
        } else {
            self.add_skeleton(recording, world_from_base, values);
        }
    }

    /// A drum for each joint, lines between them.
    fn add_skeleton(&self, recording: &mut Recording, world_from_base: &Pose, values: &[f64]) {
        let joints = self.joints(values);
        let (bone, drum) = match self.beyond(values)[..] {
            [] => (BONE_COLOUR, JOINT_COLOUR),
            _ => (BEYOND_COLOUR, BEYOND_COLOUR),
        };
        let radius = JOINT * self.length();
        let tip = Point3::from(self.base_from_tip.translation.vector);
        let points: Vec<Point3<f64>> =
            std::iter::once(Point3::origin()).chain(joints.iter().map(|(at, _)| *at)).chain([tip]).collect();
        let mut node = Node::new("arm", Group::Robot, *world_from_base);
        let mut add = |shape: Shape, colour: [f32; 4], at: Point3<f64>, along: Vector3<f64>| {
            let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along)
                .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
            let origin = Origin { xyz: [0.0; 3], rpy: [0.0; 3] };
            let geometry = Geometry { origin, shape, colour: None };
            let mut part = recording.part(&geometry, Material::painted(colour));
            part.node_from_part = Pose::from_parts(at.into(), turn);
            node.parts.push(part);
        };
        for pair in points.windows(2) {
            let along = pair[1] - pair[0];
            if along.norm() > 1e-6 {
                let shape = Shape::Capsule { radius: 0.45 * radius, length: along.norm() };
                add(shape, bone, nalgebra::center(&pair[0], &pair[1]), along);
            }
        }
        for (at, axis) in &joints {
            let shape = Shape::Cylinder { radius, length: 2.0 * radius };
            add(shape, drum, *at, axis.into_inner());
        }
        recording.add_node(node);
    }

    /// Where each joint is, and its axis, in the frame of the base.
    fn joints(&self, values: &[f64]) -> Vec<(Point3<f64>, Unit<Vector3<f64>>)> {
        let place = |(i, joint): (usize, &ChainJoint)| {
            // The chain up to the joint.
            let before = SerialChain {
                joints: self.chain.joints[..i].to_vec(),
                last_from_tip: joint.previous_from_joint,
                ..self.chain.clone()
            };
            let base_from_joint = before.forward(values);
            (Point3::from(base_from_joint.translation.vector), base_from_joint.rotation * joint.axis)
        };
        self.chain.joints.iter().enumerate().map(place).collect()
    }

    /// Length of the stretched arm, nearly.
    fn length(&self) -> f64 {
        let steps = self.chain.joints.iter().map(|j| j.previous_from_joint.translation.vector.norm());
        (steps.sum::<f64>() + self.chain.last_from_tip.translation.vector.norm()).max(1e-3)
    }

    /// Extent of the widest arm, seen from above.
    fn extent(&self) -> f64 {
        let tip = Point3::from(self.base_from_tip.translation.vector);
        let points = self.solutions.iter().flat_map(|values| self.joints(values)).map(|(at, _)| at);
        let points: Vec<Point3<f64>> = points.chain([Point3::origin(), tip]).collect();
        let side = |k: usize| {
            let of = points.iter().map(|p| p[k]);
            of.clone().fold(f64::MIN, f64::max) - of.fold(f64::MAX, f64::min)
        };
        side(0).max(side(1)).max(0.3 * self.length())
    }
}

#[cfg(test)]
mod tests {
    use robotc_core::Sources;
    use robotc_core::urdf::{self, LoadOptions};

    use super::*;

    const ARM: &str = r#"<robot name="arm"><link name="base"/><link name="upper"/><link name="tip"/>
        <joint name="a" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
        <joint name="b" type="revolute"><parent link="upper"/><child link="tip"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/>
        <limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"#;

    #[test]
    fn every_solution_has_its_place_and_its_row() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("arm.urdf");
        std::fs::write(&file, ARM).unwrap();
        let (model, _) =
            urdf::load(&robotc_kb::os::OsSystem, &mut Sources::new(), &file, &LoadOptions::default());
        let kinematics = Kinematics::new(model.unwrap().into());
        let (base, tip) = (kinematics.model().root(), kinematics.model().link_named("tip").unwrap());
        let chain = SerialChain::between(&kinematics, base, tip).unwrap();
        let solutions = [vec![0.5, 1.0], vec![2.0, 0.3], vec![-0.5, -4.0]];
        let base_from_tip = chain.forward(&solutions[0]);
        let picture =
            IkPicture { kinematics: &kinematics, chain: &chain, base, base_from_tip, solutions: &solutions };
        let recording = picture.draw();
        let rows: Vec<&str> = recording.facts.iter().map(|f| f.value.as_str()).collect();
        assert_eq!(rows, ["28.6, 57.3", "114.6, 17.2; beyond limits: a", "-28.6, -229.2"]);
        let arms: Vec<_> = recording.nodes().iter().filter(|n| n.group == Group::Robot).collect();
        let places = arms.iter().map(|n| n.track.at(0.0).translation.vector).collect::<Vec<_>>();
        assert!(places.iter().enumerate().all(|(i, p)| places[..i].iter().all(|o| (p - o).norm() > 0.5)));
        assert_eq!(places.len(), 3);
    }
}
