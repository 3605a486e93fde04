//! Solves at complex shifts: what they leave, from both sides, alone and many at once.

use nalgebra::Complex;

use super::generators::oscillator;
use super::space;
use crate::cancellation::Cancellation;
use crate::stationary::generator::{Shifted, ShiftedPattern};

/// Vectors that are nothing special, of length one.
fn vectors(cells: usize, count: usize) -> Vec<Vec<Complex<f64>>> {
    let number = |place: usize, part: f64| (0.7 * place as f64 + part).sin();
    let one = |vector: usize| -> Vec<Complex<f64>> {
        let places = (0..cells).map(|place| place * (vector + 1));
        let all = places.map(|place| Complex::new(number(place, 0.1), number(place, 1.3)));
        let all: Vec<Complex<f64>> = all.collect();
        let length = all.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
        all.into_iter().map(|value| value / length).collect()
    };
    (0..count).map(one).collect()
}

/// Length of what two vectors differ by, over the length of the second.
fn off(one: &[Complex<f64>], other: &[Complex<f64>]) -> f64 {
    let apart = one.iter().zip(other).map(|(a, b)| (a - b).norm_sqr());
    let size = other.iter().map(Complex::norm_sqr).sum::<f64>();
    (apart.sum::<f64>() / size).sqrt()
}

#[test]
fn both_sides_are_solved_for_many_vectors_as_for_one() {
    let (matrix, _) = oscillator(40, 0.01);
    let space = space(&[40, 40]);
    let pattern = ShiftedPattern::new(&space, &matrix);
    let shift = Complex::new(0.02, 1.1);
    let mut solver = Shifted::new(&pattern, &matrix, shift, &Cancellation::new()).unwrap();
    let right = vectors(matrix.cols(), 5);
    for is_transposed in [false, true] {
        let all = solver.solve(&right, is_transposed);
        for (right, solved) in right.iter().zip(&all) {
            let mut left: Vec<Complex<f64>> = right
                .iter()
                .zip(solved)
                .map(|(b, x)| b + shift * x)
                .collect();
            for (&rate, (row, column)) in matrix.iter() {
                let (to, from) = if is_transposed {
                    (column, row)
                } else {
                    (row, column)
                };
                left[to] -= solved[from] * rate;
            }
            // Refinement ends at 1e-5 of the right side.
            let left = left.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
            assert!(left <= 1e-5, "{is_transposed}: {left:e}");
            // Alone, the same but for what refinement leaves.
            let alone = solver
                .solve(std::slice::from_ref(right), is_transposed)
                .swap_remove(0);
            let off = off(&alone, solved);
            assert!(off <= 1e-3, "{is_transposed}: {off:e}");
        }
        // One pass in single precision is most of a solve.
        let before = solver.passes;
        let mut once = right.clone();
        solver.pass(&mut once, is_transposed);
        assert_eq!(solver.passes, before + right.len());
        for (once, solved) in once.iter().zip(&all) {
            let off = off(once, solved);
            assert!(off <= 0.05, "{is_transposed}: {off:e}");
        }
        // Nothing has nothing for an answer, beside vectors that are something.
        let nothing = vec![Complex::default(); matrix.cols()];
        let both = solver.solve(&[nothing.clone(), right[0].clone()], is_transposed);
        assert!(both[0] == nothing && off(&both[1], &all[0]) <= 1e-3);
    }
}
