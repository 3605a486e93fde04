//! Phases and angles against exact answers: a moving normal density, linear response, and the density of Gibbs.

use std::sync::Arc;

use super::{GeneratorMethodOptions, GeneratorSource};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, SolveReport};
use crate::density::{Density, Observable};
use crate::method::Problem;
use crate::space::{Axis, CellSpace};
use crate::system::{AtPhase, Family, Model, Path, Quantity, TypedModel};

/// Phases that are looked at.
const PHASES: usize = 16;

/// Densities of the first axis over the period, then at all phases, at a value of `A`.
fn densities(
    model: &Arc<Model>,
    fixed: &[(&str, f64)],
    amplitude: f64,
    axes: Vec<Axis>,
) -> Vec<Density> {
    let path = Path::parameter("A", amplitude, amplitude);
    let phases = (0..PHASES).map(|step| {
        let phase = step as f64 / PHASES as f64;
        Arc::new(Quantity::at_phase(model, AtPhase { axis: 0, phase }).unwrap())
    });
    let family = Family::new(Arc::clone(model), fixed, path).unwrap();
    let family = family.with_quantities(phases.collect());
    let first = model.axes.len();
    let observables = (first..first + PHASES).map(Observable::Marginal);
    let observables = [Observable::Marginal(0)]
        .into_iter()
        .chain(observables)
        .collect();
    let bins = vec![axes[0].clone(); PHASES];
    let space = CellSpace::new(axes).unwrap();
    let problem = Problem::watching(family, space, observables, bins).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let solution = session.solve(amplitude).unwrap();
    solution
        .densities
        .iter()
        .map(|one| one.density.clone())
        .collect()
}

fn mean(density: &Density) -> f64 {
    let masses = density.masses();
    let centres = density.axes[0].centres();
    centres.iter().zip(&masses).map(|(x, mass)| x * mass).sum()
}

/// x' = `drift` + A cos(w t), with white noise of intensity 2 D.
pub(crate) fn forced(drift: &str) -> Arc<Model> {
    TypedModel::new("forced", "Forced", ["x"])
        .with_equation("x", format!("{drift} + A cos(w t)"))
        .with_noise("x", ["sqrt(2 D)"])
        .with_parameters(["A", "w", "D"])
        .build()
        .unwrap()
}

/// ∫ of a normal density over a cell.
pub(crate) fn normal(mean: f64, deviation: f64, edges: &[f64]) -> f64 {
    let below = |x: f64| 0.5 * statrs::function::erf::erfc((mean - x) / deviation / 2_f64.sqrt());
    below(edges[1]) - below(edges[0])
}

#[test]
fn a_forced_linear_system_is_a_moving_normal_density_at_all_phases() {
    let (w, d, a) = (1.3, 0.1, 0.5_f64);
    let model = forced("-x");
    assert_eq!(model.axes[1].name, "t");
    let axes = vec![
        Axis::uniform(-2.6, 2.6, 100).unwrap(),
        Axis::fourier(0.0, 1.0, 12).unwrap(),
    ];
    let found = densities(&model, &[("w", w), ("D", d)], a, axes);
    let at = |phase: f64| {
        let angle = std::f64::consts::TAU * phase;
        a * (angle.cos() + w * angle.sin()) / (1.0 + w * w)
    };
    let distance = |density: &Density, exact: &dyn Fn(&[f64]) -> f64| {
        let cells = density.axes[0].edges().windows(2).zip(density.masses());
        0.5 * cells
            .map(|(edges, mass)| (mass - exact(edges)).abs())
            .sum::<f64>()
    };
    for step in 0..PHASES {
        let phase = step as f64 / PHASES as f64;
        let exact = |edges: &[f64]| normal(at(phase), d.sqrt(), edges);
        let off = distance(&found[1 + step], &exact);
        assert!(off < 1e-5, "{phase}: {off:e}");
    }
    // Over the period: the mean of many phases.
    let exact = |edges: &[f64]| {
        let steps = 400;
        let phases = (0..steps).map(|step| f64::from(step) / f64::from(steps));
        phases
            .map(|phase| normal(at(phase), d.sqrt(), edges))
            .sum::<f64>()
            / f64::from(steps)
    };
    let off = distance(&found[0], &exact);
    assert!(off < 1e-5, "{off:e}");
}

