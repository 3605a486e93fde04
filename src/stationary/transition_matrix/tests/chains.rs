//! Chains with one class and known steady states.

use proptest::prelude::*;

use super::super::{StationaryError, second_eigenvalue};
use super::*;
use crate::cancellation::Cancellation;
use crate::stationary::transition_matrix::sampled_chain::Random;

/// A birth-death chain: up with `up(i)`, down with `down(i)`; detailed balance gives the steady state.
fn birth_death(
    n: usize,
    up: impl Fn(usize) -> f64,
    down: impl Fn(usize) -> f64,
) -> (TransitionMatrix, Vec<f64>) {
    let mut entries = Vec::new();
    let mut mass = vec![1.0];
    for site in 0..n {
        let rise = if site + 1 < n { up(site) } else { 0.0 };
        let fall = if site > 0 { down(site) } else { 0.0 };
        if site + 1 < n {
            entries.push((site + 1, site, rise));
            mass.push(mass[site] * rise / down(site + 1));
        }
        if site > 0 {
            entries.push((site - 1, site, fall));
        }
        entries.push((site, site, 1.0 - rise - fall));
    }
    (transitions(n, &entries), scaled(mass))
}

/// A product of walks, one an axis: one axis moves a step. The product of the walks' steady states is steady.
fn product_walk(shape: &[usize]) -> (TransitionMatrix, CellSpace, Vec<f64>) {
    let space = grid(shape);
    let (rise, fall): (f64, f64) = (0.3, 0.4);
    let share = 1.0 / shape.len() as f64;
    let (mut entries, mut mass) = (Vec::new(), Vec::new());
    for cell in 0..space.n_cells() {
        let mut positions: Vec<usize> = (0..shape.len()).map(|a| space.position(cell, a)).collect();
        mass.push(
            positions
                .iter()
                .map(|&at| (rise / fall).powi(at as i32))
                .product(),
        );
        let mut stay = 1.0;
        for axis in 0..shape.len() {
            let at = positions[axis];
            for (to, rate) in [(at + 1, rise), (at.wrapping_sub(1), fall)] {
                if to < shape[axis] {
                    positions[axis] = to;
                    entries.push((space.number(&positions), cell, share * rate));
                    stay -= share * rate;
                }
            }
            positions[axis] = at;
        }
        entries.push((cell, cell, stay));
    }
    (transitions(space.n_cells(), &entries), space, scaled(mass))
}

/// Random walk on n sites that is absorbed at both ends: λ_k = cos(kπ/(n+1)), p ∝ sin(π i/(n+1)). It stays
/// with `laziness`, so that -λ₁ is no eigenvalue too.
fn absorbed_walk(n: usize, laziness: f64) -> (TransitionMatrix, Vec<f64>) {
    let mut entries = Vec::new();
    for site in 0..n {
        entries.push((site, site, laziness));
        for to in [site.wrapping_sub(1), site + 1] {
            if to < n {
                entries.push((to, site, 0.5 * (1.0 - laziness)));
            }
        }
    }
    let sine = |site| (std::f64::consts::PI * (site + 1) as f64 / (n + 1) as f64).sin();
    (transitions(n, &entries), scaled((0..n).map(sine).collect()))
}

