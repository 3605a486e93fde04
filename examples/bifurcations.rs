//! The shortest sweep: where does the density of x change its topology? docs/library.md shows this program.
//!
//! Run with `cargo run --release --example bifurcations`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::cancellation::Cancellation;
use pbif::continuation::{LocateOptions, sweep};
use pbif::density::Observable;
use pbif::method::{Problem, SgcmOptions, SgcmSource};
use pbif::space::{Axis, CellSpace};
use pbif::system::{Family, Path, registry};
use pbif::topology::{DetectOptions, PersistenceDetector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = Path::parameter("a", -1.0, 1.0);
    let family = Family::new(registry::find("bistable")?, &[("sigma2", 0.25)], path)?;
    let space = CellSpace::new(vec![Axis::uniform(-2.2, 2.2, 100)?])?;
    let problem = Problem::new(family, space, vec![Observable::Marginal(0)])?;
    let never = Cancellation::new();
    let source = SgcmSource::new(&problem, &SgcmOptions::default(), &never)?;
    let points = 41;
    let detector = PersistenceDetector::new(DetectOptions::default(), points);
    let found = sweep(
        &source,
        &detector,
        points,
        &LocateOptions::default(),
        &never,
        &mut (),
    )?;
    for row in found.bifurcations() {
        println!("{}: a = {:.2} ± {:.2}", row.label, row.value, row.error);
    }
    Ok(())
}
