//! A point of a stored run, solved again: whether its densities are those that are stored.

use super::{RunError, StoredRun};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, Point};
use crate::density::{EstimatedDensity, half_difference};
use crate::sweep_file::Sweep;

/// What rounding and another order of sums may make of a density, as total variation.
const ROUNDING: f64 = 1e-9;

/// A point that was solved again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Recomputed {
    /// The parameter value.
    pub value: f64,
    /// Total variation between what is stored and what was found now, the largest of all watched densities.
    pub apart: f64,
    /// How large it may be: what both solves say of their errors, and what sampling leaves open.
    pub allowed: f64,
}

impl Recomputed {
    /// Whether the stored densities are those of the equations, by this program.
    pub(crate) fn agrees(&self) -> bool {
        self.apart <= self.allowed
    }
}

impl StoredRun {
    /// The points of the run with their densities, in the order of the table, nothing detected in them.
    ///
    /// # Errors
    /// As [`StoredRun::points`].
    pub(crate) fn solved_points(&self, sweep: &Sweep) -> Result<Vec<Point>, RunError> {
        let problem = &sweep.problem;
        let cells = (problem.space(), problem.bins());
        let mut points = self.points(problem.subject(), cells, &sweep.methods())?;
        points.retain(|point| !point.densities.is_empty());
        Ok(points)
    }

    /// Solves a point of the run again in a session of its own, which knows of no neighbour, and compares. `sweep` is
    /// this run's.
    ///
    /// # Errors
    /// [`RunError::Recompute`] when it cannot be solved, or is solved on other cells.
    pub(crate) fn recompute(
        &self,
        sweep: &Sweep,
        stored: &Point,
        cancellation: &Cancellation,
    ) -> Result<Recomputed, RunError> {
        let failed = |message: String| RunError::Recompute {
            parameter: sweep.problem.family().parameter().to_owned(),
            value: stored.value,
            message,
        };
        let source = sweep.source(cancellation);
        let source = source.map_err(|error| failed(error.to_string()))?;
        let mut session = source.open(cancellation);
        let solution = session.solve(stored.value);
        let solution = solution.map_err(|error| failed(error.to_string()))?;
        let errors = 0.5 * (stored.report.solver_error + solution.report.solver_error);
        let mut found = Recomputed {
            value: stored.value,
            apart: 0.0,
            allowed: errors + ROUNDING,
        };
        for stored in &stored.densities {
            let mut now = solution.densities.iter();
            let now = now.find(|one| one.observable == stored.observable);
            let now = now.ok_or_else(|| failed("a watched density is missing".to_owned()))?;
            let apart = half_difference(&stored.density, &now.density);
            found.apart = found
                .apart
                .max(apart.map_err(|error| failed(error.to_string()))?);
            found.allowed = found.allowed.max(errors + ROUNDING + sampling(stored));
        }
        Ok(found)
    }
}

/// Total variation that sampling may make between two estimates; zero for densities without.
fn sampling(estimated: &EstimatedDensity) -> f64 {
    let volumes = estimated.density.volumes();
    let errors = estimated.standard_error.iter().zip(&volumes);
    if estimated.is_noisy() {
        errors.map(|(error, volume)| error * volume).sum()
    } else {
        0.0
    }
}