/// A walk between two states that goes round m phases, half an escape at one of them.
#[test]
fn what_goes_round_has_a_steady_state_and_relaxes_as_over_a_period() {
    let (count, passed) = (6, 5);
    let space = grid(&[2, count]);
    for escape in [0.0, 0.01] {
        let mut entries = Vec::new();
        for phase in 0..count {
            let next = (phase + passed) % count;
            let kept = if phase == 2 { 1.0 - escape } else { 1.0 };
            // p(0 → 1) is larger by one at every phase, p(1 → 0) the same at all.
            let up = 0.05 * (phase + 1) as f64;
            for (to, from, share) in [(0, 0, 1.0 - up), (1, 0, up), (0, 1, 0.2), (1, 1, 0.8)] {
                entries.push((to * count + next, from * count + phase, share * kept));
            }
        }
        let matrix = TransitionMatrix {
            phase: Some(1),
            ..transitions(2 * count, &entries)
        };
        // What the map of one period makes of (q, 1 - q) at phase 0, and its second eigenvalue.
        let (mut rest, mut slope) = (0.0, 1.0);
        for step in 0..count {
            let up = 0.05 * (step * passed % count + 1) as f64;
            (rest, slope) = (rest * (0.8 - up) + 0.2, slope * (0.8 - up));
        }
        let exact = rest / (1.0 - slope);
        for solver in Solver::ALL {
            let found = steady(&matrix, &space, None, solver, 1e-11);
            let [low, high] = [0, 1].map(|state| found.mass[state * count]);
            assert!((low / (low + high) - exact).abs() < 1e-9, "{solver:?}");
            if escape == 0.0 {
                assert!((low + high - 1.0 / count as f64).abs() < 1e-9, "{solver:?}");
            }
            let kept = 1.0 - found.info.escape_per_step;
            assert!((kept.powi(6) - (1.0 - escape)).abs() < 1e-9);
            let second = second_eigenvalue(&matrix, &space, &found, &Cancellation::new()).unwrap();
            let modulus = (slope.abs() * (1.0 - escape)).powf(1.0 / count as f64);
            assert!(
                (second.modulus - modulus).abs() < 1e-6,
                "{second:?} {modulus}"
            );
            assert!(second.relaxation_time.is_some());
        }
    }
}

#[test]
fn two_states_balance() {
    let matrix = transitions(2, &[(0, 0, 0.7), (1, 0, 0.3), (0, 1, 0.1), (1, 1, 0.9)]);
    for solver in Solver::ALL {
        let found = steady(&matrix, &grid(&[2]), None, solver, 1e-13);
        assert!(distance(&found.mass, &[0.25, 0.75]) < 1e-13);
        let second = second_eigenvalue(&matrix, &grid(&[2]), &found, &Cancellation::new()).unwrap();
        assert!((second.modulus - 0.6).abs() < 1e-10, "{second:?}");
    }
}

#[test]
fn birth_death_chains_reach_detailed_balance() {
    let slope = |site: usize| 0.25 + 0.1 * (site as f64 / 40.0).sin();
    for (solver, n, tolerance) in [
        (Solver::MultilevelAggregation, 300, 1e-12),
        (Solver::PowerIteration, 60, 1e-9),
    ] {
        let (matrix, exact) = birth_death(n, slope, |_| 0.26);
        let found = steady(&matrix, &grid(&[n]), None, solver, tolerance);
        let error = distance(&found.mass, &exact);
        assert!(error < 3.0 * tolerance, "{solver:?}: {error}");
        assert_eq!(found.info.escape_per_step, 0.0);
        assert_eq!(found.info.class_cells, n);
    }
}

#[test]
fn the_estimate_of_power_iteration_is_the_error_where_a_residual_would_deceive() {
    let (matrix, exact) = birth_death(60, |_| 0.25, |_| 0.26);
    let found = steady(&matrix, &grid(&[60]), None, Solver::PowerIteration, 1e-6);
    let error = distance(&found.mass, &exact);
    assert!(
        (0.9..1.1).contains(&(error / found.info.error_estimate)),
        "{error}"
    );
    assert!(found.info.residual < 0.01 * error, "{:?}", found.info);
}

#[test]
fn walks_in_one_to_four_dimensions_factorise() {
    for shape in [&[500][..], &[40, 30], &[12, 9, 10], &[6, 5, 4, 5]] {
        let (matrix, space, exact) = product_walk(shape);
        let multilevel = Solver::MultilevelAggregation;
        let found = steady(&matrix, &space, None, multilevel, 1e-11);
        let error = distance(&found.mass, &exact);
        assert!(error < 1e-11, "{shape:?}: {error} {:?}", found.info);
        assert!(found.info.iterations <= 25, "{shape:?}: {:?}", found.info);
    }
}

