//! A sweep file in a program: opened, changed, checked and run; the same as a job, which leaves what `pbif sweep` does;
//! what is said of mistakes; a stored run opened again.
//!
//! Run with `cargo run --release --example sweep_file [FOLDER]`, where FOLDER is for the run that the job leaves, or
//! has it from an earlier time. docs/library.md shows the middle of this program.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use std::error::Error;
use std::path::Path;

use pbif::cancellation::Cancellation;
use pbif::continuation::SweepResult;
use pbif::job::{Job, SweepJob, carry_out};
use pbif::run::StoredRun;
use pbif::sweep_file::SweepFile;

fn main() -> Result<(), Box<dyn Error>> {
    let text = solved()?;
    mistakes(&text);
    match std::env::args_os().nth(1) {
        Some(folder) => {
            carried_out(Path::new(&folder))?;
            print(&reopened(Path::new(&folder))?);
        }
        None => println!("give a folder for a run to leave it there"),
    }
    Ok(())
}

/// What `pbif sweep sweeps/bistable.toml --out FOLDER --resume` does: tables, densities and figures, and a job that was
/// stopped is gone on with. Maps, curves and comparisons are jobs too.
fn carried_out(folder: &Path) -> Result<(), Box<dyn Error>> {
    let never = Cancellation::new();
    let file = SweepFile::read(Path::new("sweeps/bistable.toml"))?;
    let sweep = file.validate()?.prepare(&never)?;
    let mut job = SweepJob::new(&sweep);
    let start = job.start(folder)?;
    let done = carry_out(&mut job, folder, start, &never, &|step| {
        println!("{step:?}")
    })?;
    match done {
        Some(done) => print(&done.found),
        None => println!("it is complete"),
    }
    Ok(())
}

/// Runs the bistable system with fewer points and cells; returns the complete sweep file.
fn solved() -> Result<String, Box<dyn Error>> {
    let mut file = SweepFile::read(Path::new("sweeps/bistable.toml"))?;
    file.set("sweep.points", "21").set("cells.x.count", "120");
    // Everything is checked, and nothing was run so far; ranges that are left to the program take some trajectories.
    let never = Cancellation::new();
    let sweep = file.validate()?.prepare(&never)?;
    let found = sweep.run(&never, &mut ())?;
    print(&found);
    println!("{}", sweep.to_toml());
    Ok(sweep.to_toml())
}

/// All mistakes are told at once, each with its place.
fn mistakes(text: &str) {
    let mut file = SweepFile::parse("bistable.toml", text);
    file.set("sweep.pionts", "21").set("method.kind", "sgmc");
    if let Err(report) = file.validate() {
        println!("{report}\n");
        for diagnostic in report.diagnostics() {
            let place = diagnostic
                .place()
                .and_then(|place| report.sources().locate(place));
            println!("{:?}: {}", place, diagnostic.title());
        }
    }
}

/// Detects with another confidence in the densities of a stored run, without solving.
fn reopened(folder: &Path) -> Result<SweepResult, Box<dyn Error>> {
    let run = StoredRun::open(folder)?;
    let mut file = run.sweep_file();
    file.set("detect.confidence", "0.99");
    let sweep = file.validate()?.fixed()?;
    let found = run.detect(&sweep)?;
    Ok(found)
}

fn print(found: &SweepResult) {
    for row in found.bifurcations() {
        println!("{}: {:.6} ± {:.6}", row.label, row.value, row.error);
    }
}
