//! Problem files: MotionBenchMaker's problems in a flat JSON form.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use robotc_core::Pose;
use robotc_core::model::{Geometry, Origin, Shape};
use serde::Deserialize;
use thiserror::Error;

/// Problems of one robot.
#[derive(Debug, Clone)]
pub struct ProblemSet {
    /// Name of the robot as the file gives it.
    pub robot: String,
    /// Joints that are planned for; starts and goals are in this order.
    pub joints: Vec<String>,
    /// Problems by scene in alphabetical order, in each scene in file order.
    pub problems: Vec<Problem>,
}

/// One start, one goal, and what is around.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The family of scenes that it belongs to.
    pub scene: String,
    /// Its number in the family.
    pub index: u64,
    /// Joint values, radians or metres.
    pub start: Vec<f64>,
    /// Joint values, radians or metres.
    pub goal: Vec<f64>,
    /// Values of joints that are not planned for.
    pub other_joints: Vec<(String, f64)>,
    /// What is around.
    pub obstacles: Vec<Obstacle>,
}

/// A body that stands still.
#[derive(Debug, Clone)]
pub struct Obstacle {
    /// Unique in its problem.
    pub name: String,
    /// Its shape, centred in its own frame.
    pub geometry: Arc<Vec<Geometry>>,
    /// Where it is, in the root frame of the robot.
    pub root_from_obstacle: Pose,
}

/// Why a text is not a problem set.
#[derive(Debug, Error)]
pub enum ProblemSetError {
    /// Not the JSON that is expected.
    #[error("not a set of problems: {0}")]
    Json(#[from] serde_json::Error),
    /// A state has another length than the list of joints.
    #[error("{scene} {index}: {what} has {found} values for {expected} joints")]
    Length {
        /// The scene.
        scene: String,
        /// The problem.
        index: u64,
        /// Start or goal.
        what: &'static str,
        /// Values given.
        found: usize,
        /// Joints planned for.
        expected: usize,
    },
    /// A size or pose that makes no body.
    #[error("{scene} {index}: obstacle {name} has no sensible {what}")]
    Obstacle {
        /// The scene.
        scene: String,
        /// The problem.
        index: u64,
        /// The obstacle.
        name: String,
        /// Size or pose.
        what: &'static str,
    },
}

#[derive(Deserialize)]
struct File {
    robot: String,
    joints: Vec<String>,
    problems: BTreeMap<String, Vec<FileProblem>>,
}

#[derive(Deserialize)]
struct FileProblem {
    index: u64,
    start: Vec<f64>,
    goal: Vec<f64>,
    #[serde(default)]
    start_other_joints: BTreeMap<String, f64>,
    #[serde(default)]
    obstacles: Vec<FileObstacle>,
}

#[derive(Deserialize)]
struct FileObstacle {
    name: String,
    position: [f64; 3],
    quat_xyzw: [f64; 4],
    #[serde(flatten)]
    shape: FileShape,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum FileShape {
    Box { size: [f64; 3] },
    Cylinder { length: f64, radius: f64 },
    Sphere { radius: f64 },
}

impl ProblemSet {
    /// The problems in a JSON text.
    pub fn parse(text: &str) -> Result<Self, ProblemSetError> {
        let file: File = serde_json::from_str(text)?;
        let mut problems = Vec::new();
        for (scene, list) in file.problems {
            for given in list {
                problems.push(problem(&scene, given, file.joints.len())?);
            }
        }
        Ok(Self { robot: file.robot, joints: file.joints, problems })
    }
}

fn problem(scene: &str, given: FileProblem, joints: usize) -> Result<Problem, ProblemSetError> {
    let index = given.index;
    for (what, values) in [("start", &given.start), ("goal", &given.goal)] {
        if values.len() != joints {
            let (scene, found) = (scene.to_owned(), values.len());
            return Err(ProblemSetError::Length { scene, index, what, found, expected: joints });
        }
    }
    let obstacle = |given: FileObstacle| {
        let name = given.name.clone();
        obstacle(given).map_err(|what| ProblemSetError::Obstacle {
            scene: scene.to_owned(),
            index,
            name,
            what,
        })
    };
    Ok(Problem {
        scene: scene.to_owned(),
        index,
        start: given.start,
        goal: given.goal,
        other_joints: given.start_other_joints.into_iter().collect(),
        obstacles: given.obstacles.into_iter().map(obstacle).collect::<Result<_, _>>()?,
    })
}

fn obstacle(given: FileObstacle) -> Result<Obstacle, &'static str> {
    let [x, y, z, w] = given.quat_xyzw;
    let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6).ok_or("orientation")?;
    let (shape, sizes) = match given.shape {
        FileShape::Box { size } => (Shape::Box { size }, size.to_vec()),
        FileShape::Cylinder { length, radius } => (Shape::Cylinder { radius, length }, vec![radius, length]),
        FileShape::Sphere { radius } => (Shape::Sphere { radius }, vec![radius]),
    };
    if !sizes.iter().all(|s| s.is_finite() && *s > 0.0) {
        return Err("size");
    }
    if !given.position.iter().all(|x| x.is_finite()) {
        return Err("position");
    }
    let [x, y, z] = given.position;
    let geometry = Geometry { origin: Origin::default(), shape, colour: None };
    Ok(Obstacle {
        name: given.name,
        geometry: Arc::new(vec![geometry]),
        root_from_obstacle: Pose::from_parts(Translation3::new(x, y, z), rotation),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(obstacle: &str) -> String {
        format!(
            r#"{{"robot": "r", "joints": ["a", "b"], "problems": {{"table": [
                {{"index": 3, "start": [0, 1], "goal": [1, 0.5], "start_other_joints": {{"f": 0.1}},
                  "obstacles": [{obstacle}]}}]}}}}"#
        )
    }

    #[test]
    fn problems_are_read_with_their_obstacles() {
        let can = r#"{"name": "can", "type": "cylinder", "position": [1, 2, 3], "quat_xyzw": [0, 0, 1, 1],
            "length": 0.2, "radius": 0.03}"#;
        let set = ProblemSet::parse(&text(can)).unwrap();
        let problem = &set.problems[0];
        assert_eq!((problem.scene.as_str(), problem.index), ("table", 3));
        assert_eq!(problem.other_joints, [("f".to_owned(), 0.1)]);
        let can = &problem.obstacles[0];
        assert_eq!(can.geometry[0].shape, Shape::Cylinder { radius: 0.03, length: 0.2 });
        let x_in_root = can.root_from_obstacle.rotation * nalgebra::Vector3::x();
        assert!((x_in_root.y - 1.0).abs() < 1e-12, "the quaternion is normalised: {x_in_root}");
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_its_place() {
        let bad = r#"{"name": "can", "type": "sphere", "position": [1, 2, 3], "quat_xyzw": [0, 0, 0, 0], "radius": 1}"#;
        let error = ProblemSet::parse(&text(bad)).unwrap_err().to_string();
        assert_eq!(error, "table 3: obstacle can has no sensible orientation");
        let short = text("").replace("[0, 1]", "[0]");
        let error = ProblemSet::parse(&short).unwrap_err().to_string();
        assert_eq!(error, "table 3: start has 1 values for 2 joints");
        assert!(matches!(ProblemSet::parse("{"), Err(ProblemSetError::Json(_))));
    }
}
