//! The curves of a map: from each crossing that no curve passes yet, one is followed, several side by side.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::crossing::{Blurred, Crossing};
use super::found::Untraced;
use super::{MapMaker, MapProgress};
use crate::continuation::SourceError;
use crate::continuation::curve::{
    Curve, CurveError, CurveOptions, CurveStart, CurveWork, EndReason, ON_IT, distance, follow,
};
use crate::topology::IndicatorKind;

/// Starts of one indicator that may fail before its other crossings are not tried.
const MOST_FAILURES: usize = 4;
/// How far beyond its two nodes a crossing may be passed, as a share of their distance: errors of nodes and curve.
const BEYOND: f64 = 0.25;
/// Farthest from a curve that another one of its indicator may begin and be the same, in sides of the box.
const IDENTICAL: f64 = 1e-3;
/// How near a curve of another indicator must pass for a crossing to be the same change, in sides of the box.
const SAME: f64 = 4e-3;

/// What follows the curves of a map.
pub(super) struct Tracer<'a> {
    pub(super) maker: &'a MapMaker<'a>,
    pub(super) options: &'a CurveOptions,
}

/// Fewest points of a curve: with fewer its indicator exists on a single line of the plane, such as the one on which a
/// system is symmetric.
const FEWEST: usize = 3;
/// A curve whose middle error is larger is none that a map could show, in sides of the box.
const VAGUE: f64 = 0.05;

/// A curve as a line in the box with sides of length one.
struct Drawn {
    observable: usize,
    kind: IndicatorKind,
    line: Vec<[f64; 2]>,
}

