//! Labelled points of a sweep: AUTO's habit of a type and an ordinal for everything worth a row.

use super::{ErrorParts, Point};
use crate::density::Observable;
use crate::topology::{IndicatorKind, Signature};

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

impl PointType {
    /// The letters of its labels.
    pub fn prefix(self) -> &'static str {
        match self {
            Self::Bifurcation => "PB",
            Self::EndPoint => "EP",
            Self::NoConvergence => "MX",
        }
    }
}

/// How well a P-bifurcation is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BifurcationStatus {
    /// Its bracket and its error are within the tolerance, and finer cells, where there are any, show it too.
    Located,
    /// The data cannot tell where in the bracket it lies.
    Unresolved,
    /// A finer grid does not show it there, or there is none to check a cell map that adds diffusion of its own, or,
    /// where only persistence tells, its feature is nowhere more than a few cells from another: it may be an effect of
    /// the cells.
    Unconfirmed,
    /// Finer cells were not asked ([`LocateOptions::grid_check`](super::LocateOptions::grid_check) is off), so that its
    /// error lacks what the cells do to it; or a check failed: [`LabelledPoint::reason`] says which. The value may be
    /// right.
    Unchecked,
}

impl BifurcationStatus {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Located,
        Self::Unresolved,
        Self::Unconfirmed,
        Self::Unchecked,
    ];

    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Located => "located",
            Self::Unresolved => "unresolved",
            Self::Unconfirmed => "unconfirmed",
            Self::Unchecked => "unchecked",
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
    /// What happens there, in words; empty for end points and failures.
    pub change: &'static str,
    /// What it was located by: the name of an indicator, or `persistence`; empty for end points and failures.
    pub method: &'static str,
    /// The indicator whose zero it is.
    pub indicator: Option<IndicatorKind>,
    /// Whether the indicator rises through its zero.
    pub rises: bool,
    /// Why it is not located, where a sentence is known.
    pub reason: Option<String>,
    /// Where the indicator is, one coordinate an axis of the density; empty without one.
    pub place: Vec<f64>,
    /// Change of the indicator per unit of the parameter at its zero.
    pub slope: Option<f64>,
    /// Parts of the error; `None` where persistence alone gives a band, and for end points and failures.
    pub parts: Option<ErrorParts>,
}

/// The end points of a sweep, unnumbered.
pub(super) fn end_points(points: &[Point]) -> Vec<LabelledPoint> {
    let ends = [points.first(), points.last()];
    ends.into_iter()
        .flatten()
        .map(|point| unplaced(PointType::EndPoint, point.value, point.value))
        .collect()
}

/// One row for every run of neighbouring points without a density or without convergence, unnumbered.
pub(super) fn failures(points: &[Point]) -> Vec<LabelledPoint> {
    points
        .chunk_by(|a, b| a.report.status.is_resolved() == b.report.status.is_resolved())
        .filter(|run| !run[0].report.status.is_resolved())
        .map(|run| {
            unplaced(
                PointType::NoConvergence,
                run[0].value,
                run[run.len() - 1].value,
            )
        })
        .collect()
}

fn unplaced(kind: PointType, lower: f64, upper: f64) -> LabelledPoint {
    LabelledPoint {
        label: String::new(),
        kind,
        value: 0.5 * (lower + upper),
        error: 0.5 * (upper - lower),
        lower,
        upper,
        observable: None,
        before: None,
        after: None,
        status: None,
        change: "",
        method: "",
        parts: None,
        indicator: None,
        rises: false,
        reason: None,
        place: Vec::new(),
        slope: None,
    }
}

/// Sorts rows by parameter and numbers each type from 1.
pub(super) fn number(mut labels: Vec<LabelledPoint>) -> Vec<LabelledPoint> {
    labels.sort_by(|a, b| a.value.total_cmp(&b.value));
    let mut counts = std::collections::BTreeMap::new();
    for row in &mut labels {
        let count = counts.entry(row.kind.prefix()).or_insert(0);
        *count += 1;
        row.label = format!("{}{count}", row.kind.prefix());
    }
    labels
}
