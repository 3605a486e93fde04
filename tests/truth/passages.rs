//! Times of first passage against closed forms, quadrature, and systems that are made of others.

use std::f64::consts::PI;
use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::generator::GeneratorOptions;
use pbif::monte_carlo::{PassageRun, PassageStart, PassageTarget, first_passages};
use pbif::passage::{Passage, Start, Timed, WithError, timed};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::generator::RateOptions;
use pbif::system::{Model, regions};
use statrs::function::gamma::gamma;

use crate::common::numbers::{Numbers, given, hypergeometric};
use crate::common::steady::{even_cells, model};

/// The numbers of a passage from a state until an inequality holds.
fn passage(model: &Arc<Model>, until: &str, start: &[f64], axes: &[(f64, f64, usize)]) -> Timed {
    asked(model, until, start, axes, (&[], &[]))
}

/// The same with probabilities at times, and quantiles.
fn asked(
    model: &Arc<Model>,
    until: &str,
    start: &[f64],
    axes: &[(f64, f64, usize)],
    (times, quantiles): (&[f64], &[f64]),
) -> Timed {
    let space = even_cells(axes);
    let until = regions(model, &[("until", until)]).unwrap().remove(0);
    let asked = Passage {
        until: until.level().bind(&model.values(&[]).unwrap()).unwrap(),
        exits: Vec::new(),
        start: Start::State(start.to_vec()),
        times: times.to_vec(),
        quantiles: quantiles.to_vec(),
    };
    let settings = (&GeneratorOptions::default(), &RateOptions::default());
    let system = model.system_with(&[]).unwrap();
    timed(
        &system,
        &space,
        &asked,
        None,
        settings,
        &Cancellation::new(),
    )
    .unwrap()
}

/// How many times its stated error a number is off, which must be below one, and the error small.
#[track_caller]
fn holds(what: &str, (value, error): WithError, exact: f64, largest: f64) -> f64 {
    let off = (value - exact).abs();
    println!(
        "{what}: {value:.8} ± {error:.1e}, exact {exact:.8}, off by {:.2} of it",
        off / error
    );
    assert!(off <= error, "{what}: {value} ± {error}, exactly {exact}");
    assert!(error <= largest * exact.abs(), "{what}: {value} ± {error}");
    off / error
}

/// Mean and standard deviation of the time from a to b > a of dx = -U'(x) dt + √(2D) dW, nothing below `low`.
/// T(a) = (1/D) ∫_a^b e^{U(y)/D} ∫_low^y e^{-U(z)/D} f(z) dz dy with f = 1 for the mean, and 2 T for the square.
pub(crate) fn by_quadrature(
    u: impl Fn(f64) -> f64,
    d: f64,
    a: f64,
    b: f64,
    low: f64,
) -> (f64, f64) {
    let steps = 40_000;
    let h = (b - low) / f64::from(steps);
    // The times from every point, from b downward, for a gain f at the points and between them.
    let times = |gain: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let place = |half: usize| low + 0.5 * h * half as f64;
        let weighed = |half: usize| (-u(place(half)) / d).exp() * gain(half);
        let n = 2 * steps as usize;
        let mut inner = vec![0.0; n + 1];
        for half in (0..n).step_by(2) {
            let [f0, f1, f2] = [0, 1, 2].map(|k| weighed(half + k));
            inner[half + 1] = inner[half] + h / 24.0 * (5.0 * f0 + 8.0 * f1 - f2);
            inner[half + 2] = inner[half] + h / 6.0 * (f0 + 4.0 * f1 + f2);
        }
        let outer = |half: usize| (u(place(half)) / d).exp() / d * inner[half];
        let mut sum = vec![0.0; n + 1];
        for half in (0..n).step_by(2).rev() {
            let [g0, g1, g2] = [0, 1, 2].map(|k| outer(half + k));
            sum[half + 1] = sum[half + 2] + h / 24.0 * (5.0 * g2 + 8.0 * g1 - g0);
            sum[half] = sum[half + 2] + h / 6.0 * (g0 + 4.0 * g1 + g2);
        }
        sum
    };
    let mean = times(&|_| 1.0);
    let square = times(&|half| 2.0 * mean[half]);
    // a may lie between two points of the quadrature.
    let place = (a - low) / (0.5 * h);
    let (first, share) = (place.floor() as usize, place.fract());
    let at = |values: &[f64]| (1.0 - share) * values[first] + share * values[first + 1];
    (at(&mean), (at(&square) - at(&mean).powi(2)).sqrt())
}

