//! Findings that a file repeats many times, told once.

use crate::diag::{Diagnostic, Diagnostics, Span};

/// Places with the same fault. A file with fifty massless links deserves one warning, not fifty.
#[derive(Debug, Default)]
pub(super) struct Grouped {
    first: Option<(Span, String)>,
    count: usize,
}

impl Grouped {
    pub(super) fn add(&mut self, span: Span, name: &str) {
        self.first.get_or_insert_with(|| (span, name.to_owned()));
        self.count += 1;
    }

    /// Pushes what `tell` makes of the count and the first name, placed at the first; nothing if there were none.
    pub(super) fn finish(self, found: &mut Diagnostics, tell: impl FnOnce(usize, &str) -> Diagnostic) {
        if let Some((span, name)) = self.first {
            let label = if self.count == 1 { "here" } else { "first of several" };
            found.push(tell(self.count, &name).at(span, label));
        }
    }
}

/// `` (and 4 others)``, or nothing when the first is the only one.
pub(super) fn and_others(count: usize) -> String {
    match count {
        0 | 1 => String::new(),
        2 => " (and one other)".to_owned(),
        _ => format!(" (and {} others)", count - 1),
    }
}
