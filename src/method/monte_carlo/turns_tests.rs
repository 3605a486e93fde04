//! Trajectories at phases and round angles against exact answers: a moving normal density with its means, deviations
//! and amplitude, and velocity and diffusion of a tilted washboard.

use std::sync::Arc;

use super::{Estimator, MonteCarloOptions, MonteCarloSource};
use crate::cancellation::Cancellation;
use crate::continuation::Solution;
use crate::density::{EstimatedDensity, Observable};
use crate::method::generator::angles_tests::{exact, washboard};
use crate::method::generator::turns_tests::{forced, normal};
use crate::method::{MethodError, Problem};
use crate::space::{Axis, CellSpace};
use crate::system::{AtPhase, Family, Model, Path, Quantity, TypedModel};

/// A model at a value of `A`, with these densities at phases watched beside those of all axes over the period.
pub(crate) fn problem(
    (model, fixed): (&Arc<Model>, &[(&str, f64)]),
    amplitude: f64,
    axes: Vec<Axis>,
    phases: &[(usize, f64)],
) -> Problem {
    let path = Path::parameter("A", amplitude, amplitude);
    let quantities = phases.iter().map(|&(axis, phase)| {
        Arc::new(Quantity::at_phase(model, AtPhase { axis, phase }).unwrap())
    });
    let family = Family::new(Arc::clone(model), fixed, path).unwrap();
    let family = family.with_quantities(quantities.collect());
    let states = (0..axes.len()).filter(|&axis| model.phase_axis() != Some(axis));
    let at_phases = axes.len()..axes.len() + phases.len();
    let observables = states.chain(at_phases).map(Observable::Marginal).collect();
    let bins = phases.iter().map(|&(axis, _)| axes[axis].clone()).collect();
    Problem::watching(family, CellSpace::new(axes).unwrap(), observables, bins).unwrap()
}

fn sampled(problem: &Problem, error: f64) -> Solution<'static> {
    let options = MonteCarloOptions {
        error,
        ..MonteCarloOptions::default()
    };
    let never = Cancellation::new();
    let source = MonteCarloSource::new(problem, &options, &never).unwrap();
    let value = problem.family().ends().0;
    source.estimate(value, &never).unwrap().0
}

/// Differences of a density from the exact masses of its cells in standard errors, where a cell holds 1e-4.
pub(crate) fn off(density: &EstimatedDensity, exact: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let axis = &density.density.axes[0];
    let masses = density.density.masses();
    let cells = axis.edges().windows(2).zip(masses).enumerate();
    let off = cells.filter_map(|(cell, (edges, mass))| {
        let exact = exact(edges);
        let error = density.standard_error[cell] * axis.width(cell);
        (exact > 1e-4).then(|| (mass - exact) / error)
    });
    off.collect()
}

/// Mean square one, within what so many differences scatter (neighbours vary together), and none far out.
pub(crate) fn assert_standard(off: &[f64], what: &str) {
    let count = off.len() as f64;
    let square = off.iter().map(|z| z * z).sum::<f64>() / count;
    let worst = off.iter().fold(0.0_f64, |worst, z| worst.max(z.abs()));
    assert!(square < 1.0 + 8.0 / count.sqrt(), "{what}: {square}");
    assert!(square > 0.2 && worst < 5.0, "{what}: {square} {worst}");
}

fn known(solution: &Solution<'_>, name: &str) -> (f64, f64) {
    let report = &solution.report;
    let known = report.measure(name).zip(report.error_of(name));
    known.unwrap_or_else(|| panic!("{name} is not known"))
}

pub(crate) fn assert_known(solution: &Solution<'_>, name: &str, exact: f64, largest_error: f64) {
    let (value, error) = known(solution, name);
    assert!(error < largest_error, "{name}: {value} ± {error:e}");
    let off = (value - exact) / error;
    assert!(off.abs() < 3.7, "{name}: {value} ± {error:e}, not {exact}");
}

