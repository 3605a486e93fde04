//! What every method refuses.

use std::sync::Arc;

use super::*;
use crate::cancellation::Cancellation;
use crate::continuation::DensitySource as _;
use crate::density::{Observable, Variants};
use crate::generator::{GeneratorError, GeneratorOptions, assemble};
use crate::monte_carlo::{EnsembleRun, ErgodicRun, MonteCarloError, ensemble, ergodic};
use crate::sampling::{Integrator, SamplingError, SamplingOptions, sample_transitions};
use crate::space::{Axis, CellSpace};
use crate::system::test_families::coulomb;
use crate::system::{
    AxisDescription, Facts, Family, Lanes, Model, Noise, ParameterDescription, Path, PeriodicDrift,
    System,
};

/// dx = (a cos t - x) dt + dW/2.
fn forced() -> Arc<Model> {
    let bind = |values: &[f64]| -> Arc<dyn System> { Arc::new(with_amplitude(values[0])) };
    let model = Model::new("forced", "Linear system under periodic forcing", bind);
    let amplitude = ParameterDescription::new("a", "a", "amplitude of the forcing");
    Arc::new(
        model
            .with_axes([AxisDescription::new("x", "x", "state")])
            .with_parameters([amplitude]),
    )
}

struct Forced {
    amplitude: f64,
    noise: [Noise; 1],
    facts: Facts,
}

fn with_amplitude(amplitude: f64) -> Forced {
    Forced {
        amplitude,
        noise: [Noise::constant(0, 0.5)],
        facts: Facts {
            period: Some(std::f64::consts::TAU),
            ..Facts::default()
        },
    }
}

impl System for Forced {
    fn dimension(&self) -> usize {
        1
    }
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        for (slope, x) in drift[0].iter_mut().zip(&states[0]) {
            *slope = self.amplitude * time.cos() - x;
        }
    }
    fn noises(&self) -> &[Noise] {
        &self.noise
    }
    fn facts(&self) -> &Facts {
        &self.facts
    }
}

fn cells() -> CellSpace {
    CellSpace::new(vec![Axis::uniform(-2.0, 2.0, 20).unwrap()]).unwrap()
}

const PERIODIC: PeriodicDrift = PeriodicDrift {
    period: std::f64::consts::TAU,
};

#[test]
fn no_method_takes_a_periodic_system_for_an_autonomous_one() {
    let family = Family::new(forced(), &[], Path::parameter("a", 0.5, 1.5)).unwrap();
    let problem = Problem::new(family, cells(), vec![Observable::Marginal(0)]).unwrap();
    for method in [
        MethodOptions::Generator(GeneratorMethodOptions::default()),
        MethodOptions::Sgcm(SgcmOptions::default()),
        MethodOptions::MonteCarlo(MonteCarloOptions::default()),
    ] {
        let Err(refused) = MethodSource::new(&problem, &method, &Cancellation::new()) else {
            panic!("{method:?} takes it");
        };
        assert!(matches!(refused, MethodError::Periodic(PERIODIC)));
        let sentence = refused.to_string();
        assert!(
            sentence.contains("depends on time with period 6.28"),
            "{sentence}"
        );
    }
}

#[test]
fn what_is_kept_of_a_point_is_what_its_densities_hold() {
    let axis = |count| Axis::uniform(-6.0, 6.0, count).unwrap();
    let space = CellSpace::new(vec![axis(12), axis(14)]).unwrap();
    let observables = vec![Observable::Marginal(1), Observable::Joint(0, 1)];
    let problem = Problem::new(coulomb(), space, observables).unwrap();
    let replicates = |replicates| SgcmOptions {
        replicates,
        samples: 60,
        ..SgcmOptions::default()
    };
    let few = MonteCarloOptions {
        error: 0.2,
        ..MonteCarloOptions::default()
    };
    for method in [
        MethodOptions::Generator(GeneratorMethodOptions::default()),
        MethodOptions::Sgcm(replicates(5)),
        MethodOptions::MonteCarlo(few),
    ] {
        let never = Cancellation::new();
        let source = MethodSource::new(&problem, &method, &never).unwrap();
        let mut session = source.open(&never);
        let solution = session.solve(problem.family().ends().0).unwrap();
        let held = solution.densities.iter().map(|one| {
            let numbers = one.density.values.len() + one.standard_error.len();
            numbers
                + match &one.variants {
                    Variants::None => 0,
                    Variants::Scheme(second) => second.len(),
                    Variants::Jackknife(all) => all.iter().map(Vec::len).sum(),
                }
        });
        let bins = (14 + 12 * 14) as f64;
        let bytes = 8.0 * held.sum::<usize>() as f64;
        assert_eq!(bytes, method.kept_bytes(bins), "{method:?}");
    }
}

#[test]
fn nor_does_what_the_methods_are_made_of() {
    let (system, space) = (with_amplitude(1.0), cells());
    let assembled = assemble(&system, &space, &GeneratorOptions::default());
    assert_eq!(assembled.err(), Some(GeneratorError::Periodic(PERIODIC)));
    let options = SamplingOptions {
        map_step: 0.1,
        time_step: 0.1,
        samples: 4,
        groups: 1,
        seed: 1,
        integrator: Integrator::StochasticHeun,
        keep_starts: false,
    };
    let sampled = sample_transitions(&system, &space, &[10], &options, &Cancellation::new());
    assert_eq!(sampled.err(), Some(SamplingError::Periodic(PERIODIC)));
    let run = ErgodicRun {
        time_step: 0.1,
        integrator: Integrator::StochasticHeun,
        seed: 1,
        trajectories: 64,
        burn_in: 1.0,
        length: 1.0,
        stride: 2,
    };
    let counted = ergodic(&system, &space, &[], &run, &Cancellation::new());
    assert_eq!(counted.err(), Some(MonteCarloError::Periodic(PERIODIC)));
    let run = EnsembleRun {
        time_step: 0.1,
        integrator: Integrator::StochasticHeun,
        seed: 1,
        trajectories: 64,
        time: 1.0,
        start: Vec::new(),
    };
    let counted = ensemble(&system, &space, &run, &Cancellation::new());
    assert_eq!(counted.err(), Some(MonteCarloError::Periodic(PERIODIC)));
}

#[test]
fn an_axis_that_cannot_be_assembled_is_named() {
    let axes = [1e155, 1e-155].map(|end| Axis::uniform(-end, end, 10).unwrap());
    let space = CellSpace::new(axes.to_vec()).unwrap();
    let problem = Problem::new(coulomb(), space, vec![Observable::Marginal(0)]).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let refused = session.solve(0.0).unwrap_err().to_string();
    assert!(refused.contains("along axis `y`"), "{refused}");
}
