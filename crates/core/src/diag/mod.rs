//! Diagnostics: what is wrong with an input, where, what was expected and what to do about it.
//!
//! Parsing never fails; it collects [`Diagnostics`] and gives a best-effort value. Rendering is the caller's.

mod codes;
mod nearest;
mod sources;

pub use codes::{CODES, CodeInfo, explain};
pub use nearest::nearest;
pub use sources::{FileId, LineColumn, Sources, Span};

use std::path::Path;

use crate::system::ReadError;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The input is usable; something was assumed or repaired.
    Warning,
    /// The input cannot be used.
    Error,
}

/// One finding about an input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Stable code, such as `R0102`, listed in [`CODES`].
    pub code: &'static str,
    /// Error or warning.
    pub severity: Severity,
    /// One sentence, lower case, no full stop.
    pub message: String,
    /// Where, if the finding has a place in a file.
    pub span: Option<Span>,
    /// A few words shown under the place.
    pub label: String,
    /// What would have been right.
    pub expected: Option<String>,
    /// What the user can do.
    pub hint: Option<String>,
}

impl Diagnostic {
    /// An error with this code and message.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(code, Severity::Error, message)
    }

    /// A warning with this code and message.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(code, Severity::Warning, message)
    }

    /// The error that a file could not be read.
    pub fn unreadable(path: &Path, error: &ReadError) -> Self {
        let path = path.display();
        match error {
            ReadError::NotFound => Self::error("R0001", format!("there is no file {path}")),
            ReadError::Unreadable(why) => Self::error("R0002", format!("{path} cannot be read: {why}")),
        }
    }

    fn new(code: &'static str, severity: Severity, message: impl Into<String>) -> Self {
        debug_assert!(explain(code).is_some(), "diagnostic code {code} is not registered");
        Self {
            code,
            severity,
            message: message.into(),
            span: None,
            label: String::new(),
            expected: None,
            hint: None,
        }
    }

    /// Places the finding, with a few words for the place.
    pub fn at(mut self, span: Span, label: impl Into<String>) -> Self {
        self.span = Some(span);
        self.label = label.into();
        self
    }

    /// Says what would have been right.
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// Says what the user can do.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// Findings in the order they were made.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagnostics {
    items: Vec<Diagnostic>,
}

impl Diagnostics {
    /// No findings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a finding.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.items.push(diagnostic);
    }

    /// Adds all findings of `other`.
    pub fn extend(&mut self, other: Diagnostics) {
        self.items.extend(other.items);
    }

    /// Whether an error was found.
    pub fn has_errors(&self) -> bool {
        self.items.iter().any(|d| d.severity == Severity::Error)
    }

    /// Number of findings of this severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.items.iter().filter(|d| d.severity == severity).count()
    }

    /// The findings, in order.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.items.iter()
    }

    /// Whether nothing was found.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// `path:line:column: severity[code]: message`, one finding a line: for logs and tests.
    pub fn to_plain_text(&self, sources: &Sources) -> String {
        let mut text = String::new();
        for d in &self.items {
            let severity = match d.severity {
                Severity::Warning => "warning",
                Severity::Error => "error",
            };
            if let Some(span) = d.span {
                let at = sources.line_column(span);
                text += &format!("{}:{}:{}: ", sources.path(span.file), at.line, at.column);
            }
            text += &format!("{severity}[{}]: {}", d.code, d.message);
            if let Some(expected) = &d.expected {
                text += &format!("; expected {expected}");
            }
            if let Some(hint) = &d.hint {
                text += &format!("; hint: {hint}");
            }
            text.push('\n');
        }
        text
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;
    fn into_iter(self) -> Self::IntoIter {
        self.items.iter()
    }
}

impl IntoIterator for Diagnostics {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;
    fn into_iter(self) -> Self::IntoIter {
        self.items.into_iter()
    }
}
