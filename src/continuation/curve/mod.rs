//! Curves of P-bifurcations in a plane of two parameters: from a zero of an indicator g on, the line on which
//! g(θ₁, θ₂) = 0.
//!
//! The curve is followed by pseudo-arclength in the plane scaled by the sides of its box. The tangent is exact where
//! the source knows how its densities answer to parameters; a step goes along the tangent and the curvature seen so
//! far, and is corrected along the gradient. Selected points are checked on finer cells and between closed ends of Ω,
//! as the rows of a sweep are, and what the checks show is interpolated along the curve. This module knows an indicator
//! and sessions, and nothing of cells.
//!
//! # Decisions
//!
//! **A curve is a path that is laid while it is walked.** A session solves along a path with one coordinate; in a plane
//! of two parameters the path is not known before. `continuation::curve::Plane` lays it leg by leg and never changes
//! what is laid, so that sessions, warm starts, finer and enclosed sources serve curves as they serve sweeps, and none
//! of them knows that there is a plane. The coordinate is the length walked, so neighbours on it are neighbours in the
//! plane.

mod agree;
mod branch;
mod broken;
mod check;
mod codimension;
mod companion;
mod crossed;
mod cusp;
mod degenerate;
mod fold_end;
mod found;
mod level;
mod level_number;
mod piece;
mod plane;
mod polynomial;
mod reading;
mod stability;
mod steps;
mod tail;
mod tree;
mod walk;
mod walked;
mod zero_lines;

pub(super) use agree::agree;
pub use codimension::{CodimensionTwo, codimension_two};
pub use crossed::{NotInPlane, RowInPlane, SweepInPlane};
pub use found::{
    CodimensionTwoKind, Curve, CurveEnd, CurveOrigin, CurvePoint, CurveWork, DegeneratePoint,
    EndReason,
};
pub(crate) use level::level_name;
pub use level::{LevelCurve, follow_level};
pub use plane::{Plane, PlaneSide};
pub use stability::{StabilityCurve, StabilityKind, StabilityPoint, stability_curves};
pub use tree::{CurveTree, MissedBranch, follow_all};
pub(super) use tree::{ON_IT, distance};

use found::label_ends;

use super::{BifurcationStatus, DensitySource, Doubt, Located, SourceError, Subject};
use crate::cancellation::Cancellation;
use crate::density::Observable;
use crate::topology::{Detector, IndicatorKind};

/// Settings of curves. Lengths are shares of the sides of the box.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveOptions {
    /// Longest step between points.
    pub largest_step: f64,
    /// Most points in each of the two directions.
    pub most_points: usize,
    /// Largest error of a point that counts as located.
    pub tolerance: f64,
    /// Hellinger distance between densities of neighbouring points above which a step is halved.
    pub largest_distance: f64,
    /// Every which point is checked on finer cells, where the source has them, and the ends; zero for none: points are
    /// then [`BifurcationStatus::Unchecked`].
    pub check_every: usize,
    /// Whether [`follow_all`] follows the curves that start from points of codimension two too.
    pub branches: bool,
}

impl Default for CurveOptions {
    fn default() -> Self {
        Self {
            largest_step: 0.025,
            most_points: 400,
            tolerance: 1e-4,
            largest_distance: 0.2,
            check_every: 8,
            branches: true,
        }
    }
}

/// Where a curve is known to pass.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveStart {
    /// Values of both parameters.
    pub values: [f64; 2],
    /// Place of the observable in [`Subject::observables`].
    pub observable: usize,
    /// The indicator that is zero there.
    pub kind: IndicatorKind,
    /// Where the indicator is, one coordinate an axis of the density.
    pub place: Vec<f64>,
}

impl CurveStart {
    /// A row of a sweep over the first parameter at a value of the second; `None` for a row that was located by no
    /// indicator, or is of no observable of the subject.
    pub fn from_row(row: &Located, second: f64, subject: &Subject) -> Option<Self> {
        let mut observables = subject.observables.iter();
        let observable = observables.position(|&one| one == row.observable)?;
        let zero = row.zero.as_ref()?;
        Some(Self {
            values: [row.value, second],
            observable,
            kind: zero.indicator,
            place: zero.place.clone(),
        })
    }
}

