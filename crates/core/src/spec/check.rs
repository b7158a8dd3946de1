//! Checks a file of any kind that specifications consist of.

use std::path::Path;

use super::describe::count;
use super::document;
use super::{ParameterTable, RobotSpec, TaskSpec, file, load_robot, load_task};
use crate::diag::{Diagnostic, Diagnostics, Severity, Sources};
use crate::model::RobotModel;
use crate::robot::{Base, Robot};
use crate::system::System;
use crate::urdf::{self, LoadOptions};
use crate::{joint_limits, srdf};

/// What a checked file holds, in a few lines for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Summary {
    /// What kind of file it is, such as `robot specification`.
    pub what: &'static str,
    /// The name it gives itself; empty if it gives none.
    pub name: String,
    /// A line for each fact.
    pub facts: Vec<String>,
}

/// The kinds of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FileKind {
    Robot,
    Task,
    Description,
    Semantics,
    JointLimits,
}

/// Checks the file at `path` with all it refers to: a robot or task specification, a URDF or xacro description, an SRDF or a
/// `joint_limits.yaml`. The summary is there exactly when nothing found is an error.
///
/// The ending of the name decides what it is; where that is silent, the content does. `load` is for a description: a robot
/// specification says itself where packages are.
pub fn check(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    parameters: &ParameterTable,
    load: &LoadOptions,
) -> (Option<Summary>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let Some(kind) = kind_of(system, path, &mut diagnostics) else { return (None, diagnostics) };
    let (summary, found) = match kind {
        FileKind::Robot => {
            let (spec, found) = load_robot(system, sources, path, parameters);
            (spec.as_ref().map(of_robot), found)
        }
        FileKind::Task => {
            let (spec, found) = load_task(system, sources, path, parameters);
            (spec.as_ref().map(of_task), found)
        }
        FileKind::Description => {
            let (model, found) = urdf::load(system, sources, path, load);
            (model.as_ref().map(of_model), found)
        }
        FileKind::Semantics => {
            let (srdf, found) = srdf::load(system, sources, path, None);
            let summary = srdf.map(|srdf| Summary {
                what: "semantic description",
                name: srdf.name,
                facts: vec![
                    count(srdf.groups.len(), "group"),
                    count(srdf.end_effectors.len(), "end effector"),
                    count(srdf.disabled_pairs.len(), "disabled pair"),
                ],
            });
            (summary, found)
        }
        FileKind::JointLimits => {
            let (limits, found) = joint_limits::load(system, sources, path);
            let facts = vec![count(limits.len(), "joint")];
            (Some(Summary { what: "joint limits", name: String::new(), facts }), found)
        }
    };
    diagnostics.extend(found);
    (summary.filter(|_| diagnostics.count(Severity::Error) == 0), diagnostics)
}

fn kind_of(system: &dyn System, path: &Path, diagnostics: &mut Diagnostics) -> Option<FileKind> {
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default().to_lowercase();
    let endings = [
        (".robot.toml", FileKind::Robot),
        (".task.toml", FileKind::Task),
        (".urdf", FileKind::Description),
        (".xacro", FileKind::Description),
        (".srdf", FileKind::Semantics),
        (".yaml", FileKind::JointLimits),
        (".yml", FileKind::JointLimits),
    ];
    if let Some((_, kind)) = endings.iter().find(|(ending, _)| name.ends_with(ending)) {
        return Some(*kind);
    }
    // A text of its own, so that the reader proper names the file once.
    let mut scratch = Sources::new();
    let text = file::read_text(system, &mut scratch, path, None, diagnostics)?;
    if scratch.text(text).trim_start().starts_with('<') {
        return Some(FileKind::Description);
    }
    let table = document::parse(&scratch, text, &mut Diagnostics::new());
    if ["robot", "goal", "object"].iter().any(|key| table.get(key).is_some()) {
        return Some(FileKind::Task);
    }
    if ["description", "arm", "gripper"].iter().any(|key| table.get(key).is_some()) {
        return Some(FileKind::Robot);
    }
    diagnostics.push(
        Diagnostic::error("R0115", format!("{} is no file of a kind known here", path.display()))
            .expected("*.robot.toml, *.task.toml, *.urdf, *.xacro, *.srdf or joint_limits.yaml"),
    );
    None
}

fn of_model(model: &RobotModel) -> Summary {
    Summary { what: "robot description", name: model.name().to_owned(), facts: vec![size(model)] }
}

fn size(model: &RobotModel) -> String {
    let meshed = model.links().iter().filter(|link| !link.collisions.is_empty()).count();
    format!(
        "{}, {}, {}, {meshed} of the links with collision shapes",
        count(model.links().len(), "link"),
        count(model.joints().len(), "joint"),
        match model.dofs().len() {
            1 => "1 degree of freedom".to_owned(),
            n => format!("{n} degrees of freedom"),
        },
    )
}

fn of_robot(spec: &RobotSpec) -> Summary {
    let robot = &spec.robot;
    let mut facts = vec![size(&robot.model)];
    facts.extend(parts(robot));
    Summary { what: "robot specification", name: spec.name.clone(), facts }
}

fn parts(robot: &Robot) -> Vec<String> {
    let link = |index| robot.model.links()[index].name.as_str();
    let mut lines = Vec::new();
    for arm in &robot.arms {
        let gripper = arm.gripper.map_or(String::new(), |g| format!(", gripper {}", robot.grippers[g].name));
        let joints = count(arm.dofs.len(), "joint");
        lines.push(format!(
            "arm {}: {joints} from {} to {}{gripper}",
            arm.name,
            link(arm.base),
            link(arm.tip)
        ));
    }
    for gripper in &robot.grippers {
        let (joints, fingers) =
            (count(gripper.dofs.len(), "joint"), count(gripper.fingers.len(), "finger link"));
        let preshapes = count(gripper.preshapes.len(), "preshape");
        lines.push(format!("gripper {}: {joints}, {fingers}, {preshapes}", gripper.name));
    }
    for camera in &robot.cameras {
        let [width, height] = camera.size;
        lines.push(format!("camera {}: {width} x {height} on {}", camera.name, link(camera.link)));
    }
    if let Base::Planar { holonomic, .. } = robot.base {
        lines.push(format!("planar base, {}", if holonomic { "holonomic" } else { "not holonomic" }));
    }
    lines
}

fn of_task(spec: &TaskSpec) -> Summary {
    let task = &spec.task;
    let facts = vec![
        format!("robot {}, arm {}", spec.robot.name, task.robot.arms[task.arm].name),
        format!(
            "{}, {}, {}",
            count(task.objects.len(), "object"),
            count(task.obstacles.len(), "obstacle"),
            count(task.goals.len(), "goal")
        ),
    ];
    Summary { what: "task specification", name: task.name.clone(), facts }
}
