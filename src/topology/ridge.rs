//! Persistence that the grid itself makes, and its removal.
//!
//! A ridge that runs oblique to the axes passes now through the centre of a cell, now between two: cell
//! values along it wave by about κh²/8 (κ its curvature across), and the wave looks like a chain of peaks. So does
//! a trench, like a chain of craters. On the ring of a crater, where density is constant in truth, this is
//! per cents of the maximum. The cure: compare not the cell values at birth and saddle, but the extremes of the
//! quadratics fitted around them; what is left is of order h⁴.

use super::FeatureKind;
use super::persistence::Component;
use super::quadratic::{local_quadratic, principal_directions};
use crate::density::EstimatedDensity;

/// One cell in the units of the fit, half of three cells; the largest step from a cell's centre.
const ONE_CELL: f64 = 2.0 / 3.0;

/// What terms of order h⁴ may leave, in units of (κh²)²/p: their size for a ridge of Gaussian section, whose
/// fourth derivative is 3κ²/p. Enough for rings as thin as σ = 1.5 h and as small as r = 4 h (`analytic_tests`).
const REMAINDER: f64 = 0.6;

/// Persistence of a component of a density over two axes without what the grid adds: at most that of the cell values,
/// and zero when the grid explains all of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct WithoutGrid {
    /// What is left whatever terms of order h⁴ have added.
    pub(super) least: f64,
    /// What is left if they have added nothing.
    pub(super) most: f64,
}

/// What the grid leaves of the persistence of a component.
pub(super) fn persistence(
    estimated: &EstimatedDensity,
    component: &Component,
    is_crater: bool,
) -> WithoutGrid {
    let (Some(death), 2) = (component.death, estimated.density.axes.len()) else {
        return WithoutGrid {
            least: component.persistence,
            most: component.persistence,
        };
    };
    let (birth_kind, sign) = if is_crater {
        (FeatureKind::Crater, -1.0)
    } else {
        (FeatureKind::Peak, 1.0)
    };
    let birth = correction(estimated, component.birth, birth_kind);
    let saddle = correction(estimated, death, FeatureKind::Valley);
    let refined = component.persistence + sign * (birth.0 - saddle.0);
    let values = &estimated.density.values;
    let height = values[component.birth].max(values[death]);
    let remainder = if height > 0.0 {
        REMAINDER * (birth.1 * birth.1 + saddle.1 * saddle.1) / height
    } else {
        0.0
    };
    let left = |persistence: f64| persistence.min(component.persistence).max(0.0);
    WithoutGrid {
        least: left(refined - remainder),
        most: left(refined),
    }
}

/// How much the critical value near a cell exceeds the cell's value, and κh², the larger of the changes of
/// slope from cell to cell along the principal directions.
fn correction(estimated: &EstimatedDensity, cell: usize, kind: FeatureKind) -> (f64, f64) {
    let Some(coefficients) = local_quadratic(estimated, cell) else {
        return (0.0, 0.0);
    };
    let (mut change, mut bend): (f64, f64) = (0.0, 0.0);
    for principal in principal_directions(coefficients) {
        bend = bend.max(principal.curvature.abs() * ONE_CELL * ONE_CELL);
        if principal.suits(kind) {
            let step = (-principal.slope / principal.curvature).clamp(-ONE_CELL, ONE_CELL);
            change += step * (principal.slope + 0.5 * principal.curvature * step);
        }
    }
    (change, bend)
}
