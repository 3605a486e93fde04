//! Systems with an angle by cell maps against exact answers: tilted washboards by quadrature, a driven rotor.

use std::f64::consts::{PI, TAU};

use super::{SgcmOptions, SgcmSource};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, Solution};
use crate::method::generator::angles_tests::{exact, washboard};
use crate::method::monte_carlo::turns_tests::{assert_known, assert_standard, off, problem};
use crate::method::{Problem, StepChoice};
use crate::space::Axis;
use crate::system::TypedModel;

fn solved(problem: &Problem, options: &SgcmOptions) -> Solution<'static> {
    let never = Cancellation::new();
    let source = SgcmSource::new(problem, options, &never).unwrap();
    let value = problem.family().ends().0;
    source.open(&never).solve(value).unwrap().detached()
}

fn tilted(shift: f64, a: f64, d: f64) -> Problem {
    let axes = vec![Axis::fourier(-PI, PI, 8).unwrap()];
    problem((&washboard(shift, d), &[]), a, axes, &[])
}

/// The exact mass between two places of a turn, by the trapezoid rule on the places of the quadrature.
fn mass(density: &[f64], shift: f64, edges: &[f64]) -> f64 {
    let count = density.len();
    let parts = 40;
    let at = |part: usize| {
        let x = edges[0] + (edges[1] - edges[0]) * (part as f64 + 0.5) / parts as f64 - shift;
        let place = x.rem_euclid(TAU) / TAU * count as f64;
        let below = place as usize % count;
        let share = place - place.floor();
        density[below] * (1.0 - share) + density[(below + 1) % count] * share
    };
    let mean = (0..parts).map(at).sum::<f64>() / parts as f64;
    let whole = density.iter().sum::<f64>() * TAU / count as f64;
    mean * (edges[1] - edges[0]) / whole
}

/// Densities bin by bin, and mean velocities, held by the stated errors, wherever the seam is.
#[test]
fn tilted_washboards_have_their_densities_and_turn_as_quadrature_says() {
    for (shift, a, d) in [(0.0, 1.1, 0.3), (2.5, 0.4, 0.5), (-1.0, 2.0, 0.2)] {
        let options = SgcmOptions {
            samples: 4000,
            map_step: StepChoice::Fixed(0.4),
            ..SgcmOptions::default()
        };
        let solution = solved(&tilted(shift, a, d), &options);
        let (velocity, _, density) = exact(a, d);
        let what = format!("{shift} {a} {d}");
        assert!(solution.report.status.is_resolved(), "{what}");
        assert_known(&solution, "velocity_theta", velocity, 0.01);
        // Cells forget how often a trajectory went round.
        assert!(solution.report.measure("diffusion_theta").is_none());
        let off = off(&solution.densities[0], |edges| mass(&density, shift, edges));
        assert_eq!(off.len(), 120, "{what}");
        assert_standard(&off, &what);
        // Cells with slopes add less than a five-hundredth of the noise; flat ones h²/(12 Δt).
        let added = solution
            .report
            .measure("numerical_diffusion_theta")
            .unwrap();
        assert!(added.abs() < 2e-3 * d, "{what}: {added}");
    }
}

#[test]
fn a_driven_rotor_turns_as_known() {
    let model = TypedModel::new("rotor", "Rotor", ["theta", "omega"])
        .with_equation("theta", "omega")
        .with_equation("omega", "-0.5 omega - sin(theta) + A")
        .with_noise("omega", [format!("{}", 0.6_f64.sqrt())])
        .with_angle("theta", TAU)
        .with_parameters(["A"]);
    let axes = vec![
        Axis::fourier(-PI, PI, 8).unwrap(),
        Axis::uniform(-5.0, 8.0, 40).unwrap(),
    ];
    let problem = problem((&model.build().unwrap(), &[]), 1.0, axes, &[]);
    let options = SgcmOptions {
        samples: 200,
        ..SgcmOptions::default()
    };
    let solution = solved(&problem, &options);
    // Of another program: γ = 0.5, T = 0.6, torque 1.
    assert_known(&solution, "velocity_theta", 1.694_755, 0.03);
}
