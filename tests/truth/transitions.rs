//! Processes on their way from one region to another, against quadrature, closed forms and paths.

use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::generator::{AdvectiveScheme, GeneratorOptions};
use pbif::passage::{FieldTarget, KnownDensity, PassageField, Reactive, reactive};
use pbif::space::CellSpace;
use pbif::stationary::generator::RateOptions;
use pbif::system::{BoundQuantity, Model, regions};

use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256Plus;
use rand_xoshiro::rand_core::SeedableRng;
use rayon::prelude::*;

use crate::common::numbers::{Numbers, given};
use crate::common::steady::{even_cells, model, solve};

/// Transitions on cells.
pub(crate) struct Found {
    space: CellSpace,
    pub(crate) reactive: Reactive,
}

/// Transitions from where the first inequality holds to where the second does.
pub(crate) fn found(model: &Arc<Model>, parts: [&str; 2], axes: &[(f64, f64, usize)]) -> Found {
    let values = model.values(&[]).unwrap();
    let bound = |text: &str| -> BoundQuantity {
        let region = regions(model, &[("until", text)]).unwrap().remove(0);
        region.level().bind(&values).unwrap()
    };
    let target = FieldTarget {
        until: bound(&format!("({}) or ({})", parts[0], parts[1])),
        exits: parts.map(bound).to_vec(),
        part: Some(1),
    };
    let space = even_cells(axes);
    let system = model.system_with(&[]).unwrap();
    let [unknowns, second] = [AdvectiveScheme::Upwind5, AdvectiveScheme::Central4]
        .map(|scheme| solve(&*system, &space, scheme));
    let changes: Vec<f64> = second
        .iter()
        .zip(&unknowns)
        .map(|(one, own)| one - own)
        .collect();
    let density = KnownDensity {
        unknowns: &unknowns,
        changes: Some(&changes),
        by_modes: None,
        returning: None,
        beyond: 0.0,
        planes: &[],
    };
    let settings = (&GeneratorOptions::default(), &RateOptions::default());
    let never = Cancellation::new();
    let reactive = reactive((&system, &space), &target, density, settings, &never).unwrap();
    Found { space, reactive }
}

/// The largest share of a stated error that a field is off by, at the states at which it is known.
#[track_caller]
fn off(
    space: &CellSpace,
    field: &PassageField,
    what: &str,
    exact: impl Fn(&[f64]) -> Option<f64>,
) -> f64 {
    let (mut share, mut most, mut stated, mut largest) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for cell in 0..space.n_cells() {
        let state = space.centre(cell);
        let Some(exact) = exact(&state) else { continue };
        let (value, error) = (field.values[cell], field.errors[cell]);
        let off = (value - exact).abs();
        most = most.max(off);
        stated = stated.max(error);
        largest = largest.max(exact.abs());
        share = share.max(off / (error + 1e-9));
    }
    println!(
        "{what}: off {most:.1e}, stated {stated:.1e} at most of {largest:.2e}, share {share:.2}"
    );
    share
}

#[track_caller]
fn holds(what: &str, (value, error): (f64, f64), exact: f64) -> f64 {
    let share = (value - exact).abs() / error;
    println!("{what}: {value:.8e} ± {error:.1e}, exactly {exact:.8e}, share {share:.2}");
    share
}

/// Values at even steps, between them by straight lines.
fn between_steps(values: &[f64], at: f64) -> f64 {
    let at = at.clamp(0.0, (values.len() - 1) as f64);
    let below = (at as usize).min(values.len() - 2);
    let share = at - below as f64;
    (1.0 - share) * values[below] + share * values[below + 1]
}

/// Intervals of a quadrature.
const STEPS: usize = 200_000;

/// On a line φ is p(1 - q), the current is the same everywhere, and q has the slope of exp(U/D).
#[test]
fn transitions_of_double_wells_are_those_of_quadrature() {
    // (tilt, D, from, to, cells)
    let cases = [
        (0.0, 0.1, -0.9, 0.83, 60),
        (0.0, 0.1, -0.9, 0.83, 120),
        (0.1, 0.15, -0.51, 0.4, 80),
        (-0.2, 0.2, -1.13, 1.02, 100),
        (0.0, 0.05, -0.8, 0.8, 160),
    ];
    for case in cases {
        let (shares, flux) = well(case);
        assert!(shares.iter().all(|share| *share < 1.0), "{shares:?}");
        assert!(flux.1 < 0.02 * flux.0);
    }
}

