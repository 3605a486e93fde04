//! Exact null vectors, dense algebra, and bad input.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use sprs::{CsMat, TriMat};

use super::{dense, distance, generators, space};
use crate::stationary::generator::{RateError, RateMethod, RateOptions, RateSolver};

/// A birth-death chain: rates up and down, and its exact steady state by detailed balance.
fn birth_death(count: usize, seed: u64) -> (DMatrix<f64>, Vec<f64>) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut matrix = DMatrix::zeros(count, count);
    let mut mass = vec![1.0];
    for cell in 0..count - 1 {
        let (up, down): (f64, f64) = (random.random_range(0.2..2.0), random.random_range(0.2..2.0));
        matrix[(cell + 1, cell)] += up;
        matrix[(cell, cell)] -= up;
        matrix[(cell, cell + 1)] += down;
        matrix[(cell + 1, cell + 1)] -= down;
        mass.push(mass[cell] * up / down);
    }
    let sum: f64 = mass.iter().sum();
    (matrix, mass.iter().map(|value| value / sum).collect())
}

fn sparse(matrix: &DMatrix<f64>) -> CsMat<f64> {
    let mut triplets = TriMat::new(matrix.shape());
    for column in 0..matrix.ncols() {
        for row in 0..matrix.nrows() {
            if matrix[(row, column)] != 0.0 {
                triplets.add_triplet(row, column, matrix[(row, column)]);
            }
        }
    }
    triplets.to_csc()
}

/// Independent chains on the axes: rates add, masses multiply.
fn product(shape: &[usize]) -> (CsMat<f64>, Vec<f64>) {
    let (mut matrix, mut mass) = birth_death(shape[0], 1);
    for (seed, &count) in shape.iter().enumerate().skip(1) {
        let (other, weights) = birth_death(count, 1 + seed as u64);
        let one = |size: usize| DMatrix::<f64>::identity(size, size);
        matrix = matrix.kronecker(&one(count)) + one(matrix.nrows()).kronecker(&other);
        let pairs = mass.iter().flat_map(|a| weights.iter().map(move |b| a * b));
        mass = pairs.collect();
    }
    (sparse(&matrix), mass)
}

fn solver(shape: &[usize], method: RateMethod) -> RateSolver {
    let options = RateOptions {
        method: Some(method),
        ..RateOptions::default()
    };
    RateSolver::new(space(shape), options)
}

/// Random rates to cells up to two away along each axis, and random escape of the given size.
fn random_generator(shape: [usize; 2], leak: f64) -> (CsMat<f64>, Vec<f64>) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    let n = shape[0] * shape[1];
    let mut matrix = DMatrix::<f64>::zeros(n, n);
    let mut escape = vec![0.0; n];
    for from in 0..n {
        for to in 0..n {
            let dx = (from / shape[1]).abs_diff(to / shape[1]);
            let dy = (from % shape[1]).abs_diff(to % shape[1]);
            if from != to && dx <= 2 && dy <= 2 {
                let rate: f64 = random.random_range(0.0..1.0);
                matrix[(to, from)] += rate;
                matrix[(from, from)] -= rate;
            }
        }
        escape[from] = leak * random.random_range(0.0..1.0);
        matrix[(from, from)] -= escape[from];
    }
    (sparse(&matrix), escape)
}

/// Eigenvector of the eigenvalue next to zero, by dense inverse iteration.
fn slowest(matrix: &CsMat<f64>) -> (Vec<f64>, f64) {
    let n = matrix.rows();
    let shift = 1e-9;
    let factors = (dense(matrix) - DMatrix::identity(n, n) * shift).lu();
    let mut vector = DVector::from_element(n, 1.0 / n as f64);
    let mut rate = 0.0;
    for _ in 0..200 {
        let next = factors.solve(&vector).unwrap();
        rate = -(1.0 / next.sum() + shift);
        vector = &next / next.sum();
    }
    (vector.as_slice().to_vec(), rate)
}

#[test]
fn chains_of_births_and_deaths_and_their_products_are_exact() {
    for shape in [&[300][..], &[31, 23], &[40, 5], &[11, 9, 7], &[5, 6, 4, 5]] {
        let (matrix, exact) = product(shape);
        let escape = vec![0.0; exact.len()];
        for method in RateMethod::ALL {
            let state = solver(shape, method).solve(&matrix, &escape, None).unwrap();
            let error = distance(&state.mass, &exact);
            let info = state.info;
            assert!(info.converged, "{shape:?} {info:?}");
            assert!(error < 1e-10, "{shape:?} {method:?} {error:e}");
            assert!(info.residual < 1e-12, "{shape:?} {info:?}");
        }
    }
}

