//! What is kept of a solve: the solution, the answers to what was asked of it, and what it has left in its session.

use serde::{Deserialize, Serialize};

use crate::continuation::{Point, Sensitivity, Solution, SolveReport, SourceError};
use crate::density::EstimatedDensity;

/// A solve that is kept.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Kept {
    /// Seconds that it took.
    pub(super) seconds: f64,
    /// The solution, or what the method said instead.
    pub(super) solved: Result<KeptSolution, String>,
    /// Whether the solution can be asked how it answers to parameters.
    pub(super) is_sensitive: bool,
    /// What was asked of it, in this order.
    pub(super) answers: Vec<(Question, Answer)>,
    /// [`Session::memory`](crate::continuation::Session::memory) after the last answer.
    pub(super) memory: Vec<u8>,
}

/// How densities answer to a parameter, or what the method said instead.
pub(super) type Answer = Result<Vec<Vec<f64>>, String>;

/// A solution without its session.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct KeptSolution {
    report: SolveReport,
    densities: Vec<EstimatedDensity>,
}

impl KeptSolution {
    /// What a solution holds, which is still to be handed on.
    pub(super) fn of(solution: &Solution<'_>) -> Self {
        Self {
            report: solution.report.clone(),
            densities: solution.densities.clone(),
        }
    }

    /// The solution that a method of this name has given.
    pub(super) fn solution(self, method: &'static str) -> Solution<'static> {
        let mut report = self.report;
        report.method = method;
        Solution {
            report,
            densities: self.densities,
            sensitivity: None,
        }
    }
}

impl Kept {
    /// A point that was solved elsewhere.
    pub(super) fn of_point(point: &Point) -> Self {
        Self {
            seconds: point.seconds,
            solved: Ok(KeptSolution {
                report: point.report.clone(),
                densities: point.densities.clone(),
            }),
            is_sensitive: false,
            answers: Vec::new(),
            memory: Vec::new(),
        }
    }

    /// The densities that were solved, none where there is no solution.
    pub(super) fn densities(&self) -> &[EstimatedDensity] {
        self.solved.as_ref().map_or(&[], |found| &found.densities)
    }

    /// Whether what was read is what a solve can give.
    pub(super) fn is_sound(&self) -> bool {
        self.densities().iter().all(EstimatedDensity::is_sound)
    }
}

/// What a solution can be asked.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Question {
    AlongPath,
    ToParameter(String),
    JumpsToParameter(String),
}

impl Question {
    pub(super) fn ask(&self, of: &mut dyn Sensitivity) -> Result<Vec<Vec<f64>>, SourceError> {
        match self {
            Self::AlongPath => of.along_path(),
            Self::ToParameter(name) => of.to_parameter(name),
            Self::JumpsToParameter(name) => of.jumps_to_parameter(name),
        }
    }
}

/// What a method said, as its error.
pub(super) fn in_words(words: String) -> SourceError {
    SourceError::Method(words.into())
}
