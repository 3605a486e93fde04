//! A stored run and its sweep, joined again: the sweep file that was run, and what is found in its densities.

use super::looks::read_looks;
use super::{Ending, RunError, StoredRun};
use crate::continuation::{SweepResult, detect_again};
use crate::sweep_file::{Sweep, SweepFile};

impl StoredRun {
    /// The complete sweep file that was run. Keys of `detect`, `locate` and `figures` can be set anew; its cells are
    /// [`fixed`](crate::sweep_file::Settings::fixed).
    pub fn sweep_file(&self) -> SweepFile {
        let manifest = self.path().join("run.json");
        let file = SweepFile::parse(&manifest.display().to_string(), self.resolved());
        match self.typed() {
            Some(typed) => file.made_of(typed),
            None => file,
        }
    }

    /// Detects and locates in the stored densities, by the settings of a sweep that is this run's but for them. With
    /// unchanged settings it is the result of the run.
    ///
    /// # Errors
    /// As [`StoredRun::points`].
    pub fn detect(&self, sweep: &Sweep) -> Result<SweepResult, RunError> {
        let problem = &sweep.problem;
        let (subject, cells) = (problem.subject(), (problem.space(), problem.bins()));
        let points = self.points(subject, cells, &sweep.methods())?;
        let checks = self.checks(subject)?;
        let looks = read_looks(self.path(), &sweep.to_toml())?;
        let swept = (subject.clone(), sweep.settings.points);
        let (detector, locate) = (sweep.detector(), &sweep.settings.locate);
        let mut result = detect_again(swept, &detector, points, (checks, looks), locate);
        result.interrupted = self.ending() != Ending::Complete;
        Ok(result)
    }
}
