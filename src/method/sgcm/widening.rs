//! What cells make of moments beside sampling: a density that is constant inside them is wider than one that is not,
//! and so is one with more noise.

use super::phases::moments_at_phases;
use crate::density::{EstimatedMoments, Moments, excess_variances};
use crate::method::problem::Maps;
use crate::method::step_errors::widened;
use crate::method::{MethodError, Problem};

/// Moments of the axes, which are known, of the quantities that are averaged, and of axes at phases, from masses and
/// their replicates, with what cells make of them beside sampling; `share` is what they add to the noise.
pub(super) fn all_moments(
    problem: &Problem,
    maps: &Maps,
    of_axes: &[Moments],
    (masses, replicates): (&[f64], &[Vec<f64>]),
    share: f64,
) -> Result<Vec<EstimatedMoments>, MethodError> {
    let space = problem.space();
    let sampled = maps.all_sampled_moments(space, of_axes, masses, replicates)?;
    let excess = excess_variances(space, masses)?;
    let mut known = widened(sampled, &excess, share);
    for (one, axis) in moments_at_phases(problem, masses, replicates)? {
        // At a phase the mean may answer to noise, as that of a quantity does.
        let more = Moments {
            mean: share.abs() * one.moments.standard_deviation,
            standard_deviation: 0.0,
        };
        known.extend(widened(vec![one.with(more)], &excess[axis..], share));
    }
    Ok(known)
}
