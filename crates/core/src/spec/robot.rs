//! `*.robot.toml` to a checked [`Robot`].

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::{Node, Table};
use super::file::{self, SpecFile};
use super::limits;
use super::{ParameterTable, Parameters, SpecKind, annotations, arms, grippers, groups, lookup};
use crate::diag::{Diagnostic, Diagnostics, Sources, Span};
use crate::joint_limits;
use crate::model::{Kinematics, Origin, RobotModel};
use crate::robot::{Arm, Gripper, Robot};
use crate::srdf::{self, Srdf};
use crate::system::{ReadError, System};
use crate::urdf::{self, LoadOptions};

/// A checked robot specification.
#[derive(Debug, Clone)]
pub struct RobotSpec {
    /// Its name.
    pub name: String,
    /// The robot.
    pub robot: Arc<Robot>,
    /// `palm_from_tool` of each gripper as written: what an artefact key hashes.
    pub tools: Vec<Origin>,
    /// `link_from_camera` of each camera as written.
    pub camera_poses: Vec<Origin>,
    /// Parameters of artefact kinds set for this robot.
    pub parameters: Parameters,
    /// The specification.
    pub path: PathBuf,
    /// The description it refers to.
    pub description: PathBuf,
}

/// Reads the robot specification at `path`: all findings, and the robot if none of them is an error.
///
/// `parameters` are those that artefact kinds declare; `[parameters]` is checked against them.
pub fn load_robot(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    parameters: &ParameterTable,
) -> (Option<RobotSpec>, Diagnostics) {
    let (spec, diagnostics) = load(system, sources, path, None, parameters);
    (spec, file::by_place(diagnostics))
}

/// As [`load_robot`]; `at` is the reference to the file in another specification.
pub(super) fn load(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    at: Option<Span>,
    parameters: &ParameterTable,
) -> (Option<RobotSpec>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let opened = file::open(system, sources, path, at, SpecKind::Robot, parameters, &mut diagnostics);
    let Some(opened) = opened else { return (None, diagnostics) };
    let spec = read(system, sources, path, &opened, parameters, &mut diagnostics);
    (spec.filter(|_| !diagnostics.has_errors()), diagnostics)
}

/// The robot, as far as it can be read.
fn read(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    file: &SpecFile,
    parameters: &ParameterTable,
    diagnostics: &mut Diagnostics,
) -> Option<RobotSpec> {
    let table = &file.table;
    let description = referenced(system, file, "description", "a URDF or xacro file", diagnostics);
    let packages = table.entries("packages").iter().filter_map(|entry| {
        let folder = file::resolve(system, &file.folder, entry.node.text()?);
        if !system.exists(&folder) {
            diagnostics.push(
                Diagnostic::error("R0001", format!("there is no folder {}", folder.display()))
                    .at(entry.node.span, "named here"),
            );
        }
        Some((entry.key.clone(), folder))
    });
    let packages = packages.collect();
    let arguments = table.entries("arguments").iter();
    let arguments =
        arguments.filter_map(|entry| Some((entry.key.clone(), entry.node.text()?.to_owned()))).collect();
    let shapeless = table.list("shapeless").iter().filter_map(|name| Some(name.text()?.to_owned())).collect();
    let options = LoadOptions { packages, arguments, shapeless, ..LoadOptions::default() };
    let description = description?;
    let (model, found) = urdf::load(system, sources, &description, &options);
    diagnostics.extend(found);
    let model = model?;
    lookup::links(&model, table.list("shapeless"), diagnostics);
    let model = joint_limits(system, sources, file, &model, diagnostics).unwrap_or(model);
    let srdf = semantics(system, sources, file, &model, diagnostics);
    let robot = annotate(table, file.place, &model, srdf.as_ref(), diagnostics);
    Some(RobotSpec {
        name: table.text("name")?.0.to_owned(),
        robot: Arc::new(robot),
        tools: table.tables("gripper").map(|(gripper, _)| lookup::origin(gripper, "tool")).collect(),
        camera_poses: table.tables("camera").map(|(camera, _)| lookup::origin(camera, "pose")).collect(),
        parameters: file::read_parameters(table, parameters),
        path: path.to_owned(),
        description,
    })
}

