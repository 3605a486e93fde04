//! Curves in a plane of two parameters on which a number of the steady state, such as a mean time of first passage, is
//! at a level.
//!
//! A number has no derivatives by parameters: each point of the curve takes two values at least, one where the curve is
//! expected and one across it, and lies where the line through them is at the level.

use super::found::label_ends;
use super::level_number::{LevelNode, NumberSession, across, left_of};
use super::steps::{Expected, dot, steps};
use super::walk::{ACROSS, FAR, SHARP};
use super::walked::apart;
use super::{CurveEnd, CurveError, CurveOptions, CurvePoint, CurveWork, EndReason, Plane};
use crate::cancellation::Cancellation;
use crate::continuation::levels::{is_sampled, limit_of};
use crate::continuation::{DensitySource, Doubt, ErrorParts, SourceError};
use crate::system::MeasureLevel;

/// Shortest chord that tells the direction of the curve of a number that is sampled.
const CHORD: f64 = 0.08;

/// Least change of the slope across a curve that is reckoned with, relative and per length: what neighbouring points
/// show is small by chance where the slope is the same along the curve.
const LEAST_BEND: f64 = 2.0;

/// What the curve of a level is called, by its place among several.
pub(crate) fn level_name(index: usize) -> String {
    format!("L{}", index + 1)
}

/// A curve on which a number of the steady state is at a level.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelCurve {
    /// The number and its level.
    pub asked: MeasureLevel,
    /// Its points from end to end. Their indicator is the number less the level, or the logarithm of the ratio of both
    /// where that is larger than zero; they have no place in a density.
    pub points: Vec<CurvePoint>,
    /// The point at which it was begun, by its place.
    pub start: usize,
    /// Its ends: that of the first point and that of the last. A closed curve has one.
    pub ends: Vec<CurveEnd>,
    /// What following it took.
    pub work: CurveWork,
}

impl LevelCurve {
    /// What is where on it, such as `exit_mean = 1000`.
    pub fn words(&self) -> String {
        format!("{} = {}", self.asked.measure, self.asked.level)
    }

    /// Whether it was asked to stop before it was complete.
    pub fn is_interrupted(&self) -> bool {
        let mut ends = self.ends.iter();
        ends.any(|end| end.reason == EndReason::Interrupted)
    }
}

/// Follows the curve on which a number is at a level from a place where it is, in both directions, in the box of a
/// plane along whose path `source` solves. Where numbers are sampled, errors hold with this confidence. `observer` is
/// told the values of every point as it is met.
///
/// Cancelled, the curve ends early, and says so.
///
/// # Errors
/// [`CurveError`] where the number is not at its level near the start, or is unknown there.
pub fn follow_level(
    source: &dyn DensitySource,
    plane: &Plane,
    (start, asked): ([f64; 2], &MeasureLevel),
    (options, confidence): (&CurveOptions, f64),
    cancellation: &Cancellation,
    observer: &mut dyn FnMut([f64; 2]),
) -> Result<LevelCurve, CurveError> {
    let subject = source.subject();
    let walker = Walker {
        source,
        plane,
        asked,
        options,
        is_sampled: is_sampled(subject, asked),
        limit: limit_of(subject, asked, confidence),
        cancellation,
    };
    let (mut reader, first) = walker.begin(plane.place(start))?;
    observer(plane.values(first.foot));
    let (onward, last) = walker.one_way(&mut reader, &first, observer);
    let mut ends = vec![last];
    let (mut work, mut back) = (reader.work, Vec::new());
    if !matches!(ends[0], EndReason::Closed | EndReason::Interrupted) {
        // Afresh: what was solved last is at the other end.
        let mut reader = walker.reader(reader.is_ratio);
        plane.begin(first.foot);
        let before;
        (back, before) = walker.one_way(&mut reader, &first.turned(), observer);
        work.add(&reader.work);
        ends.insert(0, before);
    }
    let before = back.len();
    let back = back.iter().rev().map(LevelNode::turned);
    let met: Vec<LevelNode> = back.chain([first]).chain(onward).collect();
    Ok(LevelCurve {
        asked: asked.clone(),
        start: before,
        ends: label_ends(ends, met.len()),
        points: walker.points(&met),
        work,
    })
}

/// What is followed, and how.
struct Walker<'a> {
    source: &'a dyn DensitySource,
    plane: &'a Plane,
    asked: &'a MeasureLevel,
    options: &'a CurveOptions,
    /// Whether neighbouring values of the number differ by samples of their own.
    is_sampled: bool,
    /// How many of its errors are believed to hold the true one.
    limit: f64,
    cancellation: &'a Cancellation,
}

