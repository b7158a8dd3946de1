//! `cargo xtask test`: everything continuous integration checks, in the order that fails fastest.

use std::time::Instant;

use crate::workspace::execute;

/// Runs all checks; stops at the first that fails.
pub(crate) fn run(_args: &[String]) -> anyhow::Result<()> {
    let steps: &[(&str, &[&str])] = &[
        ("format", &["cargo", "fmt", "--all", "--check"]),
        ("lints", &["cargo", "clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"]),
        // Alone, since other crates of the workspace switch the generators on.
        (
            "lints of the run time",
            &["cargo", "clippy", "-p", "robotc-embedded", "--locked", "--", "-D", "warnings"],
        ),
        ("tests", &["cargo", "test", "--workspace", "--locked"]),
    ];
    let mut times = Vec::new();
    crate::tidy::run(&[])?;
    crate::browser::prepare();
    for (name, command) in steps {
        let start = Instant::now();
        println!("== {name}: {}", command.join(" "));
        execute(command)?;
        times.push(format!("{name} {:.0} s", start.elapsed().as_secs_f64()));
    }
    let start = Instant::now();
    println!("== python");
    crate::python::run(&[])?;
    times.push(format!("python {:.0} s", start.elapsed().as_secs_f64()));
    println!("== all passed: {}", times.join(", "));
    Ok(())
}
