//! Power spectra, cross spectra and correlation functions against closed forms and other discretisations.

use std::sync::Arc;
use std::time::Instant;

use nalgebra::{Complex, Matrix2};
use pbif::cancellation::Cancellation;
use pbif::continuation::Label;
use pbif::generator::GeneratorOptions;
use pbif::spectrum::{Power, PowerQuestion, Spectrum, StateFunction, Steady, power_spectra};
use pbif::stationary::generator::RateOptions;
use pbif::system::Model;

use crate::common::numbers::{Numbers, assert_holds, given};
use crate::common::steady::{even_cells, masses, model, random_linear};

/// Spectra of a model on even cells.
fn spectra(model: &Arc<Model>, axes: &[(f64, f64, usize)], question: &PowerQuestion<'_>) -> Power {
    let (system, space) = (model.system_with(&[]).unwrap(), even_cells(axes));
    let steady = Steady {
        masses: &masses(&*system, &space),
        closed: &vec![[false; 2]; axes.len()],
        phase: None,
    };
    let settings = (&GeneratorOptions::default(), &RateOptions::default());
    let (never, clock) = (Cancellation::new(), Instant::now());
    let found = power_spectra(&system, &space, question, steady, settings, &never).unwrap();
    println!("{:?} in {:.2} s", found.work, clock.elapsed().as_secs_f64());
    found
}

/// Whether every number of a curve is an exact one within its error; the largest share, and the median and largest
/// error relative to the largest value.
#[track_caller]
fn hold(what: &str, known: &[(f64, f64)], exact: &[f64]) -> f64 {
    assert_eq!(known.len(), exact.len());
    let largest = exact
        .iter()
        .fold(0.0, |most: f64, value| most.max(value.abs()));
    let share = |((value, error), exact): (&(f64, f64), &f64)| {
        // Rounding of the exact values.
        (value - exact).abs() / (error + 1e-12 * largest)
    };
    let shares: Vec<f64> = known.iter().zip(exact).map(share).collect();
    let worst = shares.iter().copied().fold(0.0, f64::max);
    let place = shares.iter().position(|one| *one == worst).unwrap();
    let mut sorted = shares.clone();
    sorted.sort_by(f64::total_cmp);
    let mut relative: Vec<f64> = known
        .iter()
        .map(|(value, error)| error / value.abs())
        .collect();
    relative.sort_by(f64::total_cmp);
    println!(
        "  {what}: worst {worst:.2} of the error at {place} ({:.6e} ± {:.1e}, exact {:.6e}), median {:.2}; stated {:.1e} to {:.1e}, median {:.1e}",
        known[place].0,
        known[place].1,
        exact[place],
        sorted[sorted.len() / 2],
        relative[0],
        relative[relative.len() - 1],
        relative[relative.len() / 2]
    );
    worst
}

