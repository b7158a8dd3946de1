//! Reading specifications for commands: findings are printed, and errors end the command.

use std::path::Path;

use robotc_core::spec::{self, SpecKind, TaskSpec};
use robotc_core::{Sources, diag::Diagnostics};
use robotc_kb::Project;
use robotc_kb::os::OsSystem;

use crate::output::{self, Failure, Outcome};
use crate::settings::Settings;

/// What kind of specification a file is, by its name: `*.robot.toml` or `*.task.toml`.
pub(crate) fn kind_of(path: &Path) -> Option<SpecKind> {
    let name = path.file_name()?.to_str()?;
    if name.ends_with(".robot.toml") {
        Some(SpecKind::Robot)
    } else if name.ends_with(".task.toml") {
        Some(SpecKind::Task)
    } else {
        None
    }
}

/// Reads a robot or task specification into what the knowledge base compiles.
pub(crate) fn project(path: &Path, settings: &Settings) -> Outcome<Project> {
    match kind_of(path) {
        Some(SpecKind::Task) => Ok(Project::of_task(&task(path, settings)?)),
        Some(SpecKind::Robot) => {
            let mut sources = Sources::new();
            let table = robotc_kb::kinds::parameter_table();
            let (spec, found) = spec::load_robot(&OsSystem, &mut sources, path, &table);
            let mut spec = accept(spec, &found, &sources)?;
            settings.apply(&mut spec.parameters);
            Ok(Project::of_robot(&spec))
        }
        None => Err(Failure::Input(format!(
            "{} is neither a *.robot.toml nor a *.task.toml; `robotc init` writes one from a URDF",
            path.display()
        ))),
    }
}

/// Reads a task specification.
pub(crate) fn task(path: &Path, settings: &Settings) -> Outcome<TaskSpec> {
    if kind_of(path) == Some(SpecKind::Robot) {
        let path = path.display();
        return Err(Failure::Input(format!("{path} is a robot specification; this needs a *.task.toml")));
    }
    let mut sources = Sources::new();
    let table = robotc_kb::kinds::parameter_table();
    let (spec, found) = spec::load_task(&OsSystem, &mut sources, path, &table);
    let mut spec = accept(spec, &found, &sources)?;
    settings.apply(&mut spec.parameters);
    Ok(spec)
}

/// Prints what was found and passes on the value, if there is one.
pub(crate) fn accept<T>(value: Option<T>, found: &Diagnostics, sources: &Sources) -> Outcome<T> {
    output::report(found, sources);
    value.ok_or(Failure::Reported)
}
