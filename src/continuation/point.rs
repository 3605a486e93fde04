//! One value with all that was found there.

use std::time::Instant;

use super::{Finding, PointStatus, Session, Solution, SolveReport, SourceError};
use crate::density::EstimatedDensity;
use crate::topology::{Detection, Detector};

/// One parameter value of a sweep with all that was found there.
#[derive(Debug, Clone)]
pub struct Point {
    /// The parameter's value.
    pub value: f64,
    /// How the solve went, and its measures.
    pub report: SolveReport,
    /// The watched densities, in the order of [`Subject::observables`](super::Subject::observables); empty when there
    /// is no density.
    pub densities: Vec<EstimatedDensity>,
    /// What the detector says of each, in the same order; empty where the solver stopped so far from its tolerance that
    /// nothing can be read from them.
    pub detections: Vec<Detection>,
    /// Largest Hellinger distance over the watched densities to the point below; `None` for the first.
    pub distance: Option<f64>,
    /// Seconds of wall-clock time spent on the point.
    pub seconds: f64,
}

/// Why a source refused a value.
pub(super) type Refusal = Box<dyn std::error::Error + Send + Sync>;

impl Point {
    /// A solution without detections yet.
    pub(crate) fn undetected(value: f64, solution: Solution<'_>) -> Self {
        Self {
            value,
            report: solution.report,
            densities: solution.densities,
            detections: Vec::new(),
            distance: None,
            seconds: 0.0,
        }
    }

    /// Solves a value and detects. A refused value is a failed point, and why it was refused stands beside it; `None`
    /// where the source was asked to stop.
    pub(super) fn solve(
        session: &mut dyn Session,
        method: &'static str,
        detector: &dyn Detector,
        value: f64,
    ) -> Option<(Self, Option<Refusal>)> {
        let clock = Instant::now();
        let (solution, refusal) = match session.solve(value) {
            Ok(solution) => (solution.detached(), None),
            Err(SourceError::Interrupted) => return None,
            Err(SourceError::Method(error)) => {
                let mut report = SolveReport::solved(method);
                report.status = PointStatus::Failed;
                report.findings = vec![Finding::Told(error.to_string())];
                (Solution::without_density(report), Some(error))
            }
        };
        let mut point = Self::undetected(value, solution);
        point.detect(detector);
        point.seconds = (session.seconds()).unwrap_or_else(|| clock.elapsed().as_secs_f64());
        Some((point, refusal))
    }

    /// Whether the point has a steady state whose watched densities are positive enough for their shapes to be read.
    pub fn is_sound(&self) -> bool {
        let mut findings = self.report.findings.iter();
        self.report.status.is_resolved() && !findings.any(Finding::is_too_negative)
    }

    /// Detects in its densities, if anything can be read from them.
    pub(crate) fn detect(&mut self, detector: &dyn Detector) {
        let densities = self.densities.iter().filter(|_| self.is_readable());
        self.detections = densities.map(|one| detector.detect(one)).collect();
    }

    /// Whether the solver came near enough to its tolerance for peaks to be no doing of what is left, as where wells
    /// exchange mass more slowly than the digits of rates can tell. An error that is not a number is no small one.
    fn is_readable(&self) -> bool {
        !self
            .report
            .findings
            .iter()
            .any(Finding::is_too_far_to_count)
    }
}