/// Wells of other tilts, noises, regions and cells, of which nothing was tuned; `PBIF_RANDOM_SYSTEMS` of them, from the
/// seed `PBIF_FUZZ_SEED`.
#[test]
fn stated_errors_of_transitions_hold_in_random_wells() {
    let mut numbers = Numbers(given("PBIF_FUZZ_SEED", 7));
    let mut largest = 0.0_f64;
    for _ in 0..given("PBIF_RANDOM_SYSTEMS", 12) {
        let tilt = numbers.rounded(-0.25, 0.25);
        let d = numbers.rounded(0.06, 0.4);
        let (a, b) = (numbers.rounded(-1.3, -0.2), numbers.rounded(0.1, 1.3));
        let cells = 50 + numbers.below(120);
        let (shares, _) = well((tilt, d, a, b, cells));
        let most = shares.iter().copied().fold(0.0, f64::max);
        largest = largest.max(most);
        assert!(most < 1.0, "{tilt} {d} {a} {b} {cells}: {shares:?}");
    }
    println!("largest share of a stated error: {largest:.2}");
}

/// U/D of a well.
fn potential(tilt: f64, d: f64) -> impl Fn(f64) -> f64 {
    move |x| (x.powi(4) / 4.0 - x * x / 2.0 + tilt * x) / d
}

/// Where nothing of the steady state of a well is beyond.
pub(crate) fn end_of_well(tilt: f64, d: f64) -> f64 {
    let u = potential(tilt, d);
    let is_empty = |x: &f64| u(*x).min(u(-*x)) > 34.0;
    let mut steps = (40..).map(|step| 0.05 * f64::from(step));
    steps.find(is_empty).unwrap()
}

/// Transitions of x' = x - x³ - tilt + √(2D) ξ from below a to above b.
pub(crate) struct Exact {
    /// Flux, rate and duration.
    pub(crate) numbers: [f64; 3],
    /// The norm of exp(-U/D), and the committor at even steps from a to b.
    z: f64,
    committor: Vec<f64>,
}

/// The same by quadrature.
pub(crate) fn exact_well((tilt, d, a, b): (f64, f64, f64, f64)) -> Exact {
    let (u, end) = (potential(tilt, d), end_of_well(tilt, d));
    let over = |from: f64, to: f64, f: &dyn Fn(f64) -> f64| -> f64 {
        let h = (to - from) / STEPS as f64;
        (0..STEPS).map(|k| h * f(from + (k as f64 + 0.5) * h)).sum()
    };
    let z = over(-end, end, &|x| (-u(x)).exp());
    let rising = over(a, b, &|x| u(x).exp());
    let flux = d / (z * rising);
    // Midpoints of ∫ p (1 - q) and ∫ p q (1 - q), with q summed on the way.
    let h = (b - a) / STEPS as f64;
    let (mut q, mut outside, mut way) = (0.0, 0.0, 0.0);
    let mut committor = vec![0.0; STEPS + 1];
    for k in 0..STEPS {
        let x = a + (k as f64 + 0.5) * h;
        let slope = h * u(x).exp() / rising;
        let (middle, p) = (q + 0.5 * slope, (-u(x)).exp() / z);
        outside += h * p * (1.0 - middle);
        way += h * p * middle * (1.0 - middle);
        q += slope;
        committor[k + 1] = q;
    }
    let inside = over(-end, a, &|x| (-u(x)).exp()) / z;
    Exact {
        numbers: [flux, flux / (inside + outside), way / flux],
        z,
        committor,
    }
}

/// A well and its two regions.
pub(crate) fn model_of_well((tilt, d, a, b): (f64, f64, f64, f64)) -> (Arc<Model>, [String; 2]) {
    let (drift, noise) = (format!("x - x^3 - {tilt:?}"), format!("sqrt(2*{d})"));
    let well = model(&[("x", &drift)], &[("x", &noise)]);
    (well, [format!("x < {a:?}"), format!("x > {b:?}")])
}

