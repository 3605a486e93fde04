//! Progress on stderr: a bar with the time left on a terminal, a line a point elsewhere, nothing when quiet.

use std::io::{IsTerminal as _, Write as _};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::continuation::{Point, Subject};

/// Shows how far a sweep is.
pub(in crate::cli) struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Progress {
    pub(in crate::cli) fn new(points: usize, quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(points as u64);
            let template = "{bar:30} {pos}/{len}, {elapsed} gone, {eta} left  {msg}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(250));
            bar
        });
        Self { bar, quiet }
    }

    /// What the program is doing.
    pub(in crate::cli) fn say(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.set_message(text.to_owned()),
            None => self.line(text),
        }
    }

    /// A point is done.
    pub(in crate::cli) fn point(
        &self,
        subject: &Subject,
        point: &Point,
        done: usize,
        remaining: usize,
    ) {
        let family = &subject.family;
        let mut text = format!("{} = {:.6}", family.parameter(), point.value);
        if point.detections.is_empty() {
            text += &format!(": {}", point.report.status.word());
        }
        for (&observable, detection) in subject.observables.iter().zip(&point.detections) {
            let name = observable.name(family);
            text += &format!("  {name}: {}", detection.signature);
        }
        match &self.bar {
            Some(bar) => {
                bar.set_length((done + remaining) as u64);
                bar.set_position(done as u64);
                bar.set_message(text);
            }
            None => self.line(&format!("{done:4} of {:4}  {text}", done + remaining)),
        }
    }

    /// So many of those that are wanted are done.
    pub(in crate::cli) fn count(&self, text: &str, done: usize, wanted: usize) {
        match &self.bar {
            Some(bar) => {
                bar.set_length(wanted as u64);
                bar.set_position(done as u64);
                bar.set_message(text.to_owned());
            }
            None => self.line(&format!("{done:4} of {wanted:4}  {text}")),
        }
    }

    /// A step of something else than a sweep begins.
    pub(in crate::cli) fn step(&self, text: &str, done: usize, total: usize) {
        match &self.bar {
            Some(bar) => {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
                bar.set_message(text.to_owned());
            }
            None => self.line(&format!("{:4} of {total:4}  {text}", done + 1)),
        }
    }

    /// Takes the bar away.
    pub(in crate::cli) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// Warnings of a finished run.
    pub(in crate::cli) fn warn(&self, warnings: &[String]) {
        for warning in warnings {
            self.line(&format!("warning: {warning}"));
        }
    }

    fn line(&self, text: &str) {
        if !self.quiet {
            // Without a reader of stderr there is nobody to tell.
            let _ = writeln!(std::io::stderr().lock(), "{text}");
        }
    }
}
