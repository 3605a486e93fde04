//! The program `pbif`: commands, progress, exit codes. The only module that prints.

mod args;
mod check;
mod cite;
mod clean;
mod compare;
mod curve;
mod detect;
mod explore;
mod export;
mod fault;
mod friction;
mod interrupts;
mod jobs;
mod list;
mod manual;
mod map;
mod merge;
mod new;
mod output;
mod plot;
mod progress;
mod show;
mod stored;
mod sweep;
mod systems;
mod terminal;
mod usage;
mod verify;

use std::error::Error as _;
use std::ffi::OsString;
use std::io::{self, IsTerminal as _, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use clap::Parser as _;

use crate::cancellation::Cancellation;
use crate::job::{JobError, Outcome};
use crate::run::check_names;
use crate::sweep_file::{Diagnostic, Report, Settings, Sweep, SweepFile};
use args::{Arguments, Command};
use output::OutputError;
use terminal::harmless;

/// Why a command was not carried out.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CommandError {
    /// Bad input.
    #[error("bad input")]
    Input(Report),
    /// The results cannot be written where they should go.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Something cannot be computed.
    #[error(transparent)]
    Job(JobError),
    /// A file of the run cannot be written or read.
    #[error(transparent)]
    Run(#[from] crate::run::RunError),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] crate::figure::FigureError),
    /// A page cannot be made.
    #[error(transparent)]
    Explore(#[from] crate::explore::ExploreError),
    /// The threads cannot be made.
    #[error("cannot start the threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Ctrl-C cannot be handled.
    #[error("cannot handle interrupts: {0}")]
    Interrupts(io::Error),
    /// Standard output cannot be written to.
    #[error("cannot write to standard output: {0}")]
    Print(#[from] io::Error),
    /// The command failed after it had written something.
    #[error("{error}")]
    Stopped {
        /// Why it failed.
        error: Box<CommandError>,
        /// A sentence of what there is.
        written: String,
    },
}

impl CommandError {
    /// Whether what was given is at fault, and nothing else.
    fn is_input(&self) -> bool {
        match self {
            Self::Input(_) => true,
            Self::Stopped { error, .. } => error.is_input(),
            _ => false,
        }
    }

    /// The same after something was written: `written` says what there is.
    fn after(self, written: String) -> Self {
        match self {
            Self::Stopped { .. } => self,
            error => Self::Stopped {
                error: Box::new(error),
                written,
            },
        }
    }
}

impl From<JobError> for CommandError {
    fn from(error: JobError) -> Self {
        match error {
            JobError::Refused(report) => Self::Input(report),
            JobError::Run(error) => Self::Run(error),
            error => Self::Job(error),
        }
    }
}

impl From<Diagnostic> for CommandError {
    fn from(found: Diagnostic) -> Self {
        Self::Input(found.into())
    }
}

impl From<Report> for CommandError {
    fn from(report: Report) -> Self {
        Self::Input(report)
    }
}

/// Reads the command line, does what it says, and gives the exit code: see [`run_with`].
pub fn run() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os()))
}

/// Does what the words of a command line say, the program's name first, and gives the status that a process ends with:
/// 0 done, 1 finished with something unresolved, 2 bad usage or input, 70 a fault of the program itself, 130
/// interrupted. It takes signals and the words of panics for itself, as the last thing that a process does may.
pub fn run_with(words: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and the version come this way too, with code 0. A closed pipe is no failure.
            let error = usage::with_tip(error);
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    interrupts::hear_of_full_files();
    let command = &arguments.command;
    let Some(ended) = fault::guard(command.target(), || dispatch(command)) else {
        return fault::STATUS;
    };
    match ended {
        Ok(outcome) => exit_code(outcome),
        // The reader of a pipe may stop early, as `head` does.
        Err(CommandError::Print(error)) if error.kind() == io::ErrorKind::BrokenPipe => 0,
        Err(error) => {
            tell_styled(&render(error, is_styled()));
            2
        }
    }
}

