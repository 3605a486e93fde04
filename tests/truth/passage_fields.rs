//! Fields of first passage over the state where a process starts, against closed forms, quadrature and paths.

use std::f64::consts::PI;
use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::generator::GeneratorOptions;
use pbif::passage::{FieldTarget, PassageField, field};
use pbif::space::CellSpace;
use pbif::stationary::generator::RateOptions;
use pbif::system::{BoundQuantity, Model, regions};
use statrs::function::erf::erf;
use statrs::function::gamma::gamma;

use super::passages::sampled_share;
use crate::common::numbers::hypergeometric;
use crate::common::steady::{even_cells, model};

/// A field with its cells.
struct Found {
    space: CellSpace,
    field: PassageField,
}

/// The mean time until any of several inequalities holds, or the probability that one of them is the first.
fn found(
    model: &Arc<Model>,
    parts: &[&str],
    part: Option<usize>,
    axes: &[(f64, f64, usize)],
) -> Found {
    let values = model.values(&[]).unwrap();
    let bound = |text: &str| -> BoundQuantity {
        let region = regions(model, &[("until", text)]).unwrap().remove(0);
        region.level().bind(&values).unwrap()
    };
    let either: Vec<String> = parts.iter().map(|part| format!("({part})")).collect();
    let target = FieldTarget {
        until: bound(&either.join(" or ")),
        exits: parts.iter().map(|part| bound(part)).collect(),
        part,
    };
    let space = even_cells(axes);
    let settings = (&GeneratorOptions::default(), &RateOptions::default());
    let system = model.system_with(&[]).unwrap();
    let never = Cancellation::new();
    let field = field(&system, &space, &target, settings, &never).unwrap();
    Found { space, field }
}

/// What is off at all states of a field.
#[derive(Debug, Default)]
struct Off {
    states: usize,
    /// The largest difference, stated error, and share of a stated error that one is off by.
    off: f64,
    stated: f64,
    share: f64,
}

impl Found {
    /// Compares all states at which the exact value is known, to within `digits`; every stated error must hold.
    #[track_caller]
    fn holds(&self, what: &str, digits: f64, exact: impl Fn(&[f64]) -> Option<f64>) -> Off {
        let mut all = Off::default();
        for cell in 0..self.space.n_cells() {
            let state = self.space.centre(cell);
            let Some(exact) = exact(&state) else { continue };
            let (value, error) = (self.field.values[cell], self.field.errors[cell]);
            let off = (value - exact).abs();
            assert!(
                off <= error + digits,
                "{what} at {state:?}: {value} ± {error:.1e}, exactly {exact}"
            );
            all.states += 1;
            all.off = all.off.max(off);
            all.stated = all.stated.max(error);
            all.share = all.share.max(off / (error + digits));
        }
        println!("{what}: {all:?}");
        assert!(all.states > 0);
        all
    }
}

/// ∫ f by Gauss's rule of two points.
fn integral(f: &dyn Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let n = 2000;
    let h = (to - from) / f64::from(n);
    let half = 0.5 * h / 3.0_f64.sqrt();
    let middles = (0..n).map(|k| from + (f64::from(k) + 0.5) * h);
    let terms = middles.map(|x| 0.5 * h * (f(x - half) + f(x + half)));
    terms.sum()
}

/// Mean times until `end` of dx = -U'(x) dt + √(2D) dW above a wall at `low`.
fn times_to(u: impl Fn(f64) -> f64, d: f64, low: f64, end: f64) -> impl Fn(f64) -> f64 {
    let n = 100_000;
    let h = (end - low) / n as f64;
    let mut inner = 0.0;
    let mut slopes = vec![0.0; n];
    for (k, slope) in slopes.iter_mut().enumerate() {
        let x = low + (k as f64 + 0.5) * h;
        let weight = h * (-u(x) / d).exp();
        *slope = (u(x) / d).exp() / d * (inner + 0.5 * weight);
        inner += weight;
    }
    let mut times = vec![0.0; n + 1];
    for k in (0..n).rev() {
        times[k] = times[k + 1] + h * slopes[k];
    }
    move |x: f64| {
        let at = ((x - low) / h).clamp(0.0, n as f64);
        let below = (at as usize).min(n - 1);
        let share = at - below as f64;
        (1.0 - share) * times[below] + share * times[below + 1]
    }
}

#[test]
fn the_committor_of_a_double_well_is_that_of_quadrature() {
    let well = model(&[("x", "x - x^3")], &[("x", "sqrt(0.2)")]);
    let slope = |x: f64| ((x.powi(4) / 4.0 - x * x / 2.0) / 0.1).exp();
    let (a, b) = (-0.9, 0.83);
    let whole = integral(&slope, a, b);
    for (cells, largest) in [(60, 1e-4), (100, 1e-5), (160, 5e-6)] {
        let found = found(
            &well,
            &["x < -0.9", "x > 0.83"],
            Some(1),
            &[(-2.0, 2.0, cells)],
        );
        let exact = |state: &[f64]| integral(&slope, a, state[0].clamp(a, b)) / whole;
        let off = found.holds(&format!("committor, {cells}"), 1e-10, |state| {
            Some(exact(state))
        });
        assert!(off.stated < largest, "{off:?}");
    }
}

