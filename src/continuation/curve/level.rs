//! Curves in a plane of two parameters on which a number of the steady state, such as a mean time of first passage, is
//! at a level.
//!
//! A number has no derivatives by parameters: each point of the curve takes two values at least, one where the curve is
//! expected and one across it, and lies where the line through them is at the level.

use super::found::label_ends;
use super::walk::{
    ACROSS, CLOSE, FAR, FEWEST_CLOSED, GENTLE, GROWTH, MOST_CORRECTIONS, SHARP, SHORTEST,
    WITHIN_NOISE, dot, nearest_side, passes, predict,
};
use super::walked::{apart, within};
use super::{CurveEnd, CurveError, CurveOptions, CurvePoint, CurveWork, EndReason, Plane};
use crate::cancellation::Cancellation;
use crate::continuation::levels::{is_sampled, limit_of, measure_of, over};
use crate::continuation::{DensitySource, Doubt, ErrorParts, Session, SourceError};
use crate::system::MeasureLevel;

/// Distance of the two places of a point at least, and of numbers that are sampled; sides of the box have length one.
const APART: f64 = 5e-4;
const APART_SAMPLED: f64 = 0.04;

/// Of numbers that are sampled: shortest chord that tells the direction of the curve, and the share that a point has in
/// the slope, the rest being that of the points before.
const CHORD: f64 = 0.08;
const NEW: f64 = 0.3;

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
    let walker = Walker {
        source,
        plane,
        asked,
        options,
        confidence,
        cancellation,
    };
    let (mut reader, first) = walker.begin(plane.place(start))?;
    observer(plane.values(first.foot));
    let (mut onward, last) = walker.one_way(&mut reader, &first, observer);
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
    let back = back.iter().rev().map(Met::turned);
    let met: Vec<Met> = back.chain([first]).chain(onward.drain(..)).collect();
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
    confidence: f64,
    cancellation: &'a Cancellation,
}

/// A point as it was met, in the box with sides of length one.
#[derive(Debug, Clone)]
struct Met {
    foot: [f64; 2],
    /// Toward rising arclength, of length one.
    along: [f64; 2],
    /// Change of the number per length to the left of that direction.
    slope: f64,
    arclength: f64,
    /// The two places that it lies between, or beside: the product of its distances from them.
    spread: f64,
    read: Read,
}

/// The number at a place.
#[derive(Debug, Clone)]
struct Read {
    over: f64,
    error: f64,
    is_judged: bool,
    doubt: Option<Doubt>,
}

/// A session with the number that is read in it.
struct Reader<'a> {
    session: Box<dyn Session>,
    walker: &'a Walker<'a>,
    is_ratio: bool,
    /// Whether neighbouring values differ by samples of their own.
    is_noisy: bool,
    /// How many errors of the number are believed to hold the true one.
    limit: f64,
    work: CurveWork,
}

/// A straight line on which a point of the curve is looked for.
#[derive(Clone, Copy)]
struct Line {
    from: [f64; 2],
    /// Of length one.
    direction: [f64; 2],
    /// Change of the number per length, as far as it is known.
    slope: f64,
    farthest: f64,
}

impl Line {
    fn at(&self, length: f64) -> [f64; 2] {
        [0, 1].map(|k| self.from[k] + length * self.direction[k])
    }
}

impl Met {
    /// Takes the direction from a point far behind, which samples tell better than the one before, and as much of the
    /// slope there as is known by more than this point.
    fn smooth(&mut self, before: &Self, far: &Self) {
        let chord = [0, 1].map(|k| self.foot[k] - far.foot[k]);
        let length = chord[0].hypot(chord[1]);
        if length > 0.0 {
            self.along = chord.map(|part| part / length);
        }
        self.slope = before.slope + NEW * (self.slope - before.slope);
    }

    /// The same seen from the other end of the curve.
    fn turned(&self) -> Self {
        Self {
            along: self.along.map(|part| -part),
            slope: -self.slope,
            arclength: -self.arclength,
            ..self.clone()
        }
    }
}

