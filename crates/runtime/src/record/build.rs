//! Scenes from robots, objects and plans.

use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::geom::MOST_SHOWN;
use robotc_core::ids::{LinkIdx, TypedVec};
use robotc_core::model::{Geometry, LinkPoses, RobotModel, Shape};
use robotc_core::{Pose, Task};

use super::{Group, LineSet, Material, Node, NodeIdx, Part, Recording, Surface, SurfaceIdx, tessellate};

/// Colours of links that have none of their own, used in turn down the chain.
const LINK_COLOURS: [[f32; 4]; 2] = [[0.90, 0.91, 0.92, 1.0], [0.74, 0.77, 0.81, 1.0]];
/// Colour of links at the end of a chain, such as finger tips.
const TIP_COLOUR: [f32; 4] = [0.25, 0.28, 0.32, 1.0];
/// Colours of objects that have none of their own, used in turn.
const OBJECT_COLOURS: [[f32; 4]; 6] = [
    [0.85, 0.33, 0.24, 1.0],
    [0.13, 0.52, 0.76, 1.0],
    [0.95, 0.70, 0.20, 1.0],
    [0.22, 0.62, 0.45, 1.0],
    [0.55, 0.40, 0.72, 1.0],
    [0.93, 0.52, 0.22, 1.0],
];
/// Colour of obstacles that have none of their own.
const OBSTACLE_COLOUR: [f32; 4] = [0.66, 0.62, 0.57, 1.0];
/// Colours of lines by what they mean.
const PATH_COLOUR: [f32; 4] = [0.10, 0.52, 0.92, 1.0];
const GRASP_COLOUR: [f32; 4] = [0.18, 0.68, 0.42, 0.8];
const TREE_COLOURS: [[f32; 4]; 2] = [[0.95, 0.55, 0.15, 0.55], [0.45, 0.38, 0.85, 0.55]];

/// The nodes of a robot's links.
#[derive(Debug, Clone)]
pub struct RobotNodes {
    nodes: TypedVec<LinkIdx, NodeIdx>,
}

impl RobotNodes {
    /// The node of a link.
    pub fn of(&self, link: LinkIdx) -> NodeIdx {
        self.nodes[link]
    }

    /// Nodes with `world_from_node`, for [`Recording::push_frame`]: the robot stands at `world_from_root`.
    pub fn poses(
        &self,
        world_from_root: &Pose,
        root_from_links: &LinkPoses,
    ) -> impl Iterator<Item = (NodeIdx, Pose)> {
        self.nodes
            .enumerate()
            .map(move |(link, &node)| (node, world_from_root * root_from_links.root_from(link)))
    }
}

impl Recording {
    /// Adds a node for each link of a robot, where `root_from_links` says, standing at `world_from_root`.
    ///
    /// Links without visual elements show their collision elements.
    pub fn add_robot(
        &mut self,
        model: &RobotModel,
        world_from_root: &Pose,
        root_from_links: &LinkPoses,
    ) -> RobotNodes {
        let nodes = model.links().indices().map(|index| {
            let link = &model.links()[index];
            let shown = if link.visuals.is_empty() { &link.collisions } else { &link.visuals };
            let colour = if link.child_joints.is_empty() && link.parent_joint.is_some() {
                TIP_COLOUR
            } else {
                let above = model.joints_between(model.root(), index).map_or(0, |joints| joints.len());
                LINK_COLOURS[above % LINK_COLOURS.len()]
            };
            let world_from_link = world_from_root * root_from_links.root_from(index);
            let mut node = Node::new(&link.name, Group::Robot, world_from_link);
            node.parts =
                shown.iter().map(|g| self.part(g, Material::painted(g.colour.unwrap_or(colour)))).collect();
            self.add_node(node)
        });
        RobotNodes { nodes: nodes.collect() }
    }

    /// Adds an object or obstacle.
    pub fn add_body(
        &mut self,
        name: impl Into<String>,
        group: Group,
        geometry: &[Geometry],
        world_from_body: Pose,
    ) -> NodeIdx {
        let of_group = self.nodes().iter().filter(|n| n.group == group).count();
        let plain = match group {
            Group::Obstacle => OBSTACLE_COLOUR,
            _ => OBJECT_COLOURS[of_group % OBJECT_COLOURS.len()],
        };
        let mut node = Node::new(name, group, world_from_body);
        node.parts = geometry
            .iter()
            .map(|g| {
                let colour = g.colour.unwrap_or(plain);
                let material =
                    if group == Group::Obstacle { Material::matt(colour) } else { Material::painted(colour) };
                self.part(g, material)
            })
            .collect();
        self.add_node(node)
    }