#[test]
fn mean_times_of_wells_are_those_of_quadrature_wherever_they_start() {
    // (tilt, D, border, cells)
    let cases = [
        (0.0, 0.1, 0.37, 60),
        (0.0, 0.1, 0.37, 100),
        (0.0, 0.1, 0.37, 200),
        (0.2, 0.07, 0.81, 90),
        (-0.15, 0.2, -0.03, 74),
        (-0.3, 0.15, 1.1, 120),
        (0.1, 0.4, 0.0, 50),
    ];
    for (tilt, d, border, cells) in cases {
        let (drift, noise) = (format!("x - x^3 - {tilt:?}"), format!("sqrt(2*{d})"));
        let well = model(&[("x", &drift)], &[("x", &noise)]);
        let u = move |x: f64| x.powi(4) / 4.0 - x * x / 2.0 + tilt * x;
        let times = times_to(u, d, -2.0, border);
        let found = found(
            &well,
            &[&format!("x > {border:?}")],
            None,
            &[(-2.0, 2.0, cells)],
        );
        let longest = times(-2.0);
        let off = found.holds(
            &format!("time, D = {d}, {cells}"),
            1e-7 * longest,
            |state| {
                Some(if state[0] < border {
                    times(state[0])
                } else {
                    0.0
                })
            },
        );
        assert!(off.stated < 1e-2 * longest, "{off:?}");
    }
}

#[test]
fn an_ornstein_uhlenbeck_process_leaves_an_interval_and_a_disc_in_the_time_of_closed_forms() {
    // (T'/s)' = -1/s with s = exp(x²/2).
    let line = model(&[("x", "-x")], &[("x", "sqrt(2)")]);
    let (a, b) = (-1.2, 1.73);
    let s = |x: f64| (x * x / 2.0).exp();
    let inner = |x: f64| s(x) * (PI / 2.0).sqrt() * erf(x / 2.0_f64.sqrt());
    let [one, other] = [integral(&s, a, b), integral(&inner, a, b)];
    for (cells, largest) in [(40, 1e-2), (80, 6e-4), (160, 2e-4)] {
        let found = found(
            &line,
            &["x < -1.2", "x > 1.73"],
            None,
            &[(-2.0, 2.5, cells)],
        );
        let off = found.holds(&format!("interval, {cells}"), 1e-10, |state| {
            let x = state[0].clamp(a, b);
            Some(other / one * integral(&s, a, x) - integral(&inner, a, x))
        });
        assert!(off.stated < largest, "{off:?}");
    }
    // T = ∫_r^R (e^{s²/2} - 1)/s ds.
    let noise = [("x", "sqrt(2)"), ("y", "sqrt(2)")];
    let plane = model(&[("x", "-x"), ("y", "-y")], &noise);
    let series = |r: f64| -> f64 {
        let terms = (1..60).scan(1.0, |term, k| {
            *term *= r * r / (2.0 * f64::from(k));
            Some(*term / (2.0 * f64::from(k)))
        });
        terms.sum()
    };
    for (cells, largest) in [(40, 0.1), (60, 1e-2), (100, 4e-3)] {
        let axis = (-2.0, 2.0, cells);
        let found = found(&plane, &["x^2 + y^2 > 1.5^2"], None, &[axis, axis]);
        let off = found.holds(&format!("disc, {cells}"), 1e-12, |state| {
            Some(series(1.5) - series(state[0].hypot(state[1]).min(1.5)))
        });
        assert!(off.stated < largest, "{off:?}");
    }
}

#[test]
fn brownian_motion_in_a_ring_comes_to_the_outer_circle_as_the_logarithm_says() {
    let noise = [("x", "1"), ("y", "1")];
    let free = model(&[("x", "0 x"), ("y", "0 y")], &noise);
    for (cells, largest) in [(40, 1.0), (60, 1e-2), (100, 4e-3)] {
        let axis = (-2.0, 2.0, cells);
        let circles = ["x^2 + y^2 > 1.5^2", "x^2 + y^2 < 0.4^2"];
        let found = found(&free, &circles, Some(0), &[axis, axis]);
        let off = found.holds(&format!("ring, {cells}"), 1e-12, |state| {
            let share = (state[0].hypot(state[1]) / 0.4).ln() / (1.5_f64 / 0.4).ln();
            Some(share.clamp(0.0, 1.0))
        });
        assert!(off.stated <= largest, "{off:?}");
    }
}