impl Tracer<'_> {
    /// The curves, and what none explains; `work` grows by what they took.
    pub(super) fn trace(
        &self,
        mut open: Vec<Crossing>,
        blurred: Vec<Blurred>,
        work: &mut CurveWork,
    ) -> (Vec<Curve>, Vec<Untraced>) {
        let mut curves = Vec::new();
        let mut drawn: Vec<Drawn> = Vec::new();
        let mut failures: Vec<(Crossing, String)> = Vec::new();
        let mut vague: Vec<(Crossing, String)> = Vec::new();
        let mut branches: Vec<CurveStart> = Vec::new();
        let mut tried: Vec<CurveStart> = Vec::new();
        let met = AtomicUsize::new(0);
        while !self.maker.cancellation.is_cancelled() {
            open.retain(|crossing| !drawn.iter().any(|curve| curve.explains(crossing)));
            let starts = starts(&mut open, &failures);
            if starts.is_empty() {
                let Some(start) = self.next_branch(&mut branches, &mut tried, &drawn) else {
                    break;
                };
                let found = self.follow_from(&start, &met);
                add_work(work, &found);
                if let Ok(curve) = found
                    && curve.points.len() >= FEWEST
                    && middle_error(&curve) <= VAGUE
                {
                    drawn.push(Drawn {
                        observable: start.observable,
                        kind: start.kind,
                        line: self.line(&curve),
                    });
                    branches.extend(curve.branches.iter().cloned());
                    curves.push(curve);
                }
                continue;
            }
            let found = starts.par_iter().map(|start| self.follow(start, &met));
            let found: Vec<Result<Curve, CurveError>> = found.collect();
            for (start, found) in starts.into_iter().zip(found) {
                add_work(work, &found);
                match found {
                    Ok(_) if drawn.iter().any(|curve| curve.explains(&start)) => {}
                    Ok(curve) if self.is_drawn(&drawn, &start, &curve) => {}
                    Ok(curve) => {
                        let line = self.line(&curve);
                        drawn.push(Drawn {
                            observable: start.observable,
                            kind: start.kind,
                            line,
                        });
                        let error = middle_error(&curve);
                        if error > VAGUE {
                            let reason = format!(
                                "its curve is uncertain by {error:.1} of the sides of the box: the cells do not resolve it"
                            );
                            vague.push((start, reason));
                        } else if curve.points.len() >= FEWEST {
                            branches.extend(curve.branches.iter().cloned());
                            curves.push(curve);
                        } else if is_broken(&curve) {
                            let reason = "its curve was not met again beside the crossing";
                            vague.push((start, reason.to_owned()));
                        }
                    }
                    Err(CurveError::Source(SourceError::Interrupted)) => {}
                    Err(error) => failures.push((start, error.to_string())),
                }
            }
        }
        let untraced = match self.maker.cancellation.is_cancelled() {
            true => Vec::new(),
            false => {
                let mut untraced = self.untraced(&drawn, &open, &failures, &blurred);
                untraced.extend(
                    vague
                        .iter()
                        .map(|(start, reason)| self.vague(start, reason)),
                );
                untraced
            }
        };
        (curves, untraced)
    }

    /// Where a curve starts from a point of codimension two that is not drawn and was not tried: it may be too narrow
    /// for the nodes to show.
    fn next_branch(
        &self,
        branches: &mut Vec<CurveStart>,
        tried: &mut Vec<CurveStart>,
        drawn: &[Drawn],
    ) -> Option<CurveStart> {
        branches.retain(|start| {
            let at = self.maker.plane.place(start.values);
            let is_drawn = drawn.iter().any(|curve| curve.has(start, at));
            let is_tried = tried.iter().any(|one| one.is_near(start, self.maker.plane));
            !is_drawn && !is_tried
        });
        let start = branches.pop()?;
        tried.push(start.clone());
        Some(start)
    }

    fn follow(&self, start: &Crossing, met: &AtomicUsize) -> Result<Curve, CurveError> {
        let begins = CurveStart {
            values: self.maker.plane.values(start.at),
            observable: start.observable,
            kind: start.kind,
            place: start.place.clone(),
        };
        self.follow_from(&begins, met)
    }

    fn follow_from(&self, begins: &CurveStart, met: &AtomicUsize) -> Result<Curve, CurveError> {
        let plane = self.maker.plane.afresh();
        let source = (self.maker.source)(&plane)?;
        let mut observer = |values: [f64; 2]| {
            let done = met.fetch_add(1, Ordering::Relaxed) + 1;
            (self.maker.observer)(&MapProgress::Met { values, done });
        };
        let (options, cancellation) = (self.options, self.maker.cancellation);
        let detector = self.maker.detector;
        follow(
            source.as_ref(),
            &plane,
            detector,
            begins,
            options,
            cancellation,
            &mut observer,
        )
    }

    /// Whether a curve that was followed from a crossing is one that is drawn already: beyond the end of a curve its
    /// crossings are not explained by it.
    fn is_drawn(&self, drawn: &[Drawn], start: &Crossing, curve: &Curve) -> bool {
        let begins = curve.points.get(curve.start);
        let at = begins.map(|point| self.maker.plane.place(point.values));
        let mut drawn = drawn.iter();
        at.is_some_and(|at| {
            drawn.any(|one| {
                let same = (one.observable, one.kind) == (start.observable, start.kind);
                same && distance(&one.line, at) <= IDENTICAL
            })
        })
    }

    fn line(&self, curve: &Curve) -> Vec<[f64; 2]> {
        let points = curve.points.iter();
        points
            .map(|point| self.maker.plane.place(point.values))
            .collect()
    }

    /// A change whose curve says too little.
    fn vague(&self, start: &Crossing, reason: &str) -> Untraced {
        Untraced {
            observable: start.observable,
            pairs: 1,
            near: self.maker.plane.values(start.at),
            reason: reason.to_owned(),
        }
    }

    /// Changes without a curve, one an observable and reason.
    fn untraced(
        &self,
        drawn: &[Drawn],
        open: &[Crossing],
        failures: &[(Crossing, String)],
        blurred: &[Blurred],
    ) -> Vec<Untraced> {
        const NO_INDICATOR: &str = "no indicator tells where between two nodes it changes";
        let is_open = |ends: &[[f64; 2]; 2], observable: usize| {
            let mut curves = drawn.iter().filter(|curve| curve.observable == observable);
            !curves.any(|curve| curve.passes(ends).is_some())
        };
        let mut pairs: Vec<(usize, [[f64; 2]; 2], &str)> = Vec::new();
        for (crossing, reason) in failures {
            pairs.push((crossing.observable, crossing.ends, reason));
        }
        pairs.extend(open.iter().map(|one| {
            let same = failures.iter().find(|failed| is_alike(&failed.0, one));
            let reason = same.map_or("its curve was not followed", |failed| &failed.1);
            (one.observable, one.ends, reason)
        }));
        pairs.extend(
            blurred
                .iter()
                .map(|one| (one.observable, one.ends, NO_INDICATOR)),
        );
        pairs.retain(|(observable, ends, _)| is_open(ends, *observable));
        let mut found: Vec<Untraced> = Vec::new();
        for (observable, [a, b], reason) in pairs {
            let known = found
                .iter_mut()
                .find(|one| one.observable == observable && one.reason == reason);
            if let Some(known) = known {
                known.pairs += 1;
                continue;
            }
            found.push(Untraced {
                observable,
                pairs: 1,
                near: self.maker.plane.values([0, 1].map(|k| 0.5 * (a[k] + b[k]))),
                reason: reason.to_owned(),
            });
        }
        found
    }
}

