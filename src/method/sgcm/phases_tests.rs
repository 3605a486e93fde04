//! Forced systems by cell maps against exact answers: a moving normal density with its means, deviations and amplitude.

use super::{Correction, SgcmOptions, SgcmSource};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, Solution};
use crate::density::EstimatedDensity;
use crate::method::generator::turns_tests::{forced, normal};
use crate::method::monte_carlo::turns_tests::{assert_known, assert_standard, off, problem};
use crate::method::{MethodError, Problem, StepChoice};
use crate::space::Axis;

fn solved(problem: &Problem, options: &SgcmOptions) -> Solution<'static> {
    let never = Cancellation::new();
    let source = SgcmSource::new(problem, options, &never).unwrap();
    let value = problem.family().ends().0;
    source.open(&never).solve(value).unwrap().detached()
}

/// x' = -x + A cos(w t) + √(2 D) ξ with A = 0.5, w = 1.3 and D = 0.1: its mean and deviation at a phase.
const FORCED: (f64, f64, f64) = (0.5, 1.3, 0.1);

fn mean(phase: f64) -> f64 {
    let (a, w, _) = FORCED;
    let angle = std::f64::consts::TAU * phase;
    a * (angle.cos() + w * angle.sin()) / (1.0 + w * w)
}

fn linear(cells: usize, phases: &[(usize, f64)]) -> Problem {
    let (a, w, d) = FORCED;
    let axes = vec![
        Axis::uniform(-2.0, 2.0, cells).unwrap(),
        Axis::fourier(0.0, 1.0, 6).unwrap(),
    ];
    problem((&forced("-x"), &[("w", w), ("D", d)]), a, axes, phases)
}

/// ½ Σ |p - q| of the cells of a density and the exact masses.
fn total_variation(density: &EstimatedDensity, exact: impl Fn(&[f64]) -> f64) -> f64 {
    let masses = density.density.masses();
    let cells = density.density.axes[0].edges().windows(2).zip(masses);
    0.5 * cells
        .map(|(edges, mass)| (mass - exact(edges)).abs())
        .sum::<f64>()
}

/// The density at phases, over the period, its moments and its amplitude within their stated errors, for map steps of
/// three sixteenths of the period, and of more than a period.
#[test]
fn a_forced_linear_system_is_a_moving_normal_density_at_phases() {
    let (a, w, d) = FORCED;
    let phases = [(0, 0.0), (0, 0.25), (0, 0.8125)];
    let problem = linear(40, &phases);
    let period = std::f64::consts::TAU / w;
    for (choice, passed) in [
        (StepChoice::Auto, 3.0),
        (StepChoice::Fixed(1.3 * period), 21.0),
    ] {
        let options = SgcmOptions {
            map_step: choice,
            ..SgcmOptions::default()
        };
        let solution = solved(&problem, &options);
        assert!(solution.report.status.is_resolved());
        let step = solution.report.measure("map_step").unwrap();
        assert!((step / period - passed / 16.0).abs() < 1e-12, "{step}");
        for (density, (_, phase)) in solution.densities[1..].iter().zip(phases) {
            let whole: f64 = density.density.masses().iter().sum();
            assert!((whole - 1.0).abs() < 1e-6, "{whole}");
            let off = off(density, |edges| normal(mean(phase), d.sqrt(), edges));
            assert_standard(&off, &format!("{choice:?} phase {phase}"));
        }
        let over_the_period = |edges: &[f64]| {
            let phases = (0..400).map(|step| f64::from(step) / 400.0);
            let all = phases.map(|phase| normal(mean(phase), d.sqrt(), edges));
            all.sum::<f64>() / 400.0
        };
        let off = off(&solution.densities[0], over_the_period);
        assert_standard(&off, &format!("{choice:?} mean"));
        for (name, phase) in [("0", 0.0), ("1_4", 0.25), ("13_16", 0.8125)] {
            let known = |name: &str, exact: f64| assert_known(&solution, name, exact, 8e-3);
            known(&format!("mean_x_phase_{name}"), mean(phase));
            known(&format!("sd_x_phase_{name}"), d.sqrt());
        }
        let gain = 1.0 / (1.0 + w * w);
        assert_known(&solution, "amplitude_x", a * gain.sqrt(), 8e-3);
        assert_known(&solution, "amplification_x", gain, 2e-2);
        assert_known(&solution, "mean_x", 0.0, 8e-3);
        let diffusion = |axis: &str| {
            solution
                .report
                .measure(&format!("numerical_diffusion_{axis}"))
        };
        assert!(diffusion("x").unwrap().abs() < 5e-4 && diffusion("t") == Some(0.0));
    }
}

