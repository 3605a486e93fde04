//! Processes that end, by factors in single precision.

use sprs::{CsMat, TriMat};

use super::super::{AbsorbingSolver, RateOptions};
use crate::cancellation::Cancellation;
use crate::space::{Axis, CellSpace};

/// Cells a side.
const SIDE: usize = 40;

/// A walk on a square that drifts to its first column of cells, which is left at a rate: Q by columns, and the rates
/// of the ends.
fn walk(leaves: f64) -> (CsMat<f64>, Vec<f64>) {
    let cells = SIDE * SIDE;
    let mut entries = TriMat::new((cells, cells));
    let mut ends = vec![0.0; cells];
    let mut go = |from: usize, to: usize, rate: f64| {
        entries.add_triplet(to, from, rate);
        entries.add_triplet(from, from, -rate);
    };
    for cell in 0..cells {
        let (x, y) = (cell / SIDE, cell % SIDE);
        if x + 1 < SIDE {
            go(cell, cell + SIDE, 1.0);
            go(cell + SIDE, cell, 1.2 + 0.02 * y as f64);
        }
        if y + 1 < SIDE {
            go(cell, cell + 1, 2.0);
            go(cell + 1, cell, 2.0 - 0.01 * x as f64);
        }
    }
    for (cell, end) in ends.iter_mut().enumerate().take(SIDE) {
        *end = leaves;
        entries.add_triplet(cell, cell, -leaves);
    }
    (entries.to_csc(), ends)
}

/// The mean time from a cell, and the same put right by what the transposed equation is short of.
fn mean_time(leaves: f64, is_light: bool) -> ([f64; 2], usize) {
    let axis = || Axis::uniform(0.0, 1.0, SIDE).unwrap();
    let space = CellSpace::new(vec![axis(), axis()]).unwrap();
    let (matrix, ends) = walk(leaves);
    let options = RateOptions {
        tolerance: 1e-4,
        ..RateOptions::default()
    };
    let mut solver = AbsorbingSolver::new(&space, options, &Cancellation::new())
        .rough()
        .free()
        .light(is_light);
    let mut start = vec![0.0; SIDE * SIDE];
    start[SIDE * SIDE / 2 + 5] = 1.0;
    let (stage, times) = solver.stage(&matrix, &ends, &start).unwrap();
    let expected = solver.expected(&stage, &vec![1.0; start.len()]).unwrap();
    let mean: f64 = times.iter().sum();
    let left = stage.of_balance(&stage.balance(&times), &expected, &times);
    let corrected = mean + expected.over(&start) + left;
    ([mean, corrected], solver.work.factorisations)
}

#[test]
fn single_precision_has_the_digits_of_double_where_both_sides_put_each_other_right() {
    let ([mean, corrected], factorisations) = mean_time(1.0, true);
    let ([_, exact], _) = mean_time(1.0, false);
    assert_eq!(factorisations, 1);
    let [one, both] = [mean, corrected].map(|value| (value / exact - 1.0).abs());
    // Single precision leaves about 1e-7 times the mean time in units of the fastest rate, hundreds.
    assert!(one < 1e-3, "{one:e}");
    assert!(both < 1e-6, "{both:e}");
}

#[test]
fn a_matrix_that_single_precision_takes_for_singular_is_solved_in_double() {
    // The walk ends at 1e-9 times its share in the first column, so that the mean time goes as one over that.
    let ([_, rare], factorisations) = mean_time(1e-9, true);
    let ([_, exact], _) = mean_time(1e-9, false);
    assert!(factorisations > 1);
    assert!((rare / exact - 1.0).abs() < 1e-6, "{rare:e} {exact:e}");
    let ([_, rarer], _) = mean_time(1e-10, true);
    assert!((rarer / rare - 10.0).abs() < 1e-4, "{rarer:e} {rare:e}");
}