/// Shares of stated errors that flux, rate, duration, density and current of a well are off by, and its flux.
fn well((tilt, d, a, b, cells): (f64, f64, f64, f64, usize)) -> ([f64; 5], (f64, f64)) {
    let (well, parts) = model_of_well((tilt, d, a, b));
    let end = end_of_well(tilt, d);
    let Found { space, reactive } = found(&well, [&parts[0], &parts[1]], &[(-end, end, cells)]);
    let exact = exact_well((tilt, d, a, b));
    let [flux, rate, duration] = exact.numbers;
    let u = potential(tilt, d);
    let at = |x: f64| between_steps(&exact.committor, (x - a) / (b - a) * STEPS as f64);
    let between = |state: &[f64]| (a < state[0] && state[0] < b).then_some(state[0]);
    let name = format!("D = {d}, {cells}");
    let shares = [
        holds(&format!("flux, {name}"), reactive.flux, flux),
        holds("rate", reactive.rate, rate),
        holds("duration", reactive.duration, duration),
        off(&space, &reactive.density, "density", |state| {
            let x = between(state)?;
            let q = at(x);
            Some((-u(x)).exp() / exact.z * q * (1.0 - q))
        }),
        off(&space, &reactive.current[0], "current", |state| {
            between(state).map(|_| flux)
        }),
    ];
    (shares, reactive.flux)
}

/// A rotation about a centre changes neither the normal steady state nor q, which is that of the radius; it carries
/// processes on their way round.
#[test]
fn transitions_between_circles_go_round_with_a_rotation() {
    let noise = [("x", "sqrt(0.8)"), ("y", "sqrt(0.8)")];
    let (d, turn) = (0.4, 1.7);
    let plane = model(&[("x", "-x - 1.7 y"), ("y", "-y + 1.7 x")], &noise);
    let parts = ["x^2 + y^2 < 0.4^2", "x^2 + y^2 > 1.5^2"];
    // q' = exp(r²/2D)/r.
    let slope = |r: f64| (r * r / (2.0 * d)).exp() / r;
    let n = 20_000;
    let h = 1.1 / n as f64;
    let mut committor = vec![0.0];
    for k in 0..n {
        let r = 0.4 + (k as f64 + 0.5) * h;
        committor.push(committor[k] + h * slope(r));
    }
    let whole = committor[n];
    let q = |r: f64| between_steps(&committor, (r - 0.4) / h) / whole;
    let p = |r: f64| (-r * r / (2.0 * d)).exp() / (2.0 * std::f64::consts::PI * d);
    // 2πr D p q'.
    let flux = 1.0 / whole;
    let way = (0..n).map(|k| {
        let r = 0.4 + (k as f64 + 0.5) * h;
        2.0 * std::f64::consts::PI * r * h * p(r) * q(r) * (1.0 - q(r))
    });
    let duration = way.sum::<f64>() / flux;
    for cells in [40, 60, 100, 160] {
        let axis = (-3.6, 3.6, cells);
        let Found { space, reactive } = found(&plane, parts, &[axis, axis]);
        let polar = |state: &[f64]| {
            let r = state[0].hypot(state[1]);
            (0.4 < r && r < 1.5).then_some((r, state[0] / r, state[1] / r))
        };
        let current = |axis: usize| {
            move |state: &[f64]| {
                let (r, cos, sin) = polar(state)?;
                let outward = flux / (2.0 * std::f64::consts::PI * r);
                let around = q(r) * (1.0 - q(r)) * p(r) * turn * r;
                Some(if axis == 0 {
                    outward * cos - around * sin
                } else {
                    outward * sin + around * cos
                })
            }
        };
        let shares = [
            holds(&format!("flux, {cells}"), reactive.flux, flux),
            holds("duration", reactive.duration, duration),
            off(&space, &reactive.density, "density", |state| {
                let (r, ..) = polar(state)?;
                Some(p(r) * q(r) * (1.0 - q(r)))
            }),
            off(&space, &reactive.current[0], "current, x", current(0)),
            off(&space, &reactive.current[1], "current, y", current(1)),
        ];
        assert!(shares.iter().all(|share| *share < 1.0), "{shares:?}");
    }
}

