//! What following a curve gives: its points with their errors, its ends with their reasons, and the work it took.

use super::{CurveStart, Plane};
use crate::continuation::doubt::status_of;
use crate::continuation::measure::FACTORISATIONS;
use crate::continuation::{
    BifurcationStatus, Doubt, ErrorParts, LevelCrossing, Located, SolveReport,
};
use crate::density::Observable;
use crate::topology::{IndicatorKind, Signature};

/// A point of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// Values of both parameters.
    pub values: [f64; 2],
    /// Half-width of the band that is believed to hold the true curve, across the curve, as a share of the sides of the
    /// box.
    pub error: f64,
    /// Its parts, in the same unit.
    pub parts: ErrorParts,
    /// From the curve to the edge of the band on the side where the indicator is positive, in units of the parameters;
    /// the other edge is as far on the other side.
    pub to_edge: [f64; 2],
    /// The indicator where it was solved last.
    pub indicator: f64,
    /// Its change per unit of each parameter.
    pub gradient: [f64; 2],
    /// Where the indicator is, one coordinate an axis of the density.
    pub place: Vec<f64>,
    /// Length of the curve from the start to here, in sides of the box; negative before it.
    pub arclength: f64,
    /// Direction of the curve toward rising arclength, in units of the parameters per arclength.
    pub tangent: [f64; 2],
    /// Whether it was checked on finer cells, or between closed ends.
    pub checked: bool,
    /// Why it may not be where it says; the first decides its status. None where it is located.
    pub doubts: Vec<Doubt>,
}

impl CurvePoint {
    /// How well it is known.
    pub fn status(&self) -> BifurcationStatus {
        status_of(&self.doubts)
    }
}

/// Why a curve ends.
#[derive(Debug, Clone, PartialEq)]
pub enum EndReason {
    /// It leaves the box; the side whose parameter is at an end of its range, 0 or 1.
    Border(usize),
    /// It comes back to where it began.
    Closed,
    /// The density has no steady state beyond, or none was found, for this reason.
    NoDensity(String),
    /// The feature whose indicator was followed is not there beyond.
    FeatureLost,
    /// The density has no centre of symmetry beyond, at which the indicator would be.
    SymmetryLost,
    /// The number whose level was followed is unknown beyond.
    NumberLost,
    /// Two folds meet in a cusp: the last point, found from how both parameters depend on the place of the fold.
    Cusp,
    /// Two folds meet in a centre of symmetry, at which births away from it turn into births at it: the last point,
    /// found in the same way.
    DegenerateSplit,
    /// Slope and curvature beside a kink vanish together: births at the kink turn into births away from it.
    DegenerateKink,
    /// The slopes on both sides of a kink vanish together: there two curves of the kink meet and end.
    KinkCorner,
    /// The indicator changes in no direction: curves meet, or turn on the spot.
    Singular,
    /// However short the step, the curve was not met again.
    NotConverged,
    /// The curve was not met again, and samples leave more open than that takes: with more of them it would go on.
    Sampling,
    /// It has as many points as were wanted at most.
    TooManyPoints,
    /// It was asked to stop.
    Interrupted,
}

impl EndReason {
    /// The letters of its label, as AUTO has them: `EP` an end of the box, `CL` closed, `MX` no density or no
    /// convergence; `CP` cusp, `DS` degenerate split, `DK` degenerate kink, `KC` corner at a kink, `FL` feature lost,
    /// `SP` singular point, `UN` unfinished.
    pub(crate) fn prefix(&self) -> &'static str {
        match self {
            Self::Border(_) => "EP",
            Self::Closed => "CL",
            Self::NoDensity(_) | Self::NumberLost | Self::NotConverged | Self::Sampling => "MX",
            Self::Cusp => "CP",
            Self::DegenerateSplit => "DS",
            Self::DegenerateKink => "DK",
            Self::KinkCorner => "KC",
            Self::FeatureLost | Self::SymmetryLost => "FL",
            Self::Singular => "SP",
            Self::TooManyPoints | Self::Interrupted => "UN",
        }
    }

    /// In words, for a curve in this plane.
    pub fn words(&self, plane: &Plane) -> String {
        match self {
            Self::Border(side) => {
                let parameter = plane.sides().get(*side).map(|side| side.parameter.as_str());
                format!("border of the box in {}", parameter.unwrap_or("?"))
            }
            Self::Closed => "closed curve".to_owned(),
            Self::NoDensity(reason) => format!("no density beyond: {reason}"),
            Self::Cusp => "cusp: two folds meet".to_owned(),
            Self::DegenerateSplit => "degenerate split: two folds meet at the centre".to_owned(),
            Self::DegenerateKink => {
                "degenerate kink: births at the kink turn into births away from it".to_owned()
            }
            Self::KinkCorner => "corner: the slopes on both sides of the kink vanish".to_owned(),
            Self::SymmetryLost => {
                "the symmetry is lost: beyond, the density has no centre".to_owned()
            }
            Self::FeatureLost => "the feature is lost".to_owned(),
            Self::NumberLost => "the number has no value beyond".to_owned(),
            Self::Singular => "the indicator changes in no direction".to_owned(),
            Self::NotConverged => "the curve was not met again".to_owned(),
            Self::Sampling => "too few samples to tell where the curve goes on".to_owned(),
            Self::TooManyPoints => "as many points as wanted at most".to_owned(),
            Self::Interrupted => "interrupted".to_owned(),
        }
    }
}

