//! An oscillator typed as text: a tristable van der Pol oscillator, swept over the damping at rest.
//!
//! x'' + (c0 + c1 x² + c2 x⁴ + c3 x⁶ + c4 x⁸) x' + x = noise. With small damping and no noise the amplitude a obeys
//! a' = -(g/2) a (a² - 1)(a² - 3)(a² - 6)(a² - 9) for c0 = 162 g and the other coefficients below: rest and two limit
//! cycles are stable. Less damping at rest drives the oscillator off it, and the density gets a crater.
//!
//! Run with `cargo run --release --example typed_oscillator`; it takes a few seconds.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::cancellation::Cancellation;
use pbif::continuation::{LocateOptions, sweep};
use pbif::density::Observable;
use pbif::method::{GeneratorMethodOptions, GeneratorSource, Problem};
use pbif::space::{Axis, CellSpace};
use pbif::system::{
    Family, Interpretation, ParameterDescription, ParameterRange, Path, TypedModel, contract,
};
use pbif::topology::{DetectOptions, PersistenceDetector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let intensity = |name, value| {
        ParameterDescription::from(name)
            .with_default(value)
            .within(ParameterRange::NonNegative)
    };
    let model = TypedModel::new("tristable", "Tristable van der Pol oscillator", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-(c0 + c1 x^2 + c2 x^4 + c3 x^6 + c4 x^8) y - x")
        .with_definition("c1", "-1044 g")
        .with_definition("c2", "936 g")
        .with_definition("c3", "-243.2 g")
        .with_definition("c4", "128/7*g")
        // Noise of its own, and noise of the stiffness.
        .with_noise("y", ["sqrt(2 D1)", "sqrt(2 D2) x"])
        .with_interpretation(Interpretation::Stratonovich)
        .with_parameters([
            ParameterDescription::from("c0"),
            ParameterDescription::from("g").with_default(0.002),
            intensity("D1", 0.05),
            intensity("D2", 0.001),
        ])
        .build()?;

    // What was read off the formulas holds at random states.
    let values = model.values(&[("c0", 0.3)])?;
    contract::verify_model(&model, &values, &[(-4.0, 4.0); 2])?;

    let family = Family::new(model, &[], Path::parameter("c0", -0.2, 0.8))?;
    let space = CellSpace::new(vec![Axis::uniform(-4.5, 4.5, 60)?; 2])?;
    let watched = vec![Observable::Marginal(0), Observable::Joint(0, 1)];
    let problem = Problem::new(family, space, watched)?;
    let options = GeneratorMethodOptions::default();
    let source = GeneratorSource::new(&problem, &options)?;
    let points = 11;
    let detector = PersistenceDetector::new(DetectOptions::default(), points);
    let locate = LocateOptions::default();
    let found = sweep(
        &source,
        &detector,
        points,
        &locate,
        &Cancellation::new(),
        &mut (),
    )?;
    for row in found.bifurcations() {
        println!("{}: c0 = {:.3} ± {:.3}", row.label, row.value, row.error);
    }
    Ok(())
}
