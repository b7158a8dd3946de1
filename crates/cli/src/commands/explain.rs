//! `robotc explain`: what a diagnostic code means.

use clap::Args;
use robotc_core::diag::{CODES, explain, nearest};

use crate::output::{Failure, Outcome, print};

/// Explain a diagnostic code, or list all of them
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc explain R0102\n  robotc explain")]
pub(crate) struct Explain {
    /// The code, such as R0102; without it all codes are listed
    code: Option<String>,
}

pub(crate) fn run(args: &Explain) -> Outcome {
    let Some(code) = &args.code else {
        for info in CODES {
            print(&format!("{}  {}", info.code, info.title));
        }
        return Ok(());
    };
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