/// The direction to the left of another one.
fn left_of([x, y]: [f64; 2]) -> [f64; 2] {
    [-y, x]
}

impl Walker<'_> {
    fn reader(&self, is_ratio: bool) -> Reader<'_> {
        let subject = self.source.subject();
        Reader {
            session: self.source.open(self.cancellation),
            walker: self,
            is_ratio,
            is_noisy: is_sampled(subject, self.asked),
            limit: limit_of(subject, self.asked, self.confidence),
            work: CurveWork::default(),
        }
    }

    /// The point of the curve at its start, its direction toward larger values of the second parameter.
    fn begin(&self, at: [f64; 2]) -> Result<(Reader<'_>, Met), CurveError> {
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
        reader: &mut Reader<'_>,
        start: &Met,
        observer: &mut dyn FnMut([f64; 2]),
    ) -> (Vec<Met>, EndReason) {
        let mut nodes: Vec<Met> = Vec::new();
        let mut bend = [0.0; 2];
        let longest = self.options.largest_step;
        let mut step = 0.5 * longest;
        loop {
            let here = nodes.last().unwrap_or(start);
            if nodes.len() >= self.options.most_points {
                return (nodes, EndReason::TooManyPoints);
            }
            let Some((at, border)) = predict((here.foot, here.along), bend, step) else {
                let side = nearest_side(here.foot);
                return (nodes, EndReason::Border(side));
            };
            match self.next(reader, here, (at, border), step) {
                Ok(mut node) => {
                    if reader.is_noisy {
                        let far = nodes
                            .iter()
                            .rev()
                            .find(|one| apart(one.foot, node.foot) >= CHORD);
                        node.smooth(here, far.unwrap_or(start));
                    }
                    let length = apart(node.foot, here.foot);
                    let is_gentle = dot(node.along, here.along) > GENTLE;
                    if !reader.is_noisy {
                        bend = [0, 1].map(|k| (node.along[k] - here.along[k]) / length);
                    }
                    observer(self.plane.values(node.foot));
                    let is_closed =
                        nodes.len() >= FEWEST_CLOSED && passes(here.foot, node.foot, start.foot);
                    if is_closed {
                        let arclength = here.arclength + apart(here.foot, start.foot);
                        let last = Met {
                            arclength,
                            ..start.clone()
                        };
                        nodes.push(last);
                        return (nodes, EndReason::Closed);
                    }
                    nodes.push(node);
                    if let Some(side) = border {
                        return (nodes, EndReason::Border(side));
                    }
                    if is_gentle {
                        step = (GROWTH * step).min(longest);
                    }
                }
                Err(EndReason::Interrupted) => return (nodes, EndReason::Interrupted),
                Err(reason) => {
                    step *= 0.5;
                    if step < SHORTEST * longest {
                        return (nodes, reason);
                    }
                }
            }
        }
    }

    /// The point of the curve near where it is expected, or why it is not there.
    fn next(
        &self,
        reader: &mut Reader<'_>,
        here: &Met,
        (at, border): ([f64; 2], Option<usize>),
        step: f64,
    ) -> Result<Met, EndReason> {
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
        let is_sharp = !reader.is_noisy && dot(met.along, here.along) < SHARP;
        let turns = is_sharp || dot(onward, here.along) <= 0.0;
        let keeps_side = met.slope * here.slope > 0.0;
        match turns || !keeps_side {
            true if reader.is_noisy => Err(EndReason::Sampling),
            true => Err(EndReason::NotConverged),
            false => Ok(met),
        }
    }

    /// The points with their errors.
    fn points(&self, all: &[Met]) -> Vec<CurvePoint> {
        let sides = self.plane.sides();
        let is_noisy = is_sampled(self.source.subject(), self.asked);
        let point = |(index, met): (usize, &Met)| {
            let steepness = met.slope.abs();
            let beside = index
                .checked_sub(1)
                .map_or_else(|| all.get(1), |k| all.get(k));
            let bend = beside.map_or(LEAST_BEND, |beside| {
                let change = (met.slope - beside.slope).abs();
                ACROSS * change / (steepness * apart(met.foot, beside.foot))
            });
            let bend = bend.max(LEAST_BEND);
            let (own, line) = (met.read.error / steepness, 0.5 * bend * met.spread);
            let (solver, sampling) = match is_noisy {
                true => (0.0, own),
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
            let known = imprecise.then_some(match is_noisy {
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

/// The line across a curve at a place, along the end of a side of the box where the place is on it.
fn across(
    from: [f64; 2],
    along: [f64; 2],
    (border, slope): (Option<usize>, f64),
    farthest: f64,
) -> Line {
    let left = left_of(along);
    let Some(side) = border else {
        return Line {
            from,
            direction: left,
            slope,
            farthest,
        };
    };
    let mut direction = [0.0; 2];
    direction[1 - side] = 1.0;
    Line {
        from,
        direction,
        slope: slope * dot(left, direction),
        farthest,
    }
}

impl Reader<'_> {
    /// Distance of the two places of a point at least.
    fn apart(&self) -> f64 {
        if self.is_noisy { APART_SAMPLED } else { APART }
    }

    /// The number at a place.
    fn read(&mut self, at: [f64; 2]) -> Result<Read, EndReason> {
        let coordinate = self.walker.plane.lay(at);
        let solution = self
            .session
            .solve(coordinate)
            .map_err(|error| match error {
                SourceError::Interrupted => EndReason::Interrupted,
                SourceError::Method(error) => EndReason::NoDensity(error.to_string()),
            })?;
        let report = &solution.report;
        self.work.count(report);
        if !report.status.is_resolved() {
            return Err(EndReason::NoDensity(report.status.word().to_owned()));
        }
        let asked = self.walker.asked;
        let measure = measure_of(report, asked).ok_or(EndReason::NumberLost)?;
        if self.is_ratio && measure.value <= 0.0 {
            return Err(EndReason::NumberLost);
        }
        let (over, error) = over(measure, asked.level, self.is_ratio);
        Ok(Read {
            over,
            error: self.limit * error,
            is_judged: measure.error.is_some(),
            doubt: Doubt::of_status(report.status, None),
        })
    }

    /// The point of the curve on a line across it, which has this direction there.
    fn meet(&mut self, line: &Line, along: [f64; 2]) -> Result<Met, EndReason> {
        let mut before: Option<(f64, Read)> = None;
        let (mut slope, mut length) = (line.slope, 0.0);
        for _ in 0..MOST_CORRECTIONS {
            let read = self.read(line.at(length))?;
            if let Some((at, before)) = &before {
                slope = (read.over - before.over) / (length - at);
            }
            if !(slope != 0.0 && slope.is_finite()) {
                return Err(EndReason::Singular);
            }
            let gap = -read.over / slope;
            let root = length + gap;
            if root.abs() > line.farthest.max(self.apart()) {
                break;
            }
            let noise = WITHIN_NOISE * read.error / slope.abs();
            let is_near = gap.abs() <= self.apart().max(if self.is_noisy { noise } else { 0.0 });
            if let Some((at, _)) = before.as_ref().filter(|_| is_near) {
                let spread = (root - at).abs() * gap.abs();
                let foot = line.at(root).map(|part| part.clamp(0.0, 1.0));
                // What is on the curve to rounding has no slope of its own to be known better by.
                let slope = slope / dot(left_of(along), line.direction);
                return Ok(Met {
                    foot,
                    along,
                    slope,
                    arclength: 0.0,
                    spread,
                    read,
                });
            }
            before = Some((length, read));
            length = self.beside(line, length, gap);
        }
        match self.is_noisy {
            true => Err(EndReason::Sampling),
            false => Err(EndReason::NotConverged),
        }
    }

    /// Where the number is read next: where its level is expected, or farther, so that the two places tell its slope.
    fn beside(&self, line: &Line, length: f64, gap: f64) -> f64 {
        let least = self.apart().max(CLOSE);
        let step = gap.abs().max(least).copysign(gap);
        let there = length + step;
        if within(line.at(there)) {
            there
        } else {
            length - least.copysign(gap)
        }
    }
}
