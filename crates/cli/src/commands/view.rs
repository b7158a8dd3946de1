//! `robotc view`: artefacts as pages to look at.

use std::path::PathBuf;

use clap::Args;
use robotc_core::diag::nearest;
use robotc_runtime::{picture, view};

use super::compile::write_whole;
use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, say};
use crate::settings::Settings;

/// Draw artefacts of a specification: a 3-D page, or a plot of what lies in a plane
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc view mug.task.toml grasp_set -o grasps.html\n  \
    robotc view arm.robot.toml convex_parts forearm -o forearm.html\n  \
    robotc view mug.task.toml base_placement mug -o bases.svg\n\n\
    What is missing is compiled first. The page opens offline in any browser.")]
pub(crate) struct View {
    /// A `*.robot.toml` or `*.task.toml` file
    file: PathBuf,
    /// The kind of artefact
    kind: String,
    /// Only those whose subject contains this
    subject: Option<String>,
    /// Write a 3-D page, or an SVG plot of reachability or base_placement
    #[arg(long, short, value_name = "FILE.html|svg")]
    output: Option<PathBuf>,
    /// Write binary glTF
    #[arg(long, value_name = "FILE.glb")]
    glb: Option<PathBuf>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    store: StoreArgs,
}

pub(crate) fn run(args: &View) -> Outcome {
    if args.output.is_none() && args.glb.is_none() {
        return Err(Failure::Input(
            "nothing to write: give -o FILE.html, -o FILE.svg or --glb FILE.glb".into(),
        ));
    }
    let kinds = picture::kind_names();
    if !kinds.contains(&args.kind.as_str()) {
        let hint = nearest(&args.kind, kinds.iter().copied())
            .map_or(String::new(), |near| format!("; did you mean {near}?"));
        let kinds = kinds.join(", ");
        return Err(Failure::Input(format!("{} is not one of the kinds drawn: {kinds}{hint}", args.kind)));
    }
    let graph = knowledge::plan(&crate::input::project(&args.file, &args.settings)?)?;
    let compiled = knowledge::compile(&graph, &args.store.open()?)?;
    let subject = args.subject.as_deref().unwrap_or_default();
    let (plots, pages): (Vec<&PathBuf>, Vec<&PathBuf>) =
        args.output.iter().partition(|path| path.extension().is_some_and(|end| end == "svg"));
    for path in plots {
        let panels = picture::plot(&compiled.knowledge, &args.kind, subject)
            .map_err(|error| Failure::Input(error.to_string()))?
            .ok_or_else(|| Failure::Input(no_plot(&args.kind)))?;
        write_whole(path, picture::plot::svg(&panels).as_bytes())?;
        say(&format!("wrote {}", path.display()));
    }
    if pages.is_empty() && args.glb.is_none() {
        return Ok(());
    }
    let recording = picture(&compiled.knowledge, &args.kind, subject)
        .map_err(|error| Failure::Input(error.to_string()))?;
    for path in pages {
        write_whole(path, view::html(&recording).as_bytes())?;
        say(&format!("wrote {}; open it in a browser", path.display()));
    }
    if let Some(path) = &args.glb {
        write_whole(path, &view::glb(&recording))?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}

fn no_plot(kind: &str) -> String {
    let kinds: Vec<&str> = picture::PLOTS.iter().map(|(name, _)| *name).collect();
    format!("{kind} does not lie in a plane: plots are of {}; write it as FILE.html", kinds.join(" and "))
}
