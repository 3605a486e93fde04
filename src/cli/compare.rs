//! `pbif compare`: solves by every method at the values of `figures.at`, and writes tables and figures of how they
//! agree. What is solved is kept as it comes, so that a comparison that was stopped can be gone on with.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use comfy_table::{Table, presets};

use super::args::CompareArguments;
use super::output::OutputFolder;
use super::sweep::progress::Progress;
use super::{CommandError, Outcome, warnings};
use crate::cancellation::Cancellation;
use crate::compare::{self, CompareError, CompareObserver, Solved, Task};
use crate::figure::{Figures, write_figures};
use crate::run::{CompareFolder, ComparedRun, Journal, RunError, compare_tables, format_number};
use crate::sweep_file::{Diagnostic, MethodKind, Sweep};

/// Compares, writes, draws and prints.
///
/// # Errors
/// [`CommandError`] when the results cannot be written or a method refuses; failed solves are data.
pub(super) fn run(
    spec: &Sweep,
    name: &str,
    arguments: &CompareArguments,
) -> Result<Outcome, CommandError> {
    if spec.settings.figures.at.is_empty() {
        let diagnostic = Diagnostic::new("`figures.at` is empty: there is no value to compare at")
            .remedy("leave `figures.at` out, or give values of the swept parameter");
        return Err(CommandError::Input(diagnostic.into()));
    }
    let default = || Path::new("output").join(format!("{name}-compare"));
    let path = arguments.out.clone().unwrap_or_else(default);
    let output = OutputFolder::prepare(&path)?;
    let of = described(spec)?;
    let going_on = arguments.resume && CompareFolder::has_journal(output.path());
    if arguments.resume && !going_on && CompareFolder::is_complete(output.path(), &of)? {
        let text = format!(
            "the comparison in {} is complete: nothing was solved\n",
            output.path().display()
        );
        return super::print(&text);
    }
    // What would be refused is refused before hours of work, and another process is kept away.
    let folder = CompareFolder::new(output.path())?;
    let journal = match going_on {
        true => folder.go_on(&of)?,
        false => folder.begin(&of)?,
    };
    let (threads, cancellation) = super::interruptible(arguments.work.threads)?;
    let progress = Progress::new(2 + 3 * spec.settings.figures.at.len(), arguments.work.quiet);
    let keeper = Keeper {
        journal,
        progress: &progress,
        done: 0,
        goes_on: going_on,
        began: Instant::now(),
    };
    let home = output.path();
    threads.install(|| carry_out((spec, &of), (home, folder), keeper, &cancellation))
}

/// What the comparison is made of beside the program, as TOML: the sweep, the values, and the settings of every method.
fn described(spec: &Sweep) -> Result<String, RunError> {
    let mut whole: toml::Table = spec.to_toml().parse()?;
    let mut compared = toml::Table::new();
    let figures = whole.get("figures").and_then(|figures| figures.get("at"));
    compared.extend(figures.map(|at| ("at".to_owned(), at.clone())));
    for kind in MethodKind::ALL {
        let mut settings = spec.settings.clone();
        settings.method.kind = kind;
        let mut of: toml::Table = settings.to_toml().parse()?;
        compared.extend(of.remove("method").map(|of| (kind.name().to_owned(), of)));
    }
    whole.insert("compare".to_owned(), compared.into());
    Ok(whole.to_string())
}

/// Shows how far a comparison is, and keeps what is solved.
struct Keeper<'a> {
    journal: Journal,
    progress: &'a Progress,
    /// Solves that were taken from the journal or added to it.
    done: usize,
    /// Whether there was a journal before.
    goes_on: bool,
    began: Instant,
}

/// What took less, and has no value by all methods yet, is not worth a file that somebody has to remove.
const WORTH_KEEPING: Duration = Duration::from_secs(10);

type Failure = Box<dyn std::error::Error + Send + Sync>;

impl CompareObserver for Keeper<'_> {
    fn step(&mut self, step: &compare::Progress) {
        self.progress.step(&step.next, step.done, step.total);
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

impl Keeper<'_> {
    /// Whether nothing is lost that somebody would miss.
    fn has_hardly_begun(&self) -> bool {
        let solves = self.done.max(self.journal.solves());
        !self.goes_on && (solves == 0 || self.began.elapsed() < WORTH_KEEPING)
    }

    /// What there is of a comparison that did not come to its end.
    fn kept(&self, folder: &Path) -> String {
        let folder = folder.display();
        match self.done.max(self.journal.solves()) {
            0 => format!("nothing was solved; {folder} holds no results of it"),
            1 => format!(
                "1 solve that was done is kept in {folder}, and `--resume` goes on from there"
            ),
            solves => format!(
                "{solves} solves that were done are kept in {folder}, and `--resume` goes on from there"
            ),
        }
    }
}

