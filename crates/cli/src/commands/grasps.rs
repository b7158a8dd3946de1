//! `robotc grasps`: grasp sets in the formats of other programs.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use robotc_kb::formats::{GraspFile, GraspFormat};
use robotc_kb::kinds::ranked_grasps;
use robotc_kb::project::OfGripperAndObject;

use super::compile::write_whole;
use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, count, print, print_text};
use crate::settings::Settings;

/// Write grasp sets in the formats of other programs, and convert between them
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc grasps export mug.task.toml --object mug -o mug.yaml\n  \
    robotc grasps export mug.task.toml --object mug --format acronym -o mug.json\n  \
    robotc grasps convert mug.yaml mug.json\n\n\
    Poses are those of the gripper's palm link in the frame of the object, metres. What a set lacks is computed first.")]
pub(crate) struct Grasps {
    #[command(subcommand)]
    command: GraspsCommand,
    #[command(flatten)]
    store: StoreArgs,
}

#[derive(Subcommand)]
enum GraspsCommand {
    /// Write the grasps of an object of a task
    Export {
        /// A `*.task.toml` file
        task: PathBuf,
        /// The object
        #[arg(long, value_name = "NAME")]
        object: String,
        /// The gripper [default: that of the task's arm]
        #[arg(long, value_name = "NAME")]
        gripper: Option<String>,
        /// The format [default: by the ending of the file]
        #[arg(long, value_enum)]
        format: Option<Format>,
        /// The file [default: standard output]
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// Most grasps that are written, best first
        #[arg(long, value_name = "N")]
        most: Option<usize>,
    },
    /// Read a file in one format and write it in another
    Convert {
        /// `*.yaml` (isaac_grasp), `*.json` (ACRONYM) or `*.npz` (numpy)
        from: PathBuf,
        /// The same
        to: PathBuf,
    },
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// YAML of Isaac Sim's grasp editor
    Isaac,
    /// The fields of the ACRONYM data set as JSON
    Acronym,
    /// Arrays of numpy
    Npz,
}

impl From<Format> for GraspFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Isaac => Self::IsaacGrasp,
            Format::Acronym => Self::Acronym,
            Format::Npz => Self::Npz,
        }
    }
}

pub(crate) fn run(args: &Grasps) -> Outcome {
    match &args.command {
        GraspsCommand::Export { task, object, gripper, format, output, most } => {
            let mut file = exported(args, task, object, gripper.as_deref())?;
            file.grasps.truncate(most.unwrap_or(usize::MAX));
            let format = match (format, output) {
                (Some(format), _) => (*format).into(),
                (None, Some(path)) => format_of(path)?,
                (None, None) => GraspFormat::IsaacGrasp,
            };
            let written = file.write(format);
            let Some(path) = output else {
                return match String::from_utf8(written) {
                    Ok(text) => {
                        print_text(&text);
                        Ok(())
                    }
                    Err(_) => Err(Failure::Input("arrays go into a file: give -o FILE.npz".into())),
                };
            };
            write_whole(path, &written)?;
            print(&format!("{}: {}", path.display(), count(file.grasps.len(), "grasp")));
            Ok(())
        }
        GraspsCommand::Convert { from, to } => {
            let (read_as, write_as) = (format_of(from)?, format_of(to)?);
            let read = std::fs::read(from)
                .map_err(|error| Failure::Environment(format!("{}: {error}", from.display())))?;
            let file = GraspFile::read(&read, read_as)
                .map_err(|error| Failure::Input(format!("{}: {error}", from.display())))?;
            write_whole(to, &file.write(write_as))?;
            print(&format!("{}: {}", to.display(), count(file.grasps.len(), "grasp")));
            Ok(())
        }
    }
}

/// The grasps of an object, computed where they are not known.
fn exported(args: &Grasps, path: &Path, object: &str, gripper: Option<&str>) -> Outcome<GraspFile> {
    let spec = crate::input::task(path, &Settings::default())?;
    let (task, robot) = (&spec.task, &spec.robot.robot);
    let unknown = |what: &str, name: &str, all: Vec<&str>| {
        Failure::Input(format!("there is no {what} \"{name}\"; there are {}", all.join(", ")))
    };
    let position =
        task.objects.iter().position(|o| o.name == object).ok_or_else(|| {
            unknown("object", object, task.objects.iter().map(|o| o.name.as_str()).collect())
        })?;
    let index = match gripper {
        Some(name) => robot.grippers.iter().position(|g| g.name == name).ok_or_else(|| {
            unknown("gripper", name, robot.grippers.iter().map(|g| g.name.as_str()).collect())
        })?,
        None => robot.arms[task.arm].gripper.expect("a task is done by an arm with a gripper"),
    };
    let graph = knowledge::plan(&robotc_kb::Project::of_task(&spec))?;
    let report = knowledge::compile(&graph, &args.store.open()?)?;
    let grasps = ranked_grasps(&report.knowledge, &OfGripperAndObject { gripper: index, object: position })
        .map_err(|error| Failure::Environment(error.to_string()))?;
    Ok(GraspFile::of(object, robot, &robot.grippers[index], &grasps))
}

fn format_of(path: &Path) -> Outcome<GraspFormat> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("yaml" | "yml") => Ok(GraspFormat::IsaacGrasp),
        Some("json") => Ok(GraspFormat::Acronym),
        Some("npz") => Ok(GraspFormat::Npz),
        _ => Err(Failure::Input(format!(
            "{}: the format of grasps is told by the ending: .yaml (isaac_grasp), .json (ACRONYM) or .npz (numpy)",
            path.display()
        ))),
    }
}
