//! Time and memory of the steady state of generators, cold and warm.
//!
//! `cargo bench --bench rates -- 50x50 100x100 50x50x16` runs grids; add a method's name (`lu`, `lu-single`,
//! `narrow-lu`, `narrow-lu-single`) to force it, `short` for two values instead of five, `predict` to print
//! what the factorisations would take, `faer` for a general sparse LU on the same matrix.

#![expect(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a bench reports and stops at the first fault"
)]

#[path = "../src/stationary/generator/tests/generators.rs"]
mod generators;

use std::time::Instant;

use faer::sparse::{SparseColMat, Triplet};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::generator::{RateMethod, RateOptions, RateSolver, estimate};

fn space(shape: &[usize]) -> CellSpace {
    let axes = shape
        .iter()
        .map(|&count| Axis::uniform(-1.0, 1.0, count).expect("a range"));
    CellSpace::new(axes.collect()).expect("a grid")
}

fn matrix(shape: &[usize], step: u32) -> (sprs::CsMat<f64>, Vec<f64>) {
    let step = f64::from(step);
    match *shape {
        [count, _] => generators::oscillator(count, 0.01 + step * 1e-4),
        _ => generators::dahl([shape[0], shape[1], shape[2]], 0.5 - step * 0.025),
    }
}

/// What a factorisation of the grid takes, without running it.
fn predict(shape: &[usize]) {
    for method in RateMethod::ALL {
        let plan = estimate(&space(shape), &vec![3; shape.len()], u64::MAX, Some(method));
        let plan = plan.expect("no limit");
        println!(
            "{shape:?} {:17} factors {:9.1} MB, peak {:9.1} MB, {:10.2} Gflop",
            method.name(),
            plan.factor_bytes as f64 / 1e6,
            plan.peak_bytes as f64 / 1e6,
            plan.operations / 1e9,
        );
    }
}

/// A cold solve, then warm ones: the parameter moves a little, the neighbour's mass is the guess.
fn run(shape: &[usize], method: Option<RateMethod>, values: u32) {
    let options = RateOptions {
        method,
        memory_limit_bytes: 20 << 30,
        ..RateOptions::default()
    };
    let mut solver = RateSolver::new(space(shape), options);
    let mut guess: Option<Vec<f64>> = None;
    for step in 0..values {
        let (matrix, escape) = matrix(shape, step);
        let clock = Instant::now();
        let state = solver.solve(&matrix, &escape, guess.as_deref());
        let seconds = clock.elapsed().as_secs_f64();
        let state = state.expect("a generator");
        let info = &state.info;
        println!(
            "{shape:?} {:9} {seconds:9.4} s, {} factorisations, {:3} iterations, residual {:.0e}, error {:.0e}, \
             escape {:.0e}, negative {:.0e}, factors {:.1} MB{}",
            info.method.name(),
            info.factorisations,
            info.iterations,
            info.residual,
            info.error_estimate,
            info.escape_rate,
            info.negative_mass,
            info.factor_bytes as f64 / 1e6,
            if info.converged {
                ""
            } else {
                ", NOT CONVERGED"
            },
        );
        guess = Some(state.mass);
    }
}

/// The general sparse LU of faer (COLAMD order, partial pivoting) on the same matrix, its middle cell held.
fn general(shape: &[usize]) {
    let (matrix, _) = matrix(shape, 0);
    let n = matrix.cols();
    let held = n / 2;
    let entries = matrix
        .iter()
        .filter(|(_, (row, column))| *row != held && *column != held);
    let mut triplets: Vec<_> = entries
        .map(|(&rate, (row, column))| Triplet::new(row, column, rate))
        .collect();
    triplets.push(Triplet::new(held, held, 1.0));
    let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets);
    let matrix = matrix.expect("indices in range");
    let clock = Instant::now();
    let regular = matrix.sp_lu().is_ok();
    let seconds = clock.elapsed().as_secs_f64();
    println!("{shape:?} faer sp_lu {seconds:9.4} s, regular {regular}");
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| words.iter().any(|word| word == name);
    let method = RateMethod::ALL
        .into_iter()
        .find(|method| has(method.name()));
    let shapes = words.iter().map(|word| {
        let counts = word.split('x').map(|count| count.parse().ok());
        counts.collect::<Option<Vec<usize>>>().unwrap_or_default()
    });
    let mut shapes: Vec<Vec<usize>> = shapes.filter(|shape| shape.len() >= 2).collect();
    if shapes.is_empty() {
        shapes = vec![vec![50, 50], vec![100, 100]];
    }
    for shape in &shapes {
        if has("predict") {
            predict(shape);
        } else if has("faer") {
            general(shape);
        } else {
            run(shape, method, if has("short") { 2 } else { 5 });
        }
    }
}