#[test]
fn a_forced_linear_system_is_a_moving_normal_density_at_phases() {
    let (w, d, a) = (1.3, 0.1, 0.5_f64);
    let model = forced("-x");
    let phases = [(0, 0.0), (0, 0.25), (0, 0.6)];
    let axes = vec![
        Axis::uniform(-2.0, 2.0, 40).unwrap(),
        Axis::fourier(0.0, 1.0, 6).unwrap(),
    ];
    let problem = problem((&model, &[("w", w), ("D", d)]), a, axes, &phases);
    let solution = sampled(&problem, 0.003);
    assert!(solution.report.status.is_resolved());
    let mean = |phase: f64| {
        let angle = std::f64::consts::TAU * phase;
        a * (angle.cos() + w * angle.sin()) / (1.0 + w * w)
    };
    for (density, (_, phase)) in solution.densities[1..].iter().zip(phases) {
        let whole: f64 = density.density.masses().iter().sum();
        assert!((whole - 1.0).abs() < 1e-4, "{whole}");
        let off = off(density, |edges| normal(mean(phase), d.sqrt(), edges));
        assert_standard(&off, &format!("phase {phase}"));
    }
    let over_the_period = |edges: &[f64]| {
        let steps = 400;
        let phases = (0..steps).map(|step| f64::from(step) / f64::from(steps));
        let all = phases.map(|phase| normal(mean(phase), d.sqrt(), edges));
        all.sum::<f64>() / f64::from(steps)
    };
    assert_standard(&off(&solution.densities[0], over_the_period), "mean");
    for (name, phase) in [("0", 0.0), ("1_4", 0.25), ("3_5", 0.6)] {
        assert_known(
            &solution,
            &format!("mean_x_phase_{name}"),
            mean(phase),
            3e-3,
        );
        let name = format!("sd_x_phase_{name}");
        assert_known(&solution, &name, d.sqrt(), 3e-3);
    }
    let gain = 1.0 / (1.0 + w * w);
    assert_known(&solution, "amplitude_x", a * gain.sqrt(), 3e-3);
    assert_known(&solution, "amplification_x", gain, 1e-2);
    assert_known(&solution, "mean_x", 0.0, 3e-3);
}

