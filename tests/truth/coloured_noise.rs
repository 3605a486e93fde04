//! Coloured noise against exact moments, against its white limit, and against free trajectories.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::steady::{by_trajectories, means, solve};
use crate::common::sweeps::{measure, solved, swept};
use nalgebra::{DMatrix, DVector};
use pbif::continuation::{BifurcationStatus, Finding};
use pbif::density::{Density, Observable, Projection, total_variation};
use pbif::generator::{AdvectiveScheme, GeneratorOptions, assemble, cell_masses};
use pbif::space::{Axis, CellSpace};
use pbif::system::{Model, NoiseKind, System, TypedModel, registry};
use pbif::topology::{DetectOptions, Detector, Feature, FeatureKind, PersistenceDetector};
use statrs::function::erf::erfc;

const OU: NoiseKind = NoiseKind::OrnsteinUhlenbeck;

fn coloured(name: &str, given: &[(&str, f64)]) -> Arc<dyn System> {
    let model = Model::with_coloured_noise(&registry::find(name).unwrap(), OU).unwrap();
    model.system_with(given).unwrap()
}

/// Mean of a function of the state.
fn mean(space: &CellSpace, unknowns: &[f64], look: impl Fn(&[f64]) -> f64) -> f64 {
    means(space, unknowns, |state| [look(state)])[0]
}

const ALPHA: f64 = 1.3;
const KAPPA: f64 = 0.4;
const SIGMA2: f64 = 0.3;

/// x' = y, y' = -α x - κ y + c η, η' = -η/τ + …, c² = σ²/(2τ): the Lyapunov equation's [xx, yy, xη, yη].
fn lyapunov(tau: f64) -> [f64; 4] {
    let c = (SIGMA2 / (2.0 * tau)).sqrt();
    let y_noise = c / (KAPPA + 1.0 / tau + ALPHA * tau);
    let yy = c * y_noise / KAPPA;
    let x_noise = tau * y_noise;
    [(yy + c * x_noise) / ALPHA, yy, x_noise, y_noise]
}

fn linear(tau: f64) -> Arc<dyn System> {
    let given = [
        ("alpha", ALPHA),
        ("kappa", KAPPA),
        ("f_c", 0.0),
        ("sigma2", SIGMA2),
        ("tau", tau),
    ];
    coloured("coulomb", &given)
}

