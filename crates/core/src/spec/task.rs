//! `*.task.toml` to a checked [`Task`].

use std::path::{Path, PathBuf};

use super::document::{Node, Table};
use super::file::{self, SpecFile};
use super::robot::{self, RobotSpec};
use super::shapes::Shapes;
use super::{ParameterTable, Parameters, SpecKind, articles, goals, lookup};
use crate::diag::{Diagnostic, Diagnostics, Sources, Span};
use crate::model::Configuration;
use crate::robot::Robot;
use crate::system::System;
use crate::task::{Article, Goal, Object, Obstacle, Task};

/// A checked task specification.
#[derive(Debug, Clone)]
pub struct TaskSpec {
    /// The task.
    pub task: Task,
    /// The robot specification that the task refers to.
    pub robot: RobotSpec,
    /// Parameters of artefact kinds: the robot's, overridden one by one by the task's.
    pub parameters: Parameters,
    /// The specification.
    pub path: PathBuf,
}

/// Reads the task specification at `path` with the robot it names: all findings about both, and the task if none of them
/// is an error.
///
/// `parameters` are those that artefact kinds declare; `[parameters]` is checked against them.
pub fn load_task(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    parameters: &ParameterTable,
) -> (Option<TaskSpec>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let opened = file::open(system, sources, path, None, SpecKind::Task, parameters, &mut diagnostics);
    let Some(opened) = opened else { return (None, file::by_place(diagnostics)) };
    let robot = opened.table.text("robot").and_then(|(robot, at)| {
        let robot = file::resolve(system, &opened.folder, robot);
        let (robot, found) = robot::load(system, sources, &robot, Some(at), parameters);
        diagnostics.extend(found);
        robot
    });
    let task = read(system, sources, &opened, robot.as_ref(), &mut diagnostics);
    let spec = task.zip(robot).map(|(task, robot)| {
        let own = file::read_parameters(&opened.table, parameters);
        TaskSpec { task, parameters: robot.parameters.overlaid(&own), robot, path: path.to_owned() }
    });
    (spec.filter(|_| !diagnostics.has_errors()), file::by_place(diagnostics))
}

/// The task, as far as it can be read; objects and goals are checked even without a robot.
fn read(
    system: &dyn System,
    sources: &mut Sources,
    file: &SpecFile,
    robot: Option<&RobotSpec>,
    diagnostics: &mut Diagnostics,
) -> Option<Task> {
    let table = &file.table;
    unique_names(table, diagnostics);
    let mut shapes = Shapes::new(system, &file.folder);
    let mut objects = Vec::new();
    let mut obstacles = Vec::new();
    for (object, _) in table.tables("object") {
        let geometry = shapes.read(object, diagnostics);
        let Some((name, _)) = object.text("name") else { continue };
        objects.push(Object {
            name: name.to_owned(),
            geometry: geometry.unwrap_or_default(),
            mass: object.number("mass").unwrap_or(1.0),
            friction: object.number("friction").unwrap_or(0.5),
            world_from_object: lookup::origin(object, "pose").pose(),
        });
    }
    for (obstacle, _) in table.tables("obstacle") {
        let geometry = shapes.read(obstacle, diagnostics);
        let Some((name, _)) = obstacle.text("name") else { continue };
        obstacles.push(Obstacle {
            name: name.to_owned(),
            geometry: geometry.unwrap_or_default(),
            world_from_obstacle: lookup::origin(obstacle, "pose").pose(),
            without_robot: obstacle.table("cloud").and_then(|cloud| cloud.number("without_robot")),
        });
    }
    let standing = obstacles.clone();
    let mut read_article =
        |(t, _): (&Table, Span)| articles::read(system, sources, file, t, &mut obstacles, diagnostics);
    let articles: Vec<Article> = table.tables("article").filter_map(&mut read_article).collect();
    let goals: Vec<Goal> = table
        .tables("goal")
        .filter_map(|(goal, _)| goals::read(goal, &objects, &standing, &articles, diagnostics))
        .collect();
    let robot = &robot?.robot;
    let arm = arm(table, file.place, robot, diagnostics);
    let start = start(table, robot, diagnostics);
    Some(Task {
        name: table.text("name")?.0.to_owned(),
        robot: robot.clone(),
        arm: arm?,
        world_from_robot: lookup::origin(table, "robot_pose").pose(),
        start,
        objects,
        obstacles,
        articles,
        goals,
        seed: table
            .get("seed")
            .and_then(Node::integer)
            .and_then(|seed| u64::try_from(seed).ok())
            .unwrap_or(0),
    })
}

/// Objects, obstacles and articles share their names; the schema has looked at each kind for itself.
fn unique_names(table: &Table, diagnostics: &mut Diagnostics) {
    let mut before: Vec<(&str, &str)> = Vec::new();
    for (key, kind) in [("object", "an object"), ("obstacle", "an obstacle"), ("article", "an article")] {
        let named: Vec<(&str, Span)> = table.tables(key).filter_map(|(t, _)| t.text("name")).collect();
        for (name, place) in &named {
            if let Some((_, other)) = before.iter().find(|(known, _)| known == name) {
                diagnostics.push(
                    Diagnostic::error("R0107", format!("{other} and {kind} are called \"{name}\""))
                        .at(*place, "used before")
                        .expected("a `name` of its own for each"),
                );
            }
        }
        before.extend(named.iter().map(|(name, _)| (*name, kind)));
    }
}

/// The arm that does the task, which must carry a gripper.
fn arm(table: &Table, place: Span, robot: &Robot, diagnostics: &mut Diagnostics) -> Option<usize> {
    let names = robot.arms.iter().map(|arm| arm.name.as_str());
    let (arm, place) = match table.text("arm") {
        Some(name) => (lookup::named(name, names, "R0501", "an arm of the robot", diagnostics)?, name.1),
        None if robot.arms.len() == 1 => (0, table.entry("robot").map_or(place, |e| e.node.span)),
        None => {
            let all: Vec<&str> = names.collect();
            diagnostics.push(
                Diagnostic::error("R0502", format!("the robot has {} arms, and none is chosen", all.len()))
                    .at(table.entry("robot").map_or(place, |e| e.node.span), "this robot")
                    .expected(format!("`arm`: one of {}", all.join(", "))),
            );
            return None;
        }
    };
    if robot.arms[arm].gripper.is_none() {
        diagnostics.push(
            Diagnostic::error("R0503", format!("arm \"{}\" carries no gripper", robot.arms[arm].name))
                .at(place, "it cannot grasp")
                .expected("an arm with `gripper` in the robot specification"),
        );
    }
    Some(arm)
}

/// Zero, then the arms' home, then the grippers' first preshape, then what `[start]` says.
fn start(table: &Table, robot: &Robot, diagnostics: &mut Diagnostics) -> Configuration {
    let mut start = Configuration::neutral(&robot.model);
    for arm in &robot.arms {
        if let Some(home) = &arm.home {
            start.set(&arm.dofs, home);
        }
    }
    for gripper in &robot.grippers {
        if let Some(preshape) = gripper.preshapes.first() {
            start.set(&gripper.dofs, &preshape.values);
        }
    }
    for entry in table.entries("start") {
        let dof = lookup::dof(&robot.model, (&entry.key, entry.key_span), diagnostics);
        if let Some((dof, value)) = dof.zip(entry.node.number())
            && let Some(value) = lookup::within_limits(&robot.model, dof, value, entry.node.span, diagnostics)
        {
            start[dof] = value;
        }
    }
    start
}