#[test]
fn a_forced_linear_oscillator_moves_along_its_ellipse() {
    // x'' + 0.3 x' + x = A cos(1.2 t) + noise of variance 0.15/0.3 of x and of x'.
    let model = TypedModel::new("forced", "Forced", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-0.3 y - x + A cos(1.2 t)")
        .with_noise("y", ["sqrt(0.3)"])
        .with_parameters(["A"]);
    let model = model.build().unwrap();
    let (w, a) = (1.2_f64, 0.8);
    let size = (1.0 - w * w).powi(2) + (0.3 * w).powi(2);
    let (cosine, sine) = (a * (1.0 - w * w) / size, a * 0.3 * w / size);
    let mean = |phase: f64| {
        let angle = std::f64::consts::TAU * phase;
        let x = cosine * angle.cos() + sine * angle.sin();
        (x, w * (sine * angle.cos() - cosine * angle.sin()))
    };
    let deviation = 0.5_f64.sqrt();
    let axes = vec![
        Axis::uniform(-5.5, 5.5, 40).unwrap(),
        Axis::uniform(-5.5, 5.5, 40).unwrap(),
        Axis::fourier(0.0, 1.0, 6).unwrap(),
    ];
    let phases = [(0, 0.125), (1, 0.125)];
    let problem = problem((&model, &[]), a, axes, &phases);
    let solution = sampled(&problem, 0.01);
    let (x, y) = mean(0.125);
    for (density, mean) in solution.densities[2..].iter().zip([x, y]) {
        let off = off(density, |edges| normal(mean, deviation, edges));
        assert_standard(&off, &format!("{mean}"));
    }
    assert_known(&solution, "mean_x_phase_1_8", x, 2e-2);
    assert_known(&solution, "mean_y_phase_1_8", y, 2e-2);
    assert_known(&solution, "sd_y_phase_1_8", deviation, 2e-2);
    assert_known(&solution, "amplitude_x", a / size.sqrt(), 2e-2);
}

#[test]
fn a_tilted_washboard_turns_and_spreads_as_quadrature_says() {
    for (a, d, shift) in [(0.2, 0.3, 0.0), (0.9, 0.15, 1.0), (1.4, 0.1, 2.9)] {
        let (velocity, diffusion, density) = exact(a, d);
        let axes = vec![Axis::fourier(-std::f64::consts::PI, std::f64::consts::PI, 8).unwrap()];
        let problem = problem((&washboard(shift, d), &[]), a, axes, &[]);
        let solution = sampled(&problem, 0.005);
        assert!(solution.report.status.is_resolved());
        assert_known(
            &solution,
            "velocity_theta",
            velocity,
            0.02 * velocity + 1e-3,
        );
        assert_known(&solution, "diffusion_theta", diffusion, 0.06 * diffusion);
        assert_eq!(solution.report.measure("mean_theta"), None);
        let points = density.len() as f64;
        let turn = std::f64::consts::TAU;
        let mass = |edges: &[f64]| {
            // The mean of 24 points of a smooth density inside a bin.
            let at = |k: usize| {
                let x = edges[0] + (k as f64 + 0.5) / 24.0 * (edges[1] - edges[0]) - shift;
                density[((x.rem_euclid(turn) / turn * points) as usize).min(density.len() - 1)]
            };
            (0..24).map(at).sum::<f64>() / 24.0 * (edges[1] - edges[0])
        };
        assert_standard(&off(&solution.densities[0], mass), &format!("{a} {d}"));
    }
}

#[test]
fn a_driven_rotor_turns_as_known() {
    let model = TypedModel::new("rotor", "Rotor", ["theta", "omega"])
        .with_equation("theta", "omega")
        .with_equation("omega", "-0.5 omega - sin(theta) + A")
        .with_noise("omega", [format!("{}", 0.6_f64.sqrt())])
        .with_angle("theta", std::f64::consts::TAU)
        .with_parameters(["A"]);
    let pi = std::f64::consts::PI;
    let axes = vec![
        Axis::fourier(-pi, pi, 8).unwrap(),
        Axis::uniform(-5.0, 8.0, 40).unwrap(),
    ];
    let problem = problem((&model.build().unwrap(), &[]), 1.0, axes, &[]);
    // Of another program: γ = 0.5, T = 0.6, torque 1.
    let solution = sampled(&problem, 0.01);
    assert_known(&solution, "velocity_theta", 1.694_755, 0.02);
}

#[test]
fn phases_that_no_division_of_the_period_has_are_refused_and_so_is_an_ensemble() {
    let model = forced("-x");
    let axes = || {
        vec![
            Axis::uniform(-2.0, 2.0, 20).unwrap(),
            Axis::fourier(0.0, 1.0, 4).unwrap(),
        ]
    };
    let fixed = [("w", 1.0), ("D", 0.1)];
    let never = Cancellation::new();
    let strange = problem((&model, &fixed), 0.5, axes(), &[(0, 0.123_456)]);
    let found = MonteCarloSource::new(&strange, &MonteCarloOptions::default(), &never);
    assert!(matches!(found, Err(MethodError::Phases)), "{found:?}");
    let plain = problem((&model, &fixed), 0.5, axes(), &[(0, 1.0 / 7.0)]);
    let options = MonteCarloOptions {
        estimator: Estimator::Ensemble,
        ..MonteCarloOptions::default()
    };
    let found = MonteCarloSource::new(&plain, &options, &never);
    let words = found.map(drop).unwrap_err().to_string();
    assert!(words.contains("at one phase"), "{words}");
}
