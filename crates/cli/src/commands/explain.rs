//! `robotc explain`: what a diagnostic code means, or why artefacts are computed.

use std::path::Path;

use clap::Args;
use robotc_core::diag::{CODES, explain, nearest};
use robotc_kb::Knowledge;
use robotc_kb::explain::Fate;

use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, print};
use crate::settings::Settings;

/// Explain a diagnostic code, or why each artefact of a specification was or will be computed
#[derive(Args)]
#[command(
    after_help = "Examples:\n  robotc explain R0102\n  robotc explain\n  robotc explain mug.task.toml\n  \
    robotc explain mug.task.toml grasp_set"
)]
pub(crate) struct Explain {
    /// A code such as R0102, or a `*.robot.toml` or `*.task.toml` file; without it all codes are listed
    what: Option<String>,
    /// With a file: only artefacts whose kind or subject contains this
    filter: Option<String>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    store: StoreArgs,
}

pub(crate) fn run(args: &Explain) -> Outcome {
    match args.what.as_deref() {
        None => {
            for info in CODES {
                print(&format!("{}  {}", info.code, info.title));
            }
            Ok(())
        }
        Some(file) if crate::input::kind_of(Path::new(file)).is_some() => {
            artefacts(Path::new(file), args.filter.as_deref().unwrap_or_default(), args)
        }
        Some(code) => diagnostic(code),
    }
}

fn diagnostic(code: &str) -> Outcome {
    match explain(code) {
        Some(info) => {
            print(&format!("{}: {}\n\n{}", info.code, info.title, info.text));
            Ok(())
        }
        None => {
            let hint = nearest(code, CODES.iter().map(|info| info.code))
                .map_or(String::new(), |near| format!("; did you mean {near}?"));
            Err(Failure::Input(format!("there is no diagnostic code {code}{hint}")))
        }
    }
}

fn artefacts(file: &Path, filter: &str, args: &Explain) -> Outcome {
    let graph = knowledge::plan(&crate::input::project(file, &args.settings)?)?;
    let known = Knowledge::resolve(&graph, &args.store.open()?)?;
    let fates = robotc_kb::explain::explain(&known)?;
    for (node, fate) in graph.nodes().iter().zip(&fates) {
        let title = node.title();
        if !title.contains(filter) {
            continue;
        }
        print(&match fate {
            Fate::Reused(key, reason) => {
                format!("{title}: there, key {}; computed because: {reason}", key.short())
            }
            Fate::Computed(reason) => format!("{title}: will be computed: {reason}"),
            Fate::Waits(input) => format!(
                "{title}: waits for {}, and is computed unless that comes out as it was",
                graph.node(*input).title()
            ),
        });
    }
    Ok(())
}
