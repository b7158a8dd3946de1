//! What reaches the terminal: rendered diagnostics, errors, and the exit code.

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use robotc_core::{Diagnostic, Diagnostics, Severity, Sources};

/// Why a command did not do its job.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input is wrong and the diagnostics that say how are printed already.
    Reported,
    /// The input is wrong.
    Input(String),
    /// The machine failed: a disk, a permission, a missing program.
    Environment(String),
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::Environment(error.to_string())
    }
}

/// Result of a command.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

/// Prints what is left to print and gives the exit code.
pub(crate) fn exit_code(outcome: Outcome) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Reported) => ExitCode::from(1),
        Err(Failure::Input(message)) => {
            say(&format!("error: {message}"));
            ExitCode::from(1)
        }
        Err(Failure::Environment(message)) => {
            say(&format!("error: {message}"));
            ExitCode::from(2)
        }
    }
}

/// Sets the size of the thread pool that compiling uses.
pub(crate) fn configure_threads(threads: Option<usize>) -> Outcome {
    match threads {
        None => Ok(()),
        Some(0) => Err(Failure::Input("--threads needs at least 1".into())),
        Some(n) => rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build_global()
            .map_err(|e| Failure::Environment(e.to_string())),
    }
}

/// Writes a line to standard output. A reader that went away (`robotc ... | head`) is not an error.
pub(crate) fn print(line: &str) {
    let _ = writeln!(std::io::stdout().lock(), "{line}");
}

/// Writes text without a line end of its own to standard output.
pub(crate) fn print_text(text: &str) {
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}

/// Writes a line to standard error: messages for people, not results.
pub(crate) fn say(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Says which keys of a document were ignored.
pub(crate) fn warn_of_unknown_keys(file: &Path, text: &str, known: &impl serde::Serialize) {
    for key in robotc_planning::problem::unknown_keys(text, known) {
        say(&format!("warning: {}: {key}", file.display()));
    }
}

/// Renders all diagnostics to standard error, then a line with their number if there are any.
pub(crate) fn report(diagnostics: &Diagnostics, sources: &Sources) {
    let renderer = if std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    for diagnostic in diagnostics {
        say(&render(diagnostic, sources, &renderer));
        say("");
    }
    let (errors, warnings) = (diagnostics.count(Severity::Error), diagnostics.count(Severity::Warning));
    if errors + warnings > 0 {
        say(&format!("{}, {}", count(errors, "error"), count(warnings, "warning")));
    }
}

/// `1 error`, `2 errors`.
pub(crate) fn count(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// A number of bytes for people: `812 B`, `3.4 kB`.
pub(crate) fn size(bytes: u64) -> String {
    let (mut value, mut unit) = (bytes as f64, "B");
    for larger in ["kB", "MB", "GB"] {
        if value >= 1000.0 {
            (value, unit) = (value / 1000.0, larger);
        }
    }
    if unit == "B" { format!("{bytes} B") } else { format!("{value:.1} {unit}") }
}

fn render(diagnostic: &Diagnostic, sources: &Sources, renderer: &Renderer) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code);
    let mut group = match diagnostic.span {
        None => Group::with_title(title),
        Some(span) => {
            let text = sources.text(span.file);
            let end = span.end.min(text.len());
            let annotation =
                AnnotationKind::Primary.span(span.start.min(end)..end).label(diagnostic.label.as_str());
            title.element(Snippet::source(text).path(sources.path(span.file)).annotation(annotation))
        }
    };
    if let Some(expected) = &diagnostic.expected {
        group = group.element(Level::NOTE.message(format!("expected {expected}")));
    }
    if let Some(hint) = &diagnostic.hint {
        group = group.element(Level::HELP.message(hint.as_str()));
    }
    renderer.render(&[group])
}
