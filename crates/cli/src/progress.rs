//! Progress of long work on standard error: a line that is rewritten on a terminal, a line a step elsewhere.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Shows how far a list of named steps has come, with rate and time left.
pub(crate) struct Progress {
    terminal: bool,
    last_drawn: Option<Instant>,
    step: Option<(String, Instant)>,
}

impl Progress {
    /// Time between two drawings of the line: short enough to feel live, long enough to cost nothing.
    const REDRAW: Duration = Duration::from_millis(100);

    pub(crate) fn new() -> Self {
        Self { terminal: std::io::stderr().is_terminal(), last_drawn: None, step: None }
    }

    /// `step` is `fraction` (0 to 1) done. A step that was not seen before starts now.
    pub(crate) fn update(&mut self, step: &str, fraction: f64) {
        if self.step.as_ref().is_none_or(|(name, _)| name != step) {
            self.step = Some((step.to_owned(), Instant::now()));
            self.last_drawn = None;
        }
        let due = self.last_drawn.is_none_or(|at| at.elapsed() >= Self::REDRAW);
        if self.terminal && due {
            self.last_drawn = Some(Instant::now());
            let left = self.step.as_ref().map_or(String::new(), |(_, start)| time_left(*start, fraction));
            let filled = (fraction.clamp(0.0, 1.0) * 24.0) as usize;
            let bar = format!("{}{}", "=".repeat(filled), " ".repeat(24 - filled));
            let _ = write!(std::io::stderr(), "\r\x1b[2K[{bar}] {:3.0}% {step}{left}", fraction * 100.0);
        }
    }

    /// Ends a step with a line that stays.
    pub(crate) fn finish(&mut self, line: &str) {
        self.clear();
        crate::output::say(line);
        self.step = None;
    }

    /// Removes the line, so that other text can be written.
    pub(crate) fn clear(&mut self) {
        if self.terminal {
            let _ = write!(std::io::stderr(), "\r\x1b[2K");
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear();
    }
}

fn time_left(start: Instant, fraction: f64) -> String {
    let spent = start.elapsed().as_secs_f64();
    if spent < 0.5 || fraction <= 0.01 {
        return String::new();
    }
    format!(", {:.0} s left", (spent / fraction - spent).max(0.0))
}
