//! Rows of a sweep that curves are followed from.

use crate::continuation::curve::CurveOrigin;
use crate::continuation::{BifurcationStatus, LevelCrossing, Located, SweepResult};

/// A row that can be followed: a P-bifurcation, a D-bifurcation, or the crossing of a level.
#[derive(Debug, Clone, Copy)]
pub enum FirstRow<'r> {
    /// The shape of a density changes.
    Shape(&'r Located),
    /// The exponent of a fixed point passes zero.
    Stability(&'r LevelCrossing),
    /// A number of the steady state passes its level: the exponent along the density and a change of a spectrum too.
    Level(&'r LevelCrossing),
}

impl<'r> FirstRow<'r> {
    /// Its label.
    pub fn label(self) -> &'r str {
        match self {
            Self::Shape(row) => &row.label,
            Self::Stability(row) | Self::Level(row) => &row.label,
        }
    }

    /// Its value of the swept parameter.
    pub(super) fn value(self) -> f64 {
        match self {
            Self::Shape(row) => row.value,
            Self::Stability(row) | Self::Level(row) => row.value,
        }
    }

    /// Whether there is a function whose zeros can be followed.
    pub(super) fn has_curve(self) -> bool {
        match self {
            Self::Shape(row) => row.zero.is_some(),
            Self::Stability(_) | Self::Level(_) => true,
        }
    }

    pub(super) fn status(self) -> BifurcationStatus {
        match self {
            Self::Shape(row) => row.status(),
            Self::Stability(row) | Self::Level(row) => row.status(),
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
            Self::Level(row) => format!("{} = {}", row.asked.measure, row.asked.level),
        }
    }
}

impl From<FirstRow<'_>> for CurveOrigin {
    fn from(row: FirstRow<'_>) -> Self {
        match row {
            FirstRow::Shape(row) => row.into(),
            FirstRow::Stability(row) | FirstRow::Level(row) => row.into(),
        }
    }
}
