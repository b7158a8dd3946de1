//! A task with everything that was compiled for it, ready to be planned and run.

use std::sync::{Arc, OnceLock};

use crate::own_points::without_own_points;
use robotc_core::geom::{DecomposeOptions, HullError, parts_of};
use robotc_core::task::{Obstacle, Task};
use robotc_core::world::Body;
use robotc_core::{Configuration, Kinematics, LinkIdx, LinkPoses, SerialChain, TypedVec, World};
use robotc_ikgen::Solver;
use robotc_kb::kinds::{
    Cage, CagingSet, ConvexParts, IkSolver, LinkStatistics, Reachability, ReachabilityMap,
    SelfCollisionPairs, SphereCover, ranked_grasps,
};
use robotc_kb::project::{OfArm, OfGripperAndArticle, OfGripperAndObject, OfRobot, OfShape};
use robotc_kb::{Knowledge, LoadError};
use robotc_planning::grasp::GraspSet;
use robotc_planning::manipulation::{
    Manipulation, ManipulationOptions, Measures, Observer, Plan, PlanFailure, Uncertified, certify,
    gripper_links, pick_and_place,
};
use robotc_planning::scene::Scene;
use robotc_planning::{ArmError, ArmModel, Budget, LaneRobot};
use thiserror::Error;

