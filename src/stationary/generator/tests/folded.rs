//! Symmetric generators on half of the cells, against all of them.

use super::{distance, generators, space};
use crate::stationary::generator::solver::DirectSolver;
use crate::stationary::generator::{RateMethod, RateOptions, RateSolver};

#[test]
fn half_of_the_cells_give_the_whole_answer() {
    let count = 112;
    let (matrix, escape) = generators::oscillator(count, 0.02);
    let (nearby, _) = generators::oscillator(count, 0.021);
    let options = RateOptions {
        method: Some(RateMethod::Lu),
        ..RateOptions::default()
    };
    let space = space(&[count, count]);
    let mut folded = RateSolver::new(space.clone(), options);
    let mut whole = DirectSolver::new(space, options, None);
    let a = folded.solve(&matrix, &escape, None).unwrap();
    let b = whole.solve(&matrix, &escape, None).unwrap();
    assert!(a.info.converged && a.info.factor_bytes < 6 * b.info.factor_bytes / 10);
    assert_eq!(a.info.unknowns, count * count);
    assert!(
        distance(&a.mass, &b.mass) < 1e-8,
        "{:e}",
        distance(&a.mass, &b.mass)
    );
    // A change that is symmetric, and one that is not.
    let change = whole.change(&nearby, &a.mass).unwrap();
    let mut one_sided = change.clone();
    one_sided[..count * count / 3].fill(0.0);
    for change in [change, one_sided] {
        let a = folded.response(&change, &a.mass, None, 1e-8).unwrap();
        let b = whole.response(&change, &b.mass, None, 1e-8).unwrap();
        let size: f64 = b.iter().map(|value| value.abs()).sum();
        assert!(
            distance(&a, &b) < 1e-6 * size,
            "{:e}",
            distance(&a, &b) / size
        );
    }
}