/// Measures of a forced system at a value of `A`, by so many cells and harmonics.
fn measured(
    model: &Arc<Model>,
    fixed: &[(&str, f64)],
    amplitude: f64,
    axes: Vec<Axis>,
) -> SolveReport {
    let path = Path::parameter("A", amplitude, amplitude);
    let family = Family::new(Arc::clone(model), fixed, path).unwrap();
    let space = CellSpace::new(axes).unwrap();
    let problem = Problem::new(family, space, vec![Observable::Marginal(0)]).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    session.solve(amplitude).unwrap().report
}

#[test]
fn means_and_deviations_at_phases_are_those_of_the_moving_normal_density() {
    let (w, d, a) = (1.3, 0.1, 0.5_f64);
    let model = forced("-x");
    let phases = [("0", 0.0), ("1_4", 0.25), ("3_5", 0.6)];
    let quantities = phases.map(|(_, phase)| {
        Arc::new(Quantity::at_phase(&model, AtPhase { axis: 0, phase }).unwrap())
    });
    let path = Path::parameter("A", a, a);
    let family = Family::new(Arc::clone(&model), &[("w", w), ("D", d)], path).unwrap();
    let family = family.with_quantities(quantities.to_vec());
    for (cells, harmonics, most) in [(100, 12, 1e-4), (30, 4, 5e-2)] {
        let axes = vec![
            Axis::uniform(-2.6, 2.6, cells).unwrap(),
            Axis::fourier(0.0, 1.0, harmonics).unwrap(),
        ];
        let bins = vec![axes[0].clone(); 3];
        let space = CellSpace::new(axes).unwrap();
        let watched = vec![Observable::Marginal(0)];
        let problem = Problem::watching(family.clone(), space, watched, bins).unwrap();
        let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
        let mut session = source.open(&Cancellation::new());
        let report = session.solve(a).unwrap().report;
        for (name, phase) in phases {
            let angle = std::f64::consts::TAU * phase;
            let mean = a * (angle.cos() + w * angle.sin()) / (1.0 + w * w);
            for (kind, exact) in [("mean", mean), ("sd", d.sqrt())] {
                let name = format!("{kind}_x_phase_{name}");
                let found = report.measure(&name).unwrap();
                let error = report.error_of(&name).unwrap();
                let off = (found - exact).abs();
                assert!(
                    off < error + 1e-9,
                    "{cells} {name}: {found} ± {error:e}, {exact}"
                );
                assert!(error < most, "{cells} {name}: {error:e}");
            }
        }
    }
}

#[test]
fn a_forced_double_well_amplifies_as_linear_response_says() {
    let model = forced("x - x^3");
    // Of A = 0.01 and 0.3 with D = 0.12 and the frequency 0.1, by complex harmonics of another program.
    for (amplitude, exact) in [(0.01, 10.956_236), (0.3, 9.265_904)] {
        for (cells, harmonics) in [(160, 12), (60, 5)] {
            let axes = vec![
                Axis::uniform(-2.6, 2.6, cells).unwrap(),
                Axis::fourier(0.0, 1.0, harmonics).unwrap(),
            ];
            let report = measured(&model, &[("w", 0.1), ("D", 0.12)], amplitude, axes);
            let found = report.measure("amplification_x").unwrap();
            let error = report.error_of("amplification_x").unwrap();
            let off = (found - exact).abs();
            assert!(
                off < error + 5e-7,
                "{amplitude} {cells}: {found} ± {error:e}"
            );
            let most = if cells == 160 { 1e-4 } else { 2e-1 };
            assert!(error < most * exact, "{amplitude} {cells}: {error:e}");
            // A phase has no mean.
            assert_eq!(report.measure("mean_t"), None);
        }
    }
}

