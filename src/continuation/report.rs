//! What a solve says of itself: how it ended, numbers, findings.

use super::measure::{EDGE_MASS, Measure, MeasureKind};
use super::{Finding, Fluctuations, StateField};

/// How a point ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum PointStatus {
    /// Solved.
    Solved,
    /// Solved, but mass leaves Ω: the densities are quasi-stationary, conditioned on staying.
    Escaping,
    /// The solver stopped before it reached its tolerance; the densities are its last iterate.
    NotConverged,
    /// So much mass leaves that there is no steady state in Ω; no densities.
    NoSteadyState,
    /// The cell map has several closed classes: several steady states; no densities.
    SeveralClasses,
    /// The source refused the value, or the solver gave up; no densities. A finding says why.
    Failed,
}

words! {
    PointStatus, pub word:
    Solved: "solved",
    Escaping: "escaping",
    NotConverged: "not-converged",
    NoSteadyState: "no-steady-state",
    SeveralClasses: "several-classes",
    Failed: "failed",
}

impl PointStatus {
    /// Whether the point has a density that a user may rely on.
    pub fn is_resolved(self) -> bool {
        matches!(self, Self::Solved | Self::Escaping)
    }
}

/// What a solve says of itself; a row of `points.csv`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolveReport {
    /// How it ended.
    pub status: PointStatus,
    /// Name of the method, for example `sgcm`.
    #[cfg_attr(feature = "serde", serde(skip))] // whoever reads a report knows its source
    pub method: &'static str,
    /// Solver iterations (cycles).
    pub iterations: usize,
    /// What is left of the equation at the result, Σ p = 1: ‖P p - λ p‖₁ for a cell map,
    /// ‖Q p + r p‖₁ / ‖|Q| |p|‖₁ for a generator.
    pub residual: f64,
    /// L1 error of the masses that the solver estimates for itself.
    pub solver_error: f64,
    /// Its numbers, each name once: moments, rates, masses that should be zero, whatever the method knows.
    pub measures: Vec<Measure>,
    /// Spectra and correlations that the family asks for.
    pub fluctuations: Vec<Fluctuations>,
    /// Fields of passages that the family asks for.
    pub fields: Vec<StateField>,
    /// What the user must know of this point.
    pub findings: Vec<Finding>,
}

impl SolveReport {
    /// The report of a solve by a method of this name of which nothing is to be said.
    pub fn solved(method: &'static str) -> Self {
        Self {
            status: PointStatus::Solved,
            method,
            iterations: 0,
            residual: 0.0,
            solver_error: 0.0,
            measures: Vec::new(),
            fluctuations: Vec::new(),
            fields: Vec::new(),
            findings: Vec::new(),
        }
    }

    /// The value of the measure of this name, for example `escape_rate` or `mean_x`.
    pub fn measure(&self, name: &str) -> Option<f64> {
        let found = self.measures.iter().find(|one| one.name == name);
        found.map(|one| one.value)
    }

    /// The error of the measure of this name, where one is known.
    pub(crate) fn error_of(&self, name: &str) -> Option<f64> {
        let found = self.measures.iter().find(|one| one.name == name);
        found.and_then(|one| one.error)
    }

    /// The measure of one kind that is of an axis, a quantity or a density.
    pub(crate) fn of(&self, kind: &MeasureKind, of: &str) -> Option<f64> {
        self.measure(&kind.name(of))
    }

    /// The measures of one kind.
    pub(crate) fn all(&self, kind: &MeasureKind) -> impl Iterator<Item = f64> {
        let of_kind = self.measures.iter().filter(|one| kind.has(one));
        of_kind.map(|one| one.value)
    }

    /// The largest mass at the ends of an axis' range; `None` where it is not known.
    pub(crate) fn edge_mass(&self) -> Option<f64> {
        self.all(&EDGE_MASS).reduce(f64::max)
    }

    /// One more measure without a known error, in place of what was there of its name.
    pub(crate) fn add(&mut self, kind: &MeasureKind, of: &str, value: f64) {
        self.put(kind.measure(of, value));
    }

    /// One more measure, in place of what was there of its name.
    pub(crate) fn put(&mut self, measure: Measure) {
        let mut known = self.measures.iter_mut();
        match known.find(|one| one.name == measure.name) {
            Some(known) => *known = measure,
            None => self.measures.push(measure),
        }
    }
}
