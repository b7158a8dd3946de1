//! `robotc view`: artefacts as pages to look at.

use std::path::PathBuf;

use clap::Args;
use robotc_core::diag::nearest;
use robotc_runtime::{picture, view};

use super::compile::write_whole;
use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, say};

/// Draw artefacts of a specification as a 3-D page
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc view mug.task.toml grasp_set -o grasps.html\n  \
    robotc view arm.robot.toml convex_parts forearm -o forearm.html\n\n\
    What is missing is compiled first. The page opens offline in any browser.")]
pub(crate) struct View {
    /// A `*.robot.toml` or `*.task.toml` file
    file: PathBuf,
    /// The kind of artefact
    kind: String,
    /// Only those whose subject contains this
    subject: Option<String>,
    /// Write a 3-D page
    #[arg(long, short, value_name = "FILE.html")]
    output: Option<PathBuf>,
    /// Write binary glTF
    #[arg(long, value_name = "FILE.glb")]
    glb: Option<PathBuf>,
    #[command(flatten)]
    store: StoreArgs,
}

pub(crate) fn run(args: &View) -> Outcome {
    if args.output.is_none() && args.glb.is_none() {
        return Err(Failure::Input("nothing to write: give -o FILE.html or --glb FILE.glb".into()));
    }
    let kinds = picture::kind_names();
    if !kinds.contains(&args.kind.as_str()) {
        let hint = nearest(&args.kind, kinds.iter().copied())
            .map_or(String::new(), |near| format!("; did you mean {near}?"));
        let kinds = kinds.join(", ");
        return Err(Failure::Input(format!("{} is not one of the kinds drawn: {kinds}{hint}", args.kind)));
    }
    let graph = knowledge::plan(&crate::input::project(&args.file)?)?;
    let compiled = knowledge::compile(&graph, &args.store.open()?)?;
    let subject = args.subject.as_deref().unwrap_or_default();
    let recording = picture(&compiled.knowledge, &args.kind, subject)
        .map_err(|error| Failure::Input(error.to_string()))?;
    if let Some(path) = &args.output {
        write_whole(path, view::html(&recording).as_bytes())?;
        say(&format!("wrote {}; open it in a browser", path.display()));
    }
    if let Some(path) = &args.glb {
        write_whole(path, &view::glb(&recording))?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}