impl Walker<'_> {
    fn reader(&self, is_ratio: bool) -> NumberSession<'_> {
        NumberSession {
            session: self.source.open(self.cancellation),
            plane: self.plane,
            asked: self.asked,
            is_ratio,
            is_sampled: self.is_sampled,
            limit: self.limit,
            work: CurveWork::default(),
        }
    }

    /// The point of the curve at its start, its direction toward larger values of the second parameter.
    fn begin(&self, at: [f64; 2]) -> Result<(NumberSession<'_>, LevelNode), CurveError> {
        let refused = |reason: EndReason| match reason {
            EndReason::Interrupted => CurveError::Source(SourceError::Interrupted),
            EndReason::Sampling => CurveError::TooFewSamples,
            reason => CurveError::NoStart {
                reason: reason.words(self.plane),
            },
        };
        self.plane.begin(at);
        let mut reader = self.reader(self.asked.level > 0.0);
        let first = match reader.read(at) {
            Err(EndReason::NumberLost) if reader.is_ratio => {
                // It may be at its level without being larger than zero all around.
                reader.is_ratio = false;
                reader.read(at)
            }
            first => first,
        };
        let first = first.map_err(refused)?;
        let mut gradient = [0.0; 2];
        for (side, part) in gradient.iter_mut().enumerate() {
            let inward = if at[side] < 0.5 { 1.0 } else { -1.0 };
            let step = inward * reader.apart();
            let mut beside = at;
            beside[side] += step;
            *part = (reader.read(beside).map_err(refused)?.over - first.over) / step;
        }
        let steepness = gradient[0].hypot(gradient[1]);
        if !(steepness > 0.0 && steepness.is_finite()) {
            return Err(refused(EndReason::Singular));
        }
        let [x, y] = gradient.map(|part| part / steepness);
        let is_right = x > 0.0 || (x == 0.0 && y < 0.0);
        let (along, slope) = if is_right {
            ([-y, x], -steepness)
        } else {
            ([y, -x], steepness)
        };
        let border = (0..2).find(|&k| at[k] <= 0.0 || at[k] >= 1.0);
        let line = across(at, along, (border, slope), FAR);
        let met = reader.meet(&line, along).map_err(refused)?;
        Ok((reader, met))
    }

    /// The points after the start, in its direction, and why there are no more.
    fn one_way(
        &self,
        reader: &mut NumberSession<'_>,
        start: &LevelNode,
        observer: &mut dyn FnMut([f64; 2]),
    ) -> (Vec<LevelNode>, EndReason) {
        let bends = !self.is_sampled;
        let mut next = |nodes: &[LevelNode], expected: Expected| {
            let here = nodes.last().unwrap_or(start);
            let mut node = self.next(reader, here, expected)?;
            if self.is_sampled {
                let is_far = |one: &&LevelNode| apart(one.foot, node.foot) >= CHORD;
                node.smooth(here, nodes.iter().rev().find(is_far).unwrap_or(start));
            }
            Ok((node, true))
        };
        let mut seen = |node: &LevelNode| {
            observer(self.plane.values(node.foot));
            None
        };
        steps(start, (self.options, bends), &mut next, &mut seen)
    }

    /// The point of the curve near where it is expected, or why it is not there.
    fn next(
        &self,
        reader: &mut NumberSession<'_>,
        here: &LevelNode,
        Expected { at, border, step }: Expected,
    ) -> Result<LevelNode, EndReason> {
        let length = apart(at, here.foot);
        // The chord is the tangent in the middle of the step.
        let ahead = |to: [f64; 2]| {
            let length = apart(to, here.foot);
            let ahead = [0, 1].map(|k| 2.0 * (to[k] - here.foot[k]) / length - here.along[k]);
            let size = ahead[0].hypot(ahead[1]);
            ahead.map(|part| part / size)
        };
        if length <= 0.0 {
            return Err(EndReason::NotConverged);
        }
        let line = across(at, ahead(at), (border, here.slope), 0.5 * step);
        let mut met = reader.meet(&line, ahead(at))?;
        let onward = [0, 1].map(|k| met.foot[k] - here.foot[k]);
        met.along = ahead(met.foot);
        met.arclength = here.arclength + apart(met.foot, here.foot);
        let is_sharp = !self.is_sampled && dot(met.along, here.along) < SHARP;
        let turns = is_sharp || dot(onward, here.along) <= 0.0;
        let keeps_side = met.slope * here.slope > 0.0;
        match turns || !keeps_side {
            true if self.is_sampled => Err(EndReason::Sampling),
            true => Err(EndReason::NotConverged),
            false => Ok(met),
        }
    }

    /// The points with their errors.
    fn points(&self, all: &[LevelNode]) -> Vec<CurvePoint> {
        let sides = self.plane.sides();
        let point = |(index, met): (usize, &LevelNode)| {
            let steepness = met.slope.abs();
            let beside = index
                .checked_sub(1)
                .map_or_else(|| all.get(1), |k| all.get(k));
            let bend = beside.map_or(LEAST_BEND, |beside| {
                let change = (met.slope - beside.slope).abs();
                ACROSS * change / (steepness * apart(met.foot, beside.foot))
            });
            let bend = bend.max(LEAST_BEND);
            // Half of the bend is what the secant leaves; that beside is not quite that here, and counts twice.
            let (own, line) = (met.read.error / steepness, bend * met.spread);
            let (solver, sampling) = match self.is_sampled {
                true => (line, own),
                false => (own + line, 0.0),
            };
            let parts = ErrorParts {
                solver,
                grid: 0.0,
                sampling,
                leak: 0.0,
            };
            let error = parts.total();
            let imprecise = error > self.options.tolerance;
            let known = imprecise.then_some(match self.is_sampled {
                true => Doubt::FewSamples(error),
                false => Doubt::SolverError(error),
            });
            let judged = (!met.read.is_judged).then_some(Doubt::CheckMissing);
            let uphill = left_of(met.along).map(|part| part * met.slope.signum());
            CurvePoint {
                values: self.plane.values(met.foot),
                error,
                parts,
                to_edge: [0, 1].map(|k| error * uphill[k] * sides[k].length()),
                indicator: met.read.over,
                gradient: [0, 1].map(|k| steepness * uphill[k] / sides[k].length()),
                place: Vec::new(),
                arclength: met.arclength,
                tangent: [0, 1].map(|k| met.along[k] * sides[k].length()),
                checked: met.read.is_judged,
                doubts: (met.read.doubt.clone().into_iter())
                    .chain(known)
                    .chain(judged)
                    .collect(),
            }
        };
        all.iter().enumerate().map(point).collect()
    }
}
