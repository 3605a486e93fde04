use super::*;
use crate::exponent::largest;
use crate::space::Axis;
use crate::system::{ExponentMethod, Family, Linearised, Path, TypedModel};

use super::super::relaxation;

/// Exponent and divergence of equations with one noise on the last axis, on cells of this half width.
fn rates(equations: &[(&str, &str)], amplitudes: &[&str], half: f64, steps: f64) -> [MeanRate; 2] {
    let axes: Vec<&str> = equations.iter().map(|(axis, _)| *axis).collect();
    let mut model = TypedModel::new("own", "own", axes.iter().copied());
    for (axis, text) in equations {
        model = model.with_equation(*axis, *text);
    }
    let model = model
        .with_noise(axes[axes.len() - 1], amplitudes.iter().copied())
        .with_parameters([crate::system::ParameterDescription::from("nothing")])
        .build()
        .unwrap();
    let family = Family::new(model, &[], Path::parameter("nothing", 0.0, 0.0)).unwrap();
    let axis = Axis::uniform(-half, half, 20).unwrap();
    let space = CellSpace::new(vec![axis; axes.len()]).unwrap();
    let (system, never) = (family.at(0.0).unwrap(), Cancellation::new());
    let units = vec![1.0; axes.len()];
    let by = ExponentMethod::Trajectories;
    let tangent = family.tangent(0.0, &system, (&units, by)).unwrap();
    let relaxed = relaxation(system.as_ref(), &space, 7, &never).unwrap();
    let run = TangentRun::of_steps(steps, &relaxed, 7);
    let both = (system.as_ref(), &tangent);
    let starts = relaxed.settled_states();
    let found = exponent_along_trajectories(both, &space, starts, &run, &never);
    found.unwrap().unwrap()
}

/// Whether a rate holds a known one within its error, which is below `most`.
fn assert_holds(found: MeanRate, known: f64, most: f64) {
    let off = (found.value - known).abs();
    assert!(
        off <= found.error() && found.error() <= most,
        "{found:?} (± {:.2e}) for {known}",
        found.error()
    );
}

#[test]
fn linear_systems_have_their_exponents_whatever_the_paths() {
    // A focus: -ζ on average over a turn; the sum of both exponents is the trace at every state.
    let [exponent, divergence] = rates(&[("x", "y"), ("y", "-x - 0.4 y")], &["0.5"], 4.0, 1e6);
    assert_holds(exponent, -0.2, 0.01);
    assert!((divergence.value + 0.4).abs() < 1e-12);
    // Three axes, of which two turn: the largest real part is that of the third.
    let three = [("x", "y"), ("y", "-x - 0.8 y"), ("z", "x - 0.1 z")];
    let [exponent, divergence] = rates(&three, &["0.5"], 12.0, 1e6);
    assert_holds(exponent, -0.1, 0.01);
    assert!((divergence.value + 0.9).abs() < 1e-12);
}

#[test]
fn noise_in_the_stiffness_has_the_exponent_of_the_linear_equation_whatever_the_density() {
    // One noise moves state and deviation; the additive one beside it keeps states away from rest.
    let found = rates(
        &[("x", "y"), ("y", "-x - 0.4 y")],
        &["0.5 x", "0.4"],
        6.0,
        4e6,
    );
    let exact = largest(&Linearised {
        drift: vec![vec![0.0, 1.0], vec![-1.0, -0.4]],
        noises: vec![vec![vec![0.0, 0.0], vec![0.5, 0.0]]],
    });
    // The same number is that of the closed form with Airy functions (`exponent::tests`).
    assert_holds(found[0], exact.unwrap().value, 0.01);
}

#[test]
fn the_oscillator_of_duffing_and_van_der_pol_has_the_exponent_of_another_program() {
    let equations = [("x", "y"), ("y", "-x - 0.2 y - x^3 - x^2 y")];
    let [exponent, _] = rates(&equations, &["0.4"], 3.0, 8e6);
    assert_holds(exponent, -0.16283, 0.01);
}

/// The normal form of Hopf's bifurcation with noise on both axes: neighbouring paths come together with little shear
/// and run apart with much of it (P. H. Baxendale, Probability Theory and Related Fields 99, 1994).
#[test]
fn shear_makes_neighbouring_paths_run_apart() {
    let exponent = |shear: f64, steps: f64| {
        let x = format!("x - y - (x^2 + y^2) (x - {shear} y)");
        let y = format!("x + y - (x^2 + y^2) (y + {shear} x)");
        let model = TypedModel::new("hopf", "hopf", ["x", "y"])
            .with_equation("x", x)
            .with_equation("y", y)
            .with_noise("x", ["1"])
            .with_noise("y", ["1"])
            .with_parameters([crate::system::ParameterDescription::from("nothing")])
            .build()
            .unwrap();
        let family = Family::new(model, &[], Path::parameter("nothing", 0.0, 0.0)).unwrap();
        let axis = Axis::uniform(-3.0, 3.0, 20).unwrap();
        let space = CellSpace::new(vec![axis; 2]).unwrap();
        let (system, never) = (family.at(0.0).unwrap(), Cancellation::new());
        let by = ExponentMethod::Trajectories;
        let tangent = family.tangent(0.0, &system, (&[1.0, 1.0], by)).unwrap();
        let relaxed = relaxation(system.as_ref(), &space, 7, &never).unwrap();
        let run = TangentRun::of_steps(steps, &relaxed, 7);
        let both = (system.as_ref(), &tangent);
        let starts = relaxed.settled_states();
        let found = exponent_along_trajectories(both, &space, starts, &run, &never);
        found.unwrap().unwrap()[0]
    };
    let [weak, strong] = [exponent(1.0, 2e6), exponent(8.0, 2e6)];
    assert!(weak.value + weak.error() < 0.0, "{weak:?}");
    assert!(strong.value - strong.error() > 0.0, "{strong:?}");
}
