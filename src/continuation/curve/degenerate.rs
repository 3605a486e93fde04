//! Points of a curve at which its indicator and a companion of it vanish together.
//!
//! At a degenerate split the curvature at a centre and the fourth derivative do: of the density at such a point only
//! terms of the sixth degree are left along one direction. On one side of it peaks leave the centre as it splits, on
//! the other side they are born away from it, in folds whose curve begins here and leaves along the curve of splits. At
//! a kink slope and curvature do, or the slopes on both of its sides, or the curvature along it. The point is found by
//! Newton's method on both in the plane, on the given cells and on finer ones.

use super::companion::meeting;
use super::found::DegeneratePoint;
use super::reading::{Reader, Reading};
use super::walked::{WalkPoint, Walked, apart, within};
use super::{CodimensionTwoKind, CurvePoint, CurveStart, CurveWork, EndReason, Task};
use crate::continuation::grid::share_of_distance;
use crate::continuation::locate::QUIET;
use crate::continuation::{CheckedBy, DensitySource, Doubt, ErrorParts, SourceError, Want};
use crate::topology::{Indicator, IndicatorKind};

/// Most steps of Newton's method.
const MOST_STEPS: usize = 8;
/// A step shorter than this ends it, in sides of the box: the next one is its square.
const SETTLED: f64 = 1e-5;
/// Farthest that the point may be from where the companion changes its sign.
const FAR: f64 = 0.05;

/// Two neighbouring points between which a companion changes its sign.
pub(super) struct SignChange {
    between: (usize, usize),
    kind: CodimensionTwoKind,
    /// The point, and where another curve passes that begins there; `None` where it was not found.
    point: Option<(CurvePoint, Option<CurveStart>)>,
}

/// Puts such points among those of their curve; gives them with their labels, and where the curves pass that begin
/// there. `start` is the place of the curve's start.
pub(super) fn add(
    points: &mut Vec<CurvePoint>,
    start: &mut usize,
    found: Vec<SignChange>,
) -> (Vec<DegeneratePoint>, Vec<CurveStart>) {
    let (mut degenerate, mut branches) = (Vec::<DegeneratePoint>::new(), Vec::new());
    for found in found {
        let Some((point, branch)) = found.point else {
            continue;
        };
        // Those before it are among the points already.
        let place = (found.between.1 + degenerate.len()).min(points.len());
        points.insert(place, point);
        *start += usize::from(place <= *start);
        let before = degenerate.iter().filter(|one| one.kind == found.kind);
        degenerate.push(DegeneratePoint {
            label: format!("{}{}", found.kind.prefix(), before.count() + 1),
            kind: found.kind,
            point: place,
        });
        branches.extend(branch);
    }
    (degenerate, branches)
}

/// Ends a curve at the points of codimension two on either side of its start, beyond which nothing happens on its line;
/// gives where the curves pass that begin there.
pub(super) fn cut(
    points: &mut Vec<CurvePoint>,
    walked: &mut Walked,
    found: Vec<SignChange>,
) -> Vec<CurveStart> {
    let mut branches = Vec::new();
    // From behind, so that places before stay.
    for found in found.into_iter().rev() {
        let (from, to) = found.between;
        let is_last = from >= walked.start;
        let end = match is_last {
            true => walked.ends.last_mut(),
            false => walked.ends.first_mut(),
        };
        let (Some(end), true) = (end, to < points.len()) else {
            continue;
        };
        let point = found.point.map(|(point, branch)| {
            branches.extend(branch);
            *end = match found.kind {
                CodimensionTwoKind::KinkCorner => EndReason::KinkCorner,
                _ => EndReason::DegenerateKink,
            };
            point
        });
        if is_last {
            points.truncate(to);
            points.extend(point);
        } else {
            let added = usize::from(point.is_some());
            points.splice(..to, point);
            walked.start = walked.start + added - to;
        }
    }
    branches
}

/// Where both vanish, with their errors there.
pub(super) struct Both {
    pub(super) at: [f64; 2],
    pub(super) reading: Reading,
    pub(super) companion: Indicator,
    pub(super) companion_reading: Reading,
    /// How far the place is off by the solver, and by what a rougher reconstruction changes.
    solver: f64,
    own: f64,
}