/// Why a task cannot be worked on.
#[derive(Debug, Error)]
pub enum SessionError {
    /// The knowledge base is about a robot alone.
    #[error("the knowledge base was compiled for a robot; a session needs a task")]
    NoTask,
    /// An artefact is missing or damaged.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The inverse-kinematics program does not fit the arm.
    #[error("the inverse kinematics of arm {arm} cannot be used: {error}")]
    Solver {
        /// The arm.
        arm: String,
        /// What is wrong.
        error: robotc_ikgen::run::LoadError,
    },
    /// The arm cannot be modelled.
    #[error(transparent)]
    Arm(#[from] ArmError),
}

/// Why there is no plan that holds.
#[derive(Debug, Error)]
pub enum NoPlan {
    /// The planner found none.
    #[error(transparent)]
    Failed(#[from] PlanFailure),
    /// None of the plans that it found passed the certificate; this is what was wrong with the last.
    #[error("the plan does not hold: {0}")]
    Uncertified(#[from] Uncertified),
}

/// Why something cannot be put into a session.
#[derive(Debug, Error)]
pub enum SeenError {
    /// What has this name is no plain obstacle.
    #[error("\"{0}\" is an object or an article of the task")]
    Taken(String),
    /// It has no convex parts.
    #[error(transparent)]
    Parts(#[from] HullError),
}

/// Plans made before giving up on one that holds.
const ATTEMPTS: u64 = 4;

/// What the links of the robot are made of, for collision checks in lanes.
pub(crate) struct LinkShapes {
    /// Convex parts in the frame of each link.
    pub(crate) parts: TypedVec<LinkIdx, Arc<robotc_core::geom::ConvexParts>>,
    /// Balls that cover them.
    pub(crate) covers: TypedVec<LinkIdx, Arc<robotc_core::geom::SphereCover>>,
    /// Pairs of links that are compared.
    pub(crate) pairs: Vec<(LinkIdx, LinkIdx)>,
    /// The robot as the task starts, for the joints of the arm; made when it is asked for first.
    pub(crate) at_start: OnceLock<Arc<LaneRobot>>,
}

/// A task with its artefacts. Nothing is computed that could have been compiled.
pub struct Session {
    task: Arc<Task>,
    kinematics: Kinematics,
    arm: ArmModel,
    scene: Scene,
    links: LinkShapes,
    object_covers: Vec<Arc<robotc_core::geom::SphereCover>>,
    grasps: Vec<GraspSet>,
    cages: Vec<Arc<Vec<Cage>>>,
    reachability: Option<Arc<ReachabilityMap>>,
}

impl Session {
    /// Loads everything that the task of this knowledge base needs.
    pub fn open(knowledge: &Knowledge) -> Result<Self, SessionError> {
        let project = knowledge.graph().project();
        let task = project.task().ok_or(SessionError::NoTask)?.clone();
        let robot = task.robot.clone();
        let kinematics = Kinematics::new(robot.model.clone());

        let mut links: TypedVec<LinkIdx, Arc<_>> =
            robot.model.links().iter().map(|_| Arc::default()).collect();
        let mut covers: TypedVec<LinkIdx, Arc<_>> =
            robot.model.links().iter().map(|_| Arc::default()).collect();
        for link in robot.model.links().indices() {
            if !robot.model.links()[link].collisions.is_empty() {
                links[link] = knowledge.load::<ConvexParts>(&OfShape::Link(link))?;
                covers[link] = knowledge.load::<SphereCover>(&OfShape::Link(link))?;
            }
        }
        let task = without_own_points(&task, &kinematics, &links);
        let objects = (0..task.objects.len()).map(OfShape::Object);
        let covers_of_objects = objects.clone().map(|object| knowledge.load::<SphereCover>(&object));
        let object_covers = covers_of_objects.collect::<Result<_, _>>()?;
        // In the order of the world's bodies.
        let shapes = objects.chain((0..task.obstacles.len()).map(OfShape::Obstacle));
        let bodies = shapes.map(|shape| knowledge.load::<ConvexParts>(&shape)).collect::<Result<_, _>>()?;
        let pairs: Vec<(LinkIdx, LinkIdx)> =
            knowledge.load::<SelfCollisionPairs>(&OfRobot)?.tested().collect();
        let scene = Scene::new(&World::of_task(&task, kinematics.clone()), &links, &bodies, pairs.clone());
        let links = LinkShapes { parts: links, covers, pairs, at_start: OnceLock::new() };

        let arm = load_arm(knowledge, &task, &kinematics)?;
        let reachability = match knowledge.load::<Reachability>(&OfArm(task.arm)) {
            Ok(map) => Some(map),
            // Arms whose first joint slides have no map.
            Err(LoadError::NotPlanned { .. }) => None,
            Err(error) => return Err(error.into()),
        };
        let mut grasps = Vec::new();
        for (i, object) in task.objects.iter().enumerate() {
            let set = match robot.arms[task.arm].gripper {
                Some(gripper) => {
                    let known = ranked_grasps(knowledge, &OfGripperAndObject { gripper, object: i })?;
                    GraspSet::new(&robot.grippers[gripper].name, &object.name, known)
                }
                None => GraspSet::default(),
            };
            grasps.push(set);
        }
        let mut cages = Vec::new();
        for article in 0..task.articles.len() {
            cages.push(match robot.arms[task.arm].gripper {
                Some(gripper) => knowledge.load::<CagingSet>(&OfGripperAndArticle { gripper, article })?,
                None => Arc::default(),
            });
        }
        Ok(Self { task, kinematics, arm, scene, links, object_covers, grasps, cages, reachability })
    }

    /// The same session with one more obstacle, or with another in the place of the one of this name: what a camera sees now. Nothing is
    /// compiled; what is no primitive, cloud or height field is cut into convex parts here.
    pub fn with_obstacle(&self, seen: Obstacle) -> Result<Self, SeenError> {
        let name = seen.name.clone();
        let mut task = Task::clone(&self.task);
        let taken = task.objects.iter().any(|object| object.name == name);
        match task.obstacles.iter().position(|obstacle| obstacle.name == name) {
            // The links of articles move, and are grasped.
            _ if taken || task.articles.iter().any(|a| name.split('/').next() == Some(&a.name)) => {
                return Err(SeenError::Taken(name));
            }
            Some(known) => task.obstacles[known] = seen,
            None => task.obstacles.push(seen),
        }
        let task = without_own_points(&Arc::new(task), &self.kinematics, &self.links.parts);
        let obstacle = task.obstacles.iter().find(|o| o.name == name).expect("it has just been put there");
        let parts = parts_of(&obstacle.geometry, &DecomposeOptions::default())?;
        let body = Body {
            name,
            geometry: obstacle.geometry.clone(),
            world_from_body: obstacle.world_from_obstacle,
            enabled: true,
        };
        let links = LinkShapes {
            parts: self.links.parts.clone(),
            covers: self.links.covers.clone(),
            pairs: self.links.pairs.clone(),
            at_start: self.links.at_start.clone(),
        };
        Ok(Self {
            scene: self.scene.with_body(&body, &parts),
            task,
            kinematics: self.kinematics.clone(),
            arm: self.arm.clone(),
            links,
            object_covers: self.object_covers.clone(),
            grasps: self.grasps.clone(),
            cages: self.cages.clone(),
            reachability: self.reachability.clone(),
        })
    }

    /// What shall happen.
    pub fn task(&self) -> &Arc<Task> {
        &self.task
    }

    /// The robot's model and calibration.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// The arm that does the task.
    pub fn arm(&self) -> &ArmModel {
        &self.arm
    }

    /// Robot and bodies at the start: objects of the task in order, then obstacles.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Shapes of the links, as the lane checker wants them.
    pub(crate) fn link_shapes(&self) -> &LinkShapes {
        &self.links
    }

    /// Balls that cover each object of the task, for what is held.
    pub(crate) fn object_covers(&self) -> &[Arc<robotc_core::geom::SphereCover>] {
        &self.object_covers
    }

    /// The grasp set of each object of the task, best first. The planner tries them in an order of its own, which also
    /// asks how well the arm reaches them.
    pub fn grasps(&self) -> &[GraspSet] {
        &self.grasps
    }

    /// The loose grips of each article of the task.
    pub fn cages(&self) -> impl Iterator<Item = &[Cage]> {
        self.cages.iter().map(|cages| cages.as_slice())
    }

    /// The reachability map of the arm, if it has one.
    pub fn reachability(&self) -> Option<&ReachabilityMap> {
        self.reachability.as_deref()
    }

    /// The world at the start: objects of the task in order, then obstacles.
    pub fn world(&self) -> World {
        World::of_task(&self.task, self.kinematics.clone())
    }

    /// The default options for this robot: lengths follow from the measures of its arm and hand.
    pub fn options(&self) -> ManipulationOptions {
        let gripper = self.task.robot.arms[self.task.arm].gripper;
        let links = gripper.map_or_else(Vec::new, |g| gripper_links(&self.task.robot, g));
        ManipulationOptions::new(&Measures::of(&self.arm, &self.scene, &self.task.start, &links))
    }

    /// Plans the task and certifies the plan. A plan that does not hold is thrown away and made again from the next
    /// stream of `seed`, a few times at most. The result depends on options and seed alone unless the budget ends it.
    pub fn plan(
        &self,
        options: &ManipulationOptions,
        budget: &Budget<'_>,
        seed: robotc_core::Seed,
        observer: &mut dyn Observer,
    ) -> Result<Plan, NoPlan> {
        let grasps: Vec<&GraspSet> = self.grasps.iter().collect();
        let cages: Vec<&[Cage]> = self.cages().collect();
        let problem = self.problem(&grasps, &cages);
        let mut attempt = 0;
        loop {
            let plan = pick_and_place(&problem, options, budget, seed.at(attempt), observer)?;
            attempt += 1;
            match certify(&problem, options, &plan) {
                Ok(_) => return Ok(plan),
                Err(wrong) if attempt == ATTEMPTS => return Err(wrong.into()),
                Err(_) => {}
            }
        }
    }

    /// Replays a plan densely and checks everything about it: no point of the robot travels more than
    /// [`ManipulationOptions::certified_step`] between two looks. Gives the number of states looked at.
    pub fn certify(&self, options: &ManipulationOptions, plan: &Plan) -> Result<u64, Uncertified> {
        let grasps: Vec<&GraspSet> = self.grasps.iter().collect();
        let cages: Vec<&[Cage]> = self.cages().collect();
        certify(&self.problem(&grasps, &cages), options, plan)
    }

    /// What the planners of the library are given.
    pub fn with_problem<R>(&self, work: impl FnOnce(&Manipulation<'_>) -> R) -> R {
        let grasps: Vec<&GraspSet> = self.grasps.iter().collect();
        let cages: Vec<&[Cage]> = self.cages().collect();
        work(&self.problem(&grasps, &cages))
    }

    fn problem<'a>(&'a self, grasps: &'a [&'a GraspSet], cages: &'a [&'a [Cage]]) -> Manipulation<'a> {
        Manipulation {
            task: &self.task,
            kinematics: &self.kinematics,
            arm: &self.arm,
            scene: &self.scene,
            grasps,
            cages,
            reachability: self.reachability.as_deref().map(|map| map as &dyn robotc_planning::Reachability),
            start: &self.task.start,
        }
    }