/// An end of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveEnd {
    /// Letters and ordinal, for example `EP1`.
    pub label: String,
    /// Why it ends there.
    pub reason: EndReason,
    /// The point, by its place in [`Curve::points`].
    pub point: usize,
}

/// A point of codimension two between the ends of a curve: what the change leads to differs from there on. At a
/// degenerate split two peaks leave the centre as one splits there on one side of it, on the other side they are born
/// away from it, on a fold that begins here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DegeneratePoint {
    /// Letters and ordinal: `DS1`.
    pub label: String,
    /// What happens there.
    pub kind: CodimensionTwoKind,
    /// The point, by its place in [`Curve::points`]. Its error holds in all directions.
    pub point: usize,
}

/// What solves took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurveWork {
    /// Solves.
    pub solves: usize,
    /// Iterations of the solver in all of them.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
}

impl CurveWork {
    /// One more solve.
    pub(in crate::continuation) fn count(&mut self, report: &SolveReport) {
        self.solves += 1;
        self.iterations += report.iterations;
        self.factorisations += report.of(&FACTORISATIONS, "").unwrap_or(0.0) as usize;
    }

    pub(in crate::continuation) fn add(&mut self, other: &Self) {
        self.solves += other.solves;
        self.iterations += other.iterations;
        self.factorisations += other.factorisations;
    }
}

/// The row of a sweep that a curve was begun at, as far as it is shown beside the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveOrigin {
    /// The row's label, for example `PB1`.
    pub label: String,
    /// Value of the swept parameter.
    pub value: f64,
    /// Signatures below and above it; `None` for a D-bifurcation and for the crossing of a level.
    pub sides: Option<[Signature; 2]>,
}

impl From<&Located> for CurveOrigin {
    fn from(row: &Located) -> Self {
        Self {
            label: row.label.clone(),
            value: row.value,
            sides: Some([row.before, row.after]),
        }
    }
}

impl From<&LevelCrossing> for CurveOrigin {
    fn from(row: &LevelCrossing) -> Self {
        Self {
            label: row.label.clone(),
            value: row.value,
            sides: None,
        }
    }
}

/// A curve of P-bifurcations.
#[derive(Debug, Clone)]
pub struct Curve {
    /// The plane.
    pub plane: Plane,
    /// The observable whose signature changes across it.
    pub observable: Observable,
    /// The indicator that is zero on it.
    pub kind: IndicatorKind,
    /// Its points, one after the other from end to end.
    pub points: Vec<CurvePoint>,
    /// The point at which it was begun, by its place.
    pub start: usize,
    /// Its ends: that of the first point and that of the last. A closed curve has one.
    pub ends: Vec<CurveEnd>,
    /// Its points of codimension two between the ends.
    pub degenerate: Vec<DegeneratePoint>,
    /// Where other curves start from its points of codimension two.
    pub branches: Vec<CurveStart>,
    /// What following it took.
    pub work: CurveWork,
    /// What checking it took.
    pub check_work: CurveWork,
}

impl Curve {
    /// Whether it was asked to stop before it was complete.
    pub fn is_interrupted(&self) -> bool {
        let mut ends = self.ends.iter();
        ends.any(|end| end.reason == EndReason::Interrupted)
    }
}

/// Ends with their labels, numbered by their letters.
pub(super) fn label_ends(reasons: Vec<EndReason>, points: usize) -> Vec<CurveEnd> {
    let mut ends: Vec<CurveEnd> = Vec::new();
    for (index, reason) in reasons.into_iter().enumerate() {
        let prefix = reason.prefix();
        let before = ends
            .iter()
            .filter(|end| end.reason.prefix() == prefix)
            .count();
        ends.push(CurveEnd {
            label: format!("{prefix}{}", before + 1),
            point: if index == 0 {
                0
            } else {
                points.saturating_sub(1)
            },
            reason,
        });
    }
    ends
}

/// What happens at a point of codimension two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CodimensionTwoKind {
    /// Two folds meet and turn on the spot.
    Cusp,
    /// A split at a centre turns from births at the centre to births away from it.
    DegenerateSplit,
    /// Slope and curvature beside a kink vanish together: births at the kink turn into births away from it.
    DegenerateKink,
    /// The slopes on both sides of a kink vanish together, and the curves of both end.
    KinkCorner,
    /// Two curves cross.
    Crossing,
}

words! {
    CodimensionTwoKind, pub name:
    Cusp: "cusp",
    DegenerateSplit: "degenerate split",
    DegenerateKink: "degenerate kink",
    KinkCorner: "corner at a kink",
    Crossing: "crossing",
}

impl CodimensionTwoKind {
    /// The letters of its label.
    pub(crate) fn prefix(self) -> &'static str {
        match self {
            Self::Cusp => "CP",
            Self::DegenerateSplit => "DS",
            Self::DegenerateKink => "DK",
            Self::KinkCorner => "KC",
            Self::Crossing => "CX",
        }
    }
}
