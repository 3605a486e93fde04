//! Walls at which a process is reflected, against closed forms and sampled paths.

use std::f64::consts::PI;

use crate::common::numbers::assert_holds;
use crate::common::sweeps::{measure, rows, solved as solved_at, swept};
use pbif::cancellation::Cancellation;
use pbif::continuation::{BifurcationStatus, DensitySource, Measure};
use pbif::method::{GeneratorMethodOptions, GeneratorSource, MonteCarloOptions, MonteCarloSource};
use pbif::sweep_file::{Sweep, SweepFile};
use pbif::topology::{Detector, Feature, FeatureKind};

/// A sweep of D, with the lines of a file about it.
fn sweep(system: &str, rest: &str) -> Sweep {
    let text = format!(
        "{system}\n[system.parameters]\nD = 0.5\n[sweep]\nparameter = \"D\"\nfrom = 0.4\nto = 0.6\npoints = 2\n{rest}"
    );
    let file = SweepFile::parse("walls.toml", &text);
    file.validate()
        .unwrap_or_else(|report| panic!("{report}"))
        .prepare(&Cancellation::new())
        .unwrap_or_else(|report| panic!("{report}"))
}

/// The measures at D = 1/2 by the generator, and the watched densities as cell masses. No wall is told as an end.
fn solved(sweep: &Sweep) -> (Vec<Measure>, Vec<Vec<f64>>) {
    let source = GeneratorSource::new(&sweep.problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let solution = session.solve(0.5).unwrap();
    let findings = &solution.report.findings;
    assert!(findings.is_empty(), "{findings:?}");
    let densities = solution.densities.iter().map(|one| one.density.masses());
    (solution.report.measures, densities.collect())
}

/// The stated error of a number holds, and is small.
#[track_caller]
fn holds(measures: &[Measure], name: &str, exact: f64, largest: f64) {
    let found = measures.iter().find(|one| one.name == name);
    let found = found.unwrap_or_else(|| panic!("{name}"));
    let (value, error) = (found.value, found.error.unwrap());
    println!(
        "{name}: {value:.9} ± {error:.1e}, exactly {exact:.9}, off by {:.1e}",
        value - exact
    );
    assert!(
        (value - exact).abs() <= error,
        "{name}: {value} ± {error}, exactly {exact}"
    );
    assert!(error <= largest * exact.abs(), "{name}: {value} ± {error}");
}

/// Mean and standard deviation of a normal variable of mean m and variance s² that is known to be positive.
fn half_normal(mean: f64, variance: f64) -> (f64, f64) {
    let deviation = variance.sqrt();
    let place = -mean / deviation;
    let density = (-place * place / 2.0).exp() / (2.0 * PI).sqrt();
    let beyond = 0.5 * statrs::function::erf::erfc(place / 2f64.sqrt());
    let ratio = density / beyond;
    let variance = variance * (1.0 + place * ratio - ratio * ratio);
    (mean + deviation * ratio, variance.sqrt())
}

const DRIFTING: &str = r#"
[system.equations]
x = "-1"
[system.noise]
x = "sqrt(2 D)"
[system.bounds]
x = ["reflecting", "open"]
"#;

#[test]
fn brownian_motion_that_drifts_to_a_wall_has_an_exponential_density() {
    let sweep = sweep(DRIFTING, "[cells]\nx = { from = 0, to = 20, count = 60 }\n");
    let (measures, masses) = solved(&sweep);
    // p = (c/D) e^{-c x/D}: mean and standard deviation are D/c.
    holds(&measures, "mean_x", 0.5, 1e-6);
    holds(&measures, "sd_x", 0.5, 1e-6);
    let edges = sweep.problem.space().axes()[0].edges();
    for (mass, ends) in masses[0].iter().zip(edges.windows(2)) {
        let exact = (-2.0 * ends[0]).exp() - (-2.0 * ends[1]).exp();
        assert!((mass - exact).abs() < 1e-12);
    }
}

const HALF_PLANE: &str = r#"
[system.equations]
x = "0.3 - x"
y = "0.5 x - y"
[system.noise]
x = "sqrt(2 D)"
y = "sqrt(D)"
[system.bounds]
x = ["reflecting", "open"]
"#;

#[test]
fn ornstein_uhlenbeck_on_a_half_plane_is_half_of_a_normal_density() {
    let (mean, deviation) = half_normal(0.3, 0.5);
    let erf = |x: f64| statrs::function::erf::erf(x - 0.3);
    for (count, largest) in [(60, 1e-4), (80, 6e-5), (120, 3e-5)] {
        let cells = format!(
            "[cells]\nx = {{ from = 0, to = 5, count = {count} }}\ny = {{ from = -2.7, to = 3.5, count = {count} }}\n"
        );
        let sweep = sweep(HALF_PLANE, &cells);
        let (measures, masses) = solved(&sweep);
        println!("{count} cells an axis");
        holds(&measures, "mean_x", mean, 5e-3);
        holds(&measures, "sd_x", deviation, 5e-3);
        // d⟨y⟩/dt = 0.
        holds(&measures, "mean_y", 0.5 * mean, 5e-3);
        // x alone: p(x) ∝ exp(-(x - 0.3)²) on x > 0.
        let edges = sweep.problem.space().axes()[0].edges();
        let exact = |ends: &[f64]| (erf(ends[1]) - erf(ends[0])) / (1.0 - erf(0.0));
        let off = masses[0].iter().zip(edges.windows(2));
        let off: f64 = 0.5
            * off
                .map(|(mass, ends)| (mass - exact(ends)).abs())
                .sum::<f64>();
        println!("p(x) is off by {off:.1e} in total variation");
        assert!(off < largest);
    }
}

#[test]
fn the_share_of_the_time_beside_a_wall_is_that_of_half_of_a_normal_density() {
    let beyond = |x: f64| statrs::function::erf::erfc(x - 0.3);
    for count in [40, 60, 90] {
        let rest = format!(
            "[cells]\nx = {{ from = -0.2, to = 4.5, count = {count} }}\ny = 40\n[visits]\nlow = \"x > 0\"\nhigh = \"x > 0.4\"\n"
        );
        let independent = HALF_PLANE.replace("0.5 x - y", "-y");
        let sweep = sweep(&independent, &rest);
        let options = GeneratorMethodOptions::default();
        let source = GeneratorSource::new(&sweep.problem, &options).unwrap();
        let mut session = source.open(&Cancellation::new());
        let measures = session.solve(0.5).unwrap().report.measures;
        holds(
            &measures,
            "low_time_share",
            beyond(0.0) / beyond(-0.2),
            1e-3,
        );
        holds(
            &measures,
            "high_time_share",
            beyond(0.4) / beyond(-0.2),
            1e-3,
        );
    }
}

#[test]
fn between_four_walls_two_independent_axes_stay_independent() {
    let system = r#"
[system.equations]
x = "-1"
y = "-0.5 y"
[system.noise]
x = "sqrt(2 D)"
y = "sqrt(2 D)"
[system.bounds]
x = "reflecting"
y = "reflecting"
"#;
    let cells =
        "[cells]\nx = { from = 0, to = 2, count = 40 }\ny = { from = 0, to = 1.5, count = 40 }\n";
    let (measures, _) = solved(&sweep(system, cells));
    let moment = |weight: &dyn Fn(f64) -> f64, to: f64, power: i32| {
        let n = 20_000;
        let h = to / f64::from(n);
        let at = |k: i32| (f64::from(k) + 0.5) * h;
        (0..n)
            .map(|k| h * weight(at(k)) * at(k).powi(power))
            .sum::<f64>()
    };
    let exact = |weight: &dyn Fn(f64) -> f64, to: f64| {
        let [zeroth, first, second] = [0, 1, 2].map(|power| moment(weight, to, power));
        let mean = first / zeroth;
        (mean, (second / zeroth - mean * mean).sqrt())
    };
    let (mean_x, sd_x) = exact(&|x| (-2.0 * x).exp(), 2.0);
    let (mean_y, sd_y) = exact(&|y| (-0.5 * y * y).exp(), 1.5);
    holds(&measures, "mean_x", mean_x, 2e-3);
    holds(&measures, "sd_x", sd_x, 2e-3);
    holds(&measures, "mean_y", mean_y, 2e-3);
    holds(&measures, "sd_y", sd_y, 2e-3);
}

/// A potential, of which exp(-2 U) is the density between four walls.
fn waves(x: f64, y: f64, coupling: f64) -> f64 {
    0.8 * (2.0 * x).cos() + 0.6 * (2.0 * y + 0.4).cos() + coupling * x * y
}

/// Walls of x and of y.
const BETWEEN: [(f64, f64); 2] = [(-1.6, 1.5), (-1.4, 1.7)];

/// ∫∫ f exp(-2 U) by Simpson's rule, over ∫∫ exp(-2 U).
fn mean_of(coupling: f64, function: &dyn Fn(f64, f64) -> f64) -> f64 {
    const STEPS: i32 = 400;
    let along = |(from, to): (f64, f64)| {
        (0..=STEPS).map(move |k| {
            let weight = match k {
                0 | STEPS => 1.0,
                odd if odd % 2 == 1 => 4.0,
                _ => 2.0,
            };
            (from + (to - from) * f64::from(k) / f64::from(STEPS), weight)
        })
    };
    let (mut sum, mut whole) = (0.0, 0.0);
    for (x, a) in along(BETWEEN[0]) {
        for (y, b) in along(BETWEEN[1]) {
            let weight = a * b * (-2.0 * waves(x, y, coupling)).exp();
            sum += weight * function(x, y);
            whole += weight;
        }
    }
    sum / whole
}

/// ∫ exp(-2 U) dy at a place by the same rule, over ∫∫ exp(-2 U), with its slope.
fn marginal_at(x: f64, coupling: f64) -> [f64; 2] {
    let (from, to) = BETWEEN[1];
    let whole = (BETWEEN[0].1 - BETWEEN[0].0) * (to - from);
    let inside = |y: f64| (-2.0 * waves(x, y, coupling)).exp();
    let slope = |y: f64| (3.2 * (2.0 * x).sin() - 2.0 * coupling * y) * inside(y);
    let integral = |function: &dyn Fn(f64) -> f64| {
        let terms = (0..=400).map(|k| {
            let weight = if k % 400 == 0 {
                1.0
            } else {
                f64::from(2 + 2 * (k % 2))
            };
            weight * function(from + (to - from) * f64::from(k) / 400.0)
        });
        terms.sum::<f64>() * (to - from) / 1200.0
    };
    // ∫∫ exp(-2 U) is the area over the mean of exp(2 U).
    let constant = whole / mean_of(coupling, &|x, y| (2.0 * waves(x, y, coupling)).exp());
    [integral(&inside) / constant, integral(&slope) / constant]
}

const WAVES: &str = r#"
[system.equations]
x = "1.6 sin(2 x) - k y"
y = "1.2 sin(2 y + 0.4) - k x"
[system.noise]
x = "1"
y = "1"
[system.bounds]
x = "reflecting"
y = "reflecting"
[sweep]
parameter = "k"
from = -0.3
to = 0.3
points = 2
[watch]
w = "x y"
v = "exp(x/2) cos(y)"
"#;

/// Fluxes beside walls that two schemes share would be errors that their difference does not show.
#[test]
fn formulas_between_four_walls_have_the_means_and_deviations_of_the_exact_density() {
    for (counts, k) in [([54, 59], -0.17), ([42, 37], 0.23), ([60, 60], 0.0)] {
        let [x, y] = counts;
        let cells = format!(
            "{WAVES}[cells]\nx = {{ from = -1.6, to = 1.5, count = {x} }}\ny = {{ from = -1.4, to = 1.7, count = {y} }}\n"
        );
        let (_, solution) = solved_at(&cells, "", Some(k));
        type Function = fn(f64, f64) -> f64;
        let all: [(&str, Function); 4] = [
            ("x", |x, _| x),
            ("y", |_, y| y),
            ("w", |x, y| x * y),
            ("v", |x, y| (0.5 * x).exp() * y.cos()),
        ];
        for (name, function) in all {
            let mean = mean_of(k, &function);
            let spread = mean_of(k, &|x, y| (function(x, y) - mean).powi(2)).sqrt();
            for (kind, exact) in [("mean", mean), ("sd", spread)] {
                let found = measure(&solution, &format!("{kind}_{name}"));
                println!("{kind}_{name} at {k}: {found:?}, exactly {exact}");
                assert_holds(found.into(), exact, 2e-3);
            }
        }
    }
}

/// Peaks of p(x) at a wall, and beside one within the outermost cell: places and heights.
#[test]
fn peaks_at_walls_and_beside_them_are_where_those_of_the_exact_density_are() {
    for k in [-0.17, 0.0, 0.12, 0.3] {
        let cells = format!(
            "{WAVES}[cells]\nx = {{ from = -1.6, to = 1.5, count = 54 }}\ny = {{ from = -1.4, to = 1.7, count = 59 }}\n"
        );
        let (sweep, solution) = solved_at(&cells, "", Some(k));
        let detection = sweep.detector().detect(&solution.densities[0]);
        let peaks = detection.features.iter();
        let peaks: Vec<&Feature> = peaks.filter(|one| one.kind == FeatureKind::Peak).collect();
        assert_eq!(peaks.len(), 2, "{peaks:?}");
        for peak in peaks {
            let (at, error) = (peak.position[0], peak.errors.position[0]);
            let wall = if at < 0.0 { -1.6 } else { 1.5 };
            let outward = f64::signum(wall);
            let rises = |x: f64| outward * marginal_at(x, k)[1] > 0.0;
            let exact = match rises(wall) {
                true => wall,
                false => {
                    let (mut low, mut high) = (wall - 0.5 * outward, wall);
                    for _ in 0..40 {
                        let middle = 0.5 * (low + high);
                        *(if rises(middle) { &mut low } else { &mut high }) = middle;
                    }
                    low
                }
            };
            println!("peak at {at} ± {error:e}, exactly {exact}");
            assert!(
                (at - exact).abs() <= error + 1e-9,
                "{at} ± {error:e}, exactly {exact}"
            );
            assert!(error < 5e-3);
            let height = marginal_at(exact, k)[0];
            let stated = [peak.density, peak.errors.density.unwrap()];
            println!("height {stated:?}, exactly {height}");
            assert_holds(stated, height, 5e-3 * height);
        }
    }
}

#[test]
fn a_passage_begins_at_a_wall_and_modes_die_out_between_walls() {
    // T = (D/c²)(e^{c b/D} - 1) - b/c from the wall to b.
    let rest = r#"[cells]
x = { from = 0, to = 6, count = 100 }
[passage]
up = { start = { x = 0 }, until = "x > 2" }
"#;
    let (measures, _) = solved(&sweep(DRIFTING, rest));
    holds(&measures, "up_mean", 0.5 * (4.0f64.exp() - 1.0) - 2.0, 1e-3);
    // Between walls a length L apart: λ = D π²/L² + c²/(4 D).
    let system = r#"
[system.equations]
x = "-1"
[system.noise]
x = "sqrt(2 D)"
[system.bounds]
x = "reflecting"
"#;
    let rest = "[cells]\nx = { from = 0, to = 2, count = 100 }\n[relaxation]\nmodes = 1\n";
    let (measures, _) = solved(&sweep(system, rest));
    holds(
        &measures,
        "decay_rate_1",
        0.5 * (PI / 2.0).powi(2) + 0.5,
        1e-2,
    );
}

#[test]
fn sampled_paths_turn_back_at_walls() {
    let cells =
        "[cells]\nx = { from = 0, to = 5, count = 40 }\ny = { from = -4, to = 6, count = 40 }\n";
    let sampled = sweep(
        HALF_PLANE,
        &format!("{cells}[method]\nkind = \"monte-carlo\"\ntime_step = 0.01\n"),
    );
    let options = MonteCarloOptions {
        time_step: pbif::method::StepChoice::Fixed(0.01),
        ..MonteCarloOptions::default()
    };
    let never = Cancellation::new();
    let source = MonteCarloSource::new(&sampled.problem, &options, &never).unwrap();
    let found = source.open(&never).solve(0.5).unwrap().report;
    let (mean, deviation) = half_normal(0.3, 0.5);
    for (name, exact) in [
        ("mean_x", mean),
        ("sd_x", deviation),
        ("mean_y", 0.5 * mean),
    ] {
        let one = found.measures.iter().find(|one| one.name == name).unwrap();
        let error = one.error.unwrap();
        println!("{name}: {} ± {error}, exactly {exact}", one.value);
        assert!((one.value - exact).abs() < 4.0 * error && error < 1e-2);
    }
}

/// The reflection of a noisy oscillator is found though its range is not a mirror image of itself: also between closed
/// ends, which the check of what leaves the range puts where the range ends. The split is at a = 0. What leaves
/// the range, counted twice, moves the value by less than the tolerance.
#[test]
fn a_split_in_a_range_that_is_not_symmetric_is_located() {
    let (_, result) = swept(
        "[system.equations]\nx = \"y\"\ny = \"-y + a x - x^3\"\n[system.noise]\ny = \"sqrt(0.8)\"\n\
         [sweep]\nparameter = \"a\"\nfrom = -0.5\nto = 0.6\npoints = 5\n\
         [cells]\nx = { from = -3.1, to = 3.0, count = 50 }\ny = { from = -3.2, to = 3.0, count = 50 }\n\
         [detect]\nmarginals = [\"x\"]\njoint = []\n",
        "",
    );
    let [row] = rows(&result, "x")[..] else {
        panic!("one split of x");
    };
    assert_eq!(row.status(), BifurcationStatus::Located);
    assert!(row.value.abs() <= row.error && row.error < 1e-3);
}
