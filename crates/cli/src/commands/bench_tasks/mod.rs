//! Benches over a task: grasps with destinations, doors opened from everywhere, arms on wheels, weights of the metric.

mod bispace;
mod caging;
mod clock;
mod grasps;
mod page;
mod placement;
mod table;
mod weights;

use std::path::PathBuf;

use clap::Args;
use robotc_kb::Project;
use robotc_runtime::Session;
use serde::Serialize;

pub(super) use bispace::{BiSpace, bispace};
pub(super) use caging::{Caging, caging};
pub(super) use grasps::{Grasps, grasps};
use page::Page;
pub(super) use placement::{Placement, placement};
use table::Table;
pub(super) use weights::{Weights, weights};

use super::compile::write_whole;
use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, print, say};
use crate::settings::Settings;

/// What all of them take.
#[derive(Args)]
struct TaskArgs {
    /// A `*.task.toml` file
    task: PathBuf,
    /// File for all figures
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// A page that shows them, as one HTML file
    #[arg(long, value_name = "FILE.html")]
    view: Option<PathBuf>,
    #[command(flatten)]
    store: StoreArgs,
}

/// The compiled task.
fn open(args: &TaskArgs) -> Outcome<Session> {
    let spec = crate::input::task(&args.task, &Settings::default())?;
    let graph = knowledge::plan(&Project::of_task(&spec))?;
    let compiled = knowledge::compile(&graph, &args.store.open()?)?;
    Session::open(&compiled.knowledge).map_err(|error| Failure::Input(error.to_string()))
}

/// Prints the table, and writes what was asked for.
fn publish(args: &TaskArgs, table: &Table, report: &impl Serialize, page: impl FnOnce() -> Page) -> Outcome {
    table.lines().iter().for_each(|line| print(line));
    if let Some(path) = &args.report {
        let text = serde_json::to_string_pretty(report).expect("plain values always have a JSON form");
        write_whole(path, (text + "\n").as_bytes())?;
        say(&format!("wrote {}", path.display()));
    }
    if let Some(path) = &args.view {
        write_whole(path, page().with_table(table).html().as_bytes())?;
        say(&format!("wrote {}; open it in a browser", path.display()));
    }
    Ok(())
}
