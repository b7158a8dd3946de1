//! Specifications: `*.robot.toml` and `*.task.toml`, from text to checked [`Robot`](crate::robot::Robot) and
//! [`Task`](crate::task::Task).
//!
//! One table of keys ([`TableSchema`]) describes each format. From it come the checks, the JSON Schema
//! ([`json_schema`]) and the reference in the documentation ([`reference`]). A text is read in two steps: first as a
//! tree of values with places, checked against the table; then as typed values, checked against the robot's model.
//! Both steps report all they find and go on.

mod annotations;
mod arms;
mod articles;
mod check;
mod describe;
mod document;
mod extent;
mod file;
mod goals;
mod grippers;
mod groups;
mod init;
mod json_schema;
mod limits;
mod lookup;
mod parameters;
mod reference;
mod robot;
mod robot_schema;
mod schema;
mod shapes;
mod task;
mod task_schema;
mod validate;

pub use check::{Summary, check};
pub use init::{ArmGuess, InitOptions, guess_arms, init};
pub use json_schema::json_schema;
pub use parameters::{
    KindParameters, Parameter, ParameterDefault, ParameterKind, ParameterTable, ParameterValue, Parameters,
};
pub use reference::reference;
pub use robot::{RobotSpec, load_robot};
pub use schema::{Key, Kind, Length, Presence, Range, Rule, TableSchema, Text};
pub use task::{TaskSpec, load_task};

/// The formats of specifications.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpecKind {
    /// `*.robot.toml`.
    Robot,
    /// `*.task.toml`.
    Task,
}

impl SpecKind {
    /// The keys of the format.
    pub fn schema(self) -> &'static TableSchema {
        match self {
            Self::Robot => &robot_schema::ROBOT,
            Self::Task => &task_schema::TASK,
        }
    }
}
