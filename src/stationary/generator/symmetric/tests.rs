//! Symmetric generators on half of the cells, against all of them.

use crate::generator::{GeneratorOptions, assemble};
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::question::Question;
use crate::stationary::generator::solver::DirectSolver;
use crate::stationary::generator::symmetric::folding::is_centrosymmetric;
use crate::stationary::generator::{RateMethod, RateOptions, RateSolver};
use crate::system::registry;

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum()
}

#[test]
fn half_of_the_cells_give_the_whole_answer() {
    let axis = Axis::uniform(-3.2, 3.2, 112).unwrap();
    let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
    let generator = |f_c: f64| {
        let values = [("kappa", 0.05), ("f_c", f_c), ("sigma2", 0.05)];
        let system = registry::find("coulomb").unwrap().system_with(&values);
        assemble(&*system.unwrap(), &space, &GeneratorOptions::default()).unwrap()
    };
    let (here, nearby) = (generator(0.02), generator(0.021));
    assert!(is_centrosymmetric(&here.matrix, &here.escape));
    let options = RateOptions {
        method: Some(RateMethod::Lu),
        ..RateOptions::default()
    };
    let mut folded = RateSolver::new(space.clone(), options);
    let mut whole = DirectSolver::new(space.clone(), options, None);
    let a = folded.solve(&here.matrix, &here.escape, None).unwrap();
    let b = whole.solve(&here.matrix, &here.escape, None).unwrap();
    assert!(a.info.converged && b.info.converged);
    let (half, all) = (a.info.factor_bytes, b.info.factor_bytes);
    assert!(10 * half < 6 * all, "{half} {all}");
    assert_eq!(a.info.unknowns, space.n_cells());
    let apart = distance(&a.mass, &b.mass);
    assert!(apart < 1e-8, "{apart:e}");
    // A change that is symmetric, and one that is not.
    let change = whole.change(&nearby.matrix, &a.mass).unwrap();
    let mut one_sided = change.clone();
    one_sided[..space.n_cells() / 3].fill(0.0);
    for change in [change, one_sided] {
        let a = folded.response(&change, &a.mass, None, 1e-8).unwrap();
        let question = Question {
            change: &change,
            guess: None,
            tolerance: 1e-8,
            is_aside: false,
        };
        let b = whole.response(&question, &b.mass).unwrap();
        let size: f64 = b.iter().map(|value| value.abs()).sum();
        let apart = distance(&a, &b) / size;
        assert!(apart < 1e-6, "{apart:e}");
    }
}