#[test]
fn errors_of_an_oscillator_over_a_barrier_hold_from_weak_damping_to_strong() {
    // Damping, temperature, tilt, border and start. At weak damping the density is thin along the energy.
    let wells = [
        (0.02, 0.06_f64, 0.0, 0.0, -1.0),
        (0.05, 0.08, -0.05, -0.1, -0.95),
        (0.1, 0.06, 0.0, 0.0, -1.0),
        (0.2, 0.1, 0.05, 0.1, -1.05),
        (0.5, 0.06, 0.0, 0.0, -1.0),
        (2.0, 0.08, 0.0, 0.3, -1.0),
    ];
    for (damping, temperature, tilt, border, start) in wells {
        let (drift, noise) = (
            format!("-{damping} y + x - x^3 - {tilt}"),
            (2.0 * damping * temperature).sqrt().to_string(),
        );
        let model = model(&[("x", "y"), ("y", &drift)], &[("y", &noise)]);
        let half = 1.9 * (temperature / 0.06).sqrt();
        let on = |n: usize| {
            let axes = [(-1.9, 1.9, n), (-half, half, n)];
            passage(&model, &format!("x > {border}"), &[start, 0.0], &axes)
        };
        let fine = on(200);
        for n in [80, 140] {
            let coarse = on(n);
            for (what, (value, error), (better, rest)) in [
                ("mean", coarse.mean, fine.mean),
                ("deviation", coarse.deviation, fine.deviation),
                ("rate", coarse.rate, fine.rate),
            ] {
                let off = (value - better).abs();
                println!(
                    "{damping} {n} {what}: {value:.6} ± {error:.1e}, {better:.6} ± {rest:.1e}, {:.2}",
                    off / error
                );
                assert!(off < error + rest, "{damping} {n} {what}");
            }
            // A part of second order would leave a ten-thousandth.
            let off = (coarse.mean.0 / fine.mean.0 - 1.0).abs();
            assert!(n < 140 || off < 5e-5, "{damping} {n}: {off:e}");
        }
    }
}

#[test]
fn a_passage_takes_three_factorisations_and_the_same_bits_on_any_number_of_threads() {
    let model = model(
        &[("x", "y"), ("y", "x - x^3 - 0.5 y")],
        &[("y", "sqrt(0.2)")],
    );
    let axes = [(-2.5, 2.5, 60), (-2.5, 2.5, 60)];
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        pool.install(|| passage(&model, "x > 0.5", &[-1.0, 0.0], &axes))
    });
    assert_eq!(one, two);
    assert_eq!(one.work.factorisations, 3);
    // A grid takes two passes for the times, two for their times and a density of another grid, three for what is
    // expected, and some eight vectors for the rate, of two passes each in single precision.
    assert!(one.work.passes <= 70, "{:?}", one.work);
}

#[test]
fn wells_of_one_dimension_are_left_as_quadrature_says() {
    for d in [0.05, 0.1, 0.2] {
        let noise = format!("sqrt(2*{d})");
        let model = model(&[("x", "x - x^3")], &[("x", &noise)]);
        let u = |x: f64| x.powi(4) / 4.0 - x * x / 2.0;
        for (until, end) in [("x > 0", 0.0), ("x >= 1", 1.0), ("not x < 0.37", 0.37)] {
            let (mean, deviation) = by_quadrature(u, d, -1.0, end, -2.6);
            let found = passage(&model, until, &[-1.0], &[(-2.5, 2.5, 200)]);
            holds(&format!("mean, D = {d}, {until}"), found.mean, mean, 1e-4);
            holds(
                &format!("sd, D = {d}, {until}"),
                found.deviation,
                deviation,
                1e-4,
            );
        }
    }
}

