//! A robot as the benchmark sees it, and the stage of one problem.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use robotc_core::geom::{
    ConvexPart, ConvexParts, CoverOptions, DecomposeOptions, HullError, SphereCover, parts_of_shape,
};
use robotc_core::ids::Idx;
use robotc_core::model::{Geometry, Shape};
use robotc_core::srdf::Srdf;
use robotc_core::{BodyIdx, Configuration, DofIdx, Kinematics, LinkIdx, Pose, RobotModel, TypedVec, World};
use thiserror::Error;

use super::problems::Problem;
use crate::lanes::LaneRobot;
use crate::scene::Scene;
use crate::space::{Axis, Space};

/// Why a robot and problems do not go together.
#[derive(Debug, Error)]
pub enum BenchError {
    /// A joint of the problems is none of the robot.
    #[error("the robot has no driven joint {0}")]
    Joint(String),
    /// A link without a convex hull.
    #[error("link {link}: {error}")]
    Hull {
        /// The link.
        link: String,
        /// What is wrong.
        error: HullError,
    },
    /// An obstacle without a convex hull.
    #[error("obstacle {name}: {error}")]
    Obstacle {
        /// The obstacle.
        name: String,
        /// What is wrong.
        error: HullError,
    },
}

/// What is computed once for a robot.
#[derive(Debug, Clone)]
pub struct BenchRobot {
    /// The robot.
    pub kinematics: Kinematics,
    /// What is planned for, in the order of starts and goals.
    pub dofs: Vec<DofIdx>,
    /// The space of `dofs`, every weight 1: lengths of paths are Euclidean, as usual for these problems.
    pub space: Space,
    /// For each link, the convex hulls of its collision elements.
    pub links: TypedVec<LinkIdx, Arc<ConvexParts>>,
    /// For each link, spheres that cover its hulls.
    pub covers: TypedVec<LinkIdx, Arc<SphereCover>>,
    /// Pairs of links that are compared; lower index first, ascending.
    pub self_pairs: Vec<(LinkIdx, LinkIdx)>,
}

/// One problem, ready to be planned: the robot among the obstacles.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Robot and obstacles.
    pub world: World,
    /// Their convex parts.
    pub scene: Scene,
    /// The robot with the joints that are not planned for where they are.
    pub lanes: Arc<LaneRobot>,
}

impl BenchRobot {
    /// A robot whose `joints` are planned for.
    ///
    /// Compared are the links that these joints move against each other, except where the semantic description says that
    /// it is not needed.
    pub fn new(model: Arc<RobotModel>, srdf: &Srdf, joints: &[String]) -> Result<Self, BenchError> {
        let dof = |name: &String| model.dof_named(name).ok_or_else(|| BenchError::Joint(name.clone()));
        let dofs: Vec<DofIdx> = joints.iter().map(dof).collect::<Result<_, _>>()?;
        let axis = |&dof: &DofIdx| match &model.dofs()[dof] {
            d if d.continuous => Axis::wrapping(),
            d => Axis::bounded(d.lower, d.upper),
        };
        let shapes: Vec<(Arc<ConvexParts>, Arc<SphereCover>)> = side_by_side(model.links().len(), |i| {
            let link = &model.links()[LinkIdx::new(i)];
            let parts = hulls(&link.collisions);
            let parts = parts.map_err(|error| BenchError::Hull { link: link.name.clone(), error })?;
            let cover = SphereCover::of(&parts, &CoverOptions::default());
            Ok((Arc::new(parts), Arc::new(cover)))
        })?;
        let links: TypedVec<LinkIdx, _> = shapes.iter().map(|(parts, _)| parts.clone()).collect();
        let covers = shapes.into_iter().map(|(_, cover)| cover).collect();
        let self_pairs = self_pairs(&model, srdf, &dofs, &links);
        let space = Space::new(dofs.iter().map(axis).collect());
        Ok(Self { kinematics: Kinematics::new(model), dofs, space, links, covers, self_pairs })
    }

