//! `pbif explore`: the page of a stored run, or a live one of a sweep file.

mod place;

use std::path::{Path, PathBuf};

use super::args::{ExploreArguments, SweepInput};
use super::progress::Meter;
use super::stored::{Stored, set};
use super::{CommandError, Outcome, tell};
use crate::explore::{LiveServer, StoredPage};
use crate::job;
use crate::run::{CURVES, StoredPlane, StoredPlaneContent, write_anywhere};
use crate::sweep_file::{Diagnostic, SweepFile};

/// Densities of a map between two words of how many are solved.
const EVERY: usize = 20;

/// Writes the page of a run and prints where it is; or serves that of a sweep file until it is interrupted.
///
/// # Errors
/// [`CommandError`] when the run or the sweep file cannot be read, or the page not be written or served.
pub(super) fn run(arguments: &ExploreArguments) -> Result<Outcome, CommandError> {
    if super::is_sweep_file(&arguments.target) {
        return serve(arguments);
    }
    if arguments.port.is_some() {
        return Err(refusal(
            "`--port` is for a sweep file: the page of a run is a file",
        ));
    }
    // Before anything is read or solved for it.
    place::check(&file_of(arguments), arguments.force)?;
    if let Some(stored) = StoredPlane::open(&arguments.target)? {
        return of_plane(&stored, arguments);
    }
    let stored = Stored::read(
        &arguments.target,
        &set(&arguments.overrides),
        &["detect", "locate"],
        arguments.quiet,
    )?;
    let outcome = write_page(&StoredPage::new(&stored.spec, &stored.result)?, arguments)?;
    super::print(&curves_of(&arguments.target))?;
    Ok(outcome)
}

/// How the curves of a run are looked at.
fn curves_of(run: &Path) -> String {
    let entries = std::fs::read_dir(run.join(CURVES)).into_iter().flatten();
    let mut folders: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    folders.retain(|folder| folder.join("curve.json").is_file());
    folders.sort();
    let line = |folder: &PathBuf| {
        let folder = folder.display();
        format!("its curves have a page of their own: pbif explore {folder}\n")
    };
    folders.iter().map(line).collect()
}

/// Writes the page of a map of regimes, or of curves, whose densities are solved.
fn of_plane(stored: &StoredPlane, arguments: &ExploreArguments) -> Result<Outcome, CommandError> {
    if !arguments.overrides.is_empty() {
        return Err(refusal(
            "`--set` is for a sweep file or the run of a sweep: what the page of a map or of curves shows stands in its tables",
        ));
    }
    let sweep = SweepFile::parse("plane.json", stored.resolved());
    let sweep = sweep.validate()?.fixed()?;
    let content = stored.content(&sweep.problem)?;
    let (threads, cancellation) = super::interruptible(None)?;
    let progress = Meter::new(Some(0), arguments.quiet);
    // Without a terminal every one would be a line.
    let count = |solved: usize, all: usize| {
        if solved.is_multiple_of(EVERY) || solved == all {
            progress.show(&job::Progress::Done {
                words: "densities",
                done: solved,
                wanted: all,
            });
        }
    };
    let page = threads.install(|| match &content {
        StoredPlaneContent::Map(map) => StoredPage::of_map(&sweep, map, &cancellation, &count),
        StoredPlaneContent::Curves(plane, tree, origin) => {
            let curves = (&**tree, origin.label.as_str());
            StoredPage::of_curves(&sweep, plane, curves, &cancellation, &count)
        }
    });
    progress.finish();
    if cancellation.is_cancelled() {
        super::print("interrupted: nothing was written\n")?;
        return Ok(Outcome::Interrupted);
    }
    write_page(&page?, arguments)
}

/// Writes a page where it is wanted, and says where that is.
fn write_page(page: &StoredPage, arguments: &ExploreArguments) -> Result<Outcome, CommandError> {
    let file = file_of(arguments);
    place::check(&file, arguments.force)?;
    write_anywhere(&file, page.html().as_bytes())?;
    if arguments.open {
        let file = file.canonicalize().unwrap_or_else(|_| file.clone());
        open(&file.to_string_lossy());
    }
    super::print(&text(page, &file))
}

/// The file of a run's page.
fn file_of(arguments: &ExploreArguments) -> PathBuf {
    let beside = || arguments.target.join("explorer.html");
    arguments.html.clone().unwrap_or_else(beside)
}

/// Where the page is, how large, and what packing did to the densities.
fn text(page: &StoredPage, file: &Path) -> String {
    let megabytes = page.html().len() as f64 / 1e6;
    let digits = page.joint_bits().map_or(String::new(), |bits| {
        format!(", square roots of joint densities kept to {bits} bits")
    });
    format!(
        "page\n  {} ({megabytes:.2} MB{digits})\nopen it in a browser: it needs no network\n",
        file.display()
    )
}

/// Serves the live page of a sweep file.
fn serve(arguments: &ExploreArguments) -> Result<Outcome, CommandError> {
    if arguments.html.is_some() || arguments.force {
        return Err(refusal(
            "`--html` and `--force` are for the folder of a run: `pbif sweep FILE` makes one",
        ));
    }
    let input = SweepInput {
        file: arguments.target.clone(),
        overrides: arguments.overrides.clone(),
    };
    let sweep = super::prepare(
        super::read_settings(&input, arguments.quiet)?,
        arguments.quiet,
    )?;
    let server = LiveServer::bind(&sweep, arguments.port.unwrap_or(0))?;
    let (_, cancellation) = super::interruptible(None)?;
    super::print(&format!("{}\n", server.address()))?;
    let words = "open this address in a browser of this machine; Ctrl-C ends\n";
    tell(arguments.quiet, words);
    if arguments.open {
        open(&server.address());
    }
    server.serve(&cancellation);
    Ok(Outcome::Complete)
}

/// Opens an address or a file with the program that the user has for it; the address is printed anyway.
fn open(address: &str) {
    let program = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(windows) {
        "explorer"
    } else {
        "xdg-open"
    };
    let quiet = std::process::Stdio::null;
    let mut command = std::process::Command::new(program);
    let started = command
        .arg(address)
        .stdin(quiet())
        .stdout(quiet())
        .stderr(quiet())
        .spawn();
    if started.is_err() {
        let words = format!("`{program}` cannot be started: open the page by hand\n");
        tell(false, &words);
    }
}

fn refusal(title: &str) -> CommandError {
    CommandError::Input(Diagnostic::new(title).into())
}
