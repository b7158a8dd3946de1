//! Reading specifications for commands: findings are printed, and errors end the command.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use robotc_core::spec::{self, RobotSpec, SpecKind, TaskSpec};
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
    Read::of(&OsSystem, path)?.project(settings)
}

/// The same for several, which are read at once; what is found is printed in their order.
pub(crate) fn projects(paths: &[PathBuf], settings: &Settings) -> Outcome<Vec<Project>> {
    let system = MeshesOnce::<OsSystem>::default();
    let read: Vec<Outcome<Read>> = paths.par_iter().map(|path| Read::of(&system, path)).collect();
    read.into_iter().map(|read| read?.project(settings)).collect()
}

/// A specification with what was found in it, before any of that is printed.
struct Read {
    spec: Spec,
    found: Diagnostics,
    sources: Sources,
}

enum Spec {
    Robot(Option<RobotSpec>),
    Task(Option<Box<TaskSpec>>),
}

impl Read {
    fn of(system: &dyn System, path: &Path) -> Outcome<Self> {
        let mut sources = Sources::new();
        let table = parameter_table();
        let (spec, found) = match kind_of(path) {
            Some(SpecKind::Task) => {
                let (spec, found) = spec::load_task(system, &mut sources, path, &table);
                (Spec::Task(spec.map(Box::new)), found)
            }
            Some(SpecKind::Robot) => {
                let (spec, found) = spec::load_robot(system, &mut sources, path, &table);
                (Spec::Robot(spec), found)
            }
            None => {
                return Err(Failure::Input(format!(
                    "{} is neither a *.robot.toml nor a *.task.toml; `robotc init` writes one from a URDF",
                    path.display()
                )));
            }
        };
        Ok(Self { spec, found, sources })
    }

    /// Prints what was found.
    fn project(self, settings: &Settings) -> Outcome<Project> {
        let Self { spec, found, sources } = self;
        match spec {
            Spec::Task(spec) => {
                let spec = spec.map(|spec| *spec);
                Ok(Project::of_task(&finish(spec, &found, &sources, settings)?))
            }
            Spec::Robot(spec) => {
                let mut spec = accept(spec, &found, &sources)?;
                settings.apply(&mut spec.parameters);
                Ok(Project::of_robot(&spec))
            }
        }
    }
}

/// Reads a task specification.
pub(crate) fn task(path: &Path, settings: &Settings) -> Outcome<TaskSpec> {
    if kind_of(path) == Some(SpecKind::Robot) {
        let path = path.display();
        return Err(Failure::Input(format!("{path} is a robot specification; this needs a *.task.toml")));
    }
    let mut sources = Sources::new();
    let (spec, found) = spec::load_task(&OsSystem, &mut sources, path, &parameter_table());
    finish(spec, &found, &sources, settings)
}

/// Prints what was found in a task, and sets its parameters.
fn finish(
    spec: Option<TaskSpec>,
    found: &Diagnostics,
    sources: &Sources,
    settings: &Settings,
) -> Outcome<TaskSpec> {
    let mut spec = accept(spec, found, sources)?;
    settings.apply(&mut spec.parameters);
    Ok(spec)
}

/// Prints what was found and passes on the value, if there is one.
pub(crate) fn accept<T>(value: Option<T>, found: &Diagnostics, sources: &Sources) -> Outcome<T> {
    output::report(found, sources);
    value.ok_or(Failure::Reported)
}