#[test]
fn an_interval_and_a_disc_are_left_as_closed_forms_say() {
    // Brownian motion from the middle of an interval of length 2: T = 1/(2D), and the rate is D (π/2)².
    let free = model(&[("x", "0 x")], &[("x", "1")]);
    let found = passage(&free, "abs(x) > 1", &[0.0], &[(-1.3, 1.3, 100)]);
    holds("interval", found.mean, 1.0, 1e-4);
    holds(
        "interval, sd",
        found.deviation,
        (2.0_f64 / 3.0).sqrt(),
        1e-4,
    );
    holds("interval, rate", found.rate, PI * PI / 8.0, 1e-4);
    // Ornstein and Uhlenbeck's process in two dimensions: T(0) = ∫_0^R (e^{s²/2} - 1)/s ds for unit variances.
    let two = [("x", "sqrt(2)"), ("y", "sqrt(2)")];
    let pair = model(&[("x", "-x"), ("y", "-y")], &two);
    let radius = 1.5_f64;
    let series = (1..40).scan(1.0, |term, k| {
        *term *= radius * radius / (2.0 * f64::from(k));
        Some(*term / (2.0 * f64::from(k)))
    });
    let exact: f64 = series.sum();
    for count in [40, 60] {
        let axis = (-2.0, 2.0, count);
        let found = passage(&pair, "x^2 + y^2 > 1.5^2", &[0.0, 0.0], &[axis, axis]);
        holds(&format!("disc, {count}"), found.mean, exact, 3e-4);
    }
}

#[test]
fn dry_friction_holds_as_long_as_the_formula_says() {
    // v' = -Δ sgn v + noise: the mean time to |v| = A is (D/Δ²)(e^{ΔA/D} - 1) - A/Δ.
    let (delta, d, a) = (0.3_f64, 0.1_f64, 1.0_f64);
    let exact = d / (delta * delta) * ((delta * a / d).exp() - 1.0) - a / delta;
    let friction = model(&[("v", "-0.3 sign(v)")], &[("v", "sqrt(0.2)")]);
    let found = passage(&friction, "abs(v) > 1", &[0.0], &[(-1.5, 1.5, 400)]);
    holds("dry friction", found.mean, exact, 1e-3);
}

#[test]
fn an_integrated_brownian_motion_leaves_an_interval_as_the_closed_form_says() {
    // J. Masoliver and J. M. Porrà, Physical Review Letters 75, 1995: x' = v, v' = ξ on 0 < x < 1, from rest.
    let motion = model(&[("x", "v"), ("v", "0 v")], &[("v", "1")]);
    let exact = |x: f64| {
        let front = 2.0_f64.cbrt() * (4.0_f64 / 3.0).powf(1.0 / 6.0) / gamma(7.0 / 3.0);
        front * (x * (1.0 - x)).powf(1.0 / 6.0) * (hypergeometric(x) + hypergeometric(1.0 - x))
    };
    for (x, largest) in [(0.5, 2e-3), (0.1, 1e-2), (0.02, 5e-2)] {
        let axes = [(-0.1, 1.1, 40), (-4.0, 4.0, 40)];
        let found = passage(&motion, "x < 0 or x > 1", &[x, 0.0], &axes);
        holds(
            &format!("integrated Brownian motion from {x}"),
            found.mean,
            exact(x),
            largest,
        );
    }
}

#[test]
fn a_barrier_across_one_of_two_independent_axes_is_reached_as_if_the_other_were_not_there() {
    let d = 0.1;
    let (mean, deviation) = by_quadrature(|x| x.powi(4) / 4.0 - x * x / 2.0, d, -1.0, 0.37, -2.6);
    let noise = [("x", "sqrt(0.2)"), ("y", "0.5")];
    let pair = model(&[("x", "x - x^3"), ("y", "-y")], &noise);
    let axes = [(-2.0, 2.0, 64), (-2.0, 2.0, 40)];
    let found = passage(&pair, "x > 0.37", &[-1.0, 0.3], &axes);
    holds("mean", found.mean, mean, 3e-3);
    holds("sd", found.deviation, deviation, 3e-3);
    // Turned by an angle, the barrier is oblique to both axes and cuts cells anywhere.
    let (c, s) = (0.8, 0.6);
    let along = "(0.8 x + 0.6 y)";
    let (along_drift, across) = (format!("({along} - {along}^3)"), "(0.8 y - 0.6 x)");
    let turned = [
        ("x", format!("0.8 {along_drift} + 0.6 {across}")),
        ("y", format!("0.6 {along_drift} - 0.8 {across}")),
    ];
    let turned: Vec<(&str, &str)> = turned
        .iter()
        .map(|(axis, drift)| (*axis, drift.as_str()))
        .collect();
    let turned = model(&turned, &[("x", "sqrt(0.2)"), ("y", "sqrt(0.2)")]);
    let axes = [(-2.2, 2.2, 64), (-2.2, 2.2, 64)];
    let start = [-c, -s];
    let found = passage(&turned, "0.8 x + 0.6 y > 0.37", &start, &axes);
    holds("oblique, mean", found.mean, mean, 3e-3);
    holds("oblique, sd", found.deviation, deviation, 3e-3);
}

