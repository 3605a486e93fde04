//! Changes to first order against cell maps that are solved without a group, and stated errors against exact answers.

#![allow(clippy::panic, reason = "a test that cannot be set up should stop")]

use super::slope_correction::solve_by;
use super::source::SampledPoint;
use super::{Correction, SgcmOptions, SgcmSource};
use crate::MAX_DIMENSION;
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, Solution};
use crate::method::monte_carlo::turns_tests::{off, problem};
use crate::method::{Problem, StepChoice};
use crate::numerics::{distance, jackknife};
use crate::space::Axis;
use crate::stationary::{Options, Outcome, Solver, SteadyState};
use crate::system::TypedModel;

/// Dry friction in noise of amplitude one, whose density is A exp(-2 A |v|) with A = 0.5.
fn dry_friction(cells: usize) -> Problem {
    let model = TypedModel::new("dry", "Dry friction", ["v"])
        .with_equation("v", "-A sgn(v)")
        .with_noise("v", ["1"])
        .with_parameters(["A"]);
    let axes = vec![Axis::uniform(-12.0, 12.0, cells).unwrap()];
    problem((&model.build().unwrap(), &[]), 0.5, axes, &[])
}

/// A damped oscillator with the deviation one of displacement and velocity.
fn oscillator(cells: usize) -> Problem {
    let model = TypedModel::new("linear", "Linear oscillator", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-x - A y")
        .with_noise("y", ["sqrt(2 A)"])
        .with_parameters(["A"]);
    let axis = Axis::uniform(-5.0, 5.0, cells).unwrap();
    problem(
        (&model.build().unwrap(), &[]),
        0.3,
        vec![axis.clone(), axis],
        &[],
    )
}

fn source(problem: &Problem, options: &SgcmOptions) -> SgcmSource {
    SgcmSource::new(problem, options, &Cancellation::new()).unwrap()
}

fn solved(source: &SgcmSource) -> Solution<'static> {
    let never = Cancellation::new();
    let value = source.problem.family().ends().0;
    source.open(&never).solve(value).unwrap().detached()
}

/// The steady state of a sampled cell map, all of it or without a group, and its slopes.
fn solve(
    source: &SgcmSource,
    point: &SampledPoint,
    correction: Correction,
    (left_out, guess): (Option<usize>, Option<&[f64]>),
) -> (SteadyState, Vec<[f64; MAX_DIMENSION]>) {
    let options = Options::new(Solver::MultilevelAggregation, 1e-10);
    let space = source.problem.space();
    let (transitions, limits) = (point.transitions(), (&options, 1e-7));
    let found = solve_by(correction, transitions, space, guess, left_out, limits).unwrap();
    match found.outcome {
        Outcome::Steady(steady) => (steady, found.slopes),
        other => panic!("{other:?}"),
    }
}

/// Eight changes of a steady state as they are made and as solves give them, both ways of the correction.
#[test]
fn changes_to_first_order_are_those_of_cell_maps_without_a_group() {
    let never = Cancellation::new();
    for (problem, samples, map_step) in [
        (dry_friction(120), 400, StepChoice::Auto),
        (oscillator(40), 200, StepChoice::Auto),
        // Short steps, after which slopes rule what is sent.
        (oscillator(40), 1000, StepChoice::Fixed(0.5)),
    ] {
        let options = SgcmOptions {
            samples,
            map_step,
            ..SgcmOptions::default()
        };
        let source = source(&problem, &options);
        let value = problem.family().ends().0;
        let point = source.sample_at(value, None, &never).unwrap();
        for correction in [Correction::Slope, Correction::None] {
            let space = problem.space();
            let (full, slopes) = solve(&source, &point, correction, (None, None));
            let made = source
                .replicates(&point, correction, &slopes, &full, &never)
                .unwrap();
            // What a replicate costs: no solve of its own, and 20 to 27 applications for four at a time.
            assert_eq!((made.masses.len(), made.solves), (8, 0));
            assert!(made.applications <= 60, "{}", made.applications);
            let what = format!("{:?} {map_step:?} {samples}", correction);
            let mut others = Vec::new();
            for (group, made) in made.masses.iter().enumerate() {
                let guess = Some(full.mass.as_slice());
                let (exact, _) = solve(&source, &point, correction, (Some(group), guess));
                let whole: f64 = made.iter().sum();
                assert!((whole - 1.0).abs() < 1e-12, "{whole}");
                let (error, size) = (
                    distance(made, &exact.mass),
                    distance(&full.mass, &exact.mass),
                );
                assert!(error < 0.1 * size, "{what}: {error} of {size}");
                others.push(exact.mass);
            }
            // What they are for: the error of the mean square of each axis.
            for axis in 0..space.dimension() {
                let square = |mass: &Vec<f64>| -> f64 {
                    let cells = mass.iter().enumerate();
                    cells
                        .map(|(cell, m)| m * space.centre(cell)[axis].powi(2))
                        .sum()
                };
                let error = |all: &Vec<Vec<f64>>| jackknife(all.iter().map(square));
                let ratio = error(&made.masses) / error(&others);
                assert!((ratio - 1.0).abs() < 0.05, "{what}: {ratio}");
            }
        }
    }
}

