//! Qᵀ x = b against dense algebra, and against what the steady state answers.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use sprs::{CsMat, TriMat};

use super::{dense, distance, generators, space};
use crate::stationary::generator::{RateMethod, RateOptions, RateSolver, TransposedSolution};

/// Random rates, at most 1, to cells up to two away along one axis, and random escape of the given size; rates differ
/// from those without `drift` by as much.
fn random_generator(shape: &[usize], leak: f64, drift: f64) -> (CsMat<f64>, Vec<f64>) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(11);
    let space = space(shape);
    let n = space.n_cells();
    let mut triplets = TriMat::new((n, n));
    let mut escape = vec![0.0; n];
    for (from, leaves) in escape.iter_mut().enumerate() {
        let mut sent = 0.0;
        for to in 0..n {
            let apart = |axis| {
                space
                    .position(from, axis)
                    .abs_diff(space.position(to, axis))
            };
            let steps: Vec<usize> = (0..shape.len()).map(apart).filter(|&one| one > 0).collect();
            if steps.len() == 1 && steps[0] <= 2 {
                let rate =
                    random.random_range(0.1..1.0) * (1.0 + drift * random.random_range(0.0..1.0));
                triplets.add_triplet(to, from, rate);
                sent += rate;
            }
        }
        *leaves = leak * random.random_range(0.0..1.0);
        triplets.add_triplet(from, from, -sent - *leaves);
    }
    (triplets.to_csc(), escape)
}

/// By dense algebra: bordered by the steady state where nothing escapes.
fn by_dense(matrix: &CsMat<f64>, right: &[f64], mass: &[f64], leaks: bool) -> Vec<f64> {
    let n = mass.len();
    let size = if leaks { n } else { n + 1 };
    let mut bordered = DMatrix::zeros(size, size);
    bordered
        .view_mut((0, 0), (n, n))
        .copy_from(&dense(matrix).transpose());
    let mut given = DVector::zeros(size);
    given.rows_mut(0, n).copy_from_slice(right);
    if !leaks {
        for (cell, &mass) in mass.iter().enumerate() {
            (bordered[(cell, n)], bordered[(n, cell)]) = (1.0, mass);
        }
    }
    bordered.lu().solve(&given).unwrap().as_slice()[..n].to_vec()
}

fn right_side(n: usize) -> Vec<f64> {
    (0..n).map(|cell| (1.7 * cell as f64).sin()).collect()
}

const TOLERANCE: f64 = 1e-10;

fn solver(shape: &[usize], method: RateMethod) -> RateSolver {
    let options = RateOptions {
        method: Some(method),
        ..RateOptions::default()
    };
    RateSolver::new(space(shape), options)
}

#[test]
fn it_is_that_of_dense_algebra_with_own_and_with_a_neighbours_factors() {
    for shape in [&[40][..], &[9, 8], &[5, 4, 6]] {
        for (method, leak) in [
            (RateMethod::Lu, 0.0),
            (RateMethod::Lu, 0.2),
            (RateMethod::LuSingle, 0.0),
            (RateMethod::NarrowLu, 1e-6),
        ] {
            let mut solver = solver(shape, method);
            let mut guess = None;
            for drift in [0.0, 0.02] {
                let (matrix, escape) = random_generator(shape, leak, drift);
                let steady = solver.solve(&matrix, &escape, guess.as_deref()).unwrap();
                // Factors of a stand-in may be made anew.
                let is_warm = guess.is_some() && method != RateMethod::NarrowLu;
                assert!(!is_warm || steady.info.factorisations == 0);
                let right = right_side(steady.mass.len());
                let found = solver
                    .transposed(&right, &steady.mass, None, TOLERANCE)
                    .unwrap();
                let exact = by_dense(&matrix, &right, &steady.mass, leak > 0.0);
                // The error of the masses is that of the mean, which slow escape makes as large as its time.
                let rate = steady.info.escape_rate;
                let mean = if rate > 0.0 { 1.0 / rate } else { 1.0 };
                let size: f64 = exact.iter().map(|value| value.abs()).sum();
                let most = size.max(mean * exact.len() as f64) * 100.0 * TOLERANCE;
                let apart = distance(&found.values, &exact);
                assert!(
                    apart < most,
                    "{shape:?} {method:?} {leak} {drift}: {apart:e} {most:e}"
                );
                assert!(found.residual < 10.0 * TOLERANCE, "{:e}", found.residual);
                // Own factors need a pass, one of GMRES and a look; a neighbour's, and those of a stand-in, some more.
                let is_own = guess.is_none() && method == RateMethod::Lu;
                let most_iterations = if is_own { 4 } else { 150 };
                assert!(found.iterations <= most_iterations, "{}", found.iterations);
                guess = Some(steady.mass);
            }
        }
    }
}