impl Task<'_> {
    /// The points of codimension two of a curve, in its order; `judged` are its points as far as they are checked.
    pub(super) fn search(
        &self,
        walked: &Walked,
        judged: &[CurvePoint],
        work: &mut CurveWork,
    ) -> Vec<SignChange> {
        let start = self.start;
        let kinds = (start.kind.traits().companions)(start.place.len());
        let mut found: Vec<SignChange> = Vec::new();
        for (index, kind) in kinds.into_iter().enumerate() {
            let nodes = walked.points.iter().enumerate();
            let known = nodes.filter_map(|(place, node)| {
                let value = node.reading.companions.get(index).copied().flatten();
                Some((place, value?))
            });
            let known: Vec<(usize, f64)> = known.collect();
            for pair in known.windows(2) {
                let [(from, a), (to, b)] = *pair else {
                    continue;
                };
                if (a > 0.0) == (b > 0.0) || self.cancellation.is_cancelled() {
                    continue;
                }
                found.push(SignChange {
                    between: (from, to),
                    kind: meeting(kind),
                    point: self.point((walked, judged), kind, [(from, a), (to, b)], work),
                });
            }
        }
        found.sort_by_key(|one| one.between);
        found
    }

    /// The point between two places where a companion has different signs, and where another curve passes that begins
    /// there.
    fn point(
        &self,
        (walked, judged): (&Walked, &[CurvePoint]),
        kind: IndicatorKind,
        [(from, a), (to, b)]: [(usize, f64); 2],
        work: &mut CurveWork,
    ) -> Option<(CurvePoint, Option<CurveStart>)> {
        let (before, after) = (&walked.points[from], &walked.points[to]);
        let share = a / (a - b);
        let near = [0, 1].map(|k| (1.0 - share) * before.foot[k] + share * after.foot[k]);
        let (point, both) = self.locate(kind, near, before, judged.get(from)?, work)?;
        let away: Vec<usize> = match a > 0.0 {
            true => (0..=from).rev().collect(),
            false => (to..walked.points.len()).collect(),
        };
        let branch = self.branch(meeting(kind), (walked, &away), (&point, &both), work);
        Some((point, branch))
    }

    /// The point near a place, on the finer cells where there are any.
    fn locate(
        &self,
        kind: IndicatorKind,
        near: [f64; 2],
        from: &WalkPoint,
        judged: &CurvePoint,
        work: &mut CurveWork,
    ) -> Option<(CurvePoint, Both)> {
        let coarse = self.newton(self.source, kind, near, work)?;
        let want = Want::densities(&self.source.subject().observables);
        let fine = self.on_finer_cells(&want, (kind, coarse.at), work);
        let leaks = coarse.companion_reading.edge_mass > QUIET;
        let enclosed = self.source.enclosed(&want).filter(|_| leaks);
        let enclosed =
            enclosed.and_then(|source| self.newton(source.as_ref(), kind, coarse.at, work));
        let leak = enclosed.map_or(0.0, |enclosed| apart(enclosed.at, coarse.at));
        let of_distance = share_of_distance(self.source.subject().cell_check, true);
        let (at, grid) = match &fine {
            Ok(fine) => (fine.at, of_distance * apart(fine.at, coarse.at)),
            Err(_) => (coarse.at, coarse.own),
        };
        let parts = ErrorParts {
            solver: coarse.solver + SETTLED * SETTLED,
            grid,
            sampling: 0.0,
            leak: leak.max(judged.parts.leak),
        };
        let error = parts.total();
        let reading = &coarse.reading;
        let (sides, uphill) = (self.plane.sides(), reading.uphill());
        let mut tangent = reading.tangent();
        if tangent[0] * from.tangent[0] + tangent[1] * from.tangent[1] < 0.0 {
            tangent = tangent.map(|part| -part);
        }
        let checked = fine.is_ok();
        let (check, unchecked) = match fine {
            Ok(_) => (None, None),
            Err(doubt @ (Doubt::GridCheckOff | Doubt::CheckMissing)) => (None, Some(doubt)),
            Err(doubt) => (Some(doubt), None),
        };
        let against = coarse.companion_reading.against(true);
        let point = CurvePoint {
            values: self.plane.values(at),
            error,
            parts,
            to_edge: [0, 1].map(|k| error * uphill[k] * sides[k].length()),
            indicator: reading.indicator.value,
            gradient: [0, 1].map(|k| reading.gradient[k] / sides[k].length()),
            place: reading.indicator.place.clone(),
            arclength: from.arclength + apart(coarse.at, from.foot),
            tangent: [0, 1].map(|k| tangent[k] * sides[k].length()),
            checked,
            doubts: reading.doubts(self, (check, unchecked), against, parts),
        };
        Some((point, coarse))
    }

    /// The point on finer cells; otherwise why they do not tell.
    fn on_finer_cells(
        &self,
        want: &Want,
        (kind, near): (IndicatorKind, [f64; 2]),
        work: &mut CurveWork,
    ) -> Result<Both, Doubt> {
        if self.options.check_every == 0 {
            return Err(Doubt::GridCheckOff);
        }
        match self.source.finer(want) {
            Ok(Some(source)) => self
                .newton(source.as_ref(), kind, near, work)
                .ok_or(Doubt::NotOnFinerCells),
            Ok(None) | Err(SourceError::Interrupted) => Err(Doubt::CheckMissing),
            Err(SourceError::Method(error)) => Err(Doubt::CheckFailed(
                CheckedBy::FinerCells(1),
                error.to_string(),
            )),
        }
    }

    /// The zero of the indicator and of a companion near a place.
    fn newton(
        &self,
        source: &dyn DensitySource,
        kind: IndicatorKind,
        near: [f64; 2],
        work: &mut CurveWork,
    ) -> Option<Both> {
        let mut reader = self.reader(source, self.start.kind);
        self.plane.begin(near);
        let found = self.steps(&mut reader, kind, near);
        work.add(&reader.work);
        found
    }

    fn steps(&self, reader: &mut Reader<'_>, kind: IndicatorKind, near: [f64; 2]) -> Option<Both> {
        let mut at = near;
        for _ in 0..MOST_STEPS {
            reader.kind = self.start.kind;
            let own = reader.read(at, &self.start.place).ok()?;
            reader.kind = kind;
            let companion = reader.read(at, &self.start.place).ok()?;
            let step =
                solve_pair([&own, &companion].map(|one| (one.gradient, -one.indicator.value)))?;
            at = [0, 1].map(|k| at[k] + step[k]);
            let size = step[0].hypot(step[1]);
            if apart(at, near) > FAR || !within(at) {
                return None;
            }
            if size <= SETTLED {
                // What errors of either derivative move the place by, both at their worst.
                let moved = |of: &dyn Fn(&Reading) -> f64| {
                    let first = solve_pair([(own.gradient, of(&own)), (companion.gradient, 0.0)]);
                    let second =
                        solve_pair([(own.gradient, 0.0), (companion.gradient, of(&companion))]);
                    let length =
                        |step: Option<[f64; 2]>| step.map_or(f64::INFINITY, |[x, y]| x.hypot(y));
                    length(first) + length(second)
                };
                return Some(Both {
                    at,
                    solver: moved(&|one| one.solver_error * one.indicator.sensitivity),
                    own: moved(&|one| one.indicator.systematic_error),
                    companion: companion.indicator.clone(),
                    companion_reading: companion,
                    reading: own,
                });
            }
        }
        None
    }
}

/// The solution of two linear equations in the plane, each a gradient and what it shall give; `None` where they do not
/// tell.
pub(super) fn solve_pair([(a, u), (b, v)]: [([f64; 2], f64); 2]) -> Option<[f64; 2]> {
    let determinant = a[0] * b[1] - a[1] * b[0];
    let step = [
        (u * b[1] - v * a[1]) / determinant,
        (v * a[0] - u * b[0]) / determinant,
    ];
    step.iter().all(|part| part.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_equations_are_solved() {
        assert_eq!(
            solve_pair([([2.0, 1.0], 5.0), ([1.0, -1.0], 1.0)]),
            Some([2.0, 1.0])
        );
        assert_eq!(solve_pair([([2.0, 1.0], 5.0), ([4.0, 2.0], 1.0)]), None);
    }
}
