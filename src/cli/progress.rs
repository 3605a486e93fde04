//! Progress on stderr: a bar with the time left on a terminal, a line a point elsewhere, nothing when quiet.

use std::io::IsTerminal as _;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::tell;
use super::terminal::harmless;
use crate::job;

/// Shows how far a job is.
pub(super) struct Meter {
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Meter {
    /// Of so many solves; where nobody knows how many, there are lines alone.
    pub(super) fn new(planned: Option<usize>, quiet: bool) -> Self {
        let planned = planned.filter(|_| !quiet && std::io::stderr().is_terminal());
        let bar = planned.map(|planned| {
            let bar = ProgressBar::new(planned as u64);
            let template = "{bar:30} {pos}/{len}, {elapsed} gone, {eta} left  {msg}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(250));
            bar
        });
        Self { bar, quiet }
    }

    /// A step of a job.
    pub(super) fn show(&self, step: &job::Progress<'_>) {
        use job::Progress::{Done, Next, Says, Solved};
        let (words, places) = match *step {
            Says(words) => (words, None),
            Done {
                words,
                done,
                wanted,
            } => (words, Some((done, done, wanted))),
            Next {
                words,
                done,
                wanted,
            } => (words, Some((done, done + 1, wanted))),
            // Is told in words besides.
            Solved(_) => return,
        };
        match (&self.bar, places) {
            (Some(bar), places) => {
                if let Some((done, _, wanted)) = places {
                    bar.set_length(wanted as u64);
                    bar.set_position(done as u64);
                }
                bar.set_message(harmless(words, false));
            }
            (None, Some((_, number, wanted))) => {
                self.line(&format!("{number:4} of {wanted:4}  {words}"));
            }
            (None, None) => self.line(words),
        }
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// Warnings of a finished job.
    pub(super) fn warn(&self, warnings: &[String]) {
        for warning in warnings {
            self.line(&format!("warning: {warning}"));
        }
    }

    fn line(&self, text: &str) {
        if !self.quiet {
            tell(false, &format!("{text}\n"));
        }
    }
}
