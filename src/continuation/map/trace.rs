//! The curves of a map: from each crossing that no curve passes yet, one is followed, several side by side.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::crossing::{Blurred, Crossing};
use super::curve_line::{CurveLine, IDENTICAL};
use super::found::{Untraced, UntracedChange};
use super::starts::{is_alike, starts};
use super::{MapMaker, MapProgress};
use crate::continuation::SourceError;
use crate::continuation::curve::{
    Curve, CurveError, CurveOptions, CurveStart, CurveWork, EndReason, distance, follow,
};

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

impl Tracer<'_> {
    /// The curves, and what none explains; `work` grows by what they took.
    pub(super) fn trace(
        &self,
        mut open: Vec<Crossing>,
        blurred: Vec<Blurred>,
        work: &mut CurveWork,
    ) -> (Vec<Curve>, Vec<Untraced>) {
        let mut curves = Vec::new();
        let mut drawn: Vec<CurveLine> = Vec::new();
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
                    drawn.push(CurveLine {
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
                        drawn.push(CurveLine {
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
        let untraced = if self.maker.cancellation.is_cancelled() {
            Vec::new()
        } else {
            let mut untraced = self.without_curve(&drawn, &open, &failures, &blurred);
            untraced.extend(
                vague
                    .iter()
                    .map(|(start, reason)| self.vague(start, reason)),
            );
            untraced
        };
        (curves, untraced)
    }

    /// Where a curve starts from a point of codimension two that is not drawn and was not tried: it may be too narrow
    /// for the nodes to show.
    fn next_branch(
        &self,
        branches: &mut Vec<CurveStart>,
        tried: &mut Vec<CurveStart>,
        drawn: &[CurveLine],
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
    fn is_drawn(&self, drawn: &[CurveLine], start: &Crossing, curve: &Curve) -> bool {
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
            of: UntracedChange::Signature(start.observable),
            pairs: 1,
            near: self.maker.plane.values(start.at),
            reason: reason.to_owned(),
        }
    }

    /// Changes without a curve, one an observable and reason.
    fn without_curve(
        &self,
        drawn: &[CurveLine],
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
            let of = UntracedChange::Signature(observable);
            let known = found
                .iter_mut()
                .find(|one| one.of == of && one.reason == reason);
            if let Some(known) = known {
                known.pairs += 1;
                continue;
            }
            found.push(Untraced {
                of,
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
