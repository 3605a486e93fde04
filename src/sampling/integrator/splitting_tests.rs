//! Splitting against exact variances of a linear oscillator, exact moments of Duffing's, and what is conserved.

use super::tests::{Linear, steady_energy, steady_moments};
use super::*;
use crate::sampling::random::StreamKey;

/// Variances of displacement and velocity of a lightly damped linear oscillator, relative to the exact ones, less 1, in
/// the steady state of the splitting: of its steps, and of the process.
fn split_bias(step: f64) -> [[f64; 2]; 2] {
    let (omega, damping) = (1.3, 0.02);
    let [xx, _, yy] = steady_moments(omega, damping, Integrator::Splitting, step);
    let exact = [0.5 / (damping * omega * omega), 0.5 / damping];
    let system = Linear::oscillator(omega, damping, 1.0);
    let stepper = Stepper::new(&system, Integrator::Splitting, step, &Cancellation::new());
    let unit = [[1.0; LANES], [1.0; LANES]];
    let unit = stepper.seen(&unit);
    let seen = [xx * unit[0][0].powi(2), yy * unit[1][0].powi(2)];
    [[xx, yy], seen].map(|of| [0, 1].map(|axis| of[axis] / exact[axis] - 1.0))
}

#[test]
fn splitting_keeps_the_variances_of_a_lightly_damped_oscillator_with_long_steps() {
    for step in [0.1, 0.2, 0.4] {
        let [steps, seen] = split_bias(step);
        // The displacement's is exact; the velocity's is too large by (ω dt)²/4 before the postprocessor.
        let square = f64::powi(1.3 * step, 2);
        assert!(
            steps[0].abs() < 1e-11 && seen[0].abs() < 1e-11,
            "{step} {steps:?}"
        );
        assert!(
            (steps[1] / (0.25 * square) - 1.0).abs() < 0.1,
            "{step} {steps:?}"
        );
        // 1/(1 - a) (1 - a/2)² = 1 + a²/4 + …, a = (ω dt)²/4; Heun's own damping is off by its square.
        let (left, of_damping) = (square * square / 64.0, f64::powi(0.02 * step, 2));
        let off = (seen[1] - left).abs();
        assert!(off < 0.1 * left + of_damping, "{step} {seen:?} {left}");
    }
    // Heun's at a quarter of the longest of these steps, where most of the damping is left.
    let heun = steady_energy(1.3, 0.02, Integrator::StochasticHeun, 0.1) * 2.0 * 0.02 - 1.0;
    assert!(heun > 0.03, "{heun}");
}

#[test]
fn a_state_comes_back_from_the_steps_and_an_undamped_oscillator_keeps_its_energy() {
    let (omega, step) = (1.3, 0.3);
    let system = Linear::oscillator(omega, 0.0, 0.0);
    let stepper = Stepper::new(&system, Integrator::Splitting, step, &Cancellation::new());
    let start = [[0.7; LANES], [-0.4; LANES]];
    let mut states = start;
    stepper.enter(&mut states);
    assert!((states[1][0] + 0.4).abs() > 1e-3);
    let energy = |states: &[Lanes]| states[0][0].powi(2) * omega * omega + states[1][0].powi(2);
    let mut largest: f64 = 0.0;
    for turn in 0..10_000 {
        let seen = stepper.seen(&states);
        if turn == 0 {
            let off = (seen[1][0] - start[1][0]).abs();
            assert!(off < 1e-7 && seen[0] == start[0], "{off}");
        }
        largest = largest.max((energy(&seen) / energy(&start) - 1.0).abs());
        stepper.advance_with(&mut states, 0, 1, &[[0.0; LANES]]);
    }
    // The steps keep ω²x² + y²(1 - a), a = (ω dt)²/4, and the postprocessor makes y² (1 - a/2)² of y²: a ripple of
    // a²/4, after 10 000 steps as after ten. (Heun's energy would grow by e^58.)
    let ripple = f64::powi(0.25 * (omega * step).powi(2), 2) / 4.0;
    assert!(
        (0.5..1.2).contains(&(largest / ripple)),
        "{largest} {ripple}"
    );
}

