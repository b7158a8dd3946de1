//! What is compiled, and what artefacts can be about.

use std::sync::Arc;

use robotc_core::ids::LinkIdx;
use robotc_core::model::{Geometry, Origin};
use robotc_core::spec::{RobotSpec, TaskSpec};
use robotc_core::{Robot, Task};

use crate::parameters::Given;

/// A checked robot, perhaps with a task, and the parameters that were given.
#[derive(Debug, Clone)]
pub struct Project {
    name: String,
    robot: Arc<Robot>,
    tools: Vec<Origin>,
    camera_poses: Vec<Origin>,
    task: Option<Arc<Task>>,
    given: Given,
}

impl Project {
    /// Everything that can be known about a robot alone.
    pub fn of_robot(spec: &RobotSpec) -> Self {
        Self {
            name: spec.name.clone(),
            robot: spec.robot.clone(),
            tools: spec.tools.clone(),
            camera_poses: spec.camera_poses.clone(),
            task: None,
            given: spec.parameters.clone(),
        }
    }

    /// Everything that a task needs, its robot included: of several arms only the one that does it, with its gripper.
    pub fn of_task(spec: &TaskSpec) -> Self {
        let task = Some(Arc::new(spec.task.clone()));
        Self { task, given: spec.parameters.clone(), ..Self::of_robot(&spec.robot) }
    }

    /// Name of the robot.
    pub fn robot_name(&self) -> &str {
        &self.name
    }

    /// `palm_from_tool` of a gripper as written.
    pub fn tool(&self, gripper: usize) -> &Origin {
        &self.tools[gripper]
    }

    /// `link_from_camera` of a camera as written.
    pub fn camera_pose(&self, camera: usize) -> &Origin {
        &self.camera_poses[camera]
    }

    /// The robot.
    pub fn robot(&self) -> &Arc<Robot> {
        &self.robot
    }

    /// The task, if there is one.
    pub fn task(&self) -> Option<&Arc<Task>> {
        self.task.as_ref()
    }

    /// Parameters given by hand.
    pub fn given(&self) -> &Given {
        &self.given
    }
}

/// What artefacts of a kind are about.
pub trait Subject: Clone + Send + Sync + 'static {
    /// All subjects of this type in a project, in specification order.
    fn all(project: &Project) -> Vec<Self>;

    /// What people call it: unique among the subjects of its type, stable while names are.
    fn label(&self, project: &Project) -> String;
}

/// The robot as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfRobot;

/// A serial manipulator: its position in [`Robot::arms`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfArm(pub usize);

/// A gripper: its position in [`Robot::grippers`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfGripper(pub usize);

/// A camera on the robot: its position in [`Robot::cameras`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfCamera(pub usize);

/// An object of the task that can be grasped: its position in [`Task::objects`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfObject(pub usize);

/// A gripper with an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfGripperAndObject {
    /// Position in [`Robot::grippers`].
    pub gripper: usize,
    /// Position in [`Task::objects`].
    pub object: usize,
}

/// A gripper with an article of the task, a door or a drawer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfGripperAndArticle {
    /// Position in [`Robot::grippers`].
    pub gripper: usize,
    /// Position in [`Task::articles`].
    pub article: usize,
}

/// Anything with a shape: what collision geometry is computed for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OfShape {
    /// A link of the robot.
    Link(LinkIdx),
    /// Position in [`Task::objects`].
    Object(usize),
    /// Position in [`Task::obstacles`].
    Obstacle(usize),
}

impl Subject for OfRobot {
    fn all(_project: &Project) -> Vec<Self> {
        vec![Self]
    }

    fn label(&self, project: &Project) -> String {
        robot_label(project)
    }
}

impl Subject for OfArm {
    fn all(project: &Project) -> Vec<Self> {
        match project.task() {
            Some(task) => vec![Self(task.arm)],
            None => (0..project.robot.arms.len()).map(Self).collect(),
        }
    }

    fn label(&self, project: &Project) -> String {
        format!("{}/{}", robot_label(project), word(&project.robot.arms[self.0].name))
    }
}

impl Subject for OfGripper {
    fn all(project: &Project) -> Vec<Self> {
        match project.task() {
            Some(task) => project.robot.arms[task.arm].gripper.map(Self).into_iter().collect(),
            None => (0..project.robot.grippers.len()).map(Self).collect(),
        }
    }

