//! Pick and place: which grasp, which destination, and the motions in between.
//!
//! A goal sampler walks through the grasps of the object and hands out only those for which every straight motion
//! (approach, lift, lowering, retreat) has been checked on one branch of inverse kinematics; the searches for the free
//! motions in between draw their goals from it (thesis sections 3.1 and 3.2).

mod carrying;
mod certify;
mod destinations;
mod driving;
mod folding;
mod free_motion;
mod maker;
mod opening;
mod options;
mod pick_up;
mod picks;
mod places;
mod placings;
mod plan;
mod problem;
mod put_down;
mod ranking;
mod rejections;
mod sequence;
mod stretch;
#[cfg(test)]
mod tests;
mod usable;

pub use certify::{Uncertified, certify};
pub use destinations::destination_poses;
pub(crate) use opening::article_steps;
pub use options::{ManipulationOptions, Measures};
pub use plan::{
    ArticleMotion, Choice, Event, GoalFailure, Held, Nearest, OpenChoice, PassedOver, PlaceChoice, Plan,
    Segment, SegmentKind, SkippedGoal, Stage, Tried,
};
pub use problem::{Manipulation, gripper_links};
pub(crate) use problem::{finger_space, with_fingers_space};
pub use rejections::{Cause, Filter, Rejections};
pub use sequence::{Observer, PlanFailure, pick_and_place};
pub use usable::{UsableGrasp, UsableGrasps, usable_grasps};
