//! Degenerate splits: points of a curve of splits at a centre where curvature and fourth derivative vanish together.
//!
//! Of the density at such a point only terms of the sixth degree are left along one direction. On one side of it peaks leave the centre as it splits, on the
//! other side they are born away from it, in folds whose curve begins here and leaves along the curve of splits. The point is found by Newton's method on both
//! derivatives in the plane, on the given cells and on finer ones.

use super::reading::{Reader, Reading};
use super::walk::{Node, Walked, apart, within};
use super::{CurvePoint, CurveStart, CurveWork, DegenerateSplit, Task};
use crate::continuation::grid::share_of_distance;
use crate::continuation::{BifurcationStatus, DensitySource, ErrorParts};
use crate::density::Density;
use crate::topology::IndicatorKind;

/// Most steps of Newton's method.
const MOST_STEPS: usize = 8;
/// A step shorter than this ends it, in sides of the box: the next one is its square.
const SETTLED: f64 = 1e-5;
/// Farthest that the point may be from where the fourth derivative changes its sign.
const FAR: f64 = 0.05;
/// Length along the curve at which the fold is looked for, where the two are told apart.
const LEAVES: f64 = 0.1;
/// Between centre and peak, the steepest place when the curvature at the centre is zero: √(3/5).
const STEEPEST: f64 = 0.77;
/// Cells about the centre among which no other peak is looked for.
const AT_CENTRE: f64 = 2.0;

/// What finds degenerate splits.
pub(super) struct Seeker<'a>(pub(super) Task<'a>);

/// A degenerate split.
pub(super) struct Found {
    /// The point after which it lies.
    pub(super) after: usize,
    pub(super) point: CurvePoint,
    /// Where the fold that begins there passes.
    pub(super) branch: Option<CurveStart>,
}

/// Puts degenerate splits among the points of their curve; gives them with their labels, and where the folds pass that begin there. `start` is the place of the
/// curve's start.
pub(super) fn add_splits(
    points: &mut Vec<CurvePoint>,
    start: &mut usize,
    splits: Vec<Found>,
) -> (Vec<DegenerateSplit>, Vec<CurveStart>) {
    let (mut degenerate, mut branches) = (Vec::new(), Vec::new());
    for (before, split) in splits.into_iter().enumerate() {
        // Those before it are among the points already.
        let place = (split.after + 1 + before).min(points.len());
        points.insert(place, split.point);
        *start += usize::from(place <= *start);
        degenerate.push(DegenerateSplit {
            label: format!("DS{}", before + 1),
            point: place,
        });
        branches.extend(split.branch);
    }
    (degenerate, branches)
}

/// Where both derivatives vanish, with their errors there.
struct Both {
    at: [f64; 2],
    curvature: Reading,
    /// How far the place is off by the solver, and by what a rougher reconstruction changes.
    solver: f64,
    own: f64,
}

