//! Compiled steps of every built-in oscillator against passes over a batch, to the bit, and their weak order against
//! exact moments.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::*;
use crate::sampling::random::{StreamKey, mix, unit};
use crate::system::{Facts, VELOCITY, registry};

/// A system without its compiled steps.
struct Plain(Arc<dyn System>);

impl System for Plain {
    fn dimension(&self) -> usize {
        self.0.dimension()
    }
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        self.0.drift(time, states, drift);
    }
    fn noises(&self) -> &[Noise] {
        self.0.noises()
    }
    fn facts(&self) -> &Facts {
        self.0.facts()
    }
}

/// Random states between -3 and 3, among them some at which velocities are zero and some that are no numbers.
fn states(dimension: usize, salt: u64) -> Vec<Lanes> {
    let of_axis = |axis: usize| {
        std::array::from_fn(|lane| match (axis, lane) {
            (VELOCITY, 7) => 0.0,
            (0, 13) => f64::NAN,
            (0, 21) => 1e200,
            _ => 6.0 * unit(mix(salt + (axis * LANES + lane) as u64)) - 3.0,
        })
    };
    (0..dimension).map(of_axis).collect()
}

/// Where trajectories of a system are after steps, as they are seen, and whether the steps were compiled ones.
fn ends(system: &dyn System, integrator: Integrator, salt: u64) -> (Vec<Lanes>, bool) {
    let stepper = Stepper::new(system, integrator, 0.03, &Cancellation::new()).within_a_turn();
    let mut states = states(system.dimension(), salt);
    let key = StreamKey {
        seed: salt,
        cell: 2,
        block: 3,
    };
    let mut stream = NormalStream::new(key);
    stepper.enter(&mut states);
    // More than one chunk, and one step alone.
    for steps in [21, 1] {
        stepper.advance(&mut states, 0, steps, &mut stream).unwrap();
    }
    (
        stepper.seen(&states).into_owned(),
        stepper.compiled.is_some(),
    )
}

#[test]
fn compiled_steps_of_every_built_in_oscillator_give_the_bits_of_passes() {
    for model in registry::models() {
        for (salt, first) in [(1, 0.3), (1000, 1.1)] {
            let value = |index: usize| first + 0.17 * index as f64;
            let named = model.parameters.iter().enumerate();
            let given: Vec<_> = named.map(|(i, p)| (p.name.as_str(), value(i))).collect();
            let system = model.system_with(&given).unwrap();
            let plain = Plain(Arc::clone(&system));
            for integrator in Integrator::ALL {
                let (compiled, is_compiled) = ends(&*system, integrator, salt);
                let (passes, is_plain) = ends(&plain, integrator, salt);
                let is_oscillator = system.dimension() > 1;
                let expected = is_oscillator && integrator != Integrator::EulerMaruyama;
                assert_eq!((is_compiled, is_plain), (expected, false), "{}", model.name);
                let pairs = compiled.iter().flatten().zip(passes.iter().flatten());
                for (one, other) in pairs {
                    // Zeros of either sign are the same, and what is no number is none either way.
                    assert!(
                        one == other || one.is_nan() && other.is_nan(),
                        "{} {integrator:?}: {one:?} {other:?}",
                        model.name
                    );
                }
            }
        }
    }
}