/// What is counted on paths of x'' = -γ x' + x - x³ + √(2γT) ξ from below -0.7 to above 0.7, as means and standard
/// errors over independent paths: transitions per unit of time, their duration, and the share of time on the way in
/// which the velocity is above 0.98, where an edge of cells is.
fn counted(
    gamma: f64,
    temperature: f64,
    lasting: f64,
    seeds: std::ops::Range<u64>,
) -> [(f64, f64); 3] {
    let step = 0.005;
    let (kept, noise) = (
        (-gamma * step).exp(),
        (temperature * (1.0 - (-2.0 * gamma * step).exp())).sqrt(),
    );
    let one = |seed: u64| {
        let mut random = Xoshiro256Plus::seed_from_u64(seed);
        let (mut x, mut y) = (-1.0, 0.0);
        // What was gathered since the first region was left, and altogether.
        let (mut since, mut fast, mut from_first) = (0.0, 0.0, true);
        let (mut transitions, mut way, mut fast_way) = (0.0, 0.0, 0.0);
        let steps = (lasting / step) as usize;
        for _ in 0..steps {
            let normal: f64 = StandardNormal.sample(&mut random);
            y += 0.5 * step * (x - x * x * x);
            x += 0.5 * step * y;
            y = kept * y + noise * normal;
            x += 0.5 * step * y;
            y += 0.5 * step * (x - x * x * x);
            if x < -0.7 {
                (from_first, since, fast) = (true, 0.0, 0.0);
            } else if x > 0.7 {
                if from_first {
                    transitions += 1.0;
                    way += since;
                    fast_way += fast;
                }
                from_first = false;
            } else {
                since += step;
                fast += if y > 0.98 { step } else { 0.0 };
            }
        }
        [transitions / lasting, way / transitions, fast_way / lasting]
    };
    let rows: Vec<[f64; 3]> = seeds.into_par_iter().map(one).collect();
    let n = rows.len() as f64;
    std::array::from_fn(|index| {
        let mean = rows.iter().map(|row| row[index]).sum::<f64>() / n;
        let squares: f64 = rows.iter().map(|row| (row[index] - mean).powi(2)).sum();
        (mean, (squares / (n * (n - 1.0))).sqrt())
    })
}

/// Borders stand across the displacement, which noise does not move: what comes in is carried through them.
#[test]
fn transitions_of_an_oscillator_are_those_of_paths() {
    let equations = [("x", "y"), ("y", "-0.5 y + x - x^3")];
    let oscillator = model(&equations, &[("y", "sqrt(0.2)")]);
    let axes = [(-2.2, 2.2, 88), (-2.8, 2.8, 80)];
    let Found { space, reactive } = found(&oscillator, ["x < -0.7", "x > 0.7"], &axes);
    let cells = || (0..space.n_cells()).map(|cell| (cell, space.centre(cell)));
    let fast = |of: &[f64]| -> f64 {
        let fast = cells().filter(|(_, state)| state[1] > 0.98);
        fast.map(|(cell, _)| of[cell] * space.volume(cell)).sum()
    };
    let fast = (
        fast(&reactive.density.values),
        fast(&reactive.density.errors),
    );
    let counted = counted(0.5, 0.2, 4e3, 0..64);
    let names = ["flux", "duration", "fast on the way"];
    let pairs = [reactive.flux, reactive.duration, fast]
        .into_iter()
        .zip(counted)
        .zip(names);
    for (((value, error), (mean, of_mean)), name) in pairs {
        println!("{name}: {value:.6} ± {error:.1e}, paths {mean:.6} ± {of_mean:.1e}");
        // Crossings are seen at the ends of steps, and cells are cut whole.
        assert!(
            (value - mean).abs() < 4.0 * of_mean + error + 0.005 * value,
            "{name}"
        );
        assert!(error < 0.05 * value, "{name}");
    }
    // All of the flux crosses each line between the regions.
    for x in [-0.5, 0.0, 0.3] {
        let column = space.axes()[0].find(x).unwrap();
        let across = cells().filter(|(cell, _)| space.position(*cell, 0) == column);
        let sum = |of: &[f64]| -> f64 {
            across
                .clone()
                .map(|(cell, _)| of[cell] * space.axes()[1].width(space.position(cell, 1)))
                .sum()
        };
        let (sum, error) = (
            sum(&reactive.current[0].values),
            sum(&reactive.current[0].errors),
        );
        println!(
            "through x = {x}: {sum:.6} ± {error:.1e} of {:.6}",
            reactive.flux.0
        );
        assert!((sum - reactive.flux.0).abs() < error + reactive.flux.1);
        assert!(error < 0.1 * sum);
    }
}
