//! `robotc view`: artefacts as pages and pictures to look at.

use std::path::PathBuf;

use clap::Args;
use robotc_core::diag::nearest;
use robotc_runtime::{picture, view};

use super::compile::write_whole;
use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, say};
use crate::settings::Settings;

/// Width and height of a still picture, pixels.
const STILL: [u32; 2] = [1200, 800];

/// Draw artefacts: a 3-D page, a still picture, or a plot of what lies in a plane
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc view mug.task.toml grasp_set -o grasps.html\n  \
    robotc view arm.robot.toml convex_parts forearm -o forearm.html\n  \
    robotc view arm.robot.toml sphere_cover -o cover.svg\n  \
    robotc view mug.task.toml base_placement mug -o bases.svg\n\n\
    What is missing is compiled first. The page opens offline in any browser.")]
pub(crate) struct View {
    /// A `*.robot.toml` or `*.task.toml` file
    file: PathBuf,
    /// The kind of artefact
    kind: String,
    /// Only those whose subject contains this
    subject: Option<String>,
    /// Write a 3-D page; as SVG a plot of reachability or base_placement, a still picture of the others
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
    let drawn = |error: picture::NoPicture| Failure::Input(error.to_string());
    let still = args.output.as_ref().filter(|path| path.extension().is_some_and(|end| end == "svg"));
    // What lies in a plane is plotted there; the rest is seen as a page first shows it.
    let panels = match still {
        Some(_) => picture::plot(&compiled.knowledge, &args.kind, subject).map_err(drawn)?,
        None => None,
    };
    if let (Some(path), Some(panels)) = (still, &panels) {
        write_whole(path, picture::plot::svg(panels).as_bytes())?;
        say(&format!("wrote {}", path.display()));
        if args.glb.is_none() {
            return Ok(());
        }
    }
    let recording = picture(&compiled.knowledge, &args.kind, subject).map_err(drawn)?;
    match (still, &args.output) {
        (Some(path), _) if panels.is_none() => {
            let text = view::svg(&recording, view::telling_moment(&recording), STILL);
            write_whole(path, text.as_bytes())?;
            say(&format!("wrote {}", path.display()));
        }
        (None, Some(path)) => {
            write_whole(path, view::html(&recording).as_bytes())?;
            say(&format!("wrote {}; open it in a browser", path.display()));
        }
        _ => {}
    }
    if let Some(path) = &args.glb {
        write_whole(path, &view::glb(&recording))?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}
