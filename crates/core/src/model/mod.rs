//! The immutable robot model, and kinematics over it.
//!
//! A [`RobotModel`] never changes and is shared; what a calibration found is a [`Calibration`] beside it; a
//! [`Configuration`] is joint values. [`Kinematics`] joins model and calibration, and everything that computes poses
//! takes it.

mod builder;
mod calibration;
mod chain;
mod configuration;
mod kinematics;
mod limits;
mod parts;
mod robot;
mod trimesh;

pub use builder::{ModelError, RobotBuilder};
pub use calibration::{Calibration, JointCorrection};
pub use chain::{ChainError, ChainJoint, ChainMotion, ChainVariable, SerialChain, WrittenJoint};
pub use configuration::Configuration;
pub use kinematics::{Kinematics, LinkPoses};
pub use parts::{Dof, Drive, DynamicLimits, Geometry, Inertial, Joint, JointMotion, Link, Origin, Shape};
pub use robot::RobotModel;
pub use trimesh::TriMesh;
