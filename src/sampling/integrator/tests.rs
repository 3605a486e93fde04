//! Weak convergence against exact moments. One step's moments are computed without sampling: the normals of the
//! lanes are nodes of a Gauss-Hermite rule, which integrates polynomials up to degree five exactly.

use super::*;
use crate::cancellation::Cancellation;
use crate::sampling::random::StreamKey;

/// Nodes and weights of the three-point Gauss-Hermite rule for the standard normal law.
const RULE: [(f64, f64); 3] = [
    (-1.732_050_807_568_877_2, 1.0 / 6.0),
    (0.0, 2.0 / 3.0),
    (1.732_050_807_568_877_2, 1.0 / 6.0),
];

/// dX = A X dt + (additive or, in one dimension, proportional to x) noise on the last axis.
pub(super) struct Linear {
    matrix: Vec<Vec<f64>>,
    noise: [Noise; 1],
}

impl Linear {
    pub(super) fn scalar(rate: f64, additive: Option<f64>, proportional: f64) -> Self {
        Self {
            matrix: vec![vec![rate]],
            noise: [match additive {
                Some(amplitude) => Noise::constant(0, amplitude),
                None => Noise::of_state(0, move |_, states, amplitude| {
                    *amplitude = states[0].map(|x| proportional * x);
                }),
            }],
        }
    }

    pub(super) fn oscillator(omega: f64, damping: f64, amplitude: f64) -> Self {
        Self {
            matrix: vec![vec![0.0, 1.0], vec![-omega * omega, -damping]],
            noise: [Noise::constant(1, amplitude)],
        }
    }
}

impl System for Linear {
    fn dimension(&self) -> usize {
        self.matrix.len()
    }
    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        for (row, slope) in self.matrix.iter().zip(drift) {
            for lane in 0..LANES {
                slope[lane] = row.iter().zip(states).map(|(a, x)| a * x[lane]).sum();
            }
        }
    }
    fn noises(&self) -> &[Noise] {
        &self.noise
    }
}

/// One step from `state` with each node as normal: weight and end state.
fn one_step(stepper: &Stepper<'_>, state: &[f64]) -> [(f64, Vec<f64>); 3] {
    RULE.map(|(node, weight)| {
        let mut states: Vec<Lanes> = state.iter().map(|&x| [x; LANES]).collect();
        stepper.advance_with(&mut states, 0, 1, &[[node; LANES]]);
        (weight, states.iter().map(|lanes| lanes[0]).collect())
    })
}

/// E x and E x² at time 1 from x = 1 for a scalar linear system. A step maps moments linearly:
/// E x' = m E x and E x'² = q E x² + s.
fn scalar_moments(system: &Linear, integrator: Integrator, steps: usize) -> (f64, f64) {
    let stepper = Stepper::new(system, integrator, 1.0 / steps as f64, &Cancellation::new());
    let moment = |from: f64, power: i32| -> f64 {
        let ends = one_step(&stepper, &[from]);
        ends.iter()
            .map(|(weight, end)| weight * end[0].powi(power))
            .sum()
    };
    let (mean, constant) = (moment(1.0, 1), moment(0.0, 2));
    let square = moment(1.0, 2) - constant;
    let (mut first, mut second) = (1.0, 1.0);
    for _ in 0..steps {
        (first, second) = (mean * first, square * second + constant);
    }
    (first, second)
}

/// Checks that halving the step divides the errors by 2^order; the next term of the error is a few per cent.
fn assert_order(system: &Linear, integrator: Integrator, exact: (f64, f64), order: i32) {
    let error = |steps: usize| {
        let (first, second) = scalar_moments(system, integrator, steps);
        (first - exact.0, second - exact.1)
    };
    let (coarse, fine) = (error(64), error(128));
    for (coarse, fine) in [(coarse.0, fine.0), (coarse.1, fine.1)] {
        let ratio = coarse / fine / f64::powi(2.0, order);
        assert!((ratio - 1.0).abs() < 0.04, "{integrator:?} {coarse} {fine}");
    }
}