    fn label(&self, project: &Project) -> String {
        format!("{}/{}", robot_label(project), word(&project.robot.grippers[self.0].name))
    }
}

impl Subject for OfCamera {
    fn all(project: &Project) -> Vec<Self> {
        (0..project.robot.cameras.len()).map(Self).collect()
    }

    fn label(&self, project: &Project) -> String {
        format!("{}/{}", robot_label(project), word(&project.robot.cameras[self.0].name))
    }
}

impl Subject for OfObject {
    fn all(project: &Project) -> Vec<Self> {
        (0..project.task.as_ref().map_or(0, |task| task.objects.len())).map(Self).collect()
    }

    fn label(&self, project: &Project) -> String {
        let task = project.task.as_ref().expect("objects belong to a task");
        format!("{}/{}", word(&task.name), word(&task.objects[self.0].name))
    }
}

impl Subject for OfGripperAndObject {
    fn all(project: &Project) -> Vec<Self> {
        let mut all = Vec::new();
        for OfGripper(gripper) in OfGripper::all(project) {
            all.extend(OfObject::all(project).into_iter().map(|OfObject(object)| Self { gripper, object }));
        }
        all
    }

    fn label(&self, project: &Project) -> String {
        format!("{}+{}", OfGripper(self.gripper).label(project), OfObject(self.object).label(project))
    }
}

impl Subject for OfGripperAndArticle {
    fn all(project: &Project) -> Vec<Self> {
        let articles = project.task.as_ref().map_or(0, |task| task.articles.len());
        let of_gripper = |OfGripper(gripper)| (0..articles).map(move |article| Self { gripper, article });
        OfGripper::all(project).into_iter().flat_map(of_gripper).collect()
    }

    fn label(&self, project: &Project) -> String {
        let task = project.task.as_ref().expect("articles belong to a task");
        let article = word(&task.articles[self.article].name);
        format!("{}+{}/{article}", OfGripper(self.gripper).label(project), word(&task.name))
    }
}

impl OfShape {
    /// The elements it is made of: collision elements of a link, the shape of an object or obstacle.
    pub fn geometry<'a>(&self, project: &'a Project) -> &'a [Geometry] {
        let task = || project.task.as_ref().expect("objects and obstacles belong to a task");
        match *self {
            Self::Link(link) => &project.robot.model.links()[link].collisions,
            Self::Object(object) => &task().objects[object].geometry,
            Self::Obstacle(obstacle) => &task().obstacles[obstacle].geometry,
        }
    }
}

impl Subject for OfShape {
    /// Those without any element have nothing to compute and are left out.
    fn all(project: &Project) -> Vec<Self> {
        let links = project.robot.model.links().indices().map(Self::Link);
        let (objects, obstacles) =
            project.task.as_ref().map_or((0, 0), |task| (task.objects.len(), task.obstacles.len()));
        links
            .chain((0..objects).map(Self::Object))
            .chain((0..obstacles).map(Self::Obstacle))
            .filter(|shape| !shape.geometry(project).is_empty())
            .collect()
    }

    fn label(&self, project: &Project) -> String {
        match *self {
            Self::Link(link) => {
                format!("{}/{}", robot_label(project), word(&project.robot.model.links()[link].name))
            }
            Self::Object(object) => OfObject(object).label(project),
            Self::Obstacle(obstacle) => {
                let task = project.task.as_ref().expect("obstacles belong to a task");
                format!("{}/{}", word(&task.name), word(&task.obstacles[obstacle].name))
            }
        }
    }
}

fn robot_label(project: &Project) -> String {
    word(&project.name)
}

/// A name without the characters that separate words of a label or of a lock file.
fn word(name: &str) -> String {
    let separates = |c: char| c.is_whitespace() || c.is_control() || "/+%".contains(c);
    let mut text = String::new();
    for c in name.chars() {
        if separates(c) {
            let mut bytes = [0; 4];
            for byte in c.encode_utf8(&mut bytes).bytes() {
                text += &format!("%{byte:02x}");
            }
        } else {
            text.push(c);
        }
    }
    if text.is_empty() { "%".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_keep_labels_readable_and_unambiguous() {
        for (name, expected) in
            [("panda_link0", "panda_link0"), ("a b/c", "a%20b%2fc"), ("", "%"), ("é", "é")]
        {
            assert_eq!(word(name), expected);
        }
    }
}