/// The model with the limits of the file `joint_limits`, if one is named.
fn joint_limits(
    system: &dyn System,
    sources: &mut Sources,
    file: &SpecFile,
    model: &RobotModel,
    diagnostics: &mut Diagnostics,
) -> Option<RobotModel> {
    let path = referenced(system, file, "joint_limits", "MoveIt's joint_limits.yaml", diagnostics)?;
    let (limits, found) = joint_limits::load(system, sources, &path);
    diagnostics.extend(found);
    Some(joint_limits::apply(&limits, model, diagnostics))
}

/// The SRDF, if one is named.
fn semantics(
    system: &dyn System,
    sources: &mut Sources,
    file: &SpecFile,
    model: &RobotModel,
    diagnostics: &mut Diagnostics,
) -> Option<Srdf> {
    let path = referenced(system, file, "srdf", "an SRDF file", diagnostics)?;
    let (srdf, found) = srdf::load(system, sources, &path, Some(model));
    diagnostics.extend(found);
    srdf
}

/// The existing file that `key` names; a finding at its name when there is none.
fn referenced(
    system: &dyn System,
    file: &SpecFile,
    key: &str,
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<PathBuf> {
    let (path, place) = file.table.text(key)?;
    let path = file::resolve(system, &file.folder, path);
    if system.exists(&path) {
        return Some(path);
    }
    diagnostics.push(
        Diagnostic::unreadable(&path, &ReadError::NotFound)
            .at(place, "named here")
            .expected(format!("{what}, relative to the folder of this specification")),
    );
    None
}

/// What a specification and its SRDF say about a model.
fn annotate(
    table: &Table,
    place: Span,
    model: &RobotModel,
    srdf: Option<&Srdf>,
    diagnostics: &mut Diagnostics,
) -> Robot {
    let limits_place = table.entry("limits").or(table.entry("description")).map_or(place, |e| e.key_span);
    let model = Arc::new(limits::apply(model, table, limits_place, diagnostics));
    let kinematics = Kinematics::new(model.clone());
    let (grippers, gripper_at) = read_grippers(table, &model, diagnostics);
    let gripper_names: Vec<&str> =
        table.tables("gripper").map(|(t, _)| t.text("name").map_or("", |(name, _)| name)).collect();
    let mut arms: Vec<Arm> = Vec::new();
    for (arm_table, arm_place) in table.tables("arm") {
        let Some(mut arm) = arms::read(arm_table, arm_place, &kinematics, &gripper_names, diagnostics) else {
            continue;
        };
        // From the order of the file to the order of the grippers that could be read.
        arm.gripper = arm.gripper.and_then(|written| gripper_at[written]);
        if let Some(index) = arm.gripper {
            let place = arm_table.get("gripper").map_or(arm_place, |node: &Node| node.span);
            arms::check_mounting(&arm, &grippers[index], place, &model, diagnostics);
        }
        arms.push(arm);
    }
    if table.get("arm").is_none() {
        arms = srdf.map(|srdf| groups::chains(srdf, &kinematics, &grippers)).unwrap_or_default();
        if arms.is_empty() {
            diagnostics.push(
                Diagnostic::error("R0415", "the robot has no arm")
                    .at(place, "no `[[arm]]`")
                    .expected("a table `[[arm]]`, or an SRDF with a group that is a chain")
                    .hint("`robotc init` writes a specification with guessed arms"),
            );
        }
    }
    let mut ignored_pairs = annotations::ignored_pairs(table, &model, diagnostics);
    ignored_pairs.extend(srdf.map(|srdf| groups::disabled_pairs(srdf, &model)).unwrap_or_default());
    ignored_pairs.sort();
    ignored_pairs.dedup();
    Robot {
        arms,
        grippers,
        cameras: annotations::cameras(table, &model, diagnostics),
        base: annotations::base(table, &model, diagnostics),
        ignored_pairs,
        weights: annotations::weights(table, &model, diagnostics),
        model,
    }
}

/// The grippers that could be read, and for each `[[gripper]]` table its position among them.
fn read_grippers(
    table: &Table,
    model: &RobotModel,
    diagnostics: &mut Diagnostics,
) -> (Vec<Gripper>, Vec<Option<usize>>) {
    let mut read = Vec::new();
    let mut positions = Vec::new();
    for (gripper, _) in table.tables("gripper") {
        let gripper = grippers::read(gripper, model, diagnostics);
        positions.push(gripper.as_ref().map(|_| read.len()));
        read.extend(gripper);
    }
    (read, positions)
}