#[test]
fn a_time_of_many_digits_is_a_number_with_an_error() {
    // The barrier is 35 times D high: T is about 10¹⁶.
    let d = 0.25 / 35.0;
    let (mean, _) = by_quadrature(|x| x.powi(4) / 4.0 - x * x / 2.0, d, -1.0, 1.0, -2.0);
    let noise = format!("sqrt(2*{d})");
    let well = model(&[("x", "x - x^3")], &[("x", &noise)]);
    let found = passage(&well, "x > 1", &[-1.0], &[(-2.0, 2.0, 400)]);
    assert!(mean > 1e15, "{mean}");
    holds("a rare event", found.mean, mean, 0.05);
}

/// Random wells: exact times by quadrature, cells and borders anywhere. What is off by so many of its errors.
fn random_wells(seed: u64, number: usize, axes: usize) -> Vec<f64> {
    let mut dice = Numbers(seed);
    let mut between = |from, to| dice.rounded(from, to);
    let mut all = Vec::new();
    for case in 0..number {
        let (tilt, depth) = (between(-0.2, 0.2), between(0.6, 1.5));
        let (d, end) = (between(0.06, 0.4), between(-0.1, 1.3));
        let start = between(-1.5, -0.5);
        let u = move |x: f64| depth * (x.powi(4) / 4.0 - x * x / 2.0) - tilt * x;
        let (mean, deviation) = by_quadrature(u, d, start, end, -2.8);
        let drift = format!("{depth} (x - x^3) + {tilt}");
        let noise = format!("sqrt(2*{d})");
        let (from, to) = (between(-3.2, -2.6), between(1.8, 2.6));
        let count = between(60.0, 160.0) as usize;
        let until = format!("x > {end}");
        let found = match axes {
            1 => {
                let well = model(&[("x", &drift)], &[("x", &noise)]);
                passage(&well, &until, &[start], &[(from, to, count)])
            }
            _ => {
                let equations = [("x", drift.as_str()), ("y", "-y + 0.3 sin(y)")];
                let well = model(&equations, &[("x", &noise), ("y", "0.6")]);
                let count = (count / 2).max(40);
                let across = (-3.0, 3.0, 40);
                passage(&well, &until, &[start, 0.2], &[(from, to, count), across])
            }
        };
        for ((value, error), exact) in [(found.mean, mean), (found.deviation, deviation)] {
            let off = (value - exact).abs() / error;
            if off > 1.0 {
                println!(
                    "{case}: {drift}, D = {d}, {start} to {end}, {count} cells: {value} ± {error}, exactly {exact}"
                );
            }
            all.push(off);
        }
    }
    all.sort_by(f64::total_cmp);
    println!(
        "{axes} axes: median {:.2}, largest {:.2}",
        all[all.len() / 2],
        all[all.len() - 1]
    );
    all
}

#[test]
fn stated_errors_hold_on_random_wells() {
    let seed = given("OTHER_SEEDS", 290);
    let both =
        [(60, 1), (20, 2)].map(|(number, axes)| random_wells(seed + axes as u64, number, axes));
    for all in both {
        assert!(all[all.len() - 1] <= 1.0);
        assert!(
            all[all.len() / 2] >= 0.15,
            "errors are stated much too large"
        );
    }
}

