//! Where the fold of a marginal ends inside the box: in a cusp, at a degenerate split of the centre, or at a kink. Its
//! last points tell, since both parameters are smooth functions of where the fold is in the density, through such a
//! point and beyond. Where they do not, points within a few cells of the centre are in doubt.

use super::CurveStart;
use super::cusp::cusp;
use super::found::{CurvePoint, EndReason};
use super::plane::Plane;
use super::polynomial::{evaluate, fit};
use super::tail::{Beyond, FAR, LONGEST, Tail};
use super::walked::{KinkAtEnd, apart};
use crate::continuation::{BifurcationStatus, Doubt, ErrorParts};
use crate::topology::IndicatorKind;
/// The same of an end at a kink, beside which a fold is not read.
const FAR_FROM_KINK: f64 = 0.15;
/// Where the error of such an end would be larger, nothing is said of it.
const MOST_VAGUE: f64 = 0.02;
/// Degree in the square of the distance from a centre.
const DEGREE: usize = 3;
/// Cells from a centre nearer than which a fold is not told from its mirror image: such points are left out where it
/// ends there.
const TOLD_APART: f64 = 6.0;
/// Cells from a kink nearer than which an inflection is not read from cells beside it.
const BESIDE_KINK: f64 = 2.0;
/// How far points may be off, over the root of the mean square of what polynomials leave of them.
const SCATTERS: f64 = 3.0;
/// A fold that ends at a centre or a kink comes nearer to it than this share of where the points that tell begin.
const NEAR: f64 = 0.5;

/// What is followed, and what its ends may be.
pub(super) struct Folds<'a> {
    pub(super) kind: IndicatorKind,
    /// Place of the observable in the subject.
    pub(super) observable: usize,
    pub(super) plane: &'a Plane,
    pub(super) tolerance: f64,
    /// Where the densities have their centre of symmetry, where all of them have it, and the width of the cells there.
    pub(super) centre: Option<(f64, f64)>,
    /// Where the slope of the densities jumps, at the first end and at the last.
    pub(super) kinks: [Vec<KinkAtEnd>; 2],
}

impl Folds<'_> {
    /// Whether a point is so near to the centre that cells do not tell it from its mirror image.
    fn is_unsure(&self, point: &CurvePoint) -> bool {
        let place = point.place.first().zip(self.centre);
        place.is_some_and(|(x, (centre, cell))| (x - centre).abs() < TOLD_APART * cell)
    }

    /// The end of a fold at a kink, if there is one: where the fold comes nearest to.
    fn at_kink(&self, inward: &[&CurvePoint], is_first: bool) -> Option<(Beyond, usize)> {
        let last = inward.first()?.place.first()?;
        let gap = |kink: &&KinkAtEnd| (kink.at - last).abs();
        let nearest = self.kinks[usize::from(!is_first)].iter();
        let kink = nearest.min_by(|a, b| gap(a).total_cmp(&gap(b)))?;
        let unsure = inward.iter().take_while(|point| {
            let place = point.place.first();
            place.is_some_and(|x| (x - kink.at).abs() < BESIDE_KINK * kink.cell)
        });
        let unsure = unsure.count();
        let tail = Tail::new(inward.get(unsure..)?, self.plane)?;
        Some((at_kink(&tail, kink, self.is_centre(kink))?, unsure))
    }

    /// Whether a kink lies on the centre of symmetry.
    fn is_centre(&self, kink: &KinkAtEnd) -> bool {
        let centre = self.centre;
        centre.is_some_and(|(centre, _)| (centre - kink.at).abs() < kink.cell)
    }
}

