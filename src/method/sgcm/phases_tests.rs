//! Forced systems by cell maps against exact answers: a moving normal density with its means, deviations and amplitude.

use super::{Correction, SgcmOptions, SgcmSource};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, Solution};
use crate::method::Problem;
use crate::method::StepChoice;
use crate::method::generator::turns_tests::{forced, normal};
use crate::method::monte_carlo::turns_tests::{off, problem};
use crate::space::Axis;

fn solved(problem: &Problem, options: &SgcmOptions) -> Solution<'static> {
    let never = Cancellation::new();
    let source = SgcmSource::new(problem, options, &never).unwrap();
    let value = problem.family().ends().0;
    source.open(&never).solve(value).unwrap().detached()
}

#[test]
fn trial() {
    let (w, d, a) = (1.3, 0.1, 0.5_f64);
    let model = forced("-x");
    let phases = [(0, 0.0), (0, 0.25), (0, 0.75)];
    let axes = vec![
        Axis::uniform(-2.0, 2.0, 40).unwrap(),
        Axis::fourier(0.0, 1.0, 6).unwrap(),
    ];
    let problem = problem((&model, &[("w", w), ("D", d)]), a, axes, &phases);
    for correction in [Correction::Slope, Correction::None] {
        for map_step in [
            StepChoice::Auto,
            StepChoice::Fixed(0.1),
            StepChoice::Fixed(0.9),
            StepChoice::Fixed(3.0),
        ] {
            for solver in [
                crate::stationary::Solver::MultilevelAggregation,
                crate::stationary::Solver::PowerIteration,
            ] {
                let clock = std::time::Instant::now();
                let solution = solved(
                    &problem,
                    &SgcmOptions {
                        correction,
                        map_step,
                        solver,
                        ..SgcmOptions::default()
                    },
                );
                println!(
                    "{:?} {map_step:?} {solver:?} {:?} {:?}",
                    correction,
                    solution.report,
                    clock.elapsed()
                );
                let mean = |phase: f64| {
                    let angle = std::f64::consts::TAU * phase;
                    a * (angle.cos() + w * angle.sin()) / (1.0 + w * w)
                };
                for (density, (_, phase)) in solution.densities[1..].iter().zip(phases) {
                    let whole: f64 = density.density.masses().iter().sum();
                    let off = off(density, |edges| normal(mean(phase), d.sqrt(), edges));
                    let rms = (off.iter().map(|z| z * z).sum::<f64>() / off.len() as f64).sqrt();
                    println!("   {whole} {phase} {} rms {rms}", mean(phase));
                }
            }
        }
    }
}