/// J. Masoliver and J. M. Porrà, Physical Review Letters 75, 1995: from rest.
#[test]
fn an_integrated_brownian_motion_leaves_an_interval_as_the_closed_form_and_finer_cells_say() {
    let motion = model(&[("x", "v"), ("v", "0 v")], &[("v", "1")]);
    let exact = |x: f64| {
        let front = 2.0_f64.cbrt() * (4.0_f64 / 3.0).powf(1.0 / 6.0) / gamma(7.0 / 3.0);
        front * (x * (1.0 - x)).powf(1.0 / 6.0) * (hypergeometric(x) + hypergeometric(1.0 - x))
    };
    let on = |cells: usize| {
        // An odd number: states of rest are centres of cells.
        let axes = [(-0.1, 1.1, cells), (-4.0, 4.0, cells + 1)];
        found(&motion, &["x < 0", "x > 1"], None, &axes)
    };
    let rest = |state: &[f64]| {
        let is_rest = state[1].abs() < 1e-9 && 0.0 < state[0] && state[0] < 1.0;
        is_rest.then(|| exact(state[0]))
    };
    let coarse = on(40);
    assert!(coarse.holds("from rest, 40", 1e-6, rest).stated < 5e-2);
    assert!(on(60).holds("from rest, 60", 1e-6, rest).stated < 2e-2);
    let axes = [(-0.1, 1.1, 120), (-4.0, 4.0, 123)];
    let fine = found(&motion, &["x < 0", "x > 1"], None, &axes);
    assert!(fine.holds("from rest, 120", 1e-6, rest).stated < 5e-3);
    // Centres of 40 × 41 cells are centres of the finer ones, too.
    coarse.holds("40 against 120", 5e-3, |state| {
        let cell = fine.space.find(state)?;
        let centre = fine.space.centre(cell);
        let is_same = (centre[0] - state[0]).hypot(centre[1] - state[1]) < 1e-9;
        is_same.then(|| fine.field.values[cell])
    });
}

/// A committor at some cells is the share of 20 000 paths from each, with a stated error below `largest`.
#[track_caller]
fn is_that_of_paths(
    system: &Arc<Model>,
    parts: [&str; 2],
    axes: &[(f64, f64, usize)],
    (starts, largest): (&[[f64; 2]], f64),
) -> Found {
    let found = found(system, &parts, Some(1), axes);
    for start in starts {
        let cell = found.space.find(start).unwrap();
        let state = found.space.centre(cell);
        let (value, error) = (found.field.values[cell], found.field.errors[cell]);
        let (sampled, of_sample) = sampled_share(system, parts, (&found.space, &state, 20_000));
        println!(
            "from {state:.2?}: {value:.5} ± {error:.1e}, paths {sampled:.5} ± {of_sample:.1e}"
        );
        assert!(error < largest);
        assert!((value - sampled).abs() < 4.0 * of_sample + error);
    }
    found
}

/// R. S. Maier and D. L. Stein, Physical Review E 48, 931 (1993): a drift without a potential.
#[test]
fn the_committor_of_maier_and_steins_system_is_that_of_paths_everywhere() {
    let equations = [("u", "u - u^3 - 10 u v^2"), ("v", "-(1 + u^2) v")];
    let system = model(&equations, &[("u", "sqrt(0.2)"), ("v", "sqrt(0.2)")]);
    let parts = ["(u + 1)^2 + v^2 < 0.09", "(u - 1)^2 + v^2 < 0.09"];
    let starts = [
        [-0.4, 0.3],
        [0.1, 0.0],
        [0.2, -0.5],
        [-0.66, 0.02],
        [1.2, 0.9],
        [-1.5, -0.6],
    ];
    is_that_of_paths(
        &system,
        parts,
        &[(-1.8, 1.8, 72), (-1.2, 1.2, 60)],
        (&starts, 1e-2),
    );
}

/// Borders that stand across a displacement, which noise does not move: processes are carried over them. From the
/// mirror image of a state the other well is as likely.
#[test]
fn the_committor_of_an_oscillator_between_its_wells_is_that_of_paths() {
    let equations = [("x", "y"), ("y", "-0.5 y + x - x^3")];
    let system = model(&equations, &[("y", "sqrt(0.2)")]);
    let starts = [[0.1, 0.4], [-0.3, -0.1], [0.2, -0.7], [-0.6, 0.5]];
    let axes = [(-2.0, 2.0, 60), (-2.6, 2.6, 60)];
    let found = is_that_of_paths(&system, ["x < -0.7", "x > 0.7"], &axes, (&starts, 1e-3));
    let cells = found.space.n_cells();
    let mut between = 0;
    // On the border itself, where a process moves away from it, the committor jumps.
    let is_on_border = |cell: &usize| (found.space.centre(*cell)[0].abs() - 0.7).abs() < 1e-9;
    for cell in (0..cells).filter(|cell| !is_on_border(cell)) {
        let [value, other] = [cell, cells - 1 - cell].map(|cell| found.field.values[cell]);
        let [error, of_other] = [cell, cells - 1 - cell].map(|cell| found.field.errors[cell]);
        assert!((value + other - 1.0).abs() <= error + of_other + 1e-9);
        between += usize::from(0.1 < value && value < 0.9);
    }
    assert!(between > 100, "{between}");
}