impl Seeker<'_> {
    /// The degenerate splits of a curve, in its order; `judged` are its points as far as they are checked.
    pub(super) fn found(
        &self,
        walked: &Walked,
        judged: &[CurvePoint],
        work: &mut CurveWork,
    ) -> Vec<Found> {
        let quartics: Vec<Option<f64>> = walked
            .points
            .iter()
            .map(|node| node.reading.quartic)
            .collect();
        let mut found = Vec::new();
        for (after, pair) in quartics.windows(2).enumerate() {
            let [Some(a), Some(b)] = *pair else {
                continue;
            };
            if (a > 0.0) == (b > 0.0) || self.0.cancellation.is_cancelled() {
                continue;
            }
            let (from, to) = (&walked.points[after], &walked.points[after + 1]);
            let share = a / (a - b);
            let near = [0, 1].map(|k| (1.0 - share) * from.foot[k] + share * to.foot[k]);
            let Some(point) = self.located(near, from, &judged[after], work) else {
                continue;
            };
            let away = if a > 0.0 {
                (0..=after).rev().collect()
            } else {
                (after + 1..quartics.len()).collect::<Vec<_>>()
            };
            found.push(Found {
                after,
                branch: self.branch(walked, &away, point.arclength, work),
                point,
            });
        }
        found
    }

    /// The point near a place, on the finer cells where there are any.
    fn located(
        &self,
        near: [f64; 2],
        from: &Node,
        judged: &CurvePoint,
        work: &mut CurveWork,
    ) -> Option<CurvePoint> {
        let coarse = self.newton(self.0.source, near, work)?;
        let finer = match self.0.options.check_every {
            0 => None,
            _ => self.0.source.finer().ok().flatten(),
        };
        let fine = finer
            .as_ref()
            .map(|source| self.newton(source.as_ref(), coarse.at, work));
        let of_distance = share_of_distance(self.0.source.subject().cell_check);
        let (at, grid) = match &fine {
            Some(Some(fine)) => (fine.at, of_distance * apart(fine.at, coarse.at)),
            _ => (coarse.at, coarse.own),
        };
        let parts = ErrorParts {
            solver: coarse.solver + SETTLED * SETTLED,
            grid,
            sampling: 0.0,
            leak: judged.parts.leak,
        };
        let error = parts.total();
        let reading = &coarse.curvature;
        let (sides, uphill) = (self.0.plane.sides(), reading.uphill());
        let mut tangent = reading.tangent();
        if tangent[0] * from.tangent[0] + tangent[1] * from.tangent[1] < 0.0 {
            tangent = tangent.map(|part| -part);
        }
        let status = match fine {
            _ if error > self.0.options.tolerance => BifurcationStatus::Unresolved,
            Some(None) => BifurcationStatus::Unconfirmed,
            None if reading.is_diffused => BifurcationStatus::Unconfirmed,
            _ => BifurcationStatus::Located,
        };
        Some(CurvePoint {
            values: self.0.plane.values(at),
            error,
            parts,
            to_edge: [0, 1].map(|k| error * uphill[k] * sides[k].length()),
            indicator: reading.indicator.value,
            gradient: [0, 1].map(|k| reading.gradient[k] / sides[k].length()),
            place: reading.indicator.place.clone(),
            arclength: from.arclength + apart(coarse.at, from.foot),
            tangent: [0, 1].map(|k| tangent[k] * sides[k].length()),
            checked: matches!(fine, Some(Some(_))),
            status,
        })
    }

    /// The zero of both derivatives near a place.
    fn newton(
        &self,
        source: &dyn DensitySource,
        near: [f64; 2],
        work: &mut CurveWork,
    ) -> Option<Both> {
        let mut reader = self.reader(source, self.0.start.kind);
        self.0.plane.begin(near);
        let found = self.steps(&mut reader, near);
        work.add(&reader.work);
        found
    }

    fn steps(&self, reader: &mut Reader<'_>, near: [f64; 2]) -> Option<Both> {
        let mut at = near;
        for _ in 0..MOST_STEPS {
            reader.kind = self.0.start.kind;
            let curvature = reader.read(at, &self.0.start.place).ok()?;
            reader.kind = IndicatorKind::Quartic;
            let quartic = reader.read(at, &self.0.start.place).ok()?;
            let step =
                solved([&curvature, &quartic].map(|one| (one.gradient, -one.indicator.value)))?;
            at = [0, 1].map(|k| at[k] + step[k]);
            let size = step[0].hypot(step[1]);
            if apart(at, near) > FAR || !within(at) {
                return None;
            }
            if size <= SETTLED {
                // What errors of either derivative move the place by, both at their worst.
                let moved = |of: &dyn Fn(&Reading) -> f64| {
                    let first = solved([
                        (curvature.gradient, of(&curvature)),
                        (quartic.gradient, 0.0),
                    ]);
                    let second =
                        solved([(curvature.gradient, 0.0), (quartic.gradient, of(&quartic))]);
                    let length =
                        |step: Option<[f64; 2]>| step.map_or(f64::INFINITY, |[x, y]| x.hypot(y));
                    length(first) + length(second)
                };
                return Some(Both {
                    at,
                    solver: moved(&|one| one.solver_error * one.indicator.sensitivity),
                    own: moved(&|one| one.indicator.systematic_error),
                    curvature,
                });
            }
        }
        None
    }

    fn reader(&self, source: &dyn DensitySource, kind: IndicatorKind) -> Reader<'_> {
        let mut reader = Reader::new(
            source,
            self.0.plane,
            self.0.detector,
            self.0.start,
            self.0.cancellation,
        );
        reader.kind = kind;
        reader
    }

    /// Where the fold passes that begins at a degenerate split: beside the curve, on the side of it on which peaks stand away from the centre.
    fn branch(
        &self,
        walked: &Walked,
        away: &[usize],
        begins: f64,
        work: &mut CurveWork,
    ) -> Option<CurveStart> {
        let nodes = away.iter().map(|&index| &walked.points[index]);
        let nodes =
            nodes.take_while(|node| node.reading.quartic.is_some_and(|quartic| quartic > 0.0));
        let mut node = None;
        for one in nodes {
            node = Some(one);
            if (one.arclength - begins).abs() >= LEAVES {
                break;
            }
        }
        let node = node?;
        let centre = &self.0.start.place;
        let peak = peak_away(&node.reading.density, centre)?;
        let steepest = centre
            .iter()
            .zip(peak)
            .map(|(c, x)| c + STEEPEST * (x - c))
            .collect();
        let tried: Vec<(IndicatorKind, Vec<f64>)> = match centre.len() {
            1 => vec![(IndicatorKind::Shoulder { rising: true }, steepest)],
            _ => vec![
                (IndicatorKind::Ring, centre.clone()),
                (IndicatorKind::Fold, steepest),
            ],
        };
        let mut reader = self.reader(self.0.source, self.0.start.kind);
        self.0.plane.begin(node.foot);
        let found = tried.into_iter().find_map(|(kind, near)| {
            reader.kind = kind;
            let reading = reader.read(node.foot, &near).ok()?;
            Some(CurveStart {
                values: self.0.plane.values(node.foot),
                observable: self.0.start.observable,
                kind,
                place: reading.indicator.place,
            })
        });
        work.add(&reader.work);
        found
    }
}