#[test]
fn weak_orders_for_additive_noise_are_one_and_two() {
    // dx = -x dt + 1.5 dW: E x = e^-t, E x² = e^-2t + 2.25 (1 - e^-2t)/2.
    let system = Linear::scalar(-1.0, Some(1.5), 0.0);
    let decay = f64::exp(-2.0);
    let exact = (f64::exp(-1.0), decay + 1.125 * (1.0 - decay));
    assert_order(&system, Integrator::EulerMaruyama, exact, 1);
    assert_order(&system, Integrator::StochasticHeun, exact, 2);
    assert_order(&system, Integrator::WeakHeun, exact, 2);
}

#[test]
fn multiplicative_noise_is_read_in_the_sense_of_ito() {
    // dx = -x dt + 0.5 x dW: E x = e^-t, E x² = e^(-2+0.25)t; in Stratonovich's sense E x = e^(-1+0.125)t.
    let system = Linear::scalar(-1.0, None, 0.5);
    let exact = (f64::exp(-1.0), f64::exp(-1.75));
    assert_order(&system, Integrator::EulerMaruyama, exact, 1);
    // The mean has no noise in it, so Heun's is of order 2; the mean square is of order 1.
    let error = |steps: usize| scalar_moments(&system, Integrator::StochasticHeun, steps);
    let ratio = |exact: f64, coarse: f64, fine: f64| (coarse - exact) / (fine - exact);
    let (coarse, fine) = (error(64), error(128));
    assert!((ratio(exact.0, coarse.0, fine.0) - 4.0).abs() < 0.1);
    assert!((ratio(exact.1, coarse.1, fine.1) - 2.0).abs() < 0.1);
}

/// Steady second moments E x², E xy, E y² of a linear oscillator under the integrator, by iterating its exact map
/// of second moments, found from single steps.
pub(super) fn steady_moments(
    omega: f64,
    damping: f64,
    integrator: Integrator,
    step: f64,
) -> [f64; 3] {
    let system = Linear::oscillator(omega, damping, 1.0);
    let stepper = Stepper::new(&system, integrator, step, &Cancellation::new());
    let moments = |state: &[f64]| {
        let mut sums = nalgebra::Vector3::zeros();
        for (weight, end) in one_step(&stepper, state) {
            let (x, y) = (end[0], end[1]);
            sums += weight * nalgebra::Vector3::new(x * x, x * y, y * y);
        }
        sums
    };
    let constant = moments(&[0.0, 0.0]);
    let (along_x, along_y) = (
        moments(&[1.0, 0.0]) - constant,
        moments(&[0.0, 1.0]) - constant,
    );
    let mixed = moments(&[1.0, 1.0]) - constant - along_x - along_y;
    let map = nalgebra::Matrix3::from_columns(&[along_x, mixed, along_y]);
    let steady = (nalgebra::Matrix3::identity() - map).try_inverse().unwrap() * constant;
    [steady[0], steady[1], steady[2]]
}

/// ω² E x² of the steady state.
pub(super) fn steady_energy(omega: f64, damping: f64, integrator: Integrator, step: f64) -> f64 {
    steady_moments(omega, damping, integrator, step)[0] * omega * omega
}

#[test]
fn euler_maruyama_takes_omega_squared_dt_from_the_damping_and_heun_next_to_nothing() {
    // ω² E x² = σ²/(2γ) exactly; the integrator's effective damping is read off it.
    let (omega, damping, step) = (1.5, 0.02, 0.004);
    let effective = |integrator| 0.5 / steady_energy(omega, damping, integrator, step);
    let euler = damping - effective(Integrator::EulerMaruyama);
    let expected = omega * omega * step;
    assert!((euler / expected - 1.0).abs() < 0.02, "{euler} {expected}");
    let heun = damping - effective(Integrator::StochasticHeun);
    assert!(heun.abs() < 1e-3 * expected, "{heun}");
}

