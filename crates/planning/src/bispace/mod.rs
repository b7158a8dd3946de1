//! Goals of the tool for robots with a base: a tree of configurations that follows a tree of tool poses (BiSpace, thesis
//! section 3.6.3, algorithms 3.13 and 3.14; Diankov, Ratliff, Ferguson, Srinivasa and Kuffner, 2008).
//!
//! One tree grows in the configuration space from the start, and all of its edges are valid. The other grows from the goals
//! in the space of tool poses, where only the tool is checked: it says which way to go. New configurations try to follow it
//! to a goal, and finish with inverse kinematics of the arm where that applies.
//!
//! [`bispace`] is that search; [`rrt_jt`] and [`two_stage`] are what it is compared with: a single tree that is pulled to the
//! goal by the transposed Jacobian (Vande Weghe, Ferguson and Srinivasa, 2007), and RRT-Connect to sampled configurations at
//! the goal.

mod follow;
mod forward;
mod goal_tree;
mod jacobian;
mod metric;
mod mobile_arm;
#[cfg(test)]
mod planar;
mod search;
#[cfg(test)]
mod tests;
mod two_stage;
mod workspace;

pub use follow::FollowOptions;
pub use jacobian::{JacobianOptions, rrt_jt};
pub use metric::{FollowProbability, TreeMetric};
pub use mobile_arm::{MobileArm, ToolCheck};
pub use search::{BiSpaceOptions, bispace};
pub use two_stage::{SampledGoals, TwoStageOptions, two_stage};
pub use workspace::{ToolFailure, ToolFailureReason, ToolSolution, ToolStatistics, Workspace};
