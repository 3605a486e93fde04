//! Labelled points of a sweep: AUTO's habit of a type and an ordinal for everything worth a row.

use crate::density::Observable;
use crate::topology::Signature;

/// What a labelled point is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointType {
    /// `PB`: a P-bifurcation.
    Bifurcation,
    /// `EP`: an end of the sweep.
    EndPoint,
    /// `MX`: no converged steady state.
    NoConvergence,
}

/// How well a P-bifurcation is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BifurcationStatus {
    /// Its bracket is narrower than the tolerance.
    Located,
    /// The data cannot tell where in the bracket it lies.
    Unresolved,
    /// Its evidence did not survive a check.
    Unconfirmed,
}

impl BifurcationStatus {
    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Located => "located",
            Self::Unresolved => "unresolved",
            Self::Unconfirmed => "unconfirmed",
        }
    }
}

/// A row of `bifurcations.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledPoint {
    /// Type and ordinal, for example `PB1`.
    pub label: String,
    /// The type.
    pub kind: PointType,
    /// The parameter's value.
    pub value: f64,
    /// Half-width of the interval that is believed to hold the true value; zero for end points.
    pub error: f64,
    /// Lower end of the bracket or unresolved band.
    pub lower: f64,
    /// Upper end of the bracket or unresolved band.
    pub upper: f64,
    /// The observable whose signature changes; `None` for end points and failures.
    pub observable: Option<Observable>,
    /// Signature below the value.
    pub before: Option<Signature>,
    /// Signature above the value.
    pub after: Option<Signature>,
    /// How well it is known; `None` for end points and failures.
    pub status: Option<BifurcationStatus>,
}
