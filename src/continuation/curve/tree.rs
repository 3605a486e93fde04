//! A curve and all that start from its points of codimension two.

use std::collections::VecDeque;

use super::agree::agree;
use super::walked::apart;
use super::{Curve, CurveError, CurveOptions, CurveStart, LevelCurve, Plane, follow};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource, SourceError};
use crate::topology::Detector;

/// A start nearer to a curve than this is on it, in sides of the box.
pub(in crate::continuation) const ON_IT: f64 = 0.01;

/// A point of a curve nearer to another one of the same indicator than this is on it.
const SAME_CURVE: f64 = 1e-3;

/// A curve that should start from a point of codimension two, and was not met.
#[derive(Debug, Clone, PartialEq)]
pub struct MissedBranch {
    /// Where it was looked for.
    pub start: CurveStart,
    /// Why there is none.
    pub reason: String,
}

/// Curves that hang together.
#[derive(Debug, Clone, Default)]
pub struct CurveTree {
    /// The curves, first the one that was asked for; each once. None where something else than a P-bifurcation was.
    pub curves: Vec<Curve>,
    /// The curve of a level, where that was asked for.
    pub levels: Vec<LevelCurve>,
    /// Those that were not met.
    pub missed: Vec<MissedBranch>,
}

/// Follows the curve through a start as [`follow`] does, and then, unless [`CurveOptions::branches`] is off, those that
/// start from its points of codimension two, and from theirs.
///
/// # Errors
/// [`CurveError`] where the first one cannot be followed.
pub fn follow_all(
    source: &dyn DensitySource,
    plane: &Plane,
    detector: &dyn Detector,
    start: &CurveStart,
    options: &CurveOptions,
    cancellation: &Cancellation,
    observer: &mut dyn FnMut([f64; 2]),
) -> Result<CurveTree, CurveError> {
    let mut trace = |start: &CurveStart| {
        follow(
            source,
            plane,
            detector,
            start,
            options,
            cancellation,
            observer,
        )
    };
    let first = trace(start)?;
    let mut open: VecDeque<CurveStart> = if options.branches {
        first.branches.iter().cloned().collect()
    } else {
        VecDeque::new()
    };
    let mut curves = vec![first];
    let mut missed = Vec::new();
    let mut tried: Vec<CurveStart> = Vec::new();
    let observable = |curve: &Curve| {
        let observables = &source.subject().observables;
        observables.iter().position(|&one| one == curve.observable)
    };
    while let Some(start) = open.pop_front() {
        let is_known =
            |curve: &Curve| observable(curve) == Some(start.observable) && curve.has(&start);
        let is_tried = tried.iter().any(|one| one.is_near(&start, plane));
        if cancellation.is_cancelled() || is_tried || curves.iter().any(is_known) {
            continue;
        }
        tried.push(start.clone());
        match trace(&start) {
            // Where a start was vague, it may lead to a curve that is there already.
            Ok(curve) if curves.iter().any(|known| known.passes_start_of(&curve)) => {}
            Ok(curve) => {
                open.extend(curve.branches.iter().cloned());
                curves.push(curve);
            }
            Err(CurveError::Source(SourceError::Interrupted)) => {}
            Err(error) => missed.push(MissedBranch {
                start,
                reason: error.to_string(),
            }),
        }
    }
    agree(&mut curves);
    Ok(CurveTree {
        curves,
        levels: Vec::new(),
        missed,
    })
}

impl CurveStart {
    /// Whether two starts are of one curve, as far as their places tell.
    pub(in crate::continuation) fn is_near(&self, other: &Self, plane: &Plane) -> bool {
        let [a, b] = [self, other].map(|one| plane.place(one.values));
        (self.observable, self.kind) == (other.observable, other.kind) && apart(a, b) <= ON_IT
    }
}

impl Curve {
    /// Whether another curve begins on this one, and is the same.
    fn passes_start_of(&self, other: &Self) -> bool {
        let Some(point) = other.points.get(other.start) else {
            return false;
        };
        let at = self.plane.place(point.values);
        let line = self.points.iter().map(|one| self.plane.place(one.values));
        let line: Vec<[f64; 2]> = line.collect();
        let is_same = (self.kind, self.observable) == (other.kind, other.observable);
        is_same && distance(&line, at) <= SAME_CURVE
    }

    /// Whether a start of the same observable is on this curve.
    pub(in crate::continuation) fn has(&self, start: &CurveStart) -> bool {
        let at = self.plane.place(start.values);
        let line = self
            .points
            .iter()
            .map(|point| self.plane.place(point.values));
        let line: Vec<[f64; 2]> = line.collect();
        self.kind == start.kind && distance(&line, at) <= ON_IT
    }
}

/// Distance of a place from a line of straight pieces.
pub(in crate::continuation) fn distance(line: &[[f64; 2]], at: [f64; 2]) -> f64 {
    let pieces = line.windows(2).map(|piece| {
        let [a, b] = [piece[0], piece[1]];
        let along = [b[0] - a[0], b[1] - a[1]];
        let gap = [at[0] - a[0], at[1] - a[1]];
        let length = along[0] * along[0] + along[1] * along[1];
        let share = if length > 0.0 {
            ((gap[0] * along[0] + gap[1] * along[1]) / length).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (gap[0] - share * along[0]).hypot(gap[1] - share * along[1])
    });
    pieces.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_from_lines_of_pieces() {
        let line = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert_eq!(distance(&line, [0.5, 0.25]), 0.25);
        assert_eq!(distance(&line, [1.5, 0.5]), 0.5);
        assert_eq!(distance(&line, [-3.0, 4.0]), 5.0);
    }
}
