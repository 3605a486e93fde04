//! The steady state of a system on cells and modes, for tests that hold it against exact moments.

use pbif::generator::{AdvectiveScheme, GeneratorOptions, assemble};
use pbif::space::CellSpace;
use pbif::stationary::generator::{RateOptions, RateSolver};
use pbif::system::System;

/// Unknowns at the nodes, Σ = 1.
pub(crate) fn solve(system: &dyn System, space: &CellSpace, scheme: AdvectiveScheme) -> Vec<f64> {
    let generator = assemble(system, space, &GeneratorOptions { scheme }).unwrap();
    let options = RateOptions {
        tolerance: 1e-12,
        ..RateOptions::default()
    };
    let mut solver = RateSolver::new(space.clone(), options);
    let steady = solver
        .solve(&generator.matrix, &generator.escape, None)
        .unwrap();
    assert!(steady.info.converged);
    let total: f64 = steady.mass.iter().sum();
    steady.mass.iter().map(|unknown| unknown / total).collect()
}
