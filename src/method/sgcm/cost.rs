//! What a point costs by SGCM: memory between two bounds, trajectories and their steps.
//!
//! A transition takes 8 bytes for its probability, 8 for its row, and 8 for a count of all samples and of each
//! replicate, with slope correction 4 bytes more a count and axis. A cell takes 8 vectors of 8 bytes in the solver
//! and, for each replicate, one more and those of the space in which its change is sought. The trajectories of a
//! cell end in at most `samples` cells, and in at most all of them; the image of a box generally overlaps at least
//! 2^d boxes. The solver's coarser levels at most double the transitions.

use super::passages::CELL_PATHS;
use super::{Correction, SgcmOptions};
use crate::MAX_DIMENSION;
use crate::method::StepChoice;
use crate::stationary::MOST_APPLICATIONS;

/// What a point costs by SGCM.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SgcmCost {
    /// Bytes at work if every cell reaches 2^d others.
    pub(crate) least_bytes: f64,
    /// Bytes at work if every sample ends in a cell of its own.
    pub(crate) most_bytes: f64,
    /// Trajectories, if all cells are reached.
    pub(crate) trajectories: f64,
    /// Time steps of a trajectory; `None` where a step is chosen when the sweep runs.
    pub(crate) steps: Option<f64>,
}

impl SgcmCost {
    /// Pairs of paths from a cell of a passage, at least and at most.
    pub(crate) const PASSAGE_PATHS: [usize; 2] = CELL_PATHS;
}

impl SgcmOptions {
    /// What a point costs on so many cells of so many dimensions.
    pub(crate) fn cost(&self, n_cells: f64, dimension: usize) -> SgcmCost {
        let most = n_cells.min(self.samples as f64);
        let least = most.min(2_f64.powi(dimension as i32));
        let steps = match (self.map_step, self.time_step) {
            (StepChoice::Fixed(map_step), StepChoice::Fixed(time_step)) => {
                Some((map_step / time_step).ceil())
            }
            _ => None,
        };
        SgcmCost {
            least_bytes: self.bytes(n_cells * least, n_cells, dimension),
            most_bytes: self.bytes(n_cells * most, n_cells, dimension),
            trajectories: n_cells * self.samples as f64,
            steps,
        }
    }

    /// Bytes at work at a point with so many entries of the transition matrix, in so many cells.
    pub(crate) fn bytes(&self, transitions: f64, cells: f64, dimension: usize) -> f64 {
        let (starts, moments) = match self.correction {
            // Moments of the end points by start, 21 numbers an axis, and slopes.
            Correction::Slope => (
                4.0 * dimension as f64,
                21.0 * dimension as f64 + 2.0 * MAX_DIMENSION as f64,
            ),
            Correction::None => (0.0, 0.0),
        };
        let replicates = self.replicates as f64;
        let transition = 2.0 * 16.0 + (8.0 + starts) * (replicates + 1.0);
        let sought = (1 + MOST_APPLICATIONS) as f64;
        let cell = 8.0 * (8.0 + replicates * sought + moments);
        transitions * transition + cells * cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_enclose_and_grow_with_cells_and_samples() {
        let options = SgcmOptions::default();
        let more = SgcmOptions {
            samples: 2 * options.samples,
            ..options.clone()
        };
        for n_cells in [4.0, 2500.0, 1e6] {
            let cost = options.cost(n_cells, 2);
            assert!(cost.least_bytes <= cost.most_bytes);
            assert!(options.cost(2.0 * n_cells, 2).most_bytes >= 2.0 * cost.most_bytes);
            assert!(more.cost(n_cells, 2).most_bytes >= cost.most_bytes);
        }
        // 10 cells, 10 transitions each at most: 10·(10·104 + 8·(8 + 8·41)) bytes with 8 replicates.
        let plain = SgcmOptions {
            correction: Correction::None,
            ..options.clone()
        };
        assert_eq!(plain.cost(10.0, 2).most_bytes, 37_280.0);
        assert_eq!(
            plain.cost(10.0, 2).least_bytes,
            10.0 * (4.0 * 104.0 + 2688.0)
        );
        // Slopes: 2·4 bytes more a count and transition, 8·(2·21 + 8) a cell.
        assert_eq!(
            options.cost(10.0, 2).most_bytes,
            37_280.0 + 10.0 * (10.0 * 72.0 + 400.0)
        );
    }

    #[test]
    fn steps_are_counted_where_both_are_given() {
        let mut options = SgcmOptions::default();
        assert_eq!(options.cost(10.0, 2).steps, None);
        options.map_step = StepChoice::Fixed(1.0);
        options.time_step = StepChoice::Fixed(0.3);
        assert_eq!(options.cost(10.0, 2).steps, Some(4.0));
        assert_eq!(options.cost(10.0, 2).trajectories, 20_000.0);
    }
}