/// Few trajectories pass from one well to the other: without some groups much of the mass is elsewhere, and their
/// cell maps are solved. Changes that are small are right here too.
#[test]
fn large_changes_are_solved() {
    let never = Cancellation::new();
    let mut solves = 0;
    for noise in ["0.45", "0.38", "0.33"] {
        let model = TypedModel::new("wells", "Two wells", ["x"])
            .with_equation("x", "A x - x^3")
            .with_noise("x", [noise])
            .with_parameters(["A"]);
        let axes = vec![Axis::uniform(-2.0, 2.0, 60).unwrap()];
        let problem = problem((&model.build().unwrap(), &[]), 1.0, axes, &[]);
        let options = SgcmOptions {
            samples: 24,
            map_step: StepChoice::Fixed(1.0),
            ..SgcmOptions::default()
        };
        let source = source(&problem, &options);
        let point = source.sample_at(1.0, None, &never).unwrap();
        let whole = (None, None);
        let (full, slopes) = solve(&source, &point, Correction::Slope, whole);
        let made = source.replicates(&point, Correction::Slope, &slopes, &full, &never);
        let made = made.unwrap();
        solves += made.solves;
        for (group, made) in made.masses.iter().enumerate() {
            let without = (Some(group), Some(full.mass.as_slice()));
            let (exact, _) = solve(&source, &point, Correction::Slope, without);
            let error = distance(made, &exact.mass);
            let size = distance(&full.mass, &exact.mass);
            assert!(error < 0.25 * size, "{noise} {group}: {error} of {size}");
        }
    }
    assert!(solves > 3, "{solves}");
}

/// Differences from exact answers in stated errors, of means and deviations, and of the masses of bins, over seeds.
fn off_over_seeds(
    problem: &Problem,
    options: &SgcmOptions,
    deviation: f64,
    exact: &dyn Fn(&[f64]) -> f64,
) -> [Vec<f64>; 3] {
    let mut all = [const { Vec::new() }; 3];
    let mut source = source(problem, options);
    for seed in 1..=16 {
        source.options.seed = seed;
        let solution = solved(&source);
        for (_, name) in problem.family().states_on_lines() {
            for (of, kind, truth) in [(0, "mean", 0.0), (1, "sd", deviation)] {
                let name = format!("{kind}_{name}");
                let report = &solution.report;
                let (value, error) = report.measure(&name).zip(report.error_of(&name)).unwrap();
                all[of].push((value - truth) / error);
            }
        }
        all[2].extend(solution.densities.iter().flat_map(|one| off(one, exact)));
    }
    all
}

fn root_mean_square(all: &[f64]) -> f64 {
    (all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64).sqrt()
}

/// Over sixteen seeds the differences from exact answers scatter as the stated errors say.
#[test]
fn stated_errors_are_those_of_the_differences_from_exact_answers() {
    let friction = SgcmOptions {
        samples: 200,
        // The jump of the force makes that of an automatic step a bias of the densities, which errors do not hold.
        time_step: StepChoice::Fixed(0.02),
        ..SgcmOptions::default()
    };
    let friction = off_over_seeds(&dry_friction(160), &friction, 2.0_f64.sqrt(), &|edges| {
        let below = |v: f64| {
            if v < 0.0 {
                0.5 * v.exp()
            } else {
                1.0 - 0.5 * (-v).exp()
            }
        };
        below(edges[1]) - below(edges[0])
    });
    let linear = SgcmOptions {
        samples: 100,
        ..SgcmOptions::default()
    };
    let linear = off_over_seeds(&oscillator(50), &linear, 1.0, &|edges| {
        crate::method::generator::turns_tests::normal(0.0, 1.0, edges)
    });
    for (what, all) in [("friction", friction), ("linear", linear)] {
        let [means, deviations, masses] = all.map(|all| root_mean_square(&all));
        assert!(masses > 0.8 && masses < 1.15, "{what}: {masses}");
        for moments in [means, deviations] {
            assert!(moments > 0.5 && moments < 1.3, "{what}: {moments}");
        }
    }
}
