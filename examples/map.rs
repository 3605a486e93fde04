//! A map of regimes in a plane of two parameters: where one peak is two, and the curve between.
//!
//! Run with `cargo run --release --example map`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::cancellation::Cancellation;
use pbif::continuation::curve::Plane;
use pbif::continuation::map::{MapOptions, regime_map};
use pbif::sweep_file::SweepFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let never = Cancellation::new();
    let sweep = SweepFile::read("sweeps/bistable.toml".as_ref())?
        .validate()?
        .prepare(&never)?;
    let plane = Plane::new(("a", -1.0, 1.0), ("sigma2", 0.2, 0.6))?;
    let source = |plane: &Plane| sweep.source_in(plane, &never);
    let options = MapOptions {
        counts: [9, 5],
        ..MapOptions::default()
    };
    let detector = sweep.detector();
    let map = regime_map(&source, &plane, &detector, &options, &never, &|_| ())?;
    for node in map.nodes.iter().filter(|node| node.level == 0) {
        let [a, sigma2] = node.values;
        println!("a = {a:5.2}, sigma2 = {sigma2:.1}: {}", node.signatures[0]);
    }
    for curve in &map.curves {
        let ends = curve.ends.iter().map(|end| end.reason.words(&plane));
        let ends: Vec<String> = ends.collect();
        println!(
            "{} points of a curve: {}",
            curve.points.len(),
            ends.join("; ")
        );
    }
    Ok(())
}