/// Flat cells of width h spread the density at every phase as they do without a forcing, to cell masses of a variance
/// that is larger by (h²/6)/(e^{2Δt} - 1), and leave its mean: nothing spreads along the phase. With slopes that is
/// gone.
#[test]
fn cells_widen_a_density_at_a_phase_as_they_do_without_forcing() {
    let (_, w, d) = FORCED;
    let (phases, cells) = ([(0, 0.0), (0, 0.25)], 16);
    let problem = linear(cells, &phases);
    let step = std::f64::consts::TAU / w / 16.0;
    let width = 4.0 / cells as f64;
    let by = |correction: Correction| {
        let options = SgcmOptions {
            map_step: StepChoice::Fixed(step),
            correction,
            samples: 8000,
            ..SgcmOptions::default()
        };
        solved(&problem, &options)
    };
    let (flat, sloped) = (by(Correction::None), by(Correction::Slope));
    let added = width * width / 6.0 / (2.0 * step).exp_m1();
    let (wide, narrow) = ((d + added).sqrt(), d.sqrt());
    for (index, (_, phase)) in phases.into_iter().enumerate() {
        let of = |solution: &Solution<'_>, deviation: f64| {
            let density = &solution.densities[1 + index];
            // Standard errors have what the cells add to the noise as well.
            let cells = 0..density.density.values.len();
            let sampled = cells.map(|cell| density.variants.sampling_error(|values| values[cell]));
            let noise = sampled.sum::<f64>() * width;
            let exact = |edges: &[f64]| normal(mean(phase), deviation, edges);
            // ½ Σ √(2/π) se is expected of sampling alone.
            (total_variation(density, exact), 0.4 * noise)
        };
        for (solution, own, other) in [(&flat, wide, narrow), (&sloped, narrow, wide)] {
            let ((near, noise), (far, _)) = (of(solution, own), of(solution, other));
            // About 0.025 of total variation lie between the two laws. Eight groups know the noise to a quarter.
            let words = format!("{phase}: {near} {far} {noise}");
            assert!(near < 2.0 * noise + 0.002 && noise < 0.0075, "{words}");
            assert!(far > 0.018 && far > 2.0 * near, "{words}");
        }
    }
    let law = width * width / 12.0 / step;
    let found = flat.report.measure("numerical_diffusion_x").unwrap();
    assert!((found / law - 1.0).abs() < 0.05, "{found} {law}");
}

#[test]
fn what_is_solved_does_not_depend_on_the_number_of_threads() {
    let problem = linear(30, &[(0, 0.0)]);
    let options = SgcmOptions {
        samples: 200,
        ..SgcmOptions::default()
    };
    let never = Cancellation::new();
    let source = SgcmSource::new(&problem, &options, &never).unwrap();
    let value = problem.family().ends().0;
    let by = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let solution = source.open(&never).solve(value).unwrap().detached();
            (solution.report, solution.densities)
        })
    };
    assert_eq!(by(1), by(2));
}

#[test]
fn phases_become_cells() {
    let never = Cancellation::new();
    let by = |problem: &Problem| SgcmSource::new(problem, &SgcmOptions::default(), &never);
    // Twelfths and fifths: sixty parts of the period.
    let many = by(&linear(10, &[(0, 1.0 / 12.0), (0, 0.2)])).unwrap();
    assert_eq!(many.problem().space().axes()[1].count(), 60);
    let strange = by(&linear(10, &[(0, 0.123_456)])).map(drop).unwrap_err();
    assert!(matches!(strange, MethodError::Phases), "{strange}");
}