/// S(ω) of an observable of dx = -U'(x) dt + √(2D) dW by a chain of states with rates that keep detailed balance, to
/// second order in their distance.
fn of_chain(
    (potential, observable): (&dyn Fn(f64) -> f64, &dyn Fn(f64) -> f64),
    diffusion: f64,
    (from, to): (f64, f64),
    count: usize,
    frequencies: &[f64],
) -> Vec<f64> {
    let step = (to - from) / count as f64;
    let place = |state: f64| from + step * (state + 0.5);
    let rate = |a: f64, b: f64| {
        let rise = potential(place(b)) - potential(place(a));
        diffusion / step.powi(2) * (-0.5 * rise / diffusion).exp()
    };
    let states: Vec<f64> = (0..count).map(|state| state as f64).collect();
    let weights: Vec<f64> = states
        .iter()
        .map(|&state| (-potential(place(state)) / diffusion).exp())
        .collect();
    let whole: f64 = weights.iter().sum();
    let values: Vec<f64> = states
        .iter()
        .map(|&state| observable(place(state)))
        .collect();
    let mean = weights.iter().zip(&values).map(|(w, g)| w * g).sum::<f64>() / whole;
    let up: Vec<f64> = (1..count)
        .map(|one| rate(states[one - 1], states[one]))
        .collect();
    let down: Vec<f64> = (1..count)
        .map(|one| rate(states[one], states[one - 1]))
        .collect();
    let of = |&frequency: &f64| {
        // (iω - Q) z = p (g - ⟨g⟩) by elimination along the chain.
        let (mut pivots, mut rest) = (Vec::new(), Vec::new());
        for state in 0..count {
            let outward = if state + 1 < count { up[state] } else { 0.0 };
            let inward = if state > 0 { down[state - 1] } else { 0.0 };
            let mut pivot = Complex::new(outward + inward, frequency);
            let mut source = Complex::from(weights[state] / whole * (values[state] - mean));
            if state > 0 {
                let factor = up[state - 1] / pivots[state - 1];
                pivot -= factor * down[state - 1];
                source += factor * rest[state - 1];
            }
            pivots.push(pivot);
            rest.push(source);
        }
        let mut sum = Complex::from(0.0);
        let mut above = Complex::from(0.0);
        for state in (0..count).rev() {
            let flow = if state + 1 < count { down[state] } else { 0.0 };
            above = (rest[state] + above * flow) / pivots[state];
            sum += above * (values[state] - mean);
        }
        2.0 * sum.re
    };
    frequencies.iter().map(of).collect()
}

#[test]
fn a_double_well_has_its_spectrum_over_decades() {
    let x: StateFunction<'_> = &|state| state[0];
    for noise in [0.5f64, 0.3] {
        let model = model(&[("x", "x - x^3")], &[("x", &noise.to_string())]);
        let frequencies: Vec<f64> = (0..100)
            .map(|number| 1e-5 * 10f64.powf(0.06 * f64::from(number)))
            .collect();
        let question = PowerQuestion {
            observables: &[x],
            pairs: &[(0, 0)],
            frequencies: &frequencies,
            lags: (0.0, 0),
        };
        let found = spectra(&model, &[(-2.2, 2.2, 160)], &question);
        let potential = |x: f64| 0.25 * x.powi(4) - 0.5 * x * x;
        let of = |count| {
            of_chain(
                (&potential, &|x| x),
                0.5 * noise * noise,
                (-2.2, 2.2),
                count,
                &frequencies,
            )
        };
        let pairs = of(4000).into_iter().zip(of(8000));
        let exact: Vec<f64> = pairs.map(|(a, b)| (4.0 * b - a) / 3.0).collect();
        let decades = (exact[0] / exact[99]).log10();
        println!("noise {noise}: {decades:.1} decades");
        assert!(hold("x", &found.spectra[0].real, &exact) <= 1.0);
    }
}

#[test]
fn dry_friction_has_its_spectrum() {
    // v' = -sgn v + 0.8 ξ, on cells with a face on the jump.
    let model = model(&[("v", "-sign(v)")], &[("v", "0.8")]);
    let v: StateFunction<'_> = &|state| state[0];
    let frequencies = along(10.0, 101);
    let question = PowerQuestion {
        observables: &[v],
        pairs: &[(0, 0)],
        frequencies: &frequencies,
        lags: (0.0, 0),
    };
    let found = spectra(&model, &[(-6.0, 6.0, 160)], &question);
    let of = |count| of_chain((&f64::abs, &|v| v), 0.32, (-6.0, 6.0), count, &frequencies);
    let pairs = of(4000).into_iter().zip(of(8000));
    let exact: Vec<f64> = pairs.map(|(a, b)| (4.0 * b - a) / 3.0).collect();
    assert!(hold("v", &found.spectra[0].real, &exact) <= 1.0);
}