/// Why there is no curve.
#[derive(Debug, thiserror::Error)]
pub enum CurveError {
    /// Both sides are the same parameter.
    #[error("the second parameter is the first one, `{parameter}`")]
    SameParameter {
        /// The parameter.
        parameter: String,
    },
    /// A side of the box that has no length.
    #[error("the box has no extent in {parameter}: from {from} to {to}")]
    EmptySide {
        /// The parameter.
        parameter: String,
        /// The lower end.
        from: f64,
        /// The upper end.
        to: f64,
    },
    /// The start is not in the box.
    #[error(
        "the start is not in the box: {parameter} = {value}, and the box goes from {from} to {to}"
    )]
    Outside {
        /// The parameter.
        parameter: String,
        /// Its value at the start.
        value: f64,
        /// The lower end.
        from: f64,
        /// The upper end.
        to: f64,
    },
    /// The source does not solve along the plane.
    #[error("the source moves {}, and the plane has {} and {}", moved.join(", "), sides[0], sides[1])]
    OtherPlane {
        /// The parameters that its path moves.
        moved: Vec<String>,
        /// Those of the plane.
        sides: [String; 2],
    },
    /// There is no zero of the indicator at the start.
    #[error("no zero of the indicator was found near the start: {reason}")]
    NoStart {
        /// Why.
        reason: String,
    },
    /// The density is sampled, and its samples leave the indicator at the start too uncertain to be followed.
    #[error("there are too few samples to tell where the curve passes the start")]
    TooFewSamples,
    /// The source refuses to work.
    #[error(transparent)]
    Source(#[from] SourceError),
}

/// A curve that is to be followed: of what, in which plane, from where, and how.
#[derive(Clone, Copy)]
struct Task<'a> {
    source: &'a dyn DensitySource,
    plane: &'a Plane,
    detector: &'a dyn Detector,
    start: &'a CurveStart,
    options: &'a CurveOptions,
    cancellation: &'a Cancellation,
}

/// Follows the curve through a start in both directions, in the box of a plane along whose path `source` solves.
/// `observer` is told the values of every point as it is met.
///
/// Cancelled, the curve ends early, and says so.
///
/// # Errors
/// [`CurveError`] where the start is not in the box, or no zero of its indicator is near.
pub fn follow(
    source: &dyn DensitySource,
    plane: &Plane,
    detector: &dyn Detector,
    start: &CurveStart,
    options: &CurveOptions,
    cancellation: &Cancellation,
    observer: &mut dyn FnMut([f64; 2]),
) -> Result<Curve, CurveError> {
    let subject = source.subject();
    let observable = check_start(subject, plane, start)?;
    let task = Task {
        source,
        plane,
        detector,
        start,
        options,
        cancellation,
    };
    let mut walked = task.both_ways(observer)?;
    let (mut points, mut check_work) = task.judge(&walked);
    let mut broken = task.break_symmetry(&mut walked, &mut points, &mut check_work);
    // A zero beside which there is no curve is not one of a smooth indicator.
    if let [alone] = points.as_mut_slice()
        && matches!(
            alone.status(),
            BifurcationStatus::Located | BifurcationStatus::Unchecked
        )
        && broken.is_empty()
    {
        alone.doubts.insert(0, Doubt::NoCurve);
    }
    let found = task.search(&walked, &points, &mut check_work);
    let (degenerate, mut branches) = if companion::ends_there(start.kind) {
        (Vec::new(), degenerate::cut(&mut points, &mut walked, found))
    } else {
        degenerate::add(&mut points, &mut walked.start, found)
    };
    let folds = fold_end::Folds {
        kind: start.kind,
        observable: start.observable,
        plane,
        tolerance: options.tolerance,
        centre: walked.centre(),
        kinks: walked.kinks(),
    };
    branches.append(&mut broken);
    branches.extend(fold_end::add_ends(
        &mut points,
        &mut walked.ends,
        &mut walked.start,
        &folds,
    ));
    Ok(Curve {
        plane: plane.clone(),
        observable,
        kind: start.kind,
        start: walked.start,
        ends: label_ends(walked.ends, points.len()),
        points,
        degenerate,
        branches,
        work: walked.work,
        check_work,
    })
}

/// Refuses a start that is not in the box, or not of this source; gives its observable.
fn check_start(
    subject: &Subject,
    plane: &Plane,
    start: &CurveStart,
) -> Result<Observable, CurveError> {
    let sides = plane.sides();
    let names = sides.each_ref().map(|side| side.parameter.clone());
    let moved = subject.family.path().moved();
    if moved != names {
        return Err(CurveError::OtherPlane {
            moved: moved.to_vec(),
            sides: names,
        });
    }
    for (side, value) in sides.iter().zip(start.values) {
        if !(side.from..=side.to).contains(&value) {
            return Err(CurveError::Outside {
                parameter: side.parameter.clone(),
                value,
                from: side.from,
                to: side.to,
            });
        }
    }
    let observable = subject.observables.get(start.observable).copied();
    observable.ok_or_else(|| CurveError::NoStart {
        reason: "the source does not watch its density".to_owned(),
    })
}