/// Adds what following and checking a curve took.
fn add_work(work: &mut CurveWork, found: &Result<Curve, CurveError>) {
    if let Ok(curve) = found {
        work.add(&curve.work);
        work.add(&curve.check_work);
    }
}

/// Takes one crossing of every indicator from those that are open: the middle one, away from ends of curves where they
/// turn and meet. An indicator that crosses only where another one of the same density does waits for that one's curve,
/// which is its own then.
fn starts(open: &mut Vec<Crossing>, failures: &[(Crossing, String)]) -> Vec<Crossing> {
    let mut kinds: Vec<(usize, IndicatorKind)> = Vec::new();
    for crossing in open.iter() {
        let key = (crossing.observable, crossing.kind);
        let failed = failures
            .iter()
            .filter(|failed| is_alike(&failed.0, crossing));
        if !kinds.contains(&key) && failed.count() < MOST_FAILURES {
            kinds.push(key);
        }
    }
    // What follows from the equations is known best, and asks for no checks.
    kinds.sort_by_key(|key| key.1 != IndicatorKind::KinkSlope);
    let all: Vec<Vec<Crossing>> = kinds.iter().map(|&key| of_kind(open, key)).collect();
    let mut taken: Vec<usize> = Vec::new();
    for number in 0..kinds.len() {
        let is_told = |one: &Crossing| {
            let others = taken.iter().flat_map(|&other| &all[other]);
            others.into_iter().any(|other| coincide(one, other))
        };
        if !all[number].iter().all(is_told) {
            taken.push(number);
        }
    }
    let middle = |&number: &usize| {
        let places = (0..open.len()).filter(|&index| key_of(&open[index]) == kinds[number]);
        places
            .collect::<Vec<_>>()
            .get(all[number].len() / 2)
            .copied()
    };
    let mut places: Vec<usize> = taken.iter().filter_map(middle).collect();
    let starts = places.iter().map(|&place| open[place].clone()).collect();
    places.sort_unstable();
    places.into_iter().rev().for_each(|place| {
        open.remove(place);
    });
    starts
}

fn key_of(crossing: &Crossing) -> (usize, IndicatorKind) {
    (crossing.observable, crossing.kind)
}

fn of_kind(open: &[Crossing], key: (usize, IndicatorKind)) -> Vec<Crossing> {
    let of_it = open.iter().filter(|one| key_of(one) == key);
    of_it.cloned().collect()
}

/// Whether crossings of two indicators of one density are in one place.
fn coincide(one: &Crossing, other: &Crossing) -> bool {
    let apart = (one.at[0] - other.at[0]).hypot(one.at[1] - other.at[1]);
    one.observable == other.observable && apart < SAME
}

fn is_alike(a: &Crossing, b: &Crossing) -> bool {
    a.observable == b.observable && a.kind == b.kind
}

impl Drawn {
    /// Whether a crossing is one with this curve.
    fn explains(&self, crossing: &Crossing) -> bool {
        if self.observable != crossing.observable {
            return false;
        }
        let passed = self.passes(&crossing.ends);
        let is_passed = passed.is_some_and(|at| {
            let apart = (at[0] - crossing.at[0]).hypot(at[1] - crossing.at[1]);
            self.kind == crossing.kind || apart < SAME
        });
        // Neighbours along a curve that runs through nodes have indicators of rounding's size, and of either sign.
        is_passed || distance(&self.line, crossing.at) <= IDENTICAL
    }