/// A system without a closed form: errors on coarse cells against the same on many.
#[track_caller]
fn against_finer(model: &Arc<Model>, range: [f64; 2], counts: [usize; 2], to: f64) -> f64 {
    let x: StateFunction<'_> = &|state| state[0];
    let y: StateFunction<'_> = &|state| state[1];
    let frequencies = along(to, 161);
    let question = PowerQuestion {
        observables: &[x, y],
        pairs: &[(0, 0), (1, 1)],
        frequencies: &frequencies,
        lags: (0.5, 40),
    };
    let [coarse, fine] = counts.map(|count| {
        let axes = range.map(|end| (-end, end, count));
        spectra(model, &axes, &question)
    });
    let mut worst = 0.0f64;
    for (name, (one, other)) in ["x", "y"]
        .into_iter()
        .zip(coarse.spectra.iter().zip(&fine.spectra))
    {
        let values = |known: &[(f64, f64)]| known.iter().map(|known| known.0).collect::<Vec<f64>>();
        worst = worst.max(hold(name, &one.real, &values(&other.real)));
        worst = worst.max(hold("C", &one.correlation, &values(&other.correlation)));
        println!("{:?}\n{:?}", one.features, other.features);
    }
    worst
}

#[test]
fn a_bistable_oscillator_has_the_spectrum_of_finer_cells() {
    let drift = "x - x^3 - 0.25 y";
    let model = model(&[("x", "y"), ("y", drift)], &[("y", "0.3")]);
    assert!(against_finer(&model, [2.3, 2.0], [60, 110], 4.0) <= 1.0);
}

#[test]
fn a_limit_cycle_has_the_spectrum_of_finer_cells() {
    let drift = "0.5 (1 - x^2) y - x";
    let model = model(&[("x", "y"), ("y", drift)], &[("y", "0.6")]);
    assert!(against_finer(&model, [4.6, 6.0], [60, 110], 4.0) <= 1.0);
}

fn along(to: f64, count: usize) -> Vec<f64> {
    (0..count)
        .map(|number| to * number as f64 / (count - 1) as f64)
        .collect()
}

#[test]
fn a_linear_state_has_a_lorentzian() {
    let model = model(&[("x", "-0.7 x")], &[("x", "0.5")]);
    let spread = 0.5 / 1.4f64.sqrt();
    let x: StateFunction<'_> = &|state| state[0];
    let squared: StateFunction<'_> = &|state| state[0] * state[0];
    let frequencies = along(6.0, 121);
    let question = PowerQuestion {
        observables: &[x, squared],
        pairs: &[(0, 0), (1, 1), (0, 1)],
        frequencies: &frequencies,
        lags: (0.2, 30),
    };
    let found = spectra(&model, &[(-6.0 * spread, 6.0 * spread, 120)], &question);
    let variance = spread * spread;
    let lorentzian = |rate: f64, variance: f64| {
        let at = frequencies
            .iter()
            .map(|w| 2.0 * rate * variance / (rate * rate + w * w));
        at.collect::<Vec<f64>>()
    };
    let mut worst = hold("x", &found.spectra[0].real, &lorentzian(0.7, variance));
    let of_squares = lorentzian(1.4, 2.0 * variance * variance);
    worst = worst.max(hold("x^2", &found.spectra[1].real, &of_squares));
    let lags = (0..30).map(|lag| variance * (-0.7 * 0.2 * f64::from(lag)).exp());
    worst = worst.max(hold(
        "C",
        &found.spectra[0].correlation,
        &lags.collect::<Vec<f64>>(),
    ));
    let features = found.spectra[0].features.unwrap();
    println!("{features:?}");
    assert_holds(features.correlation_time.unwrap().into(), 1.0 / 0.7, 1e-3);
    assert_holds(features.curvature.unwrap().into(), -2.0 / 0.49, 1e-2);
    assert_eq!(features.peak, None);
    // Odd and even fluctuations have nothing in common.
    for (real, imaginary) in found.spectra[2]
        .real
        .iter()
        .zip(&found.spectra[2].imaginary)
    {
        assert!(
            real.0.abs() < 1e-9 && imaginary.0.abs() < 1e-9,
            "{real:?} {imaginary:?}"
        );
    }
    assert!(worst <= 1.0, "{worst}");
}