#[test]
fn leaking_walks_are_quasi_stationary() {
    for (n, solver, tolerance) in [
        (30, Solver::MultilevelAggregation, 1e-12),
        (400, Solver::MultilevelAggregation, 1e-11),
        (60, Solver::PowerIteration, 1e-9),
    ] {
        let (matrix, exact) = absorbed_walk(n, 0.2);
        let angle = std::f64::consts::PI / (n + 1) as f64;
        let found = steady(&matrix, &grid(&[n]), None, solver, tolerance);
        let error = distance(&found.mass, &exact);
        assert!(
            error < 3.0 * tolerance,
            "{n} {solver:?}: {error} {:?}",
            found.info
        );
        let escape = 0.8 * (1.0 - angle.cos());
        assert!((found.info.escape_per_step / escape - 1.0).abs() < 1e3 * tolerance);
        let second = second_eigenvalue(&matrix, &grid(&[n]), &found, &Cancellation::new()).unwrap();
        let exact = 0.2 + 0.8 * (2.0 * angle).cos();
        assert!(
            (second.modulus - exact).abs() < 1e-6,
            "{n} {second:?} {exact}"
        );
    }
}

#[test]
fn strong_leaks_are_quasi_stationary_too() {
    // Three sites: λ = cos(π/4) = 0.71, 29 % escape a step; twelve lose 3 %.
    for n in [3, 12, 90] {
        let (matrix, exact) = absorbed_walk(n, 0.0);
        let found = steady(
            &matrix,
            &grid(&[n]),
            None,
            Solver::MultilevelAggregation,
            1e-12,
        );
        assert!(distance(&found.mass, &exact) < 1e-11, "{n}");
    }
}

#[test]
fn random_dense_chains_agree_with_a_dense_solver() {
    let n = 150;
    let mut random = Random(7);
    let mut dense = nalgebra::DMatrix::from_fn(n, n, |_, _| random.uniform().powi(8));
    let mut entries = Vec::new();
    for source in 0..n {
        let total = dense.column(source).sum();
        for target in 0..n {
            dense[(target, source)] /= total;
            entries.push((target, source, dense[(target, source)]));
        }
        dense[(source, source)] -= 1.0;
    }
    dense.row_mut(0).fill(1.0);
    let mut right = nalgebra::DVector::zeros(n);
    right[0] = 1.0;
    let exact = dense.lu().solve(&right).unwrap();
    for solver in Solver::ALL {
        let found = steady(&transitions(n, &entries), &grid(&[n]), None, solver, 1e-12);
        let error = distance(&found.mass, exact.as_slice());
        assert!(error < 2e-12, "{solver:?} {error}");
    }
}

#[test]
fn periodic_chains_are_solved_or_reported() {
    // A ring with one slower site, of period two since n is even and all moves are odd.
    let n = 200;
    let mut entries = Vec::new();
    for site in 0..n {
        let forward = if site == 17 { 0.6 } else { 0.9 };
        entries.push(((site + 1) % n, site, forward));
        entries.push(((site + n - 1) % n, site, 1.0 - forward));
    }
    let matrix = transitions(n, &entries);
    let space = grid(&[n]);
    let found = steady(&matrix, &space, None, Solver::MultilevelAggregation, 1e-12);
    assert!(found.info.residual < 1e-13);
    let mut guess = vec![1.0; n];
    guess[0] = 20.0;
    let mut options = Options::new(Solver::PowerIteration, 1e-9);
    options.max_iterations = 50_000;
    let Outcome::Steady(power) = solve(&matrix, &space, Some(&guess), &options).unwrap() else {
        panic!("one class");
    };
    assert!(!power.info.converged, "{:?}", power.info);
    assert!(distance(&power.mass, &found.mass) > 1e-3);
    assert!(power.info.iterations < 50_000, "oscillation is given up");
    let second = second_eigenvalue(&matrix, &space, &found, &Cancellation::new()).unwrap();
    assert!((second.modulus - 1.0).abs() < 1e-9, "{second:?}");
}

