//! A comparison: all methods side by side at the values of `figures.at`.

use std::time::{Duration, Instant};

use super::{Context, Job, JobError, Outcome, Progress};
use crate::compare::{self, CompareError, CompareObserver, Comparison, Solved, Task};
use crate::figure::{Figure, Figures};
use crate::run::{
    ComparedRun, JobFolder, Journal, Layout, RunError, check_names_compared, compare_files,
};
use crate::sweep_file::{Diagnostic, MethodKind, Report, Sweep};

/// What took less, and has no value by all methods yet, is not worth a file that somebody has to remove.
const WORTH_KEEPING: Duration = Duration::from_secs(10);

/// A comparison of methods.
pub struct CompareJob<'a> {
    sweep: &'a Sweep,
    made_of: String,
    resolved: String,
    /// Solves that are stored, of a comparison that is worth keeping.
    kept: usize,
}

impl<'a> CompareJob<'a> {
    /// The comparison at the values of `figures.at`.
    ///
    /// # Errors
    /// A report where there are none, or two columns of a table would have one name.
    pub fn new(sweep: &'a Sweep) -> Result<Self, Report> {
        check_names_compared(&sweep.settings)?;
        if sweep.settings.figures.at.is_empty() {
            let found = Diagnostic::new("`figures.at` is empty: there is no value to compare at")
                .remedy("leave `figures.at` out, or give values of the swept parameter");
            return Err(found.into());
        }
        let axes = sweep.problem.space().axes().iter();
        let counted = axes
            .clone()
            .position(|axis| axis.is_closed() && !axis.is_modes());
        if let Some(axis) = counted {
            let title = format!(
                "`{}` closes on itself, and the method of the file has no harmonics for the generator",
                sweep.problem.family().axis(axis)
            );
            let remedy = "set `method.kind = \"generator\"`: the others are compared with it whatever is set";
            return Err(Diagnostic::new(title).remedy(remedy).into());
        }
        Ok(Self {
            made_of: describe(sweep),
            resolved: sweep.to_toml(),
            sweep,
            kept: 0,
        })
    }

    /// What was found, with what its tables need beside it.
    pub(crate) fn run<'r>(&'r self, found: &'r Comparison) -> ComparedRun<'r> {
        ComparedRun {
            comparison: found,
            sweep: &self.resolved,
            of: &self.made_of,
            threads: rayon::current_num_threads(),
        }
    }
}

/// The sweep, the values, and the settings of every method, as TOML.
fn describe(sweep: &Sweep) -> String {
    let table = |text: String| text.parse::<toml::Table>().unwrap_or_default();
    let mut whole = table(sweep.to_toml());
    let mut compared = toml::Table::new();
    let figures = whole.get("figures").and_then(|figures| figures.get("at"));
    compared.extend(figures.map(|at| ("at".to_owned(), at.clone())));
    for kind in MethodKind::ALL {
        let mut settings = sweep.settings.clone();
        settings.method.kind = kind;
        let mut of = table(settings.to_toml());
        compared.extend(of.remove("method").map(|of| (kind.name().to_owned(), of)));
    }
    whole.insert("compare".to_owned(), compared.into());
    whole.to_string()
}

impl Job for CompareJob<'_> {
    type Found = Comparison;
    const LAYOUT: Layout = Layout::COMPARISON;

    fn sweep(&self) -> &Sweep {
        self.sweep
    }

    fn made_of(&self) -> String {
        self.made_of.clone()
    }

    fn solve(
        &mut self,
        folder: &JobFolder,
        goes_on: bool,
        context: &Context<'_>,
    ) -> Result<Option<Comparison>, JobError> {
        let mut keeper = Keeper {
            journal: folder.journal(&self.made_of, goes_on)?,
            context,
            done: 0,
        };
        let settings = &self.sweep.settings;
        let mut at: Vec<f64> = Vec::new();
        for &value in &settings.figures.at {
            if !at.contains(&value) {
                at.push(value);
            }
        }
        let task = Task {
            problem: &self.sweep.problem,
            at: &at,
            generator: settings.method.generator.clone(),
            sgcm: settings.method.sgcm.clone(),
            monte_carlo: settings.method.monte_carlo.clone(),
        };
        let began = Instant::now();
        let found = compare::compare(&task, context.cancellation, &mut keeper);
        self.kept = keeper.done.max(keeper.journal.solves());
        match found {
            Err(CompareError::Interrupted) => {
                if !goes_on && began.elapsed() < WORTH_KEEPING {
                    self.kept = 0;
                }
                Ok(None)
            }
            found => Ok(Some(found?)),
        }
    }

    fn kept(&self) -> usize {
        self.kept
    }

    fn outcome(&self, found: &Comparison) -> Outcome {
        Outcome::of(found.interrupted, found.is_complete() && found.agrees())
    }

    fn files(&self, found: &Comparison, _: f64) -> Result<Vec<(String, String)>, RunError> {
        compare_files(&self.run(found))
    }

    fn figures(&self, found: &Comparison, context: &Context<'_>) -> Vec<Figure> {
        context.say("drawing");
        let settings = &self.sweep.settings;
        Figures::of_comparison(found, &settings.title)
            .with_style(&settings.figures.style)
            .draw_all()
    }
}

impl From<CompareError> for JobError {
    fn from(error: CompareError) -> Self {
        match error {
            // What is solved could not be kept.
            CompareError::Observer(error) => match error.downcast::<RunError>() {
                Ok(error) => Self::Run(*error),
                Err(error) => Self::Compare(CompareError::Observer(error)),
            },
            error => Self::Compare(error),
        }
    }
}

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Tells how far a comparison is, and keeps what is solved.
struct Keeper<'a> {
    journal: Journal,
    context: &'a Context<'a>,
    /// Solves that were taken from the journal or added to it.
    done: usize,
}

impl CompareObserver for Keeper<'_> {
    fn step(&mut self, step: &compare::CompareStep) {
        (self.context.observer)(&Progress::Next {
            words: &step.next,
            done: step.done,
            wanted: step.total,
        });
    }

    fn known(&mut self) -> Result<Option<Vec<Solved>>, Failure> {
        let known = self.journal.known(&self.done.to_string())?;
        self.done += usize::from(known.is_some());
        Ok(known)
    }

    fn keep(&mut self, solved: &[Solved]) -> Result<(), Failure> {
        self.journal.keep(&self.done.to_string(), &solved)?;
        self.done += 1;
        Ok(())
    }
}