/// S(ω) = (iω - A)⁻¹ N (-iω - Aᵀ)⁻¹ of a linear system.
fn exact([a, b, c, d]: [f64; 4], noises: [f64; 2], frequency: f64) -> Matrix2<Complex<f64>> {
    let i = Complex::new(0.0, frequency);
    let [a, b, c, d] = [a, b, c, d].map(Complex::from);
    let resolvent = Matrix2::new(i - a, -b, -c, i - d).try_inverse().unwrap();
    let noise =
        Matrix2::from_diagonal(&nalgebra::Vector2::new(noises[0], noises[1]).map(Complex::from));
    resolvent * noise * resolvent.adjoint()
}

/// Checks the three spectra of a linear system; the largest share of an error.
fn check_linear(
    what: &str,
    found: &[Spectrum],
    frequencies: &[f64],
    matrix: [f64; 4],
    noises: [f64; 2],
) -> f64 {
    let of = |row: usize, column: usize, is_real: bool| {
        let at = frequencies.iter().map(|&frequency| {
            let value = exact(matrix, noises, frequency)[(row, column)];
            if is_real { value.re } else { value.im }
        });
        at.collect::<Vec<f64>>()
    };
    println!("{what}");
    let mut worst = hold("xx", &found[0].real, &of(0, 0, true));
    worst = worst.max(hold("yy", &found[1].real, &of(1, 1, true)));
    worst = worst.max(hold("xy real", &found[2].real, &of(0, 1, true)));
    worst.max(hold("xy imaginary", &found[2].imaginary, &of(0, 1, false)))
}

/// x'' = -x - g x' + √(2 g) ξ, of which x and x' are normal with variance one.
struct Noisy {
    damping: f64,
}

/// What jumps or bends with x: its sign about a place, or its size.
#[derive(Debug, Clone, Copy)]
enum Sharp {
    Sign(f64),
    Size,
}

impl Sharp {
    fn at(self, x: f64) -> f64 {
        match self {
            Self::Sign(place) => f64::from(i8::from(x > place) - i8::from(x < place)),
            Self::Size => x.abs(),
        }
    }

    /// Its covariance at two times at which x has a correlation. That of the sign is the integral over the correlation
    /// of four times the density at (place, place).
    fn covariance(self, correlation: f64) -> f64 {
        let angle = correlation.clamp(-1.0, 1.0).asin();
        match self {
            Self::Sign(place) => {
                let steps = 64;
                let step = angle / f64::from(steps);
                let at = (0..steps).map(|k| step * (f64::from(k) + 0.5));
                let sum: f64 = at
                    .map(|angle| (-place * place / (1.0 + angle.sin())).exp())
                    .sum();
                2.0 / std::f64::consts::PI * step * sum
            }
            Self::Size => 2.0 / std::f64::consts::PI * (angle.cos() + correlation * angle - 1.0),
        }
    }
}

impl Noisy {
    fn correlation(&self, lag: f64) -> f64 {
        let frequency = (1.0 - 0.25 * self.damping * self.damping).sqrt();
        let phase = frequency * lag;
        (-0.5 * self.damping * lag).exp()
            * (phase.cos() + 0.5 * self.damping / frequency * phase.sin())
    }

    /// The power of what is sharp, by the trapezoidal rule over lags.
    fn power(&self, sharp: Sharp, frequencies: &[f64]) -> Vec<f64> {
        let step = 1e-3;
        let count = (40.0 / self.damping / step) as usize;
        let lags = (0..count).map(|k| sharp.covariance(self.correlation(step * k as f64)));
        let lags: Vec<f64> = lags.collect();
        let of = |&frequency: &f64| {
            let at = |(k, value): (usize, &f64)| value * (frequency * step * k as f64).cos();
            let sum: f64 = lags.iter().enumerate().map(at).sum();
            2.0 * step * (sum - 0.5 * lags[0])
        };
        frequencies.iter().map(of).collect()
    }

