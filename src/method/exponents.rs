//! The largest Lyapunov exponent of a fixed point, at every value of a session that is asked for it.
//!
//! Below its D-bifurcation the fixed point attracts almost every path beside it, and what noise brings there stays: no
//! cells hold such a steady state, so that none is looked for.

use crate::continuation::measure::{DIVERGENCE, EXPONENT};
use crate::continuation::{
    Finding, Measure, MeasureColumn, MeasureKind, PointStatus, Session, Solution, SolveReport,
    SourceError,
};
use crate::exponent::{Exponent, ExponentError, of_family};
use crate::system::{Family, FixedPointFault};

/// The columns of exponents, where a family asks for them.
pub(super) fn exponent_columns(family: &Family) -> impl Iterator<Item = MeasureColumn> {
    let wanted: &[MeasureKind] = match (
        &family.questions.fixed_point,
        family.questions.largest_exponent,
    ) {
        (Some(_), _) => &[EXPONENT],
        (None, true) => &[EXPONENT, DIVERGENCE],
        (None, false) => &[],
    };
    wanted.iter().map(|&kind| MeasureColumn {
        kind,
        of: String::new(),
    })
}

/// A session whose reports have the exponent.
pub(super) struct WithExponents {
    pub(super) session: Box<dyn Session>,
    pub(super) family: Family,
    pub(super) method: &'static str,
    /// Whether the last value was handed on to the session.
    pub(super) was_solved: bool,
}

impl Session for WithExponents {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        self.was_solved = false;
        let Some(found) = of_family(&self.family, value) else {
            return self.session.solve(value);
        };
        if let Ok(exponent) = &found
            && exponent.attracts()
        {
            let mut report = SolveReport::solved(self.method);
            report.status = PointStatus::NoSteadyState;
            report.findings.push(Finding::PointMass {
                exponent: exponent.value,
                error: exponent.error,
            });
            report.put(measure(*exponent));
            return Ok(Solution::without_density(report));
        }
        self.was_solved = true;
        let mut solution = self.session.solve(value)?;
        match found {
            Ok(exponent) => solution.report.put(measure(exponent)),
            Err(error) => solution.report.findings.push(finding(&error)),
        }
        Ok(solution)
    }

    fn seconds(&self) -> Option<f64> {
        self.was_solved.then(|| self.session.seconds()).flatten()
    }

    fn memory(&self) -> Vec<u8> {
        match self.was_solved {
            true => self.session.memory(),
            false => Vec::new(),
        }
    }

    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        self.session.recall(left)
    }
}

fn measure(exponent: Exponent) -> Measure {
    Measure {
        error: Some(exponent.error),
        ..EXPONENT.measure("", exponent.value)
    }
}

fn finding(error: &ExponentError) -> Finding {
    match *error {
        ExponentError::FixedPoint(FixedPointFault::Moves { axis, drift, noise }) => {
            Finding::NoFixedPoint { axis, drift, noise }
        }
        ExponentError::FixedPoint(_) | ExponentError::Axes { .. } => Finding::NoExponent,
    }
}
