//! How often regions are visited, counted on free trajectories.

use super::passages::Setting;
use crate::cancellation::Cancellation;
use crate::continuation::SolveReport;
use crate::method::MethodError;
use crate::method::measures::add_visits;
use crate::monte_carlo::{ExitNumber, Transitions};
use crate::passage::{Visits, is_endless};
use crate::system::System;

impl Setting<'_> {
    /// Adds how often regions are visited at a value to a report, with findings: transitions from outside of a region
    /// to its inside, counted as those between two regions are.
    ///
    /// # Errors
    /// [`MethodError`] when the value is not allowed or the run was cancelled.
    pub(super) fn add_visits(
        &self,
        report: &mut SolveReport,
        (value, system): (f64, &dyn System),
        is_steady: bool,
        cancellation: &Cancellation,
    ) -> Result<(), MethodError> {
        let family = self.problem.family();
        if self.problem.subject().measures.is_empty() || !is_steady {
            return Ok(());
        }
        let values = family.values_at(value)?;
        for (visits, question) in family.questions.visits.iter().enumerate() {
            let inside = question.region.level().bind(&values)?;
            let outside = question.outside.level().bind(&values)?;
            let is_endless = is_endless((system, self.problem.space()), &inside);
            let found = match is_endless {
                true => None,
                false => {
                    let regions = [&outside, &inside];
                    self.counted(system, regions, Transitions::visits, cancellation)?
                        .ok()
                }
            };
            let found = found.map(|found| {
                let known = |number: &ExitNumber| (number.value, number.error());
                let [share, rate, length] = [0, 1, 2].map(|place| known(&found[place]));
                Visits {
                    time_share: share,
                    entries: Some([rate, length]),
                    is_endless,
                }
            });
            add_visits(report, (visits, question), found.as_ref(), is_endless);
        }
        Ok(())
    }
}
