//! Motion, grasp and manipulation planners.
//!
//! Planners work on a [`Space`] and an [`EdgeChecker`] and never see a robot.

pub mod arm;
pub mod bench;
pub mod beside;
pub mod bispace;
pub mod budget;
pub mod caging;
pub mod cartesian;
pub mod certify;
pub mod constraint;
pub mod edge;
pub mod explore;
pub mod goal;
pub mod grasp;
pub mod jitter;
pub mod lanes;
pub mod manipulation;
pub mod mechanism;
pub mod motion;
pub mod placement;
pub mod pose_goals;
pub mod problem;
#[cfg(test)]
mod properties;
pub mod reachability;
pub mod rrt;
pub mod scene;
pub mod smooth;
pub mod space;
pub mod subspace;
#[cfg(test)]
mod testbed;
pub mod timing;
#[cfg(test)]
mod toy;
pub mod travel;
mod tree;

pub use arm::{ArmError, ArmModel};
pub use beside::{Beside, Difference};
pub use budget::{Budget, Interrupt};
pub use cartesian::{LineFailure, LineObstacle, LineOptions, cartesian_line};
pub use certify::{Unproven, certify_path};
pub use constraint::{Constraint, HeldMechanism, RegionError, RegionTolerance, TaskRegion, Upright};
pub use edge::{Blocked, EdgeChecker, Obstruction, Patience};
pub use explore::{ExploreFailure, ExploreOptions, ExploreSolution, FixedMotion, explore, make_way};
pub use goal::{FixedGoals, GoalDraw, GoalSampler};
pub use grasp::{Contact, Grasp, GraspSet, Steadiness};
pub use jitter::{JitterFailure, JitterOptions, Jittered, jitter};
pub use lanes::{LaneChecker, LaneMemory, LaneRobot};
pub use mechanism::{Mechanism, MechanismMotion};
pub use motion::{MotionFailure, MotionOptions, MotionPlan, plan_motion};
pub use problem::{PathPlanner, PlanningProblem, Registry, solve};
pub use reachability::Reachability;
pub use rrt::{Gap, RrtConnect, RrtFailure, RrtOptions, RrtSolution};
pub use smooth::{Smoother, smooth};
pub use space::{Axis, Space};
pub use subspace::Subspace;
pub use timing::{MotionLimits, TimeLaw, TimedPath, TimingOptions, point_to_point, time_path};
pub use travel::TravelBounds;
