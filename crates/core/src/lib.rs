//! What every part of `robotc` shares: the robot model and its kinematics, the world, geometry, specifications
//! and diagnostics.
//!
//! This crate does no input or output. Text and bytes come in through the [`System`] trait, values and
//! [`Diagnostics`] go out. Frames are named in identifiers: `world_from_tool = world_from_base * base_from_tool`.
//! Lengths are metres and angles radians unless an identifier says otherwise.

pub mod diag;
pub mod geom;
pub mod ids;
pub mod ik;
pub mod joint_limits;
pub mod mesh;
pub mod model;
pub mod npy;
pub mod rng;
pub mod robot;
pub mod scan;
pub mod so3;
pub mod spec;
pub mod srdf;
pub mod system;
pub mod task;
pub mod trajectory;
pub mod urdf;
pub mod world;
mod xacro;
mod xml;

pub use diag::{Diagnostic, Diagnostics, Severity, Sources, Span};
pub use ids::{BodyIdx, DofIdx, JointIdx, LinkIdx, TypedVec};
pub use model::{Calibration, Configuration, Kinematics, LinkPoses, RobotModel, SerialChain};
pub use rng::Seed;
pub use robot::{Arm, Gripper, Robot};
pub use system::System;
pub use task::Task;
pub use trajectory::Trajectory;
pub use world::World;

/// Double-precision rigid transform, the only pose type of public signatures.
pub type Pose = nalgebra::Isometry3<f64>;