    /// The largest share of a stated error, and the largest relative difference.
    fn check(&self, cells: usize, sharps: [Sharp; 2], frequencies: &[f64]) -> (f64, f64) {
        let damping = self.damping;
        let (force, noise) = (format!("-x - {damping} y"), format!("sqrt(2*{damping})"));
        let model = model(&[("x", "y"), ("y", &force)], &[("y", &noise)]);
        let one = move |state: &[f64]| sharps[0].at(state[0]);
        let other = move |state: &[f64]| sharps[1].at(state[0]);
        let question = PowerQuestion {
            observables: &[&one, &other],
            pairs: &[(0, 0), (1, 1)],
            frequencies,
            lags: (0.5, 2),
        };
        let found = spectra(&model, &[(-5.0, 5.0, cells); 2], &question);
        let mut worst = (0.0_f64, 0.0_f64);
        for (sharp, found) in sharps.into_iter().zip(&found.spectra) {
            let exact = self.power(sharp, frequencies);
            worst.0 = worst.0.max(hold(
                &format!("{sharp:?} of {cells} cells"),
                &found.real,
                &exact,
            ));
            for ((value, _), exact) in found.real.iter().zip(&exact) {
                worst.1 = worst.1.max((value / exact - 1.0).abs());
            }
            let (variance, error) = found.correlation[0];
            let off = (variance - sharp.covariance(1.0)).abs();
            assert!(off <= error + 1e-3 * variance, "{sharp:?}: {off} {error}");
        }
        worst
    }
}

#[test]
fn what_jumps_or_bends_with_a_position_has_its_spectrum() {
    let frequencies = along(6.0, 61);
    let noisy = Noisy { damping: 0.5 };
    // A face lies at zero; the other place is inside a cell.
    for sharps in [
        [Sharp::Sign(0.0), Sharp::Size],
        [Sharp::Sign(0.43), Sharp::Sign(-1.1)],
    ] {
        let (share, relative) = noisy.check(60, sharps, &frequencies);
        println!("{sharps:?}: {share:.2} of an error, {relative:.3} of the power at most");
        assert!(share <= 1.0 && relative < 0.1, "{share} {relative}");
    }
}

#[test]
#[ignore = "a minute"]
fn sharp_spectra_at_length() {
    let mut numbers = Numbers(given("PBIF_FUZZ_SEED", 5));
    let mut shares = Vec::new();
    for _ in 0..given("PBIF_RANDOM_SYSTEMS", 12) {
        let noisy = Noisy {
            damping: numbers.rounded(0.1, 1.5),
        };
        let cells = 40 + (40.0 * numbers.rounded(0.0, 1.0)) as usize;
        let sharps = [Sharp::Sign(numbers.rounded(-1.2, 1.2)), Sharp::Size];
        let found = noisy.check(cells, sharps, &along(6.0, 61));
        println!("{} {cells} {sharps:?}: {found:?}", noisy.damping);
        shares.push(found.0);
    }
    let squares = shares.iter().map(|share| share * share).sum::<f64>();
    println!(
        "root mean square {:.2}",
        (squares / shares.len() as f64).sqrt()
    );
    // One of 2928 numbers of seeds 77 and 78 passes its error, by a fifth of it.
    let above = shares.iter().filter(|share| **share > 1.0).count();
    assert!(
        above <= 1 && shares.iter().all(|share| *share <= 1.25),
        "{shares:?}"
    );
}