fn exit_code(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::Complete => 0,
        Outcome::Partial => 1,
        Outcome::Interrupted => 130,
    }
}

fn dispatch(command: &Command) -> Result<Outcome, CommandError> {
    match command {
        Command::Sweep { input, run } => {
            let spec = chosen(input, run.work.quiet)?;
            sweep::run(&spec, &input.name(), run)
        }
        Command::Check { input } => {
            let spec = prepare(read_settings(input, false)?, false)?;
            print(&check::text(&input.file, &spec)?)
        }
        Command::Compare { input, run } => {
            let spec = chosen(input, run.work.quiet)?;
            compare::run(&spec, &input.name(), run)
        }
        Command::Curve { run } => curve::run(run),
        Command::Detect { run } => detect::run(run),
        Command::Plot { run } => plot::run(run),
        Command::Explore { run } => explore::run(run),
        Command::List { run } => list::run(run),
        Command::Show { run } => show::run(run),
        Command::Clean { run } => clean::run(run),
        Command::Export { run } => export::run(run),
        Command::Completions { shell } => print(&manual::completions(*shell)),
        Command::Man { out } => manual::run(out.as_deref()),
        Command::Merge { run } => merge::run(run),
        Command::Cite { run } => cite::run(run.as_deref()),
        Command::Verify { run } => verify::run(run),
        Command::New { file, like } => print(&new::run(file.as_deref(), like.as_deref())?),
        Command::Systems { name: None, .. } => print(&systems::list()),
        Command::Systems {
            name: Some(name),
            drawn,
        } if drawn.plot => {
            let model = systems::find(name)?;
            friction::run(&model, drawn)
        }
        Command::Systems {
            name: Some(name), ..
        } => print(&systems::describe(name)?),
    }
}

/// Whether a sweep file is meant where a run or a sweep file may be given, be it there or not.
fn is_sweep_file(target: &Path) -> bool {
    let is_named_so = || target.extension().is_some_and(|ending| ending == "toml");
    target.is_file() || !target.exists() && is_named_so()
}

/// Reads and checks a sweep file, prepared before overrides are set; says on stderr what a user should know, unless it
/// is to be quiet.
fn load(
    path: &Path,
    prepare: &mut dyn FnMut(&mut SweepFile),
    overrides: &[stored::Override],
    quiet: bool,
) -> Result<Settings, Report> {
    let mut file = SweepFile::read(path)?;
    prepare(&mut file);
    for (option, setting) in overrides {
        file.set_all(option, [setting]);
    }
    let settings = file.validate()?;
    check_names(&settings)?;
    if !settings.warnings.is_empty() && !quiet {
        tell_styled(&settings.warnings.render(is_styled()));
    }
    Ok(settings)
}

/// The sweep file that was given.
fn read_settings(input: &args::SweepInput, quiet: bool) -> Result<Settings, Report> {
    load(
        &input.file,
        &mut |_| (),
        &stored::set(&input.overrides),
        quiet,
    )
}

/// The sweep that was given; says on stderr what was chosen for the program's part. `pbif check` has it on stdout.
fn chosen(input: &args::SweepInput, quiet: bool) -> Result<Sweep, Report> {
    let spec = prepare(read_settings(input, quiet)?, quiet)?;
    for line in &spec.settings.chosen {
        tell(quiet, &format!("{line}\n"));
    }
    Ok(spec)
}

/// How long a part of the preparation takes before it is told.
const PATIENCE: Duration = Duration::from_secs(1);

