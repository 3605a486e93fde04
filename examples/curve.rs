//! From a located P-bifurcation to its curve in a plane of two parameters.
//!
//! Run with `cargo run --release --example curve`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::cancellation::Cancellation;
use pbif::continuation::curve::{CurveOptions, CurveStart, Plane, follow};
use pbif::sweep_file::SweepFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let never = Cancellation::new();
    let sweep = SweepFile::read("sweeps/bistable.toml".as_ref())?
        .validate()?
        .prepare(&never)?;
    let found = sweep.run(&never, &mut ())?;
    let plane = Plane::new(("a", -1.0, 1.0), ("sigma2", 0.1, 1.0))?;
    let source = sweep.source_in(&plane, &never)?;
    let row = found.bifurcations().next();
    let start = row.and_then(|row| CurveStart::from_row(row, 0.25, &found.subject));
    let start = start.ok_or("no row to start from")?;
    let (detector, options) = (sweep.detector(), CurveOptions::default());
    let curve = follow(
        &source,
        &plane,
        &detector,
        &start,
        &options,
        &never,
        &mut |_| (),
    )?;
    for point in &curve.points {
        let ([a, sigma2], error) = (point.values, point.error);
        println!("a = {a:9.6}, sigma2 = {sigma2:.4}, off by at most {error:.0e} of the box");
    }
    for end in &curve.ends {
        println!("{}: {}", end.label, end.reason.words(&plane));
    }
    Ok(())
}