/// The probability that Brownian motion from the middle of (-1, 1) is still inside after a time:
/// S(t) = (4/π) Σ (-1)ᵏ e^{-(2k + 1)² π² D t/4} / (2k + 1), D = 1/2.
pub(crate) fn brownian_survival(t: f64) -> f64 {
    let terms = (0..200).map(|k| {
        let odd = f64::from(2 * k + 1);
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        sign * (-(odd * PI).powi(2) * t / 8.0).exp() / odd
    });
    4.0 / PI * terms.sum::<f64>()
}

#[test]
fn the_probability_to_go_on_is_that_of_the_series() {
    let free = model(&[("x", "0 x")], &[("x", "1")]);
    let times = [0.05, 0.2, 0.5, 1.0, 4.0];
    let series = brownian_survival;
    let found = asked(
        &free,
        "abs(x) > 1",
        &[0.0],
        &[(-1.3, 1.3, 100)],
        (&times, &[0.5]),
    );
    for (time, &(value, error)) in times.iter().zip(&found.survival) {
        let off = (value - series(*time)).abs();
        println!(
            "S({time}) = {value:.8} ± {error:.1e}, exact {:.8}",
            series(*time)
        );
        assert!(
            off <= error + 1e-9 && error < 1e-3,
            "S({time}) = {value} ± {error}"
        );
    }
    let (median, error) = found.quantiles[0];
    assert!(
        (series(median) - 0.5).abs() <= 0.7 * error && error < 1e-3,
        "{median} ± {error}"
    );
}

/// The numbers of a passage from a state that several inequalities end.
fn ended_by(
    model: &Arc<Model>,
    parts: &[&str],
    start: &[f64],
    axes: &[(f64, f64, usize)],
) -> Timed {
    let axes = axes
        .iter()
        .map(|&(from, to, count)| Axis::uniform(from, to, count).unwrap());
    let space = CellSpace::new(axes.collect()).unwrap();
    let values = model.values(&[]).unwrap();
    let bound = |text: &str| {
        let region = regions(model, &[("until", text)]).unwrap().remove(0);
        region.level().bind(&values).unwrap()
    };
    let either: Vec<String> = parts.iter().map(|part| format!("({part})")).collect();
    let asked = Passage {
        until: bound(&either.join(" or ")),
        exits: parts.iter().map(|part| bound(part)).collect(),
        start: Start::State(start.to_vec()),
        times: Vec::new(),
        quantiles: Vec::new(),
    };
    let settings = (&GeneratorOptions::default(), &RateOptions::default());
    let system = model.system_with(&[]).unwrap();
    let never = Cancellation::new();
    let found = timed(&system, &space, &asked, None, settings, &never).unwrap();
    // Whatever ends, ends somewhere.
    let whole: f64 = found.shares.iter().map(|share| share.0).sum();
    let error: f64 = found.shares.iter().map(|share| share.1).sum();
    println!("shares sum to {whole}, errors to {error:.1e}");
    assert!((whole - 1.0).abs() <= error + 1e-9);
    found
}

#[test]
fn brownian_motion_with_drift_leaves_an_interval_by_either_end() {
    // (1 - e^{-2 c (x - a)/s²})/(1 - e^{-2 c (b - a)/s²}) is the probability of the upper end, s² = 1/2.
    let drifting = model(&[("x", "0.4")], &[("x", "sqrt(0.5)")]);
    let exact = |x: f64| (-1.6 * (x + 1.0)).exp_m1() / (-1.6f64 * 2.3).exp_m1();
    for x in [-0.9, -0.2, 1.0] {
        let axes = [(-1.6, 1.9, 90)];
        let found = ended_by(&drifting, &["x > 1.3", "x < -1"], &[x], &axes);
        holds(
            &format!("upper end from {x}"),
            found.shares[0],
            exact(x),
            1e-2,
        );
        holds(
            &format!("lower end from {x}"),
            found.shares[1],
            1.0 - exact(x),
            2e-2,
        );
    }
}