#[test]
fn energy_of_an_undamped_oscillator_grows_as_theory_says() {
    let (omega, step, steps) = (1.3, 0.02, 4_000);
    let system = Linear::oscillator(omega, 0.0, 0.0);
    let quiet = vec![[0.0; LANES]; steps];
    let growth = |integrator| {
        let stepper = Stepper::new(&system, integrator, step, &Cancellation::new());
        let mut states = [[1.0; LANES], [0.0; LANES]];
        stepper.advance_with(&mut states, 0, steps, &quiet);
        let energy = states[0][5].powi(2) + (states[1][5] / omega).powi(2);
        energy.ln() / (step * steps as f64)
    };
    // |1 + iωdt|² = 1 + ω²dt² and |1 + iωdt - ω²dt²/2|² = 1 + ω⁴dt⁴/4, exact up to rounding.
    let euler = f64::ln_1p(f64::powi(omega * step, 2)) / step;
    let heun = f64::ln_1p(f64::powi(omega * step, 4) / 4.0) / step;
    assert!((growth(Integrator::EulerMaruyama) / euler - 1.0).abs() < 1e-9);
    assert!((growth(Integrator::StochasticHeun) / heun - 1.0).abs() < 1e-6);
    assert!((euler / (omega * omega * step) - 1.0).abs() < 1e-3);
    assert!((heun / (f64::powi(omega, 4) * f64::powi(step, 3) / 4.0) - 1.0).abs() < 1e-6);
}

#[test]
fn a_run_may_be_cut_into_even_pieces() {
    let system = Linear::oscillator(1.0, 0.1, 0.3);
    let stepper = Stepper::new(
        &system,
        Integrator::StochasticHeun,
        0.05,
        &Cancellation::new(),
    );
    let key = StreamKey {
        seed: 1,
        cell: 2,
        block: 3,
    };
    let run = |pieces: &[usize]| {
        let mut stream = NormalStream::new(key);
        let mut states = [[0.5; LANES]; 2];
        let mut first = 0;
        for &steps in pieces {
            stepper
                .advance(&mut states, first, steps, &mut stream)
                .unwrap();
            first += steps;
        }
        states
    };
    assert_eq!(run(&[57]), run(&[20, 2, 35]));
}

/// dx = -x³ dt + √2 dW, whose density is as exp(-x⁴/4).
struct Quartic([Noise; 1]);

impl System for Quartic {
    fn dimension(&self) -> usize {
        1
    }
    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        drift[0] = states[0].map(|x| -x * x * x);
    }
    fn noises(&self) -> &[Noise] {
        &self.0
    }
}

/// E x² and E x⁴ of its steady state over 1.3 million units of time, each less what it is exactly.
fn quartic_bias(integrator: Integrator, step: f64) -> [f64; 2] {
    let system = Quartic([Noise::constant(0, std::f64::consts::SQRT_2)]);
    let stepper = Stepper::new(&system, integrator, step, &Cancellation::new());
    let mut stream = NormalStream::new(StreamKey {
        seed: 5,
        cell: 0,
        block: 0,
    });
    let mut states = [[0.0; LANES]];
    stepper.advance(&mut states, 0, 200, &mut stream).unwrap();
    let looks = (2e4 / (4.0 * step)) as usize;
    let mut sums = [0.0; 2];
    for _ in 0..looks {
        stepper.advance(&mut states, 0, 4, &mut stream).unwrap();
        for x in states[0] {
            sums[0] += x * x;
            sums[1] += x.powi(4);
        }
    }
    // 2 Γ(3/4)/Γ(1/4), and 1 by partial integration.
    let exact = [0.675_978_240_067_284_7, 1.0];
    [0, 1].map(|k| sums[k] / (looks * LANES) as f64 - exact[k])
}

#[test]
fn numbers_for_laws_leave_the_bias_of_normal_ones_which_falls_in_second_order() {
    let [coarse, fine] = [0.2, 0.1].map(|step| quartic_bias(Integrator::WeakHeun, step));
    let normal = quartic_bias(Integrator::StochasticHeun, 0.1);
    for moment in 0..2 {
        let ratio = coarse[moment] / fine[moment];
        assert!((3.0..6.0).contains(&ratio), "{coarse:?} {fine:?}");
        let off = (fine[moment] - normal[moment]).abs();
        assert!(off < 0.2 * normal[moment].abs(), "{fine:?} {normal:?}");
    }
}