#[test]
fn an_oscillator_has_its_line() {
    let x: StateFunction<'_> = &|state| state[0];
    let y: StateFunction<'_> = &|state| state[1];
    let frequencies = along(4.0, 201);
    let question = PowerQuestion {
        observables: &[x, y],
        pairs: &[(0, 0), (1, 1), (0, 1)],
        frequencies: &frequencies,
        lags: (0.3, 100),
    };
    let mut worst = 0.0f64;
    for damping in [0.3f64, 0.05] {
        let drift = format!("-x - {} y", 2.0 * damping);
        let model = model(&[("x", "y"), ("y", &drift)], &[("y", "0.4")]);
        let variance = 0.16 / (4.0 * damping);
        let axis = (-6.0 * variance.sqrt(), 6.0 * variance.sqrt(), 80);
        let found = spectra(&model, &[axis, axis], &question);
        let matrix = [0.0, 1.0, -1.0, -2.0 * damping];
        worst = worst.max(check_linear(
            &format!("damping {damping}"),
            &found.spectra,
            &frequencies,
            matrix,
            [0.0, 0.16],
        ));
        let features = found.spectra[0].features.unwrap();
        println!("{features:?}");
        let exact = (1.0 - 2.0 * damping * damping).sqrt();
        assert_holds(features.peak.unwrap().into(), exact, 1e-2);
        let fast = (1.0 - damping * damping).sqrt();
        let lags = (0..100).map(|lag| {
            let lag = 0.3 * f64::from(lag);
            variance
                * (-damping * lag).exp()
                * ((fast * lag).cos() + damping / fast * (fast * lag).sin())
        });
        worst = worst.max(hold(
            "C",
            &found.spectra[0].correlation,
            &lags.collect::<Vec<f64>>(),
        ));
    }
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn errors_hold_on_random_linear_systems() {
    let (count, seed) = (given("PBIF_RANDOM_SYSTEMS", 4), given("PBIF_FUZZ_SEED", 3));
    let mut numbers = Numbers(seed);
    let mut worst = 0.0f64;
    for system in 0..count {
        let cells = 40 + 10 * (system as usize % 4);
        let Some(linear) = random_linear(&mut numbers, system, cells) else {
            continue;
        };
        let matrix = linear.matrix;
        let noises = linear.amplitudes.map(|amplitude| amplitude * amplitude);
        let x: StateFunction<'_> = &|state| state[0];
        let y: StateFunction<'_> = &|state| state[1];
        let fast = (matrix[0] * matrix[3] - matrix[1] * matrix[2]).sqrt();
        let frequencies = along(6.0 * fast, 121);
        let question = PowerQuestion {
            observables: &[x, y],
            pairs: &[(0, 0), (1, 1), (0, 1)],
            frequencies: &frequencies,
            lags: (0.0, 0),
        };
        let found = spectra(&linear.model, &linear.axes, &question);
        let what = format!("{matrix:?} {noises:?}, {cells} cells");
        worst = worst.max(check_linear(
            &what,
            &found.spectra,
            &frequencies,
            matrix,
            noises,
        ));
    }
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn a_velocity_has_a_maximum_of_power_above_zero_all_along() {
    // S of the velocity is ω² times that of the position: it rises from zero, so that nothing is born or vanishes.
    let text = r#"
[system.equations]
x = "v"
v = "x - x^3 - 0.5 v"
[system.noise]
v = "sqrt(T)"
[sweep]
parameter = "T"
from = 0.38
to = 0.43
points = 6
[cells]
x = { from = -2.8, to = 2.8, count = 40 }
v = { from = -3.2, to = 3.2, count = 40 }
[spectrum]
of = ["v"]
"#;
    let (_, result) = crate::common::sweeps::swept(text, "");
    let measures = result
        .points
        .iter()
        .flat_map(|point| &point.report.measures);
    let rises = measures.filter(|one| one.name == "spectral_rise_v");
    let rises: Vec<f64> = rises.map(|one| one.value).collect();
    assert!(
        rises.len() > 3 && rises.iter().all(|rise| *rise > 0.5),
        "{rises:?}"
    );
    assert!(
        result
            .labels
            .iter()
            .all(|row| !matches!(row, Label::Level(_)))
    );
}

/// The largest local maximum above zero of d ln S / d ln ω, S being the spectrum of x² of x'' = -k x - g x' + noise.
/// That is the spectrum of the square of x's correlation, a sum of exponentials. None where the slope only falls.
fn largest_rise_of_square(k: f64, g: f64) -> Option<f64> {
    let root = Complex::new(0.25 * g * g - k, 0.0).sqrt();
    let [one, other] = [root, -root].map(|root| root - 0.5 * g);
    let amplitudes = [other / (other - one), -one / (other - one)];
    let modes = [(one, amplitudes[0]), (other, amplitudes[1])];
    let power = |frequency: f64| -> f64 {
        let pairs = modes.iter().flat_map(|a| modes.iter().map(move |b| (a, b)));
        let each = pairs.map(|(a, b)| a.1 * b.1 / (Complex::new(0.0, frequency) - a.0 - b.0));
        each.sum::<Complex<f64>>().re
    };
    let slope = |at: f64| {
        let step = 1e-4_f64;
        (power(at * step.exp()) / power(at * (-step).exp())).ln() / (2.0 * step)
    };
    let slopes: Vec<f64> = (1..2000).map(|n| slope(f64::from(n) * 2e-3)).collect();
    let local = slopes
        .windows(3)
        .filter(|three| three[1] > three[0] && three[1] > three[2]);
    local.map(|three| three[1]).max_by(f64::total_cmp)
}

/// The spectrum of x² of a linear oscillator has a maximum above zero at q = -1. At the next given value the slope
/// d ln S / d ln ω has no maximum at all.
#[test]
fn a_line_that_is_lost_between_two_values_has_a_row() {
    let text = r#"
[system.equations]
x = "y"
y = "(-1.165 - 0.177 q) x - (1.594 + 1.028 q) y"
[system.noise]
y = "0.999"
[system.parameters]
q = 0.0
[sweep]
parameter = "q"
from = -1.0
to = 1.0
points = 5
[cells]
x = { from = -4.4, to = 4.4, count = 41 }
y = { from = -4.4, to = 4.4, count = 41 }
[detect]
marginals = ["x"]
joint = []
[watch]
w2 = "x^2"
[spectrum]
of = ["w2"]
[locate]
relative_tolerance = 1e-3
"#;
    let (_, result) = crate::common::sweeps::swept(text, "");
    let rows = result.labels.iter().filter_map(|row| match row {
        Label::Level(row) => Some(row),
        _ => None,
    });
    let rows: Vec<_> = rows.collect();
    let [row] = rows.as_slice() else {
        panic!("{} rows", rows.len());
    };
    // The zero of the largest rise by the closed form.
    let [mut below, mut above] = [-1.0, -0.85];
    for _ in 0..40 {
        let q: f64 = 0.5 * (below + above);
        let rise = largest_rise_of_square(1.165 + 0.177 * q, 1.594 + 1.028 * q);
        if rise.is_some_and(|rise| rise > 0.0) {
            below = q
        } else {
            above = q
        }
    }
    assert!(largest_rise_of_square(1.165 - 0.177, 1.594 - 1.028) > Some(0.0));
    assert!((row.value - below).abs() <= row.error && row.error < 0.02);
}

/// The spectrum of a velocity begins with ω² of the position's, and d ln S / d ln ω falls from 2 on: what it is at some
/// low frequency, as 1.886 ± 0.002, is no maximum of it.
#[test]
fn a_spectrum_that_begins_at_zero_rises_as_the_square_of_the_frequency() {
    for (stiffness, damping) in [(0.238, 1.672), (0.95, 1.9)] {
        let text = format!(
            "[system.equations]\nx = \"v\"\nv = \"-k x - {damping} v\"\n[system.noise]\nv = \"0.712\"\n\
             [system.parameters]\nk = {stiffness}\n[sweep]\nparameter = \"k\"\nfrom = {stiffness}\nto = 2\npoints = 2\n\
             [cells]\nx = {{ from = -3.96, to = 3.96, count = 36 }}\nv = {{ from = -1.93, to = 1.93, count = 36 }}\n\
             [spectrum]\nof = [\"v\"]\n"
        );
        let (_, solution) = crate::common::sweeps::solved(&text, "", Some(stiffness));
        let (rise, error) = crate::common::sweeps::measure(&solution, "spectral_rise_v");
        assert!(
            (rise - 2.0).abs() <= error.max(1e-12) && error < 0.4,
            "{rise} {error}"
        );
    }
}