/// E x², E xy, E y² at time 1 from x = 1, y = 0.5 of the linear oscillator that `coulomb` is without friction, as its
/// compiled steps have them: a step maps second moments linearly, and three nodes stand for its normal number.
fn moments(integrator: Integrator, steps: usize) -> Vector3<f64> {
    let values = [
        ("kappa", 0.4),
        ("alpha", 1.7),
        ("mu", 0.0),
        ("f_c", 0.0),
        ("sigma2", 0.3),
    ];
    let system = registry::find("coulomb").unwrap();
    let system = system.system_with(&values).unwrap();
    let step = 1.0 / steps as f64;
    let stepper = Stepper::new(&*system, integrator, step, &Cancellation::new());
    assert!(stepper.compiled.is_some());
    let root = 3.0_f64.sqrt();
    let rule = [(-root, 1.0 / 6.0), (0.0, 2.0 / 3.0), (root, 1.0 / 6.0)];
    let products = |states: &[Lanes]| {
        let (x, y) = (states[0][0], states[1][0]);
        Vector3::new(x * x, x * y, y * y)
    };
    let after = |x: f64, y: f64| -> Vector3<f64> {
        let of_node = |(node, weight): (f64, f64)| {
            let mut states = [[x; LANES], [y; LANES]];
            stepper.advance_with(&mut states, 0, 1, &[[node; LANES]]);
            products(&states) * weight
        };
        rule.map(of_node).iter().sum()
    };
    let constant = after(0.0, 0.0);
    let (of_x, of_y) = (after(1.0, 0.0) - constant, after(0.0, 1.0) - constant);
    let mixed = after(1.0, 1.0) - constant - of_x - of_y;
    let map = Matrix3::from_columns(&[of_x, mixed, of_y]);
    let mut start = [[1.0; LANES], [0.5; LANES]];
    stepper.enter(&mut start);
    let mut moments = products(&start);
    for _ in 0..steps {
        moments = map * moments + constant;
    }
    // The postprocessor of a linear system is linear: what it makes of units is what it makes of moments.
    let seen = |x: f64, y: f64| products(&stepper.seen(&[[x; LANES], [y; LANES]]));
    let (of_x, of_y) = (seen(1.0, 0.0), seen(0.0, 1.0));
    let seen = Matrix3::from_columns(&[of_x, seen(1.0, 1.0) - of_x - of_y, of_y]);
    seen * moments
}

#[test]
fn compiled_steps_are_of_weak_order_two() {
    // (E x², E xy, E y²)' = A (E x², E xy, E y²) + (0, 0, σ²), by the exponential of the matrix with a row for σ².
    let mut matrix = nalgebra::Matrix4::zeros();
    for (row, column, value) in [
        (0, 1, 2.0),
        (1, 0, -1.7),
        (1, 1, -0.4),
        (1, 2, 1.0),
        (2, 1, -3.4),
        (2, 2, -0.8),
        (2, 3, 0.3),
    ] {
        matrix[(row, column)] = value;
    }
    let exact = (matrix.exp() * nalgebra::Vector4::new(1.0, 0.5, 0.25, 1.0)).xyz();
    for integrator in [
        Integrator::StochasticHeun,
        Integrator::WeakHeun,
        Integrator::Splitting,
        Integrator::WeakSplitting,
    ] {
        let [coarse, fine] = [64, 128].map(|steps| moments(integrator, steps) - exact);
        for moment in 0..3 {
            let ratio = coarse[moment] / fine[moment];
            assert!(
                (0.25 * ratio - 1.0).abs() < 0.06 && fine[moment].abs() < 1e-3,
                "{integrator:?} {moment}: {coarse} {fine}"
            );
        }
    }
}

/// E y² - 1/2 of y' = -sgn(y) + ξ, whose density is exp(-2|y|), by steps of the compiled splitting.
fn friction_bias(step: f64) -> f64 {
    let names = ["kappa", "alpha", "mu", "f_c", "sigma2"];
    let values: Vec<_> = names.into_iter().zip([0.0, 0.0, 0.0, 1.0, 1.0]).collect();
    let model = registry::find("coulomb").unwrap();
    let system = model.system_with(&values).unwrap();
    let integrator = Integrator::WeakSplitting;
    let stepper = Stepper::new(&*system, integrator, step, &Cancellation::new());
    let mut stream = NormalStream::new(StreamKey {
        seed: 1,
        cell: 0,
        block: 0,
    });
    let (mut states, mut sum) = ([[0.0; LANES]; 2], 0.0);
    stepper.advance(&mut states, 0, 200, &mut stream).unwrap();
    let looks = (1e5 / (12.0 * step)) as usize;
    for _ in 0..looks {
        stepper.advance(&mut states, 0, 12, &mut stream).unwrap();
        sum += states[1].iter().map(|y| y * y).sum::<f64>();
    }
    sum / (looks * LANES) as f64 - 0.5
}

#[test]
fn a_jump_of_friction_leaves_a_bias_of_first_order() {
    // About 0.06 dt in units in which friction and noise are one; standard errors are about 0.001.
    for step in [0.2, 0.1] {
        let share = friction_bias(step) / step;
        assert!((0.03..0.1).contains(&share), "{step} {share}");
    }
}
