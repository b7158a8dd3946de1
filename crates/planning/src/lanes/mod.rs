//! Collision checks of many configurations at once.
//!
//! A robot is read at run time into frames and trees of spheres ([`LaneRobot`]); forward kinematics and tests run over 16, 8
//! or 4 lanes of single precision, as many as the processor has ([`Width`]). Spheres that contain the robot prove that a
//! motion is free, spheres inside of it that it is not; only what lies between is asked of the convex parts themselves.
//! What rounding may do is bounded and added to the spheres.
//!
//! That the samples of a motion belong in the lanes is the idea of Thomason, Kingston and Kavraki, "Motions in microseconds
//! via vectorized sampling-based planning" (2024); here each lane also knows how far the robot can move until the next one.

mod apart;
mod checker;
mod frames;
mod glance;
mod kernel;
mod lane;
mod mechanism;
mod obstacle;
mod pile;
mod settle;
mod states;
mod suspects;
#[cfg(test)]
mod tests;
mod wheels;
mod width;

pub use checker::{LaneChecker, LaneMemory, LaneStatistics};
pub use mechanism::LaneRobot;
pub use states::Sight;
pub use width::Width;