#[test]
fn positions_are_what_velocities_and_constants_move() {
    let found = |system: &dyn System| -> Vec<usize> {
        positions(system)
            .iter()
            .map(|position| position.axis)
            .collect()
    };
    assert_eq!(found(&Linear::oscillator(1.3, 0.1, 1.0)), [0]);
    assert_eq!(found(&Linear::scalar(-1.0, Some(1.0), 0.0)), [0_usize; 0]);
    let typed = |axes: &[&'static str], equations: &[(&'static str, &'static str)], noisy| {
        let model = crate::system::TypedModel::new("tried", "Tried", axes.iter().copied());
        let with = |model: crate::system::TypedModel,
                    &(axis, drift): &(&'static str, &'static str)| {
            model.with_equation(axis, drift)
        };
        let model = equations
            .iter()
            .fold(model, with)
            .with_noise(noisy, ["0.3"]);
        model.build().unwrap().system_with(&[]).unwrap()
    };
    // Two masses and a spring; a force with a state of its own; a chain, of which one link moves apart.
    let masses = [
        ("x", "v"),
        ("v", "w - x"),
        ("z", "2 w + 1"),
        ("w", "-w - z"),
    ];
    assert_eq!(found(&*typed(&["x", "v", "z", "w"], &masses, "w")), [0, 2]);
    let dahl = [("x", "v"), ("v", "-x - z"), ("z", "v - abs(v) z")];
    assert_eq!(found(&*typed(&["x", "v", "z"], &dahl, "v")), [0]);
    let chain = [("x", "v"), ("v", "a"), ("a", "-a - v - x")];
    assert_eq!(found(&*typed(&["x", "v", "a"], &chain, "a")), [0]);
    let first = [("x", "x - x^3 + v"), ("v", "-v")];
    assert_eq!(found(&*typed(&["x", "v"], &first, "v")), [0_usize; 0]);
}

/// x' = y, y' = -0.1 y - a x - x³ + √0.2 ξ.
struct Duffing(f64, [Noise; 1]);

impl System for Duffing {
    fn dimension(&self) -> usize {
        2
    }
    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        drift[0] = states[1];
        for lane in 0..LANES {
            let (x, y) = (states[0][lane], states[1][lane]);
            drift[1][lane] = -0.1 * y - x * (self.0 + x * x);
        }
    }
    fn noises(&self) -> &[Noise] {
        &self.1
    }
}

/// E x² and E y² of its steady state at T = 1, each relative to what it is exactly, less 1; over 5 million units.
fn duffing_bias(stiffness: f64, step: f64) -> [f64; 2] {
    let system = Duffing(stiffness, [Noise::constant(1, 0.2_f64.sqrt())]);
    let stepper = Stepper::new(
        &system,
        Integrator::WeakSplitting,
        step,
        &Cancellation::new(),
    );
    let mut stream = NormalStream::new(StreamKey {
        seed: 5,
        cell: 0,
        block: 0,
    });
    let mut states = [[0.0; LANES]; 2];
    let each = (1.0 / step).round() as usize;
    stepper
        .advance(&mut states, 0, 200 * each, &mut stream)
        .unwrap();
    let (looks, mut sums) = (80_000, [0.0; 2]);
    for _ in 0..looks {
        stepper.advance(&mut states, 0, each, &mut stream).unwrap();
        let seen = stepper.seen(&states);
        for (sum, lanes) in sums.iter_mut().zip(seen.iter()) {
            *sum += lanes.iter().map(|x| x * x).sum::<f64>();
        }
    }
    // p(x) ∝ exp(-a x²/2 - x⁴/4), by the trapezoidal rule.
    let nodes = (-4000..=4000).map(|k| 1e-3 * f64::from(k));
    let (mass, square) = nodes.fold((0.0, 0.0), |(mass, square), x| {
        let weight = f64::exp(-0.5 * stiffness * x * x - 0.25 * x.powi(4));
        (mass + weight, square + weight * x * x)
    });
    let exact = [square / mass, 1.0];
    [0, 1].map(|axis| sums[axis] / (looks * LANES) as f64 / exact[axis] - 1.0)
}

#[test]
fn splitting_a_duffing_oscillator_is_of_second_order_with_a_small_constant() {
    for stiffness in [1.0, -1.0] {
        let [coarse, fine] = [0.25, 0.125].map(|step| duffing_bias(stiffness, step));
        // x is off by about dt²/6, y by less than can be seen; standard errors are about 0.15 %.
        assert!((-0.016..-0.005).contains(&coarse[0]), "{coarse:?}");
        assert!(
            fine[0].abs() < 0.4 * coarse[0].abs() + 0.001,
            "{coarse:?} {fine:?}"
        );
        assert!(
            coarse[1].abs() < 0.01 && fine[1].abs() < 0.005,
            "{coarse:?} {fine:?}"
        );
    }
}
