//! A friction model of one's own in one file: Stribeck friction on a moving belt, swept over the belt's speed.
//!
//! x' = y, y' = -κ y - x - F(y - v) + ξ with F(u) = sgn(u) (f_c + (f_s - f_c) exp(-|u|/v_s)).
//!
//! Run with `cargo run --release --example new_friction_model`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::continuation::{LocateOptions, sweep};
use pbif::density::Observable;
use pbif::method::{Problem, SgcmOptions, SgcmSource};
use pbif::space::{Axis, CellSpace};
use pbif::system::{
    Family, Model, ParameterDescription, ParameterRange, Path, TypedModel, TypedModelError,
    contract,
};
use pbif::topology::{DetectOptions, PersistenceDetector};

fn belt() -> Result<Arc<Model>, TypedModelError> {
    let parameter = |name: &str, meaning: &str, default: f64| {
        ParameterDescription::new(name, name, meaning)
            .with_default(default)
            .within(ParameterRange::Positive)
    };
    let title = "Oscillator on a moving belt with Stribeck friction";
    TypedModel::new("belt", title, ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-kappa y - x - F")
        .with_definition("u", "y - v")
        .with_definition("F", "sgn(u) (f_c + (f_s - f_c) exp(-abs(u)/v_s))")
        .with_noise("y", ["sqrt(sigma2)"])
        .with_parameters([
            parameter("kappa", "viscous damping", 0.05),
            parameter("f_s", "static friction level", 0.4),
            parameter("f_c", "sliding friction level", 0.2),
            parameter("v_s", "Stribeck velocity", 0.5),
            parameter("v", "speed of the belt", 1.0),
            parameter("sigma2", "noise intensity", 0.02),
        ])
        .with_source("this example")
        .build()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let space = CellSpace::new(vec![
        Axis::uniform(-2.5, 2.5, 40)?,
        Axis::uniform(-2.5, 2.5, 40)?,
    ])?;
    let observables = [Observable::Marginal(0), Observable::Joint(0, 1)];
    let family = Family::new(belt()?, &[], Path::parameter("v", 0.2, 1.6))?;
    // What is read off the formulas holds: here the surface, at a velocity that moves with the belt.
    contract::verify_model(family.model(), &family.values_at(0.2)?, &[(-2.5, 2.5); 2])?;
    let problem = Problem::new(family, space, observables.to_vec())?;
    let options = SgcmOptions {
        samples: 400,
        ..SgcmOptions::default()
    };
    let never = Cancellation::new();
    let source = SgcmSource::new(&problem, &options, &never)?;
    let points = 8;
    let detector = PersistenceDetector::new(DetectOptions::default(), points);
    let locate = LocateOptions {
        tolerance: Some(0.1),
        ..LocateOptions::default()
    };
    let result = sweep(&source, &detector, points, &locate, &never, &mut ())?;
    for point in &result.points {
        let signatures: Vec<String> = point
            .detections
            .iter()
            .map(|detection| detection.signature.to_string())
            .collect();
        println!("v = {:.3}: {}", point.value, signatures.join(", "));
    }
    Ok(())
}