/// A sweep that is ready to run; says on stderr which part of its preparation takes longer than a second.
fn prepare(settings: Settings, quiet: bool) -> Result<Sweep, Report> {
    // The preparation runs on the threads of the process, which would otherwise be made when they are first asked for,
    // where there is no way to refuse. That they are there already has no source.
    if let Err(error) = rayon::ThreadPoolBuilder::new().build_global()
        && error.source().is_some()
    {
        let found = Diagnostic::new(format!("cannot start the threads: {error}"));
        return Err(found
            .remedy("a higher limit on processes (`ulimit -u`)")
            .into());
    }
    let (part, parts) = mpsc::channel::<String>();
    let told = move || {
        let mut words = String::new();
        loop {
            match parts.recv_timeout(PATIENCE) {
                Ok(next) => words = next,
                Err(RecvTimeoutError::Timeout) if words.is_empty() => {}
                Err(RecvTimeoutError::Timeout) => {
                    tell(quiet, &format!("{words}\n"));
                    words.clear();
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
    };
    // Where there is no thread to be had, nothing is told.
    let teller = std::thread::Builder::new().spawn(told);
    let tells = |words: &str| {
        let _ = part.send(words.to_owned());
    };
    let sweep = settings.prepare_telling(&Cancellation::new(), &tells);
    drop(part);
    // What is told of the sweep comes after it.
    let _ = teller.map(std::thread::JoinHandle::join);
    let sweep = sweep?;
    let found = sweep.passages_without_cells();
    if !found.is_empty() && !quiet {
        tell_styled(&found.render(is_styled()));
    }
    Ok(sweep)
}

/// Says something on stderr, unless it is to be quiet.
fn tell(quiet: bool, text: &str) {
    if !quiet {
        write_out(&harmless(text, false));
    }
}

/// Says what was drawn for the terminal at hand.
fn tell_styled(text: &str) {
    write_out(&harmless(text, is_styled()));
}

fn write_out(text: &str) {
    // Without a reader of stderr there is nobody to tell.
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Whether stderr takes colours.
fn is_styled() -> bool {
    let dumb = std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb");
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() && !dumb
}

fn print(text: &str) -> Result<Outcome, CommandError> {
    print_exact(&harmless(text, false))
}

/// Prints a text word for word, as another file; on a terminal as any other.
fn print_file(text: &str) -> Result<Outcome, CommandError> {
    if io::stdout().is_terminal() {
        print(text)
    } else {
        print_exact(text)
    }
}

fn print_exact(text: &str) -> Result<Outcome, CommandError> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    stdout.flush()?;
    Ok(Outcome::Complete)
}

/// Prints the results of a command whose files are in place. A reader who has gone changes nothing of how it ended.
fn conclude(text: &str, outcome: Outcome, folder: &Path) -> Result<Outcome, CommandError> {
    match print(text) {
        Ok(_) => Ok(outcome),
        Err(CommandError::Print(error)) if error.kind() == io::ErrorKind::BrokenPipe => Ok(outcome),
        Err(error) => Err(error.after(format!("the results are in {}", folder.display()))),
    }
}

fn render(error: CommandError, styled: bool) -> String {
    let (error, written) = match error {
        CommandError::Stopped { error, written } => (*error, written),
        error => (error, "nothing was run or written".to_owned()),
    };
    let report = match error {
        CommandError::Input(report) => report,
        CommandError::Output(error) => Diagnostic::new(error.to_string())
            .remedy("give another folder with `--out DIR`")
            .into(),
        CommandError::Run(error) => stored::diagnostic(&error).into(),
        error => Diagnostic::new(error.to_string()).into(),
    };
    let (findings, count) = (report.render(styled), report.count());
    format!("{findings}{count}; {written}\n")
}

/// The threads that a command runs on (`None`: one a core), and what the first interrupt cancels. The second ends
/// the program at once.
fn interruptible(
    threads: Option<usize>,
) -> Result<(rayon::ThreadPool, Cancellation), CommandError> {
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()?;
    let cancellation = Cancellation::new();
    interrupts::cancel(&cancellation).map_err(CommandError::Interrupts)?;
    Ok((threads, cancellation))
}