/// Adds the points in which a fold ends, as points of their own: `reasons` are those of its ends, `start` the place of
/// its start. Gives where other curves begin there.
pub(super) fn add_ends(
    points: &mut Vec<CurvePoint>,
    reasons: &mut [EndReason],
    start: &mut usize,
    folds: &Folds<'_>,
) -> Vec<CurveStart> {
    let mut branches = Vec::new();
    let Some(rising) = folds.kind.traits().rising else {
        return branches;
    };
    let count = reasons.len();
    for (index, reason) in reasons.iter_mut().enumerate() {
        let ends_here = matches!(
            reason,
            EndReason::NotConverged | EndReason::FeatureLost | EndReason::Singular
        );
        let is_first = index == 0 && count > 1;
        let inward: Vec<&CurvePoint> = if is_first {
            points.iter().collect()
        } else {
            points.iter().rev().collect()
        };
        let unsure = inward.iter().take_while(|point| folds.is_unsure(point));
        let unsure = unsure.count();
        let beyond = || {
            let mut kinks = folds.kinks.iter().flatten();
            let on_kink = kinks.any(|kink| folds.is_centre(kink));
            let smooth = folds.centre.filter(|_| !on_kink);
            let centre = smooth.and_then(|(centre, _)| {
                let (left_out, told) = inward.split_at_checked(unsure)?;
                let tail = Tail::new(told, folds.plane)?;
                Some((at_centre(&tail, centre, (left_out, folds.plane))?, unsure))
            });
            let cusp = || Some((cusp(&Tail::new(&inward, folds.plane)?, rising)?, 0));
            let kink = || folds.at_kink(&inward, is_first);
            let (found, left_out) = centre.or_else(kink).or_else(cusp)?;
            let last = inward.get(left_out)?;
            Some((point(&found, last, is_first, folds), found, left_out))
        };
        let Some((point, beyond, left_out)) = ends_here.then(beyond).flatten() else {
            if ends_here {
                doubt_end(points, (unsure, is_first));
            }
            continue;
        };
        let (at, kind, place) = beyond.branch;
        branches.push(CurveStart {
            values: folds.plane.values(at),
            observable: folds.observable,
            kind,
            place: vec![place],
        });
        *reason = beyond.reason.clone();
        let (from, scatter) = (point.arclength, beyond.scatter);
        if is_first {
            points.splice(..left_out, [point]);
            *start = (*start + 1).saturating_sub(left_out);
        } else {
            points.truncate(points.len() - left_out);
            *start = (*start).min(points.len());
            points.push(point);
        }
        let place = if is_first { 0 } else { points.len() - 1 };
        let near = points
            .iter_mut()
            .enumerate()
            .filter(|(index, one)| *index != place && (one.arclength - from).abs() <= LONGEST);
        near.for_each(|(_, one)| widen(one, scatter, folds.tolerance));
    }
    branches
}

/// Doubts the last points at an end whose place is not known: what was followed there may be the centre itself.
fn doubt_end(points: &mut [CurvePoint], (unsure, is_first): (usize, bool)) {
    let first = if is_first { 0 } else { points.len() - unsure };
    for point in &mut points[first..first + unsure] {
        if !point.doubts.contains(&Doubt::FewCellsApart) {
            point.doubts.push(Doubt::FewCellsApart);
        }
    }
}

/// A point with a part more of its error.
fn widen(point: &mut CurvePoint, part: f64, tolerance: f64) {
    let before = point.error;
    point.parts.grid += part;
    point.error = point.parts.total();
    if before > 0.0 {
        point.to_edge = point.to_edge.map(|edge| edge * point.error / before);
    }
    if point.error > tolerance {
        point.doubts.push(Doubt::Extrapolated(point.error));
    }
}

fn point(beyond: &Beyond, last: &CurvePoint, is_first: bool, folds: &Folds<'_>) -> CurvePoint {
    let sides = folds.plane.sides();
    let gap = apart(beyond.at, folds.plane.place(last.values));
    let (before, onward) = if is_first { (-gap, 1.0) } else { (gap, -1.0) };
    let across = [-beyond.leaves[1], beyond.leaves[0]];
    let is_of_cells = matches!(
        last.status(),
        BifurcationStatus::Unchecked | BifurcationStatus::Unconfirmed
    );
    let doubts = if is_of_cells {
        // What the points do not say of the cells, an end that follows from them does not say either.
        last.doubts.clone()
    } else if beyond.error > folds.tolerance {
        vec![Doubt::Extrapolated(beyond.error)]
    } else {
        Vec::new()
    };
    CurvePoint {
        values: folds.plane.values(beyond.at),
        error: beyond.error,
        parts: ErrorParts {
            solver: beyond.error,
            ..ErrorParts::default()
        },
        to_edge: [0, 1].map(|k| beyond.error * across[k] * sides[k].length()),
        indicator: 0.0,
        gradient: last.gradient,
        place: vec![beyond.place],
        arclength: last.arclength + before,
        tangent: [0, 1].map(|k| onward * beyond.leaves[k] * sides[k].length()),
        checked: false,
        doubts,
    }
}

