//! Whether declarations fit each other, before anything is evaluated.

use super::super::System;
use super::ContractViolation;
use crate::MAX_DIMENSION;

/// Checks shapes and numbers; gives the ranges within the bounds of the system.
pub(super) fn check(
    system: &dyn System,
    ranges: &[(f64, f64)],
) -> Result<Vec<(f64, f64)>, ContractViolation> {
    let dimension = system.dimension();
    if !(1..=MAX_DIMENSION).contains(&dimension) {
        return Err(ContractViolation::Dimension { dimension });
    }
    if ranges.len() != dimension {
        let given = ranges.len();
        return Err(ContractViolation::Ranges { given, dimension });
    }
    let facts = system.facts();
    if let Some(period) = facts.period
        && !(period.is_finite() && period > 0.0)
    {
        return Err(ContractViolation::Period { period });
    }
    for (channel, noise) in system.noises().iter().enumerate() {
        let axis = noise.axis;
        if axis >= dimension {
            return Err(ContractViolation::NoiseAxis {
                channel,
                axis,
                dimension,
            });
        }
    }
    let declared = facts.bounds.keys().chain(facts.filtered_noise.keys());
    let declared = declared.chain(facts.turns.keys()).chain(&facts.phase);
    let mut declared = declared.chain(facts.relaxation_rates.keys());
    if let Some(&axis) = declared.find(|&&axis| axis >= dimension) {
        return Err(ContractViolation::Axis { axis, dimension });
    }
    for &surface in &facts.switching_surfaces {
        if surface.axis >= dimension || !surface.at.is_finite() {
            return Err(ContractViolation::Surface { surface, dimension });
        }
    }
    if let Some(symmetry) = &facts.symmetry {
        let (centre, reflected) = (symmetry.centre.len(), symmetry.reflected.len());
        if centre != dimension || reflected != dimension {
            return Err(ContractViolation::SymmetryShape {
                centre,
                reflected,
                dimension,
            });
        }
    }
    let axes = ranges.iter().enumerate();
    axes.map(|(axis, &range)| within_bounds(system, axis, range))
        .collect()
}

fn within_bounds(
    system: &dyn System,
    axis: usize,
    (mut from, mut to): (f64, f64),
) -> Result<(f64, f64), ContractViolation> {
    if let Some((low, high)) = system.facts().bounds(axis) {
        if low.is_nan() || high.is_nan() || low >= high {
            let (from, to) = (low, high);
            return Err(ContractViolation::Bounds { axis, from, to });
        }
        (from, to) = (from.max(low), to.min(high));
    }
    if from.is_finite() && to.is_finite() && from < to {
        return Ok((from, to));
    }
    Err(ContractViolation::Range { axis, from, to })
}