    /// Poses of all links in the frame of the robot's root.
    pub fn link_poses(&self, q: &Configuration) -> LinkPoses {
        let mut poses = LinkPoses::default();
        self.kinematics.link_poses(q, &mut poses);
        poses
    }
}

fn load_arm(knowledge: &Knowledge, task: &Task, kinematics: &Kinematics) -> Result<ArmModel, SessionError> {
    let robot = &task.robot;
    let arm = &robot.arms[task.arm];
    let chain = SerialChain::between(kinematics, arm.base, arm.tip).map_err(ArmError::from)?;
    let program = knowledge.load::<IkSolver>(&OfArm(task.arm))?;
    let solver = Solver::new((*program).clone(), &chain)
        .map_err(|error| SessionError::Solver { arm: arm.name.clone(), error })?;
    let statistics = knowledge.load::<LinkStatistics>(&OfRobot)?;
    let by_hand = |dof| robot.weights.iter().find(|(d, _)| *d == dof).map(|(_, weight)| *weight);
    let weights: Vec<f64> = chain
        .variables
        .iter()
        .map(|v| by_hand(v.dof).unwrap_or(statistics[robotc_core::ids::Idx::index(v.dof)].weight))
        .collect();
    let solver = Arc::new(solver);
    Ok(ArmModel::new(robot, kinematics, task.arm, solver, &weights, &task.world_from_robot, &task.start)?)
}
