//! Rows of a sweep that curves are followed from.

use crate::continuation::curve::CurveOrigin;
use crate::continuation::{BifurcationStatus, LevelCrossing, Located, SweepResult};

/// A row that can be followed: a P-bifurcation, or a D-bifurcation of a fixed point.
#[derive(Debug, Clone, Copy)]
pub enum FirstRow<'r> {
    /// The shape of a density changes.
    Shape(&'r Located),
    /// The exponent of a fixed point passes zero.
    Stability(&'r LevelCrossing),
}

impl<'r> FirstRow<'r> {
    /// Its label.
    pub fn label(self) -> &'r str {
        match self {
            Self::Shape(row) => &row.label,
            Self::Stability(row) => &row.label,
        }
    }

    /// Its value of the swept parameter.
    pub(super) fn value(self) -> f64 {
        match self {
            Self::Shape(row) => row.value,
            Self::Stability(row) => row.value,
        }
    }

    /// Whether there is a function whose zeros can be followed.
    pub(super) fn has_curve(self, result: &SweepResult) -> bool {
        match self {
            Self::Shape(row) => row.zero.is_some(),
            Self::Stability(_) => result.subject.family.questions.fixed_point.is_some(),
        }
    }

    pub(super) fn status(self) -> BifurcationStatus {
        match self {
            Self::Shape(row) => row.status(),
            Self::Stability(row) => row.status(),
        }
    }

    /// What is zero there, with what it is of.
    pub(super) fn words(self, result: &SweepResult) -> String {
        match self {
            Self::Shape(row) => {
                let family = &result.subject.family;
                format!("{} of {}", row.method(), row.observable.name(family))
            }
            Self::Stability(_) => "exponent of the fixed point".to_owned(),
        }
    }
}

impl From<FirstRow<'_>> for CurveOrigin {
    fn from(row: FirstRow<'_>) -> Self {
        match row {
            FirstRow::Shape(row) => row.into(),
            FirstRow::Stability(row) => row.into(),
        }
    }
}