#[test]
fn second_moments_of_a_linear_oscillator_are_those_of_the_lyapunov_equation() {
    // Central fluxes keep the second moments of a linear drift on uniform cells, whatever their width, and two modes
    // are closed for them: what is left is wiggles that reach the ends, which grow with the memory.
    for tau in [0.1, 0.2, 0.3] {
        let exact = lyapunov(tau);
        let half = 8.0 * exact[1].max(exact[0]).sqrt();
        let cells = Axis::uniform(-half, half, 52).unwrap();
        let modes = Axis::hermite(0.0, 1.0, 4).unwrap();
        let space = CellSpace::new(vec![cells.clone(), cells, modes]).unwrap();
        let unknowns = solve(&*linear(tau), &space, AdvectiveScheme::Central6);
        let looks: [fn(&[f64]) -> f64; 4] = [
            |s| s[0] * s[0],
            |s| s[1] * s[1],
            |s| s[0] * s[2],
            |s| s[1] * s[2],
        ];
        for (look, exact) in looks.into_iter().zip(exact) {
            let found = mean(&space, &unknowns, look);
            assert!((found / exact - 1.0).abs() < 1e-6, "{tau} {found} {exact}");
        }
        assert!((mean(&space, &unknowns, |s| s[2] * s[2]) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn the_density_of_a_linear_oscillator_converges_exponentially_in_the_modes() {
    let tau = 0.5;
    let [xx, yy, ..] = lyapunov(tau);
    let cells = |half: f64| Axis::uniform(-half, half, 44).unwrap();
    let distance = |modes: usize| -> f64 {
        let axes = vec![
            cells(2.6),
            cells(2.6),
            Axis::hermite(0.0, 1.0, modes).unwrap(),
        ];
        let space = CellSpace::new(axes).unwrap();
        let unknowns = solve(&*linear(tau), &space, AdvectiveScheme::Upwind5);
        let normal = |x: f64, y: f64| (-0.5 * (x * x / xx + y * y / yy)).exp();
        let nodes = space.axes()[0].nodes();
        let places = || {
            nodes
                .iter()
                .flat_map(|&x| nodes.iter().map(move |&y| (x, y)))
        };
        let total: f64 = places().map(|(x, y)| normal(x, y)).sum();
        let sums = unknowns
            .chunks(modes)
            .map(|place| place.iter().sum::<f64>());
        let differences = sums
            .zip(places())
            .map(|(sum, (x, y))| (sum - normal(x, y) / total).abs());
        0.5 * differences.sum::<f64>()
    };
    let [three, five, eight] = [3, 5, 8].map(distance);
    assert!(
        five < 0.2 * three && eight < 0.3 * five,
        "{three:e} {five:e} {eight:e}"
    );
    assert!(eight < 1e-3, "{eight:e}");
}

#[test]
fn the_joint_density_with_the_noise_comes_from_the_series_within_its_stated_error() {
    let tau = 0.5;
    let [_, yy, _, y_noise] = lyapunov(tau);
    let system = linear(tau);
    let cells = Axis::uniform(-2.6, 2.6, 40).unwrap();
    let distances = |modes: usize| -> (f64, f64) {
        let axes = vec![
            cells.clone(),
            cells.clone(),
            Axis::hermite(0.0, 1.0, modes).unwrap(),
        ];
        let space = CellSpace::new(axes).unwrap();
        let unknowns = solve(&*system, &space, AdvectiveScheme::Upwind5);
        let masses = cell_masses(&*system, &space, &unknowns);
        let [all, fewer] = [false, true].map(|is_coarse| {
            let map = Projection::of_series(&space, Observable::Joint(1, 2), is_coarse).unwrap();
            map.density(&masses).unwrap()
        });
        // The normal density of y and η with their exact correlation.
        let free = 1.0 - y_noise * y_noise / yy;
        let log = |y: f64, s: f64| -0.5 * (s * s - 2.0 * y * s * y_noise / yy + y * y / yy) / free;
        // Its means over the bins, by Simpson's rule.
        let simpson = |edges: &[f64]| -> Vec<[(f64, f64); 3]> {
            let means = edges.windows(2).map(|e| {
                let middle = 0.5 * (e[0] + e[1]);
                [(e[0], 1.0 / 6.0), (middle, 4.0 / 6.0), (e[1], 1.0 / 6.0)]
            });
            means.collect()
        };
        let [ys, noises] = [0, 1].map(|axis: usize| simpson(all.axes[axis].edges()));
        let mut values = Vec::new();
        for y in &ys {
            for s in &noises {
                let terms = y.iter().flat_map(|y| s.iter().map(move |s| (y, s)));
                values.push(
                    terms
                        .map(|(y, s)| y.1 * s.1 * log(y.0, s.0).exp())
                        .sum::<f64>(),
                );
            }
        }
        let total: f64 = values.iter().zip(all.volumes()).map(|(p, v)| p * v).sum();
        let exact = Density {
            axes: all.axes.clone(),
            values: values.iter().map(|p| p / total).collect(),
        };
        let off = total_variation(&all, &exact).unwrap();
        (off, total_variation(&all, &fewer).unwrap())
    };
    let (few, stated_of_few) = distances(4);
    let (many, _) = distances(8);
    assert!(
        few < stated_of_few && few > 1e-3,
        "{few:e} {stated_of_few:e}"
    );
    assert!(many < 2e-3 && many < 0.2 * few, "{many:e} {few:e}");
}

/// Masses of the cells of x alone.
fn masses_of_x(system: &dyn System, modes: usize) -> Vec<f64> {
    let x = Axis::uniform(-2.4, 2.4, 120).unwrap();
    let mut axes = vec![x];
    if system.dimension() == 2 {
        axes.push(Axis::hermite(0.0, 1.0, modes).unwrap());
    }
    let space = CellSpace::new(axes).unwrap();
    let unknowns = solve(system, &space, AdvectiveScheme::Upwind5);
    let masses = cell_masses(system, &space, &unknowns);
    let per_place = if system.dimension() == 2 { modes } else { 1 };
    masses
        .chunks(per_place)
        .map(|place| place.iter().sum())
        .collect()
}

#[test]
fn a_short_memory_is_white_noise_to_first_order_read_as_stratonovich() {
    let typed = |coloured: bool| {
        let model = TypedModel::new("test", "test", ["x"])
            .with_equation("x", "0.2 x - x^3")
            .with_noise("x", ["0.5 + 0.2 x"])
            .with_parameters(["tau"]);
        let model = match coloured {
            true => model.with_coloured_noise(OU),
            false => model.with_interpretation(pbif::system::Interpretation::Stratonovich),
        };
        model.build().unwrap()
    };
    let white = masses_of_x(&*typed(false).system_with(&[("tau", 1.0)]).unwrap(), 1);
    let at = |tau: f64| masses_of_x(&*typed(true).system_with(&[("tau", tau)]).unwrap(), 8);
    let (long, short) = (at(0.02), at(0.01));
    let off = |masses: &[f64]| -> f64 {
        let pairs = masses.iter().zip(&white);
        0.5 * pairs.map(|(p, q)| (p - q).abs()).sum::<f64>()
    };
    let (far, near) = (off(&long), off(&short));
    assert!(
        far > 2e-3 && (far / near - 2.0).abs() < 0.1,
        "{far:e} {near:e}"
    );
    // What is not of first order in τ.
    let left: Vec<f64> = long.iter().zip(&short).map(|(p, q)| 2.0 * q - p).collect();
    assert!(off(&left) < 0.03 * far, "{:e} {far:e}", off(&left));
}

#[test]
fn the_colour_of_noise_moves_a_pitchfork_by_six_times_its_memory_and_strength() {
    // x' = a x - x³ under coloured noise of intensity σ² = 2 D: to first order in τ the effective diffusion is D (1 + τ
    // f'(x)), so that (log p)'' = a/D + 6 τ at 0, and the peak splits at a = -6 D τ in place of 0.
    let located = |tau: f64| -> f64 {
        let text = format!(
            "[system]\nmodel = \"bistable\"\nnoise = {{ kind = \"ornstein-uhlenbeck\" }}\n\
             [system.parameters]\nsigma2 = 0.2\ntau = {tau}\n\
             [sweep]\nparameter = \"a\"\nfrom = -0.1\nto = 0.1\npoints = 5\n\
             [cells]\nx = {{ from = -2.2, to = 2.2, count = 120 }}\nnoise = {{ modes = 8 }}\n\
             [locate]\ngrid_check = \"off\"\n"
        );
        let (_, found) = swept(&text, "");
        found.bifurcations().next().unwrap().value
    };
    let rate = |tau: f64| located(tau) / tau;
    let (long, short) = (rate(0.04), rate(0.02));
    assert!((long + 0.6).abs() < 0.06, "{long}");
    assert!((2.0 * short - long + 0.6).abs() < 5e-3, "{long} {short}");
}

/// Means of x², y² and the product of y and the first noise agree with trajectories to four standard errors and what
/// the grid leaves.
fn assert_agrees(system: &dyn System, axes: Vec<Axis>) {
    let space = CellSpace::new(axes).unwrap();
    let unknowns = solve(system, &space, AdvectiveScheme::Upwind5);
    let noise = space.dimension() - 1;
    let look = |s: &[f64]| [s[0] * s[0], s[1] * s[1], s[1] * s[noise]];
    let found = means(&space, &unknowns, look);
    let trajectories = by_trajectories(system, 60_000, 7..8, look);
    for (found, (sampled, error)) in found.into_iter().zip(trajectories) {
        let off = (found - sampled).abs();
        assert!(
            off < 4.0 * error + 3e-3 * sampled,
            "{found}: {sampled} ± {error}"
        );
    }
}

#[test]
fn a_nonlinear_oscillator_with_parametric_coloured_noise_agrees_with_trajectories() {
    let model = TypedModel::new("test", "test", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-(x^2 - 0.1) y - x")
        .with_noise("y", ["0.4 + 0.3 x"])
        .with_parameters(["tau"])
        .with_coloured_noise(OU)
        .build()
        .unwrap();
    let system = model.system_with(&[("tau", 0.8)]).unwrap();
    let cells = Axis::uniform(-3.6, 3.6, 44).unwrap();
    let modes = Axis::hermite(0.0, 1.0, 8).unwrap();
    assert_agrees(&*system, vec![cells.clone(), cells, modes]);
}

#[test]
fn friction_that_remembers_agrees_with_trajectories_under_coloured_noise() {
    let given = [
        ("alpha", -0.3),
        ("kappa", 0.1),
        ("mu", 1.0),
        ("lambda", 0.3),
        ("f_c", 0.1),
        ("sigma2", 0.08),
        ("tau", 0.5),
    ];
    let system = coloured("dahl", &given);
    let cells = Axis::uniform(-2.2, 2.2, 22).unwrap();
    let (low, high) = system.facts().bounds(2).unwrap();
    let axes = vec![
        cells.clone(),
        cells,
        Axis::modes(low, high, 4).unwrap(),
        Axis::hermite(0.0, 1.0, 4).unwrap(),
    ];
    assert_agrees(&*system, axes);
}

/// x' = -α x + b ξ with b ξ harmonic noise, as linear equations of three states: the covariance Σ of A Σ + Σ Aᵀ + B =
/// 0.
fn harmonic_covariance(frequency: f64, damping: f64) -> DMatrix<f64> {
    let gain = (SIGMA2 * frequency / (4.0 * damping)).sqrt();
    let rates = [
        [-ALPHA, gain, 0.0],
        [0.0, 0.0, frequency],
        [0.0, -frequency, -2.0 * damping * frequency],
    ];
    let rates = DMatrix::from_fn(3, 3, |row, column| rates[row][column]);
    let one = DMatrix::identity(3, 3);
    let operator = one.kronecker(&rates) + rates.kronecker(&one);
    let mut noise = DVector::zeros(9);
    noise[8] = -4.0 * damping * frequency;
    let found = operator.lu().solve(&noise).unwrap();
    DMatrix::from_column_slice(3, 3, found.as_slice())
}

#[test]
fn second_moments_under_harmonic_noise_are_those_of_the_lyapunov_equation() {
    let model = TypedModel::new("test", "test", ["x"])
        .with_equation("x", format!("-{ALPHA} x"))
        .with_noise("x", [format!("sqrt({SIGMA2})")])
        .with_coloured_noise(NoiseKind::Harmonic)
        .build()
        .unwrap();
    // What is left is wiggles that reach the ends, as with one state of the filter: 1.6e-2 at a frequency of 2.
    for (frequency, damping) in [(8.0, 0.6), (12.0, 0.4), (10.0, 1.5)] {
        let given = [("noise_frequency", frequency), ("noise_damping", damping)];
        let system = model.system_with(&given).unwrap();
        let exact = harmonic_covariance(frequency, damping);
        let half = 8.0 * exact[(0, 0)].sqrt();
        let cells = Axis::uniform(-half, half, 80).unwrap();
        let modes = || Axis::hermite(0.0, 1.0, 8).unwrap();
        let space = CellSpace::new(vec![cells, modes(), modes()]).unwrap();
        let unknowns = solve(&*system, &space, AdvectiveScheme::Central6);
        for row in 0..3 {
            for column in 0..=row {
                let found = mean(&space, &unknowns, |s| s[row] * s[column]);
                let size = (exact[(row, row)] * exact[(column, column)]).sqrt();
                let off = (found - exact[(row, column)]).abs() / size;
                assert!(off < 1e-6, "{frequency} {damping} {row} {column}: {off:e}");
            }
        }
    }
}

#[test]
fn a_bistable_system_under_harmonic_noise_agrees_with_trajectories() {
    let white = registry::find("bistable").unwrap();
    let model = Model::with_coloured_noise(&white, NoiseKind::Harmonic).unwrap();
    let given = [
        ("a", 0.3),
        ("sigma2", 0.4),
        ("noise_frequency", 2.0),
        ("noise_damping", 0.3),
    ];
    let system = model.system_with(&given).unwrap();
    let axes = vec![
        Axis::uniform(-2.6, 2.6, 100).unwrap(),
        Axis::hermite(0.0, 1.0, 10).unwrap(),
        Axis::hermite(0.0, 1.0, 10).unwrap(),
    ];
    assert_agrees(&*system, axes);
}

#[test]
fn where_no_affordable_number_of_modes_is_enough_no_change_is_located() {
    // The noise remembers longer than x does, so that x nearly follows it: each pair of nodes has a peak of its own.
    let text = "[system]\nmodel = \"bistable\"\nnoise = { kind = \"harmonic\" }\n\
         [system.parameters]\na = 0.3\nsigma2 = 0.3\nnoise_damping = 0.3\n\
         [sweep]\nparameter = \"noise_frequency\"\nfrom = 2\nto = 4\npoints = 2\n\
         [cells]\nx = { from = -2.4, to = 2.4, count = 40 }\n";
    let (_, found) = swept(text, "");
    for point in &found.points {
        let mut findings = point.report.findings.iter();
        let few = findings.find_map(|finding| match finding {
            Finding::FewModes { change } => Some(*change),
            _ => None,
        });
        assert!(few.unwrap() > 1e-2, "{}", point.value);
    }
    for row in found.bifurcations() {
        assert_ne!(row.status(), BifurcationStatus::Located, "{row:?}");
    }
}

/// With eight modes x has 4 and 6 peaks at τ = 10, one a node; cells along the noise show 2.
#[test]
fn too_few_modes_are_told_when_they_were_given() {
    let run = |tau: [f64; 2]| {
        let text = format!(
            "[system]\nmodel = \"bistable\"\nnoise = {{ kind = \"ornstein-uhlenbeck\" }}\n\
             [system.parameters]\na = -0.1\nsigma2 = 0.2\n\
             [sweep]\nparameter = \"tau\"\nfrom = {}\nto = {}\npoints = 3\n\
             [cells]\nx = {{ from = -2.2, to = 2.2, count = 60 }}\nnoise = {{ modes = 8 }}\n\
             [locate]\nlargest_distance = 0.9\n",
            tau[0], tau[1]
        );
        swept(&text, "").1
    };
    let is_told =
        |finding: &Finding| matches!(finding, Finding::FewModes { change } if *change > 0.1);
    let long = run([1.0, 30.0]);
    let told = |point: &pbif::continuation::Point| point.report.findings.iter().any(is_told);
    assert!(long.points.iter().all(told));
    assert!(
        long.bifurcations()
            .all(|row| row.status() != BifurcationStatus::Located)
    );
    let short = run([0.05, 0.15]);
    let few = |finding: &Finding| matches!(finding, Finding::FewModes { .. });
    assert!(
        !short
            .points
            .iter()
            .any(|point| point.report.findings.iter().any(few))
    );
}

#[test]
fn what_modes_of_noise_are_not_for_is_refused() {
    let system = linear(0.5);
    let cells = || Axis::uniform(-3.0, 3.0, 6).unwrap();
    let refused = |axes: Vec<Axis>| {
        let space = CellSpace::new(axes).unwrap();
        assemble(&*system, &space, &GeneratorOptions::default()).is_err()
    };
    let noise = |centre: f64, width: f64| Axis::hermite(centre, width, 3).unwrap();
    assert!(!refused(vec![cells(), cells(), noise(0.0, 1.0)]));
    for axes in [
        vec![cells(), cells(), noise(0.1, 1.0)],
        vec![cells(), cells(), noise(0.0, 1.1)],
        vec![cells(), noise(0.0, 1.0), cells()],
        vec![cells(), cells(), Axis::modes(-3.0, 3.0, 3).unwrap()],
    ] {
        assert!(refused(axes));
    }
}

/// x' = -k x + c η with η of unit variance and memory τ = 0.6: what is watched of both is known, though modes carry η.
#[test]
fn formulas_with_a_state_that_modes_carry_have_their_densities_and_means() {
    let text = "[system.equations]\nx = \"-k x\"\n[system.noise]\nx = \"0.4\"\nkind = \"ornstein-uhlenbeck\"\n\
                [system.parameters]\nk = 1.0\ntau = 0.6\n[sweep]\nparameter = \"k\"\nfrom = 0.7\nto = 1.2\npoints = 2\n\
                [detect]\nmarginals = [\"s = x + 2 noise\"]\njoint = [[\"noise\", \"s\"]]\n\
                [watch]\nq = \"x noise\"\nsize = \"abs(noise)\"\nstrength = \"noise^2\"\n";
    let (k, tau): (f64, f64) = (1.2, 0.6);
    let (_, solution) = solved(text, "", None);
    let c = 0.4 / (2.0 * tau).sqrt();
    let both = c / (k + 1.0 / tau);
    let exact = [
        ("mean_q", both),
        ("mean_size", (2.0 / PI).sqrt()),
        ("mean_strength", 1.0),
    ];
    for (name, exact) in exact {
        let (value, error) = measure(&solution, name);
        let off = (value - exact).abs();
        assert!(off <= error && error < 2e-4, "{name}: {off:e} of {error:e}");
    }
    let deviation = (c * both / k + 4.0 * both + 4.0).sqrt();
    let below = |x: f64| 0.5 * erfc(-x / deviation / 2_f64.sqrt());
    let [s, joint] = &solution.densities[..] else {
        panic!("two densities");
    };
    let edges = s.density.axes[0].edges();
    let bins = edges.windows(2).zip(s.density.masses());
    let off: f64 = bins
        .map(|(bin, mass)| (mass - below(bin[1]) + below(bin[0])).abs())
        .sum();
    // What is asked of the cells, `cells.accuracy`.
    assert!(0.5 * off < 1e-3, "{off:e}");
    // The noise's own axis is laid out over bins, and either sum over the joint density is a density again.
    let columns = joint.density.axes[1].count();
    let of_s = (0..columns).map(|column| {
        let rows = joint
            .density
            .masses()
            .into_iter()
            .skip(column)
            .step_by(columns);
        rows.sum::<f64>()
    });
    let apart = of_s
        .zip(s.density.masses())
        .map(|(a, b)| (a - b).abs())
        .sum::<f64>();
    assert!(apart < 1e-3, "{apart:e}");
}

/// z = x + a x² + b x³ is normal under filtered noise, so that p(x) ∝ exp(-(z - m)²/2v) z' is known.
fn bent(noise: &str, modes: &str) -> (String, impl Fn(f64) -> f64) {
    let (a, b, c) = (-0.134, 0.203, 1.39);
    let z = format!("(x + ({a})*x^2 + {b}*x^3)");
    let slope = format!("(1 + 2*({a})*x + 3*{b}*x^2)");
    let text = format!(
        "[system.equations]\nx = \"(0.109 - {c}*{z})/{slope}\"\n\
         [system.noise]\nkind = \"ornstein-uhlenbeck\"\nx = \"{noise}/{slope}\"\n\
         [sweep]\nparameter = \"tau\"\nfrom = 0.06\nto = 0.8\npoints = 9\n\
         [cells]\nx = {{ from = -3.2, to = 3.2, count = 120 }}\n{modes}\
         [detect]\nmarginals = [\"x\"]\n"
    );
    let strength: f64 = noise.parse().unwrap();
    let peak = move |tau: f64| {
        let v = strength * strength / (2.0 * c * (1.0 + c * tau));
        let slope_of_log = |x: f64| {
            let (z, first, second) = (
                x + a * x * x + b * x * x * x,
                1.0 + 2.0 * a * x + 3.0 * b * x * x,
                2.0 * a + 6.0 * b * x,
            );
            -(z - 0.109 / c) * first / v + second / first
        };
        let (mut low, mut high) = (-0.6, 0.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if slope_of_log(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    };
    (text, peak)
}

#[test]
fn the_place_of_a_peak_is_known_as_well_as_the_modes_of_the_noise_tell() {
    for (modes, most) in [("", 1e-3), ("noise = { modes = 12 }\n", 3e-2)] {
        let (text, peak) = bent("2.095", modes);
        let (_, found) = solved(&text, "", Some(0.7075));
        let detector = PersistenceDetector::new(DetectOptions::default(), 1);
        let detected = detector.detect(&found.densities[0]);
        let exact = peak(0.7075);
        let near = detected
            .features
            .iter()
            .filter(|one| one.kind == FeatureKind::Peak);
        let near = near.min_by(|one, other| {
            let off = |one: &Feature| (one.position[0] - exact).abs();
            off(one).total_cmp(&off(other))
        });
        let near = near.unwrap();
        let (off, error) = ((near.position[0] - exact).abs(), near.errors.position[0]);
        assert!(off <= error, "{modes}: {off:e}, stated {error:e}");
        assert!(error < most, "{modes}: {error:e}");
    }
}
