//! Chains like sampled ones: weak damping, hence slow mixing, on two-dimensional grids.

use super::super::second_eigenvalue;
use super::*;
use crate::cancellation::Cancellation;
use crate::stationary::transition_matrix::sampled_chain::{Settings, sampled_chain};

fn chain(count: usize, samples: usize, leaks: bool) -> (TransitionMatrix, CellSpace) {
    let (matrix, escape) = sampled_chain(&Settings {
        count,
        samples,
        damping: 0.998,
        spread: 0.25,
        leaks,
        seed: 1,
    });
    (over_all_cells(matrix, escape), grid(&[count, count]))
}

const MULTILEVEL: Solver = Solver::MultilevelAggregation;

#[test]
fn the_solvers_agree_where_mixing_is_slow() {
    for leaks in [false, true] {
        let (matrix, space) = chain(50, 100, leaks);
        let multilevel = steady(&matrix, &space, None, MULTILEVEL, 1e-12);
        let power = steady(&matrix, &space, None, Solver::PowerIteration, 1e-11);
        let apart = distance(&multilevel.mass, &power.mass);
        assert!(
            apart < 2e-11,
            "{apart} {:?} {:?}",
            multilevel.info,
            power.info
        );
        assert!(multilevel.info.residual < 1e-13);
        assert_eq!(leaks, multilevel.info.escape_per_step > 0.0);
        assert!(20 * multilevel.info.matrix_passes < power.info.matrix_passes);
    }
}

#[test]
fn the_error_is_below_the_tolerance() {
    let (matrix, space) = chain(50, 100, false);
    let exact = steady(&matrix, &space, None, MULTILEVEL, 1e-13).mass;
    for (solver, tolerance) in [
        (MULTILEVEL, 1e-4),
        (MULTILEVEL, 1e-8),
        (Solver::PowerIteration, 1e-4),
        (Solver::PowerIteration, 1e-8),
    ] {
        let found = steady(&matrix, &space, None, solver, tolerance);
        let error = distance(&found.mass, &exact);
        assert!(error < tolerance, "{solver:?}: {error} {:?}", found.info);
    }
}

#[test]
fn a_slow_mode_behind_a_fast_one_does_not_deceive_power_iteration() {
    // A slow mode of amplitude 1e-6 under fast ones of 1e-2: the first thousands of steps look fast.
    let (matrix, space) = chain(50, 100, false);
    let exact = steady(&matrix, &space, None, MULTILEVEL, 1e-13).mass;
    let guess: Vec<f64> = exact
        .iter()
        .enumerate()
        .map(|(cell, mass)| {
            let (x, y) = (
                space.position(cell, 0) as f64,
                space.position(cell, 1) as f64,
            );
            let radius = ((x - 24.5).powi(2) + (y - 24.5).powi(2)) / 625.0;
            mass * (1.0 + 1e-5 * radius) * if cell % 2 == 0 { 1.01 } else { 0.99 }
        })
        .collect();
    let found = steady(&matrix, &space, Some(&guess), Solver::PowerIteration, 1e-7);
    assert!(distance(&found.mass, &exact) < 2e-7, "{:?}", found.info);
}

#[test]
fn a_warm_start_gives_the_same_in_fewer_iterations() {
    let (matrix, space) = chain(60, 100, true);
    // A neighbour: the same chain with fewer samples a cell, so with fewer transitions and other masses.
    let (other, _) = chain(60, 97, true);
    let mut neighbour = steady(&other, &space, None, MULTILEVEL, 1e-12).mass;
    for solver in Solver::ALL {
        let cold = steady(&matrix, &space, None, solver, 1e-9);
        let warm = steady(&matrix, &space, Some(&neighbour), solver, 1e-9);
        assert!(distance(&cold.mass, &warm.mass) < 2e-9);
        assert!(
            work(&warm.info) < work(&cold.info),
            "{:?} {:?}",
            warm.info,
            cold.info
        );
    }
    let again = steady(&matrix, &space, None, MULTILEVEL, 1e-12).mass;
    let settled = steady(&matrix, &space, Some(&again), MULTILEVEL, 1e-9);
    assert_eq!(settled.info.iterations, 2);
    // Exact zeros where there is mass must not stall the corrections.
    let half = neighbour.len() / 2;
    neighbour[half..].fill(0.0);
    let cold = steady(&matrix, &space, None, MULTILEVEL, 1e-9);
    let holed = steady(&matrix, &space, Some(&neighbour), MULTILEVEL, 1e-9);
    assert!(distance(&holed.mass, &cold.mass) < 2e-9);
    assert!(
        2 * holed.info.iterations <= 3 * cold.info.iterations,
        "{:?}",
        holed.info
    );
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let (matrix, space) = chain(150, 30, true);
    let run = |threads| {
        with_threads(threads, || {
            let multilevel = steady(&matrix, &space, None, MULTILEVEL, 1e-10);
            let second =
                second_eigenvalue(&matrix, &space, &multilevel, &Cancellation::new()).unwrap();
            let mut options = Options::new(Solver::PowerIteration, 1e-10);
            options.max_iterations = 200;
            (
                multilevel,
                second,
                solve(&matrix, &space, None, &options).unwrap(),
            )
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn running_out_of_iterations_is_data() {
    let (matrix, space) = chain(50, 100, false);
    for solver in Solver::ALL {
        let mut options = Options::new(solver, 1e-12);
        options.max_iterations = 3;
        let Outcome::Steady(found) = solve(&matrix, &space, None, &options).unwrap() else {
            panic!("one class");
        };
        assert!(!found.info.converged && found.info.iterations == 3);
        assert!(found.info.error_estimate > 1e-12 && found.mass.iter().all(|p| p.is_finite()));
    }
}

#[test]
fn the_second_eigenvalue_is_that_of_a_dense_solver() {
    let (matrix, space) = chain(50, 100, false);
    let found = steady(&matrix, &space, None, MULTILEVEL, 1e-12);
    let second = second_eigenvalue(&matrix, &space, &found, &Cancellation::new()).unwrap();
    assert!(
        second.residual < 0.01 * (1.0 - second.modulus),
        "{second:?}"
    );
    let relaxation = second.relaxation_time.unwrap();
    assert!((relaxation + 1.0 / second.modulus.ln()).abs() < 1e-9);
    // Dense eigenvalues of a small chain are the independent method.
    let (matrix, space) = chain(16, 200, true);
    let found = steady(&matrix, &space, None, MULTILEVEL, 1e-13);
    let dense = nalgebra::DMatrix::from_fn(256, 256, |row, column| {
        matrix.matrix.get(row, column).copied().unwrap_or(0.0)
    });
    let mut moduli: Vec<f64> = dense
        .complex_eigenvalues()
        .iter()
        .map(|z| z.norm())
        .collect();
    moduli.sort_by(|a, b| b.total_cmp(a));
    let second = second_eigenvalue(&matrix, &space, &found, &Cancellation::new()).unwrap();
    assert!(
        (second.modulus - moduli[1]).abs() < 1e-6,
        "{second:?} {:?}",
        &moduli[..4]
    );
    assert!((1.0 - found.info.escape_per_step - moduli[0]).abs() < 1e-10);
}