#[test]
fn malformed_input_is_refused() {
    let space = grid(&[2]);
    let good = transitions(2, &[(0, 0, 0.5), (1, 0, 0.5), (0, 1, 1.0)]);
    let options = Options::new(Solver::PowerIteration, 1e-9);
    let refusal = |matrix: &TransitionMatrix| solve(matrix, &space, None, &options).unwrap_err();
    let mut leaky = good.clone();
    leaky.escape[1] = 0.1;
    assert!(matches!(refusal(&leaky), StationaryError::Column { cell: 1, sum } if sum == 1.1));
    let negative = over_all_cells(
        good.matrix.map(|p| if *p < 1.0 { -p } else { *p }),
        vec![0.0; 2],
    );
    assert!(matches!(
        refusal(&negative),
        StationaryError::Column { cell: 0, .. }
    ));
    let mut unordered = good.clone();
    unordered.cells = vec![1, 0];
    assert!(matches!(refusal(&unordered), StationaryError::Cell { .. }));
    let mut short = good.clone();
    short.escape.pop();
    assert!(matches!(refusal(&short), StationaryError::Shape { .. }));
    let columns = over_all_cells(good.matrix.to_csc(), vec![0.0; 2]);
    assert_eq!(refusal(&columns), StationaryError::Storage);
    let guess = solve(&good, &space, Some(&[f64::NAN, 1.0]), &options);
    assert!(matches!(guess, Err(StationaryError::Guess { cells: 2 })));
    let loose = Options::new(Solver::PowerIteration, 1.0);
    let tolerance = solve(&good, &space, None, &loose);
    assert!(matches!(tolerance, Err(StationaryError::Tolerance { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn the_solvers_agree_on_random_sparse_chains(
        seed in 0u64..10_000, rows in 2usize..25, columns in 2usize..25, leak in prop::bool::ANY,
    ) {
        // A ring through all cells makes one class; the rest is random.
        let n = rows * columns;
        let mut random = Random(seed);
        let mut entries = Vec::new();
        for source in 0..n {
            let kept = if leak { 1.0 - 0.02 * random.uniform() } else { 1.0 };
            entries.push(((source + 1) % n, source, 0.25 * kept));
            for _ in 0..3 {
                let target = (random.uniform() * n as f64) as usize;
                entries.push((target, source, 0.25 * kept));
            }
        }
        let (matrix, space) = (transitions(n, &entries), grid(&[rows, columns]));
        let multilevel = steady(&matrix, &space, None, Solver::MultilevelAggregation, 1e-11);
        let power = steady(&matrix, &space, None, Solver::PowerIteration, 1e-11);
        prop_assert!(distance(&multilevel.mass, &power.mass) < 4e-11);
        prop_assert!(multilevel.info.residual < 1e-11);
        let escapes = [&multilevel, &power].map(|state| state.info.escape_per_step);
        prop_assert!((escapes[0] - escapes[1]).abs() < 1e-12);
    }
}

#[test]
fn no_solve_goes_on_once_cancelled() {
    let (matrix, space, _) = product_walk(&[12, 12]);
    let cancellation = Cancellation::new();
    let options = |solver| Options::new(solver, 1e-10).cancelled_by(&cancellation);
    let found = solve(&matrix, &space, None, &options(Solver::ALL[0])).unwrap();
    let Outcome::Steady(found) = found else {
        panic!("one steady state");
    };
    cancellation.cancel();
    let stopped = StationaryError::Cancelled(crate::cancellation::Cancelled);
    for solver in Solver::ALL {
        let again = solve(&matrix, &space, None, &options(solver));
        assert_eq!(again.unwrap_err(), stopped);
    }
    let second = second_eigenvalue(&matrix, &space, &found, &cancellation);
    assert_eq!(second.unwrap_err(), stopped);
}
