//! Tests of the solver against exact null vectors and dense algebra.

mod absorbing;
mod along;
mod cancelled;
mod exact;
mod generators;
mod shifted;
mod warm;

use sprs::CsMat;

use super::preconditioner::{Preconditioner, Structure};
use super::{RateMethod, RateOptions, RateSolver, RateSteadyState};
use crate::cancellation::Cancellation;
use crate::generator::Generator;
use crate::space::{Axis, CellSpace};

/// A space with the given numbers of cells; ranges do not matter to the solver.
fn space(shape: &[usize]) -> CellSpace {
    let axes = shape
        .iter()
        .map(|&count| Axis::uniform(-1.0, 1.0, count).unwrap());
    CellSpace::new(axes.collect()).unwrap()
}

/// Largest difference of two mass vectors in L1.
pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum()
}

/// A solver by one method, to a relative residual.
pub(super) fn solver(space: &CellSpace, method: RateMethod, tolerance: f64) -> RateSolver {
    let options = RateOptions {
        method: Some(method),
        tolerance,
        ..RateOptions::default()
    };
    RateSolver::new(space.clone(), options)
}

/// The steady state by one method.
pub(super) fn solve(
    space: &CellSpace,
    generator: &Generator,
    method: RateMethod,
) -> RateSteadyState {
    let mut solver = solver(space, method, 1e-11);
    let steady = solver.solve(&generator.matrix, &generator.escape, None);
    let steady = steady.unwrap();
    assert!(steady.info.converged, "{:?}", steady.info);
    assert_eq!(steady.info.method, method);
    steady
}

/// How far the answers to a change of the generator are apart, in L1, when factors are those of all cells and when
/// they are mode by mode, over the size of the answer.
pub(super) fn difference_of_answers(
    space: &CellSpace,
    generator: &Generator,
    change: &CsMat<f64>,
) -> f64 {
    let [whole, each] = [RateMethod::Lu, RateMethod::Modewise].map(|method| {
        let mut solver = solver(space, method, 1e-11);
        let steady = solver.solve(&generator.matrix, &generator.escape, None);
        solver.sensitivity(change, &steady.unwrap().mass).unwrap()
    });
    let size: f64 = whole.iter().map(|value| value.abs()).sum();
    distance(&whole, &each) / size
}

/// Steady states mode by mode are the same to the bit on one thread and on two.
pub(super) fn assert_same_bits(space: &CellSpace, generator: &Generator) {
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        let steady = pool.install(|| solve(space, generator, RateMethod::Modewise));
        let bits = steady.mass.iter().map(|mass| mass.to_bits());
        bits.collect::<Vec<u64>>()
    });
    assert_eq!(one, two);
}

/// Transposed factors are the adjoint of the factors: a · M⁻¹ b = M⁻ᵀ a · b for a and b that are zero at the held
/// cell. Both are sums in double precision with the same factors, whatever the precision of these.
pub(super) fn assert_adjoint(space: &CellSpace, generator: &Generator, method: RateMethod) {
    let structure = Structure {
        reach: space
            .axes()
            .iter()
            .map(|axis| axis.count().min(4) - 1)
            .collect(),
        folded: None,
    };
    let matrix = &generator.matrix;
    let never = Cancellation::new();
    let factors = Preconditioner::new(space, &structure, method, matrix, 7, None, &never);
    let factors = factors.unwrap();
    let vector = |factor: f64| -> Vec<f64> {
        let mut values: Vec<f64> = (0..space.n_cells())
            .map(|cell| (factor * cell as f64).sin())
            .collect();
        values[factors.held] = 0.0;
        values
    };
    let (a, b) = (vector(1.7), vector(0.9));
    let (forward, backward) = (factors.apply_one(&b), factors.apply_transposed(&a));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size: f64 = forward
        .iter()
        .chain(&backward)
        .map(|value| value.abs())
        .sum();
    let error = dot(&a, &forward) - dot(&backward, &b);
    assert!(
        error.abs() < 1e-10 * size,
        "{method:?}: {error:e} of {size:e}"
    );
}

/// Dense copy.
fn dense(matrix: &CsMat<f64>) -> nalgebra::DMatrix<f64> {
    let mut copy = nalgebra::DMatrix::zeros(matrix.rows(), matrix.cols());
    for (&rate, (row, column)) in matrix {
        copy[(row, column)] += rate;
    }
    copy
}