#[test]
fn where_nothing_escapes_a_constant_takes_part_in_neither_side() {
    let shape = [12, 10];
    let (matrix, escape) = random_generator(&shape, 0.0, 0.0);
    let mut solver = solver(&shape, RateMethod::Lu);
    let mass = solver.solve(&matrix, &escape, None).unwrap().mass;
    let solve =
        |solver: &mut RateSolver, right: &[f64], guess: Option<&[f64]>| -> TransposedSolution {
            solver.transposed(right, &mass, guess, TOLERANCE).unwrap()
        };
    let right = right_side(mass.len());
    let raised: Vec<f64> = right.iter().map(|value| value + 3.0).collect();
    let (a, b) = (
        solve(&mut solver, &right, None),
        solve(&mut solver, &raised, None),
    );
    assert!(distance(&a.values, &b.values) < 1e-8);
    let mean: f64 = a.values.iter().zip(&mass).map(|(x, p)| x * p).sum();
    assert!(mean.abs() < 1e-11, "{mean:e}");
    // What is expected needs a look only, whatever is added to it.
    let expected: Vec<f64> = a.values.iter().map(|value| value + 5.0).collect();
    let c = solve(&mut solver, &right, Some(&expected));
    assert_eq!(c.iterations, 1);
    assert!(distance(&a.values, &c.values) < 1e-8);
}

/// What a function of the state changes by when the balance does, from the steady state's answer and from the
/// function's own solution: g · p' = -x · change.
#[test]
fn half_of_the_cells_and_all_of_them_are_each_others_adjoints() {
    let count = 112;
    let line = |diffusion: f64| generators::TestAxis {
        from: -4.0,
        to: 4.0,
        count,
        diffusion,
        walls: true,
    };
    let drift = |axis: usize, state: &[f64]| match axis {
        0 => state[1],
        // No face has a drift that is rounding alone, of either sign.
        _ => -0.1001 * state[1] - state[0],
    };
    let (matrix, escape) = generators::generator(&[line(0.0), line(0.05)], drift);
    let mut solver = RateSolver::new(space(&[count, count]), RateOptions::default());
    let steady = solver.solve(&matrix, &escape, None).unwrap();
    assert!(solver.memory().folded);
    let n = steady.mass.len();
    let change: Vec<f64> = (0..n)
        .map(|cell| steady.mass[cell] * (0.3 * cell as f64).sin())
        .collect();
    let excess: f64 = change.iter().sum();
    let change: Vec<f64> = change
        .iter()
        .zip(&steady.mass)
        .map(|(c, p)| c - excess * p)
        .collect();
    let answer = solver.response(&change, &steady.mass, None, 1e-9).unwrap();
    let symmetric: Vec<f64> = (0..n)
        .map(|cell| ((cell.min(n - 1 - cell)) as f64 * 0.01).cos())
        .collect();
    for function in [symmetric, right_side(n)] {
        let found = solver
            .transposed(&function, &steady.mass, None, 1e-9)
            .unwrap();
        assert!(found.residual < 1e-8, "{:e}", found.residual);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (forward, backward) = (dot(&function, &answer), -dot(&found.values, &change));
        let size: f64 = answer.iter().map(|value| value.abs()).sum();
        assert!(
            (forward - backward).abs() < 1e-6 * size,
            "{forward:e} {backward:e}"
        );
    }
}
