//! Reading specifications for commands: findings are printed, and errors end the command.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use robotc_core::spec::{self, SpecKind, TaskSpec};
use robotc_core::system::MeshesOnce;
use robotc_core::{Sources, System, diag::Diagnostics};
use robotc_kb::Project;
use robotc_kb::kinds::parameter_table;
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
    let (project, found, sources) = read(&OsSystem, path, settings)?;
    accept(project, &found, &sources)
}

/// The same for several, which are read at once; what is found is printed in their order.
pub(crate) fn projects(paths: &[PathBuf], settings: &Settings) -> Outcome<Vec<Project>> {
    let system = MeshesOnce::<OsSystem>::default();
    let read: Vec<_> = paths.par_iter().map(|path| read(&system, path, settings)).collect();
    read.into_iter()
        .map(|read| read.and_then(|(project, found, sources)| accept(project, &found, &sources)))
        .collect()
}

/// A project, if the specification is one, with what was found in it; nothing is printed.
fn read(
    system: &dyn System,
    path: &Path,
    settings: &Settings,
) -> Outcome<(Option<Project>, Diagnostics, Sources)> {
    let mut sources = Sources::new();
    let table = parameter_table();
    let (project, found) = match kind_of(path) {
        Some(SpecKind::Task) => {
            let (mut spec, found) = spec::load_task(system, &mut sources, path, &table);
            spec.iter_mut().for_each(|spec| settings.apply(&mut spec.parameters));
            (spec.as_ref().map(Project::of_task), found)
        }
        Some(SpecKind::Robot) => {
            let (mut spec, found) = spec::load_robot(system, &mut sources, path, &table);
            spec.iter_mut().for_each(|spec| settings.apply(&mut spec.parameters));
            (spec.as_ref().map(Project::of_robot), found)
        }
        None => {
            return Err(Failure::Input(format!(
                "{} is neither a *.robot.toml nor a *.task.toml; `robotc init` writes one from a URDF",
                path.display()
            )));
        }
    };
    Ok((project, found, sources))
}

/// Reads a task specification.
pub(crate) fn task(path: &Path, settings: &Settings) -> Outcome<TaskSpec> {
    if kind_of(path) == Some(SpecKind::Robot) {
        let path = path.display();
        return Err(Failure::Input(format!("{path} is a robot specification; this needs a *.task.toml")));
    }
    let mut sources = Sources::new();
    let (spec, found) = spec::load_task(&OsSystem, &mut sources, path, &parameter_table());
    let mut spec = accept(spec, &found, &sources)?;
    settings.apply(&mut spec.parameters);
    Ok(spec)
}

/// Prints what was found and passes on the value, if there is one.
pub(crate) fn accept<T>(value: Option<T>, found: &Diagnostics, sources: &Sources) -> Outcome<T> {
    output::report(found, sources);
    value.ok_or(Failure::Reported)
}