    /// The robot among the obstacles of a problem. Joints that are not planned for, and that the model has, take the
    /// values of the problem; `lanes` is the robot prepared with these joints there, if it is known.
    pub fn stage(&self, problem: &Problem, lanes: Option<Arc<LaneRobot>>) -> Result<Stage, BenchError> {
        let model = self.kinematics.model();
        let mut q = Configuration::neutral(model);
        for (name, value) in &problem.other_joints {
            if let Some(dof) = model.dof_named(name) {
                q[dof] = *value;
            }
        }
        q.set(&self.dofs, &problem.start);
        let mut world = World::new(self.kinematics.clone(), Pose::identity(), q);
        let mut bodies: TypedVec<BodyIdx, Arc<ConvexParts>> = TypedVec::new();
        for obstacle in &problem.obstacles {
            world.add(&obstacle.name, obstacle.geometry.clone(), obstacle.root_from_obstacle);
            let parts = hulls(&obstacle.geometry);
            let parts = parts.map_err(|error| BenchError::Obstacle { name: obstacle.name.clone(), error })?;
            bodies.push(Arc::new(parts));
        }
        let scene = Scene::new(&world, &self.links, &bodies, self.self_pairs.clone());
        let lanes = lanes.unwrap_or_else(|| {
            let (q, kinematics) = (world.q(), &self.kinematics);
            let lanes =
                LaneRobot::new(kinematics, &self.dofs, q, &self.links, &self.covers, &self.self_pairs);
            lanes.with_tables(kinematics, &self.dofs, &self.links).into()
        });
        Ok(Stage { world, scene, lanes })
    }
}

/// What `of` makes of 0, 1, 2, ... below `count`, in this order, made on all processors; the first error, if any.
fn side_by_side<T: Send, E: Send>(
    count: usize,
    of: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut made = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return made;
            }
            made.push((i, of(i)));
        }
    };
    let workers = std::thread::available_parallelism().map_or(1, |n| n.get()).min(count.max(1));
    let mut made = std::thread::scope(|scope| {
        let others: Vec<_> = (1..workers).map(|_| scope.spawn(work)).collect();
        let mut made = work();
        others.into_iter().for_each(|other| made.extend(other.join().expect("a worker does not panic")));
        made
    });
    made.sort_by_key(|(i, _)| *i);
    made.into_iter().map(|(_, result)| result).collect()
}

/// One convex hull for each element, in the frame of the elements.
fn hulls(elements: &[Geometry]) -> Result<ConvexParts, HullError> {
    let mut all = ConvexParts::default();
    for element in elements {
        let parts = match &element.shape {
            Shape::Mesh { mesh, .. } => ConvexParts::new(vec![ConvexPart::hull_of(&mesh.vertices)?]),
            primitive => parts_of_shape(primitive, &DecomposeOptions::default())?,
        };
        all.extend(parts.transformed(&element.origin.pose()));
    }
    Ok(all)
}

fn self_pairs(
    model: &RobotModel,
    srdf: &Srdf,
    dofs: &[DofIdx],
    links: &TypedVec<LinkIdx, Arc<ConvexParts>>,
) -> Vec<(LinkIdx, LinkIdx)> {
    let moving = |link: LinkIdx| -> Vec<DofIdx> {
        model.dofs_moving(link).into_iter().filter(|dof| dofs.contains(dof)).collect()
    };
    let disabled = |a: LinkIdx, b: LinkIdx| {
        let (a, b) = (&model.links()[a].name, &model.links()[b].name);
        srdf.disabled_pairs.iter().any(|pair| {
            let (first, second) = (&pair.first.text, &pair.second.text);
            (first == a && second == b) || (first == b && second == a)
        })
    };
    let mut pairs = Vec::new();
    for b in links.indices() {
        for a in links.indices().take_while(|a| *a < b) {
            let both = !links[a].is_empty() && !links[b].is_empty();
            if both && moving(a) != moving(b) && !disabled(a, b) {
                pairs.push((a, b));
            }
        }
    }
    pairs.sort_unstable();
    pairs
}
