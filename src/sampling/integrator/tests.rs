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
struct Linear {
    matrix: Vec<Vec<f64>>,
    noise: [Noise; 1],
}

impl Linear {
    fn scalar(rate: f64, additive: Option<f64>, proportional: f64) -> Self {
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

    fn oscillator(omega: f64, damping: f64, amplitude: f64) -> Self {
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
fn steady_moments(omega: f64, damping: f64, integrator: Integrator, step: f64) -> [f64; 3] {
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
fn steady_energy(omega: f64, damping: f64, integrator: Integrator, step: f64) -> f64 {
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
