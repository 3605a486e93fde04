//! What the second scheme says of a point.

use super::GeneratorSource;
use crate::generator::AdvectiveScheme;
use crate::method::MethodError;
use crate::stationary::generator::RateSolver;
use crate::system::System;

/// Relative error of differences between schemes, which estimate errors.
pub(super) const ROUGH: f64 = 1e-2;

/// What the second scheme says of a point.
pub(super) struct Second {
    /// By how much its unknowns differ; nothing in a check.
    pub(super) change: Vec<f64>,
    /// Its solution; `None` in a check.
    pub(super) solved: Option<SecondSolve>,
}

/// A solution by the second scheme.
pub(super) struct SecondSolve {
    pub(super) unknowns: Vec<f64>,
    pub(super) masses: Vec<f64>,
}

impl Second {
    pub(super) fn unknowns(&self) -> Option<&[f64]> {
        Some(&self.solved.as_ref()?.unknowns)
    }

    pub(super) fn masses(&self) -> Option<&[f64]> {
        Some(&self.solved.as_ref()?.masses)
    }
}

/// The scheme whose difference to the given one stands for its error.
pub(super) fn companion(scheme: AdvectiveScheme) -> AdvectiveScheme {
    match scheme {
        AdvectiveScheme::Upwind5 | AdvectiveScheme::Central6 => AdvectiveScheme::Central4,
        AdvectiveScheme::Central4 => AdvectiveScheme::Central6,
    }
}

/// What the unknowns of a solved system would change by in first order if what leaves Ω stayed in the cells that it
/// leaves from, with the sign by which it adds to another change, so that the two never cancel as a whole.
pub(super) fn closing(
    source: &GeneratorSource,
    solver: &mut RateSolver,
    (system, unknowns): (&dyn System, &[f64]),
    beside: &[f64],
) -> Result<Vec<f64>, MethodError> {
    let escape = source.assemble(system, source.options.scheme)?.escape;
    let back: Vec<f64> = escape.iter().zip(unknowns).map(|(e, u)| e * u).collect();
    let mut found = solver.response(&back, unknowns, None, ROUGH)?;
    let size = |sign: f64| -> f64 {
        let pairs = found.iter().zip(beside);
        pairs.map(|(a, b)| (sign * a + b).abs()).sum()
    };
    if size(-1.0) > size(1.0) {
        found.iter_mut().for_each(|one| *one = -*one);
    }
    Ok(found)
}