    /// Adds everything a task describes except its robot: nodes of objects, then of obstacles, in the task's order.
    pub fn add_bodies(&mut self, task: &Task) -> (Vec<NodeIdx>, Vec<NodeIdx>) {
        let objects = task
            .objects
            .iter()
            .map(|o| self.add_body(&o.name, Group::Object, &o.geometry, o.world_from_object))
            .collect();
        let obstacles = task
            .obstacles
            .iter()
            .map(|o| self.add_body(&o.name, Group::Obstacle, &o.geometry, o.world_from_obstacle))
            .collect();
        (objects, obstacles)
    }

    /// Adds the path of a tool: times in seconds and points in the world.
    pub fn add_tool_path(
        &mut self,
        name: impl Into<String>,
        path_in_world: impl IntoIterator<Item = (f64, Point3<f64>)>,
    ) -> NodeIdx {
        let lines = LineSet::timed_polyline(path_in_world, PATH_COLOUR, 3.0);
        self.add_node(Node::new(name, Group::Path, Pose::identity()).with_lines(lines))
    }

    /// Adds a search tree of a planner: edges between points in the world, such as tool positions. The first tree and
    /// the second have their own colours.
    pub fn add_tree(
        &mut self,
        name: impl Into<String>,
        edges_in_world: impl IntoIterator<Item = [Point3<f64>; 2]>,
    ) -> NodeIdx {
        let of_group = self.nodes().iter().filter(|n| n.group == Group::Tree).count();
        let mut lines = LineSet::new(TREE_COLOURS[of_group % TREE_COLOURS.len()], 1.2);
        for [from, to] in edges_in_world {
            lines.add_segment(&from, &to);
        }
        self.add_node(Node::new(name, Group::Tree, Pose::identity()).with_lines(lines))
    }

    /// Adds grasps of an object as forks that move with it; `opening` and `depth` as in [`LineSet::forks`].
    pub fn add_grasps<'a>(
        &mut self,
        name: impl Into<String>,
        object: NodeIdx,
        object_from_tool: impl IntoIterator<Item = &'a Pose>,
        opening: f64,
        depth: f64,
    ) -> NodeIdx {
        let forks = LineSet::forks(object_from_tool, opening, depth, GRASP_COLOUR);
        self.add_node(Node::new(name, Group::Grasp, Pose::identity()).child_of(object).with_lines(forks))
    }

    /// Adds coordinate axes of a length in metres; `parent_from_frame`, in the world when there is no parent.
    pub fn add_frame(
        &mut self,
        name: impl Into<String>,
        parent: Option<NodeIdx>,
        parent_from_frame: Pose,
        length: f64,
    ) -> NodeIdx {
        let mut node = Node::new(name, Group::Frame, parent_from_frame).with_lines(LineSet::axes(length));
        node.parent = parent;
        self.add_node(node)
    }

    /// A part that shows a visual or collision element.
    pub fn part(&mut self, geometry: &Geometry, material: Material) -> Part {
        let surface = match &geometry.shape {
            Shape::Mesh { mesh, .. } => self.surface_of(mesh),
            Shape::Box { size } => self.add_surface(tessellate::cuboid(*size)),
            Shape::Cylinder { radius, length } => self.add_surface(tessellate::cylinder(*radius, *length)),
            Shape::Capsule { radius, length } => self.add_surface(tessellate::capsule(*radius, *length)),
            Shape::Sphere { radius } => self.add_surface(tessellate::sphere(*radius)),
            Shape::Cloud { cloud, .. } => self.add_surface(Surface::smoothed(&cloud.mesh(MOST_SHOWN))),
            Shape::HeightField { field, .. } => self.add_surface(Surface::smoothed(&field.mesh(MOST_SHOWN))),
        };
        Part { surface, material, node_from_part: geometry.origin.pose() }
    }

    fn surface_of(&mut self, mesh: &Arc<robotc_core::model::TriMesh>) -> SurfaceIdx {
        if let Some((_, known)) = self.made_from.iter().find(|(made_from, _)| Arc::ptr_eq(made_from, mesh)) {
            return *known;
        }
        let surface = self.add_surface(Surface::smoothed(mesh));
        self.made_from.push((mesh.clone(), surface));
        surface
    }
}
