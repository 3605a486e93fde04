//! dp/dθ by one substitution against central differences of full solves.

use pbif::generator::{GeneratorOptions, assemble, assemble_derivative};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::generator::{RateMethod, RateOptions, RateSolver};
use pbif::system::{Family, Path, registry};

/// Relative L1 difference between the sensitivity and a fourth-order central difference of step `step`.
///
/// Its error is about step⁴ p⁽⁵⁾/30 plus the solver's tolerance over the step.
fn mismatch(
    model: &str,
    given: &[(&str, f64)],
    parameter: &str,
    space: &CellSpace,
    step: f64,
) -> f64 {
    let named = |one: &&(&str, f64)| one.0 == parameter;
    let value = given.iter().find(named).unwrap().1;
    let fixed: Vec<_> = given.iter().filter(|one| !named(one)).copied().collect();
    let path = Path::parameter(parameter, value - 2.0 * step, value + 2.0 * step);
    let family = Family::new(registry::find(model).unwrap(), &fixed, path).unwrap();
    let options = GeneratorOptions::default();
    let mut solver = RateSolver::new(
        space.clone(),
        RateOptions {
            tolerance: 1e-12,
            method: Some(RateMethod::Lu),
            ..RateOptions::default()
        },
    );
    let mut steady = |value: f64| {
        let system = family.at(value).unwrap();
        let generator = assemble(&*system, space, &options).unwrap();
        let state = solver
            .solve(&generator.matrix, &generator.escape, None)
            .unwrap();
        assert!(state.info.converged);
        state.mass
    };
    let mut difference = vec![0.0; space.n_cells()];
    for (steps, weight) in [(2.0, -1.0), (1.0, 8.0), (-1.0, -8.0), (-2.0, 1.0)] {
        let mass = steady(value + steps * step);
        for (slot, mass) in difference.iter_mut().zip(mass) {
            *slot += weight / (12.0 * step) * mass;
        }
    }
    let mass = steady(value);
    let derivative = assemble_derivative(|at| family.at(at), value, space, &options).unwrap();
    let change = solver.sensitivity(&derivative.matrix, &mass).unwrap();
    let gap = change.iter().zip(&difference).map(|(a, b)| (a - b).abs());
    gap.sum::<f64>() / difference.iter().map(|value| value.abs()).sum::<f64>()
}

#[test]
fn coulomb_matches_central_differences() {
    let given = [
        ("kappa", 0.05),
        ("f_c", 0.01),
        ("mu", 0.05),
        ("sigma2", 0.05),
    ];
    let axis = Axis::uniform(-3.0, 3.0, 40).unwrap();
    let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
    for (parameter, step) in [("f_c", 5e-4), ("kappa", 2e-4), ("sigma2", 2e-4)] {
        let error = mismatch("coulomb", &given, parameter, &space, step);
        assert!(error < 1e-5, "{parameter}: {error:e}");
    }
}

#[test]
fn dahl_matches_central_differences() {
    let given = [
        ("alpha", 0.3),
        ("kappa", 0.1),
        ("mu", 1.0),
        ("lambda", 0.2),
        ("f_c", 0.1),
        ("sigma2", 0.2),
    ];
    // z within its walls, which f_c and λ move: Ω is held, open ends in their stead.
    let axes = [(2.4, 16), (2.8, 16), (0.45, 8)];
    let axes = axes.map(|(half, count)| Axis::uniform(-half, half, count).unwrap());
    let space = CellSpace::new(axes.to_vec()).unwrap();
    for (parameter, step) in [("alpha", 2e-3), ("sigma2", 1e-3), ("f_c", 2e-4)] {
        let error = mismatch("dahl", &given, parameter, &space, step);
        assert!(error < 1e-5, "{parameter}: {error:e}");
    }
}