    /// Whether a start lies on this curve; `at` is its place in the box.
    fn has(&self, start: &CurveStart, at: [f64; 2]) -> bool {
        (self.observable, self.kind) == (start.observable, start.kind)
            && distance(&self.line, at) <= ON_IT
    }

    /// Where the curve passes between two nodes, or a little beyond them.
    fn passes(&self, ends: &[[f64; 2]; 2]) -> Option<[f64; 2]> {
        let [a, b] = *ends;
        let wider =
            |from: [f64; 2], to: [f64; 2]| [0, 1].map(|k| to[k] + BEYOND * (to[k] - from[k]));
        let (from, to) = (wider(b, a), wider(a, b));
        let mut pieces = self.line.windows(2);
        pieces.find_map(|piece| meeting([from, to], [piece[0], piece[1]]))
    }
}

/// Whether a curve ends for want of convergence, not of its feature.
fn is_broken(curve: &Curve) -> bool {
    let mut ends = curve.ends.iter();
    ends.any(|end| {
        matches!(
            end.reason,
            EndReason::NotConverged | EndReason::NoDensity(_)
        )
    })
}

/// The error that half of the points of a curve exceed.
fn middle_error(curve: &Curve) -> f64 {
    let mut errors: Vec<f64> = curve.points.iter().map(|point| point.error).collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied().unwrap_or(0.0)
}

/// Where two straight lines meet, if they do.
fn meeting([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let minus = |u: [f64; 2], v: [f64; 2]| [u[0] - v[0], u[1] - v[1]];
    let (first, second, gap) = (minus(b, a), minus(d, c), minus(c, a));
    let across = cross(first, second);
    let (along, beside) = (cross(gap, second) / across, cross(gap, first) / across);
    // Parallel lines give numbers that are no shares.
    let inside = (0.0..=1.0).contains(&along) && (-1e-9..=1.0 + 1e-9).contains(&beside);
    inside.then(|| [0, 1].map(|k| a[k] + along * first[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crossing(kind: IndicatorKind, x: f64, y: f64) -> Crossing {
        Crossing {
            observable: 0,
            kind,
            place: vec![0.0],
            at: [x, y],
            ends: [[x, y], [x, y + 0.1]],
        }
    }

    #[test]
    fn an_indicator_that_crosses_where_another_does_waits_for_it() {
        use IndicatorKind::{Curvature, KinkSlope, Quartic};
        let mut open: Vec<Crossing> = (0..5)
            .flat_map(|k| {
                let y = 0.2 * f64::from(k);
                [
                    crossing(Quartic, 0.3 + 1e-4, y),
                    crossing(KinkSlope, 0.3, y),
                    crossing(Curvature, 0.6, y),
                ]
            })
            .collect();
        let found = starts(&mut open, &[]);
        let kinds: Vec<IndicatorKind> = found.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [KinkSlope, Curvature]);
        assert!(found.iter().all(|one| one.at[1] == 0.4));
        assert_eq!(open.len(), 13);
        // Both neighbours lie on the curve itself: the line between them meets it nowhere, or everywhere.
        let curve = Drawn {
            observable: 0,
            kind: KinkSlope,
            line: vec![[0.3, 0.0], [0.3, 1.0]],
        };
        open.retain(|one| !curve.explains(one));
        assert_eq!(open.len(), 4);
        assert!(open.iter().all(|one| one.kind == Curvature));
    }

    #[test]
    fn lines_meet_where_they_cross() {
        let met = meeting([[0.0, 0.0], [1.0, 0.0]], [[0.25, -1.0], [0.25, 1.0]]);
        assert_eq!(met, Some([0.25, 0.0]));
        assert_eq!(
            meeting([[0.0, 0.0], [1.0, 0.0]], [[1.25, -1.0], [1.25, 1.0]]),
            None
        );
        assert_eq!(
            meeting([[0.0, 0.0], [1.0, 0.0]], [[0.0, 1.0], [1.0, 1.0]]),
            None
        );
    }
}
