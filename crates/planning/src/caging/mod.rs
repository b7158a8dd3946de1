//! Doors, drawers and levers opened with a loose grip (thesis section 3.4; Diankov, Srinivasa, Ferguson and Kuffner,
//! "Manipulation planning with caging grasps", 2008).
//!
//! A firm grasp of a door leaves the arm no choice: its tool goes where the handle goes. A gripper that only cages the
//! handle may turn and shift around it while the door moves, as long as it stays within the set of caging grasps, and at
//! the end holds it in contact. Planning is quasi-static, and the arm compliant.
//!
//! [`discrete_search`] follows a given order of object steps and is exhaustive; [`randomized_search`] may move the object
//! forth and back and samples redundant arms; [`open_with_sets`] changes between disjoint sets of grasps, such as hooking,
//! pulling and pushing, when one of them gets no farther. All work on an [`ArticulatedTask`]; [`CagedObject`] is the one of
//! an arm.

mod cage;
mod discrete;
mod fixed;
mod object;
mod randomized;
mod restarts;
mod starting;
mod switch;
mod task;
#[cfg(test)]
mod tests;

pub use cage::{Cage, CageHold};
pub use discrete::discrete_search;
pub use fixed::FixedGrasp;
pub use object::{CageGrasp, CagedObject, CagedObjectError, CagedObjectOptions, ObjectStep, WaySearch};
pub use randomized::{CageStart, RandomizedOptions, randomized_search};
pub use restarts::restarted_search;
pub use starting::StartingAt;
pub use switch::{CageStage, CageSwitchFailure, open_with_sets};
pub use task::{
    ArticulatedTask, CagedState, CagingFailure, CagingFailureReason, CagingSolution, CagingStatistics,
};
