//! A sweep file in a program: opened, changed, checked and run; what is said of mistakes; a stored run opened again.
//!
//! Run with `cargo run --release --example sweep_file [RUN]`, where RUN is a folder that `pbif sweep` wrote. The README
//! shows the middle of this program.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use std::error::Error;
use std::path::Path;

use pbif::cancellation::Cancellation;
use pbif::continuation::SweepResult;
use pbif::run::StoredRun;
use pbif::sweep_file::SweepFile;

fn main() -> Result<(), Box<dyn Error>> {
    let text = solved()?;
    mistakes(&text);
    match std::env::args_os().nth(1) {
        Some(folder) => print(&reopened(Path::new(&folder))?),
        None => println!("give the folder of a run to detect in it again"),
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
    for row in &found.labels {
        println!("{}: {:.6} ± {:.6}", row.label, row.value, row.error);
    }
}