#[test]
fn random_generators_agree_with_dense_algebra_with_and_without_escape() {
    for leak in [0.0, 1e-6, 1e-2, 1.0, 10.0] {
        let (matrix, escape) = random_generator([12, 11], leak);
        let (exact, rate) = slowest(&matrix);
        for method in RateMethod::ALL {
            let state = solver(&[12, 11], method)
                .solve(&matrix, &escape, None)
                .unwrap();
            let error = distance(&state.mass, &exact);
            assert!(state.info.converged, "{leak} {:?}", state.info);
            assert!(error < 1e-10, "{leak} {method:?} {error:e}");
            let difference = (state.info.escape_rate - rate).abs();
            assert!(
                difference < 1e-8 * leak + 1e-12,
                "{leak} {method:?} {difference:e}"
            );
        }
    }
}

#[test]
fn the_error_estimate_bounds_the_error_of_a_stopped_solve() {
    let (matrix, escape) = generators::oscillator(24, 0.01);
    let (exact, _) = slowest(&matrix);
    for method in RateMethod::ALL {
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let options = RateOptions {
                tolerance,
                method: Some(method),
                ..RateOptions::default()
            };
            let mut solver = RateSolver::new(space(&[24, 24]), options);
            let state = solver.solve(&matrix, &escape, None).unwrap();
            let error = distance(&state.mass, &exact);
            assert!(state.info.converged, "{:?}", state.info);
            assert!(error < tolerance, "{method:?} {tolerance:e} {error:e}");
        }
    }
}

#[test]
fn an_improbable_cell_held_first_does_no_harm() {
    // The first cell is left most slowly by far, yet carries almost nothing: it is entered more slowly still.
    let n = 40;
    let mut matrix = DMatrix::<f64>::zeros(n, n);
    for cell in 0..n - 1 {
        let (up, down) = if cell == 0 { (1e-4, 1e-14) } else { (1.0, 0.7) };
        matrix[(cell + 1, cell)] += up;
        matrix[(cell, cell)] -= up;
        matrix[(cell, cell + 1)] += down;
        matrix[(cell + 1, cell + 1)] -= down;
    }
    let mut mass = vec![1e-10];
    mass.extend((1..n).map(|cell| (1.0f64 / 0.7).powi(cell as i32 - 1)));
    let sum: f64 = mass.iter().sum();
    let exact: Vec<f64> = mass.iter().map(|value| value / sum).collect();
    let mut solver = solver(&[n], RateMethod::LuSingle);
    let state = solver.solve(&sparse(&matrix), &vec![0.0; n], None).unwrap();
    let error = distance(&state.mass, &exact);
    assert!(error < 1e-10, "{error:e} {:?}", state.info);
    assert!(state.info.converged, "{:?}", state.info);
}

#[test]
fn bad_input_is_named() {
    let (matrix, escape) = generators::oscillator(8, 0.01);
    let mut solver = RateSolver::new(space(&[8, 8]), RateOptions::default());
    let derivative = CsMat::zero((64, 64)).to_csc();
    assert_eq!(
        solver.sensitivity(&derivative, &[0.0; 64]),
        Err(RateError::NoSteadyState)
    );
    let shape = |part, found| RateError::Shape {
        cells: 64,
        part,
        found,
    };
    let result = solver.solve(&matrix, &escape[1..], None);
    assert_eq!(result, Err(shape("escape", 63)));
    let result = solver.solve(&matrix, &escape, Some(&[1.0]));
    assert_eq!(result, Err(shape("guess", 1)));
    let result = solver.solve(&matrix, &escape, Some(&[0.0; 64]));
    assert_eq!(result, Err(RateError::Guess));
    assert_eq!(
        solver.solve(&matrix.to_csr(), &escape, None),
        Err(RateError::Storage)
    );
    let mut broken = matrix.clone();
    broken.data_mut()[5] = f64::NAN;
    assert!(matches!(
        solver.solve(&broken, &escape, None),
        Err(RateError::Column { cell: 0, .. })
    ));
    let options = RateOptions {
        memory_limit_bytes: 1000,
        ..RateOptions::default()
    };
    let mut small = RateSolver::new(space(&[8, 8]), options);
    assert!(matches!(
        small.solve(&matrix, &escape, None),
        Err(RateError::Memory { limit: 1000, .. })
    ));
}
