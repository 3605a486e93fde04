//! The shortest sweep: where does the density of x change its topology? The README shows this program.
//!
//! Run with `cargo run --release --example bifurcations`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::continuation::{LocateOptions, Plan, sweep};
use pbif::density::Observable;
use pbif::method::{Setting, SgcmOptions, SgcmSource};
use pbif::space::{Axis, CellSpace};
use pbif::system::registry;
use pbif::topology::{DetectOptions, PersistenceDetector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = registry::find("bistable")?;
    let values = model.values(&[("a", -1.0), ("sigma2", 0.25)])?;
    let space = CellSpace::new(vec![Axis::uniform(-2.2, 2.2, 100)?])?;
    let observables = [Observable::Marginal(0)];
    let setting = Setting {
        model: &model,
        values: &values,
        parameter: "a",
        range: (-1.0, 1.0),
        space: &space,
        observables: &observables,
    };
    let source = SgcmSource::new(&setting, &SgcmOptions::default(), Default::default())?;
    let plan = Plan {
        parameter: "a".to_owned(),
        from: -1.0,
        to: 1.0,
        points: 41,
        observables: observables.to_vec(),
    };
    let detector = PersistenceDetector::new(DetectOptions::default(), plan.points);
    let found = sweep(
        &source,
        &detector,
        &plan,
        &LocateOptions::default(),
        &mut (),
    )?;
    for row in &found.labels {
        println!("{}: a = {:.2} ± {:.2}", row.label, row.value, row.error);
    }
    Ok(())
}