fn carry_out(
    (spec, of): (&Sweep, &str),
    (home, folder): (&Path, CompareFolder),
    mut keeper: Keeper<'_>,
    cancellation: &Cancellation,
) -> Result<Outcome, CommandError> {
    let mut at: Vec<f64> = Vec::new();
    for &value in &spec.settings.figures.at {
        if !at.contains(&value) {
            at.push(value);
        }
    }
    let task = Task {
        problem: &spec.problem,
        at: &at,
        generator: spec.settings.method.generator.clone(),
        sgcm: spec.settings.method.sgcm.clone(),
        monte_carlo: spec.settings.method.monte_carlo.clone(),
    };
    let progress = keeper.progress;
    let compared = compare::compare(&task, cancellation, &mut keeper);
    let comparison = match compared {
        Ok(comparison) => comparison,
        Err(CompareError::Interrupted) => {
            progress.finish();
            let kept = match keeper.has_hardly_begun() {
                true => {
                    folder.give_up();
                    "nothing was written".to_owned()
                }
                false => keeper.kept(home),
            };
            super::print(&format!("interrupted: {kept}\n"))?;
            return Ok(Outcome::Interrupted);
        }
        Err(error) => return Err(CommandError::from(error).after(keeper.kept(home))),
    };
    let resolved = spec.to_toml();
    let run = ComparedRun {
        comparison: &comparison,
        sweep: &resolved,
        of,
        threads: rayon::current_num_threads(),
    };
    let written = write(spec, &run, folder, progress);
    let files = written.map_err(|error| error.after(keeper.kept(home)))?;
    progress.finish();
    progress.warn(&warnings::of_comparison(run.family(), &comparison));
    let mut text = text(&run, &files);
    let outcome = match comparison.is_complete() && comparison.agrees() {
        _ if comparison.interrupted => {
            text += &format!("\ninterrupted: {}\n", keeper.kept(home));
            Outcome::Interrupted
        }
        true => Outcome::Complete,
        false => Outcome::Partial,
    };
    super::conclude(&text, outcome, home)
}

/// Writes tables and figures, and returns the files.
fn write(
    spec: &Sweep,
    run: &ComparedRun<'_>,
    folder: CompareFolder,
    progress: &Progress,
) -> Result<Vec<PathBuf>, CommandError> {
    folder.write(run)?;
    progress.say("drawing");
    let figures = Figures::of_comparison(run.comparison, &spec.settings.title)
        .with_style(&spec.settings.figures.style)
        .draw_all()?;
    write_figures(&figures, &spec.settings.figures.formats, &folder.figures())?;
    Ok(folder.take_place(run.comparison.interrupted)?)
}

/// The tables, the verdict and the files.
fn text(run: &ComparedRun<'_>, files: &[PathBuf]) -> String {
    let mut text = String::new();
    for table in compare_tables(run) {
        let mut lines = Table::new();
        lines
            .load_style(presets::NOTHING)
            .set_header(&table.header)
            .add_rows(&table.rows);
        text += &format!("{}\n", table.caption);
        for line in lines.to_string().lines() {
            text += &format!("{}\n", line.trim_end());
        }
        text.push('\n');
    }
    let (bins, beyond) = run.comparison.bins();
    let verdict = match run.comparison.agrees() {
        _ if bins == 0 => "generator and Monte Carlo have no value in common",
        true => "generator and Monte Carlo agree",
        false => "generator and Monte Carlo DISAGREE beyond their stated uncertainties",
    };
    text += &format!("{verdict}: {beyond} of {bins} marginal bins are beyond all errors\n");
    for value in &run.comparison.values {
        for observable in value.disagreements() {
            let name = observable.name(run.family());
            let at = format_number(value.value);
            text += &format!("  {} = {at}: {name}\n", run.family().parameter());
        }
    }
    text += "\nfiles\n";
    for file in files {
        text += &format!("  {}\n", file.display());
    }
    text
}
