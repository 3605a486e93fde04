//! Settings of a sampled transition matrix.

use super::{Integrator, SamplingError};

/// Settings of one sampled transition matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct SamplingOptions {
    /// Time one transition spans, Δt.
    pub map_step: f64,
    /// Upper bound of the integrator's step; the step taken divides the map step.
    pub time_step: f64,
    /// Trajectories started in each cell.
    pub samples: usize,
    /// Groups the samples are split into, 1 to 256.
    pub groups: usize,
    /// Seed of the random streams.
    pub seed: u64,
    /// Integrator of the trajectories.
    pub integrator: Integrator,
    /// Whether to keep where in its cell the samples of each transition started, for
    /// `SampledTransitions::corrected_matrix`.
    pub keep_starts: bool,
}

impl SamplingOptions {
    /// Largest number of groups.
    pub(crate) const MOST_GROUPS: usize = 256;

    /// Integrator steps in one map step.
    pub(crate) fn steps(&self) -> usize {
        // A quotient that is whole but for rounding does not cost a further step.
        let steps = self.map_step / self.time_step * (1.0 - 1e-12);
        (steps.ceil() as usize).max(1)
    }

    pub(super) fn check(&self) -> Result<(), SamplingError> {
        for (name, value) in [("map step", self.map_step), ("time step", self.time_step)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(SamplingError::Step { name, value });
            }
        }
        let (samples, groups) = (self.samples, self.groups);
        // One group may be left out, and the counts must fit 32 bits.
        if !(1..=Self::MOST_GROUPS).contains(&groups)
            || samples < groups
            || samples >= u32::MAX as usize
        {
            return Err(SamplingError::Groups { samples, groups });
        }
        Ok(())
    }
}