/// Where a fold and its mirror image meet in the centre: both parameters are smooth functions of the square of the
/// distance from it. Points that are left out, since they are not told from their mirror images, say nothing of where
/// exactly that is, and show how near to it the fold was met.
fn at_centre(
    tail: &Tail<'_>,
    centre: f64,
    (left_out, plane): (&[&CurvePoint], &Plane),
) -> Option<Beyond> {
    let branch = (EndReason::DegenerateSplit, IndicatorKind::CURVATURE);
    let distance = |place: &f64| (place - centre).abs();
    let met = left_out.iter().filter_map(|point| point.place.first());
    let nearest = met.map(distance).fold(f64::INFINITY, f64::min);
    let found = meeting(tail, (centre, 2), nearest, branch)?;
    let met = left_out.iter().map(|point| plane.place(point.values));
    let met = met.chain(tail.values.first().copied());
    let gaps = met.map(|place| apart(found.at, place));
    let is_near = gaps.fold(f64::INFINITY, f64::min) <= FAR;
    (is_near && (left_out.is_empty() || found.error <= MOST_VAGUE)).then_some(found)
}

/// Where a fold comes to a kink: both parameters are smooth functions of the distance from it.
fn at_kink(tail: &Tail<'_>, beside: &KinkAtEnd, is_centre: bool) -> Option<Beyond> {
    let above = tail.places[0] > beside.at;
    let kind = if is_centre {
        IndicatorKind::KINK_SLOPE
    } else {
        // The kink is what it was before the pair on this side: the peak or valley that the other side says.
        IndicatorKind::beside_kink(above, beside.rises_away[usize::from(!above)])
    };
    let branch = (EndReason::DegenerateKink, kind);
    let found = meeting(tail, (beside.at, 1), f64::INFINITY, branch)?;
    let is_near = apart(found.at, tail.values[0]) <= FAR_FROM_KINK;
    (is_near && found.error <= MOST_VAGUE).then_some(found)
}

/// Where a fold meets a place in the density, both parameters being smooth functions of this power of its distance from
/// there; with the indicator whose curve passes there. Points that are no part of the tail may have come as near to it
/// as `met`.
fn meeting(
    tail: &Tail<'_>,
    (place, power): (f64, i32),
    met: f64,
    (reason, kind): (EndReason, IndicatorKind),
) -> Option<Beyond> {
    let distances = tail.places.iter().map(|x| (x - place).abs().powi(power));
    let distances: Vec<f64> = distances.collect();
    let (nearest, scale) = (distances[0], distances[distances.len() - 1]);
    let nearest = nearest.min(met.powi(power));
    let leaves = distances.windows(2).all(|pair| pair[1] > pair[0]);
    if !leaves || nearest > NEAR.powi(power) * scale {
        return None;
    }
    let scaled: Vec<f64> = distances.iter().map(|one| one / scale).collect();
    let found = Meeting::new(&scaled, &tail.values, DEGREE);
    let lower = Meeting::new(&scaled, &tail.values, DEGREE - 1);
    let quarter = scaled.len() / 4;
    let farther = Meeting::new(&scaled[quarter..], &tail.values[quarter..], DEGREE);
    let doubt = apart(found.at, lower.at) + apart(found.at, farther.at);
    let scatter = SCATTERS * found.scatter;
    Some(Beyond {
        reason,
        at: found.at,
        place,
        error: tail.largest_error() + 2.0 * doubt + scatter,
        scatter,
        leaves: found.leaves,
        branch: (found.at, kind, place),
    })
}

/// Both parameters where a power of the distance is zero.
struct Meeting {
    at: [f64; 2],
    leaves: [f64; 2],
    /// Root of the mean square of what the polynomials leave of the points.
    scatter: f64,
}

impl Meeting {
    fn new(distances: &[f64], values: &[[f64; 2]], degree: usize) -> Self {
        let fits = [0, 1].map(|k| {
            let values: Vec<f64> = values.iter().map(|value| value[k]).collect();
            fit(distances, &values, degree)
        });
        let both = fits.each_ref().map(|fit| evaluate(fit, 0.0));
        let slope = both.map(|one| one[1]);
        let length = slope[0].hypot(slope[1]);
        let left = distances.iter().zip(values).map(|(&distance, value)| {
            let off = [0, 1].map(|k| evaluate(&fits[k], distance)[0] - value[k]);
            off[0] * off[0] + off[1] * off[1]
        });
        Self {
            at: both.map(|one| one[0]),
            leaves: slope.map(|part| part / length),
            scatter: (left.sum::<f64>() / distances.len() as f64).sqrt(),
        }
    }
}