#[test]
fn a_forced_linear_system_moves_with_its_exact_amplitude() {
    let model = forced("-x");
    let (w, amplitude) = (1.3, 0.5);
    let axes = vec![
        Axis::uniform(-2.6, 2.6, 100).unwrap(),
        Axis::fourier(0.0, 1.0, 9).unwrap(),
    ];
    let report = measured(&model, &[("w", w), ("D", 0.1)], amplitude, axes);
    let gain = 1.0 / (1.0 + w * w);
    for (name, exact) in [
        ("amplitude_x", amplitude * f64::sqrt(gain)),
        ("amplification_x", gain),
    ] {
        let (found, error) = (report.measure(name), report.error_of(name).unwrap());
        let off = (found.unwrap() - exact).abs();
        assert!(
            off <= error && error < 1e-4 * exact,
            "{name}: {off:e} of {error:e}"
        );
    }
    // A force that depends on the state has no amplitude of its own.
    let model = forced("-x + 0.3 x sin(w t)");
    let axes = vec![
        Axis::uniform(-3.0, 3.0, 60).unwrap(),
        Axis::fourier(0.0, 1.0, 6).unwrap(),
    ];
    let report = measured(&model, &[("w", w), ("D", 0.1)], amplitude, axes);
    assert_eq!(report.measure("amplification_x"), None);
    assert!(report.measure("amplitude_x").is_some());
}

#[test]
fn a_rotor_has_the_density_of_gibbs_and_a_driven_one_its_velocity() {
    let model = TypedModel::new("rotor", "Rotor", ["theta", "y"])
        .with_equation("theta", "y")
        .with_equation("y", "-0.5 y - sin(theta) + A")
        .with_noise("y", ["sqrt(0.6)"])
        .with_angle("theta", std::f64::consts::TAU)
        .with_parameters(["A"])
        .build()
        .unwrap();
    let pi = std::f64::consts::PI;
    // Velocities by a product of Hermite and Fourier modes, 40 × 25, of another program.
    for (torque, velocity) in [(0.0, 0.0), (0.5, 0.328_288_1), (1.0, 1.694_755_1)] {
        let axes = vec![
            Axis::fourier(-pi, pi, 12).unwrap(),
            Axis::uniform(-5.5, 7.5, 90).unwrap(),
        ];
        let space = CellSpace::new(axes).unwrap();
        let path = Path::parameter("A", torque, torque);
        let family = Family::new(Arc::clone(&model), &[], path).unwrap();
        let observables = vec![Observable::Marginal(0), Observable::Marginal(1)];
        let problem = Problem::new(family, space, observables).unwrap();
        let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
        let mut session = source.open(&Cancellation::new());
        let solution = session.solve(torque).unwrap();
        let found = mean(&solution.densities[1].density);
        assert!((found - velocity).abs() < 1e-5, "{torque}: {found}");
        if torque == 0.0 {
            let density = &solution.densities[0].density;
            let exact = |x: f64| (x.cos() / 0.6).exp();
            let steps = 600;
            let width = 2.0 * pi / f64::from(steps);
            let whole: f64 = (0..steps)
                .map(|k| exact(f64::from(k) * width) * width)
                .sum();
            for (bin, value) in density.values.iter().enumerate() {
                let (from, to) = (
                    density.axes[0].edges()[bin],
                    density.axes[0].edges()[bin + 1],
                );
                // Simpson's rule over the bin.
                let exact =
                    (exact(from) + 4.0 * exact(0.5 * (from + to)) + exact(to)) / 6.0 / whole;
                assert!((value - exact).abs() < 1e-5, "{bin}: {value} {exact}");
            }
        }
    }
}

#[test]
fn what_has_no_phase_that_moves_forward_is_refused() {
    let model = forced("-x");
    let family = |w: f64| {
        let path = Path::parameter("A", 0.1, 0.2);
        Family::new(Arc::clone(&model), &[("w", w), ("D", 0.1)], path).unwrap()
    };
    let axes = vec![
        Axis::uniform(-2.0, 2.0, 20).unwrap(),
        Axis::fourier(0.0, 1.0, 2).unwrap(),
    ];
    let space = CellSpace::new(axes).unwrap();
    for (w, is_right) in [(1.0, true), (0.0, false), (-1.0, false)] {
        let problem =
            Problem::new(family(w), space.clone(), vec![Observable::Marginal(0)]).unwrap();
        let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default());
        assert_eq!(source.is_ok(), is_right, "{w}");
    }
}
