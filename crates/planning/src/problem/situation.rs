//! What a problem about a robot among things says beyond coordinates.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::document::PoseDocument;

/// Where things are, and what is held: what differs from the start of the task that a problem belongs to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SituationDocument {
    /// Values of joints that are not planned for, by name: fingers, a torso. Radians or metres.
    pub joints: BTreeMap<String, f64>,
    /// `world_from_body` of objects and obstacles, by name.
    pub bodies: BTreeMap<String, PoseDocument>,
    /// Values of the joints of articles, by the article's name. Radians or metres.
    pub articles: BTreeMap<String, f64>,
    /// An object that moves with the gripper.
    pub held: Option<HeldDocument>,
}

/// An object in the gripper. The links of the gripper may touch it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeldDocument {
    /// Its name.
    pub object: String,
    /// The object in the tool frame.
    pub tool_from_object: PoseDocument,
}