/// The middle of the cell in which a density is largest, not at the centre; of a marginal on the upper side of it.
fn peak_away(density: &Density, centre: &[f64]) -> Option<Vec<f64>> {
    let axes = &density.axes;
    let columns = axes.get(1).map_or(1, crate::space::Axis::count);
    let place = |cell: usize| -> Vec<f64> {
        let first = axes[0].centre(cell / columns);
        let second = axes.get(1).map(|axis| axis.centre(cell % columns));
        std::iter::once(first).chain(second).collect()
    };
    let is_away = |place: &[f64]| {
        let cells = place.iter().zip(centre).zip(axes).map(|((x, c), axis)| {
            let cell = axis.find(*c).unwrap_or(0);
            (x - c) / axis.width(cell)
        });
        let cells: Vec<f64> = cells.collect();
        match cells.as_slice() {
            [along] => *along > AT_CENTRE,
            all => all.iter().any(|one| one.abs() > AT_CENTRE),
        }
    };
    let away = (0..density.values.len()).filter(|&cell| is_away(&place(cell)));
    let highest = away.max_by(|&a, &b| density.values[a].total_cmp(&density.values[b]))?;
    Some(place(highest))
}

/// The solution of two linear equations in the plane, each a gradient and what it shall give; `None` where they do not tell.
fn solved([(a, u), (b, v)]: [([f64; 2], f64); 2]) -> Option<[f64; 2]> {
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
            solved([([2.0, 1.0], 5.0), ([1.0, -1.0], 1.0)]),
            Some([2.0, 1.0])
        );
        assert_eq!(solved([([2.0, 1.0], 5.0), ([4.0, 2.0], 1.0)]), None);
    }
}
