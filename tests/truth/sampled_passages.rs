//! Times of first passage by free trajectories against closed forms, quadrature and the generator.

use std::f64::consts::PI;

use pbif::cancellation::Cancellation;
use pbif::monte_carlo::{
    ExitNumber, ExitTimes, PassageRun, PassageStart, SteadyStart, first_passages,
};
use pbif::sampling::Integrator;
use pbif::space::{Axis, CellSpace};
use pbif::system::regions;

use crate::common::steady::ito_model;
use crate::common::sweeps::{measure, solved};
use crate::passages::brownian_survival;

/// Axes with their drifts, or with the amplitudes of their noises.
type Given<'a> = &'a [(&'a str, &'a str)];

/// How paths are followed: time step, number of paths and the longest time.
struct Effort(f64, usize, f64);

/// Where they start: at a state, or as the steady state is spread in a region.
enum From<'a> {
    State(&'a [f64]),
    Region(&'a str),
}

/// The times of paths of a system, given by equations and amplitudes of noise, until an inequality holds.
fn follow(
    (equations, noise): (Given<'_>, Given<'_>),
    (from, until): (From<'_>, &str),
    Effort(time_step, paths, longest): Effort,
) -> ExitTimes {
    let model = ito_model(equations, noise);
    let values = model.values(&[]).unwrap();
    let bound = |text: &str| {
        let region = regions(&model, &[("one", text)]).unwrap().remove(0);
        region.level().bind(&values).unwrap()
    };
    let axes = equations
        .iter()
        .map(|_| Axis::uniform(-3.0, 3.0, 40).unwrap());
    let space = CellSpace::new(axes.collect()).unwrap();
    let run = PassageRun {
        time_step,
        integrator: Integrator::StochasticHeun,
        seed: 3,
        paths,
        longest,
    };
    let region = match &from {
        From::Region(text) => Some(bound(text)),
        From::State(_) => None,
    };
    let start = match from {
        From::State(state) => PassageStart::State(state),
        From::Region(_) => PassageStart::Steady(SteadyStart {
            region: region.as_ref(),
            states: &[],
            time_step,
            burn_in: 12.0,
            spacing: 3.0,
        }),
    };
    let system = model.system_with(&[]).unwrap();
    let never = Cancellation::new();
    let found = first_passages(&*system, &space, &bound(until), &start, &run, &never).unwrap();
    assert_eq!(found.runaways(), 0);
    found
}

/// A number lies within four of its stated errors of the exact one, and its error is small.
#[track_caller]
fn holds(what: &str, found: ExitNumber, exact: f64, largest: f64) {
    let error = found.error();
    let off = (found.value - exact) / error;
    println!(
        "{what}: {:.6} ± {error:.1e} (sampling {:.1e}, step {:.1e} ± {:.1e}), exact {exact:.6}, off by {off:.2} of it",
        found.value, found.sampling, found.step.0, found.step.1
    );
    assert!(
        off.abs() < 4.0,
        "{what}: {} ± {error}, exactly {exact}",
        found.value
    );
    assert!(
        error < largest * exact.abs(),
        "{what}: {} ± {error}",
        found.value
    );
}

const FREE: (Given<'static>, Given<'static>) = (&[("x", "0 x")], &[("x", "1")]);

#[test]
fn brownian_motion_leaves_an_interval_as_the_series_says() {
    // From the middle of (-1, 1): T = 1, its variance 2/3, its rate π²/8.
    let series = brownian_survival;
    let found = follow(
        FREE,
        (From::State(&[0.0]), "abs(x) > 1"),
        Effort(0.02, 65_536, 100.0),
    );
    let times = [0.2, 1.0, 4.0];
    let numbers = found.numbers(&times, &[0.5]);
    holds("mean", numbers[0], 1.0, 0.01);
    holds("sd", numbers[1], (2.0_f64 / 3.0).sqrt(), 0.01);
    holds("rate", numbers[2], PI * PI / 8.0, 0.02);
    for (time, number) in times.iter().zip(&numbers[3..]) {
        holds(&format!("S({time})"), *number, series(*time), 0.1);
    }
    let median = numbers[6];
    let slope = (series(median.value + 0.01) - series(median.value - 0.01)) / 0.02;
    let exact = median.value - (series(median.value) - 0.5) / slope;
    holds("median", median, exact, 0.01);
}

#[test]
fn a_border_is_where_it_is_however_its_level_or_the_noise_changes_toward_it() {
    // Brownian motion from a place between two borders takes the product of the distances: of cos(πx), of x² and of
    // ln x, which moves without drift.
    let level = format!("cos(pi*x) > {:.17}", (0.1 * PI).cos());
    let free = |from: &'static [f64], until: &str| {
        follow(FREE, (From::State(from), until), Effort(0.01, 65_536, 40.0))
    };
    holds("cos", free(&[0.5], &level).numbers(&[], &[])[0], 0.56, 0.02);
    holds(
        "|x|",
        free(&[0.5], "abs(x) < 0.1 or abs(x - 2) < 0.1").numbers(&[], &[])[0],
        0.56,
        0.02,
    );
    holds(
        "square",
        free(&[0.3], "x^2 > 1").numbers(&[], &[])[0],
        0.91,
        0.02,
    );
    let growing: (Given<'_>, Given<'_>) = (&[("x", "0.125 x")], &[("x", "0.5 x")]);
    let found = follow(
        growing,
        (From::State(&[1.0]), "x > 2 or x < 0.5"),
        Effort(0.02, 65_536, 100.0),
    );
    let exact = (2.0_f64.ln() / 0.5).powi(2);
    holds("logarithm", found.numbers(&[], &[])[0], exact, 0.02);
}

#[test]
fn paths_that_are_given_up_are_counted_by_the_rate_of_the_others() {
    let found = follow(
        FREE,
        (From::State(&[0.0]), "abs(x) > 1"),
        Effort(0.02, 65_536, 0.8),
    );
    let left = 1.0 - found.exits() as f64 / found.paths() as f64;
    assert!(left > 0.4, "{left}");
    let numbers = found.numbers(&[4.0], &[0.9]);
    holds("mean", numbers[0], 1.0, 0.02);
    holds("sd", numbers[1], (2.0_f64 / 3.0).sqrt(), 0.03);
    holds("S(4)", numbers[3], 4.0 / PI * (-PI * PI / 2.0).exp(), 0.3);
    holds(
        "deciles",
        numbers[4],
        (40.0 / PI).ln() * 8.0 / (PI * PI),
        0.03,
    );
}

#[test]
fn an_ornstein_uhlenbeck_process_leaves_interval_and_disc_as_closed_forms_say() {
    // dx = -x dt + √2 dW until |x| = 2: T(0) = ∫_0^2 e^{y²/2} ∫_0^y e^{-z²/2} dz dy, by its series.
    let root = std::f64::consts::SQRT_2.to_string();
    let one = (&[("x", "-x")][..], &[("x", root.as_str())][..]);
    let found = follow(
        one,
        (From::State(&[0.0]), "abs(x) > 2"),
        Effort(0.05, 65_536, 1e3),
    );
    // y'' - x y' = -1: y = -Σ 2ⁿ n!/(2n+2)! x^{2n+2} from the middle, so T is the sum at x = 2.
    let terms = (0..60).scan(2.0, |term: &mut f64, n| {
        let now = *term;
        *term *= 4.0 * f64::from(2 * n + 2) / f64::from((2 * n + 3) * (2 * n + 4));
        Some(now)
    });
    holds("interval", found.numbers(&[], &[])[0], terms.sum(), 0.01);
    let two = (
        &[("x", "-x"), ("y", "-y")][..],
        &[("x", root.as_str()), ("y", root.as_str())][..],
    );
    let radius = 1.5_f64;
    let series = (1..40).scan(1.0, |term, k| {
        *term *= radius * radius / (2.0 * f64::from(k));
        Some(*term / (2.0 * f64::from(k)))
    });
    let border = (From::State(&[0.0, 0.0]), "x^2 + y^2 > 1.5^2");
    let found = follow(two, border, Effort(0.005, 65_536, 1e3));
    holds("disc", found.numbers(&[], &[])[0], series.sum(), 0.01);
}

#[test]
fn a_lightly_damped_oscillator_reaches_its_limit_as_the_generator_says() {
    let equations = [("x", "y"), ("y", "-x - 0.16 y")];
    // Variance 1/(4 ζ) · σ² with σ² = 0.32 is 1.
    let noise = [("y", "sqrt(0.32)")];
    let border = (From::State(&[0.0, 0.0]), "abs(x) > 2");
    let found = follow((&equations, &noise), border, Effort(0.1, 65_536, 1e4));
    let numbers = found.numbers(&[], &[]);
    holds("oscillator", numbers[0], 48.1490, 0.01);
    holds("oscillator, rate", numbers[2], 0.023_754_1, 0.02);
}

#[test]
fn an_integrated_brownian_motion_leaves_an_interval_as_the_closed_form_says() {
    // J. Masoliver and J. M. Porrà, Physical Review Letters 75, 1995.
    let motion = (&[("x", "v"), ("v", "0 v")][..], &[("v", "1")][..]);
    let border = (From::State(&[0.5, 0.0]), "x < 0 or x > 1");
    let found = follow(motion, border, Effort(0.02, 65_536, 1e3));
    holds("integrated", found.numbers(&[], &[])[0], 1.456_44, 0.01);
}

#[test]
fn a_well_is_left_from_a_state_and_from_the_density_in_it() {
    let noise = 0.2_f64.sqrt().to_string();
    let well = (&[("x", "x - x^3")][..], &[("x", noise.as_str())][..]);
    let found = follow(
        well,
        (From::State(&[-1.0]), "x > 0"),
        Effort(0.05, 32_768, 1e4),
    );
    // By quadrature.
    holds("well", found.numbers(&[], &[])[0], 30.8213, 0.02);
    // Weighted by p = exp((x²/2 - x⁴/4)/D) over x < -0.5: T(x) = (1/D) ∫_x^0 ∫_{-∞}^y p(z)/p(y) dz dy.
    let found = follow(
        well,
        (From::Region("x < -0.5"), "x > 0"),
        Effort(0.05, 32_768, 1e4),
    );
    let (mut inner, mut times, n, low) = (0.0, vec![0.0; 26_001], 26_000, -2.6);
    let h = -low / f64::from(n);
    let p = |x: f64| ((x * x / 2.0 - x.powi(4) / 4.0) / 0.1).exp();
    let place = |k: i32| low + h * f64::from(k);
    let mut slopes = Vec::new();
    for k in 0..=n {
        inner += h * p(place(k)) * if k == 0 { 0.5 } else { 1.0 };
        slopes.push((inner - 0.5 * h * p(place(k))) / (0.1 * p(place(k))));
    }
    for k in (0..n as usize).rev() {
        times[k] = times[k + 1] + 0.5 * h * (slopes[k] + slopes[k + 1]);
    }
    let inside = (0..n).filter(|&k| place(k) < -0.5);
    let (sum, mass) = inside.fold((0.0, 0.0), |(sum, mass), k| {
        (sum + p(place(k)) * times[k as usize], mass + p(place(k)))
    });
    holds(
        "well, from its density",
        found.numbers(&[], &[])[0],
        sum / mass,
        0.02,
    );
}

#[test]
fn a_rate_is_that_of_the_tail_where_exits_become_rarer_and_more_frequent_again() {
    // A rotation brings paths to the corner by turns: the first halves of the exits agree by chance. The
    // generator knows the rate to a thousandth.
    let text = r#"
[system.equations]
x = "-x - 2 y"
y = "-y + 2 x"
[system.noise]
x = "s"
y = "s"
[system.parameters]
s = 0.8
[sweep]
parameter = "s"
from = 0.7
to = 0.9
points = 2
[cells]
x = { from = -2.6, to = 2.6, count = 60 }
y = { from = -2.6, to = 2.6, count = 60 }
[passage]
l = { start = { x = 0, y = 0 }, until = "x > 0.5 or y > 0.7" }
"#;
    let rate = |words: &str| measure(&solved(text, words, Some(0.9)).1, "l_rate");
    let (exact, rest) = rate("");
    for seed in [1, 2] {
        let words = format!("method.kind=monte-carlo method.passages=32768 method.seed={seed}");
        let (value, error) = rate(&words);
        let off = (value - exact).abs();
        println!("{value} ± {error:.1e}, generator {exact} ± {rest:.1e}");
        assert!(off < 4.0 * error + rest && error < 0.05 * value, "{seed}");
    }
}
