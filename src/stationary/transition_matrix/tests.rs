//! Tests of the steady-state solvers against exact solutions and each other.

mod chains;
mod reducible;
mod sampled;

use sprs::{CsMat, TriMat};

use super::{Info, Options, Outcome, Solver, SteadyState, solve};
use crate::numerics::distance;
use crate::sampling::TransitionMatrix;
use crate::space::{Axis, CellSpace};

/// A grid of unit cells with the given shape.
fn grid(shape: &[usize]) -> CellSpace {
    let axis = |&count: &usize| Axis::uniform(0.0, count as f64, count).unwrap();
    CellSpace::new(shape.iter().map(axis).collect()).unwrap()
}

/// A transition matrix over all cells from (target, source, probability); what is missing escapes.
fn transitions(n: usize, entries: &[(usize, usize, f64)]) -> TransitionMatrix {
    let mut triplets = TriMat::new((n, n));
    let mut escape = vec![1.0; n];
    for &(target, source, probability) in entries {
        triplets.add_triplet(target, source, probability);
        escape[source] -= probability;
    }
    for value in &mut escape {
        *value = if *value < 1e-12 { 0.0 } else { *value };
    }
    TransitionMatrix {
        matrix: triplets.to_csr::<usize>(),
        escape,
        cells: (0..n).collect(),
        map_step: 1.0,
        phase: None,
    }
}

/// Wraps a matrix by rows over all cells.
fn over_all_cells(matrix: CsMat<f64>, escape: Vec<f64>) -> TransitionMatrix {
    TransitionMatrix {
        cells: (0..escape.len()).collect(),
        matrix,
        escape,
        map_step: 1.0,
        phase: None,
    }
}

/// A converged steady state.
fn steady(
    matrix: &TransitionMatrix,
    space: &CellSpace,
    guess: Option<&[f64]>,
    solver: Solver,
    tolerance: f64,
) -> SteadyState {
    match solve(matrix, space, guess, &Options::new(solver, tolerance)).unwrap() {
        Outcome::Steady(state) => {
            assert!(state.info.converged, "{:?}", state.info);
            let total: f64 = state.mass.iter().sum();
            assert!((total - 1.0).abs() < 1e-12);
            state
        }
        other => panic!("{other:?}"),
    }
}

/// Masses scaled to Σ = 1.
fn scaled(mut mass: Vec<f64>) -> Vec<f64> {
    let total: f64 = mass.iter().sum();
    mass.iter_mut().for_each(|value| *value /= total);
    mass
}

fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap().install(run)
}

fn work(info: &Info) -> (usize, usize) {
    (info.iterations, info.matrix_passes)
}