#[test]
fn ornstein_uhlenbeck_leaves_by_the_far_end_as_often_as_quadrature_says() {
    // q' ∝ e^{x²/(2 D)}, D = 1/4.
    let spring = model(&[("x", "-x")], &[("x", "sqrt(0.5)")]);
    let slope = |x: f64| (2.0 * x * x).exp();
    let integral = |from: f64, to: f64| {
        let h = (to - from) / 20_000.0;
        (0..20_000)
            .map(|k| h * slope(from + (f64::from(k) + 0.5) * h))
            .sum::<f64>()
    };
    let exact = |x: f64| integral(-1.0, x) / integral(-1.0, 1.7);
    let axes = [(-1.9, 2.4, 120)];
    for x in [-0.8, 0.0, 1.2] {
        let found = ended_by(&spring, &["x < -1", "x > 1.7"], &[x], &axes);
        holds(
            &format!("far end from {x}"),
            found.shares[1],
            exact(x),
            2e-2,
        );
    }
}

/// The share of free paths from a state that come to the second of two regions first, and its standard error.
pub(super) fn sampled_share(
    system: &Arc<Model>,
    parts: [&str; 2],
    (space, start, paths): (&CellSpace, &[f64], usize),
) -> (f64, f64) {
    let values = system.values(&[]).unwrap();
    let bound = |text: &str| {
        let region = regions(system, &[("until", text)]).unwrap().remove(0);
        region.level().bind(&values).unwrap()
    };
    let exits = parts.map(bound);
    let until = bound(&format!("({}) or ({})", parts[0], parts[1]));
    let target = PassageTarget {
        until: &until,
        exits: &exits,
    };
    let run = PassageRun {
        time_step: 0.02,
        integrator: pbif::sampling::Integrator::StochasticHeun,
        seed: 11,
        paths,
        longest: 200.0,
    };
    let (from, never) = (PassageStart::State(start), Cancellation::new());
    let system = system.system_with(&[]).unwrap();
    let paths = first_passages(&*system, space, target, &from, &run, &never);
    let share = &paths.unwrap().numbers(&[], &[])[4];
    (share.value, share.error())
}

/// Shares of exits by the second of two regions are those of 40 000 paths from each of some states.
#[track_caller]
fn shares_are_those_of_paths(
    system: &Arc<Model>,
    parts: [&str; 2],
    axes: &[(f64, f64, usize)],
    starts: &[[f64; 2]],
) {
    let space = even_cells(axes);
    for start in starts {
        let (value, error) = ended_by(system, &parts, start, axes).shares[1];
        let (sampled, of_sample) = sampled_share(system, parts, (&space, start, 40_000));
        println!("from {start:?}: {value:.5} ± {error:.1e}, paths {sampled:.5} ± {of_sample:.1e}");
        assert!(error < 2e-3);
        assert!((value - sampled).abs() < 4.0 * of_sample + error);
    }
}

/// R. S. Maier and D. L. Stein, Physical Review E 48, 931 (1993): a drift without a potential.
#[test]
fn the_committor_of_maier_and_steins_system_is_that_of_paths() {
    let equations = [("u", "u - u^3 - 10 u v^2"), ("v", "-(1 + u^2) v")];
    let system = model(&equations, &[("u", "sqrt(0.2)"), ("v", "sqrt(0.2)")]);
    let parts = ["(u + 1)^2 + v^2 < 0.09", "(u - 1)^2 + v^2 < 0.09"];
    let axes = [(-1.8, 1.8, 72), (-1.2, 1.2, 60)];
    let starts = [[-0.4, 0.3], [0.1, 0.0], [0.2, -0.5]];
    shares_are_those_of_paths(&system, parts, &axes, &starts);
}

/// Borders that stand across a displacement, which noise does not move: processes are carried over them.
#[test]
fn shares_of_an_oscillators_exits_are_those_of_paths() {
    let system = model(
        &[("x", "y"), ("y", "-0.5 y + x - x^3")],
        &[("y", "sqrt(0.2)")],
    );
    let parts = ["x < -0.7", "x > 0.9"];
    let axes = [(-2.0, 2.0, 60), (-2.6, 2.6, 60)];
    let starts = [[0.0, 0.0], [0.1, 0.4], [-0.3, -0.1]];
    shares_are_those_of_paths(&system, parts, &axes, &starts);
}
