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
use pbif::system::friction::{FrictionLaw, Motion};
use pbif::system::{
    AxisDescription, Duffing, Family, Model, Oscillator, ParameterDescription, ParameterRange,
    Path, Viscous, contract,
};
use pbif::topology::{DetectOptions, PersistenceDetector};

fn belt() -> Model {
    let parameter = |name: &str, meaning: &str, default: f64| {
        ParameterDescription::new(name, name, meaning)
            .with_default(default)
            .within(ParameterRange::Positive)
    };
    Model::new(
        "belt",
        "Oscillator on a moving belt with Stribeck friction",
        |values| {
            let spring = Duffing {
                alpha: 1.0,
                mu: 0.0,
            };
            let damping = Viscous { kappa: values[0] };
            let friction = StribeckOnBelt {
                f_s: values[1],
                f_c: values[2],
                v_s: values[3],
                speed: values[4],
            };
            Arc::new(Oscillator::new(spring, damping, friction, values[5]))
        },
    )
    .with_equations(["x' = y", "y' = -κ y - x - F(y - v) + ξ(t)"])
    .with_axes([
        AxisDescription::new("x", "x", "displacement"),
        AxisDescription::new("y", "ẋ", "velocity"),
    ])
    .with_parameters([
        parameter("kappa", "viscous damping", 0.05),
        parameter("f_s", "static friction level", 0.4),
        parameter("f_c", "sliding friction level", 0.2),
        parameter("v_s", "Stribeck velocity", 0.5),
        parameter("v", "speed of the belt", 1.0),
        parameter("sigma2", "noise intensity", 0.02),
    ])
    .with_source("this example")
}

/// The law, for one state; spring, damping, noise and the loop over a batch of states are the oscillator's.
struct StribeckOnBelt {
    f_s: f64,
    f_c: f64,
    v_s: f64,
    speed: f64,
}

impl FrictionLaw<0> for StribeckOnBelt {
    #[inline(always)]
    fn rates(&self, _motion: Motion, _state: &[f64; 0]) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn force(&self, motion: Motion, _state: &[f64; 0], _rates: &[f64; 0]) -> f64 {
        let slip = motion.velocity - self.speed;
        let level = self.f_c + (self.f_s - self.f_c) * (-slip.abs() / self.v_s).exp();
        if slip == 0.0 {
            0.0
        } else {
            slip.signum() * level
        }
    }

    fn base_velocity(&self) -> Option<f64> {
        Some(self.speed)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let space = CellSpace::new(vec![
        Axis::uniform(-2.5, 2.5, 40)?,
        Axis::uniform(-2.5, 2.5, 40)?,
    ])?;
    let observables = [Observable::Marginal(0), Observable::Joint(0, 1)];
    let family = Family::new(Arc::new(belt()), &[], Path::parameter("v", 0.2, 1.6))?;
    // What the law declares holds: here its surface, at a velocity that moves with the belt.
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
