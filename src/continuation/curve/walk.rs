//! Following a curve: predicted along tangent and curvature, corrected along the gradient, in steps as long as the
//! curve allows.

use super::reading::{NoReading, Reader, Reading};
use super::steps::{CLOSE, CurveNode, Expected, dot, steps};
use super::walked::{WalkPoint, Walked, apart};
use super::{CurveError, EndReason, Task, companion};
use crate::continuation::SourceError;
use crate::density::hellinger;

/// Of a sampled density a place is on the curve when it is nearer than this share of the sampling error there.
pub(super) const WITHIN_NOISE: f64 = 0.5;
/// Corrections of one point.
pub(super) const MOST_CORRECTIONS: usize = 6;
/// A correction that leaves more than this share of the distance does not converge.
const CONVERGING: f64 = 0.5;
/// Cosine of the angle between neighbouring tangents below which a step is halved.
pub(super) const SHARP: f64 = 0.906;
/// Farthest that the curve may be from where it is said to begin.
pub(super) const FAR: f64 = 0.05;
/// Places of an indicator at neighbouring points farther apart than this, in ranges of the axes, are not one place that
/// moved.
const ONE_PLACE: f64 = 0.1;
/// How many times as fast as along a curve its indicator's gradient may change across it.
pub(super) const ACROSS: f64 = 2.0;

impl Task<'_> {
    /// Both directions from the start.
    pub(super) fn both_ways(
        &self,
        observer: &mut dyn FnMut([f64; 2]),
    ) -> Result<Walked, CurveError> {
        let mut reader = self.reader(self.source, self.start.kind);
        let start = self.begin(&mut reader)?;
        observer(self.plane.values(start.foot));
        let (mut onward, last) = self.one_way(&mut reader, &start, observer);
        let mut work = reader.work;
        let mut ends = vec![last];
        let mut back = Vec::new();
        if !matches!(ends[0], EndReason::Closed | EndReason::Interrupted) {
            // Afresh: what was solved last is at the other end.
            let mut reader = self.reader(self.source, self.start.kind);
            self.plane.begin(start.reading.at);
            let mut turned = start.clone();
            turned.tangent = turned.tangent.map(|part| -part);
            let first;
            (back, first) = self.one_way(&mut reader, &turned, observer);
            work.add(&reader.work);
            ends.insert(0, first);
        }
        for node in &mut back {
            node.arclength = -node.arclength;
            node.tangent = node.tangent.map(|part| -part);
        }
        let before = back.len();
        let mut points: Vec<WalkPoint> = back.into_iter().rev().collect();
        points.push(start);
        points.append(&mut onward);
        Ok(Walked {
            points,
            start: before,
            ends,
            work,
        })
    }

    /// The point of the curve at its start, the tangent toward larger values of the second parameter.
    fn begin(&self, reader: &mut Reader<'_>) -> Result<WalkPoint, CurveError> {
        let at = self.plane.place(self.start.values);
        self.plane.begin(at);
        let border = (0..2).find(|&k| at[k] <= 0.0 || at[k] >= 1.0);
        let sought = Sought {
            near: &self.start.place,
            border,
            farthest: FAR,
            before: None,
        };
        let (mut node, _) = correct(reader, at, &sought).map_err(|reason| match reason {
            EndReason::Interrupted => CurveError::Source(SourceError::Interrupted),
            EndReason::Sampling => CurveError::TooFewSamples,
            reason => CurveError::NoStart {
                reason: reason.words(self.plane),
            },
        })?;
        let [x, y] = node.tangent;
        if y < 0.0 || (y == 0.0 && x < 0.0) {
            node.tangent = [-x, -y];
        }
        Ok(node)
    }

    /// The points after the start, in the direction of its tangent, and why there are no more.
    fn one_way(
        &self,
        reader: &mut Reader<'_>,
        start: &WalkPoint,
        observer: &mut dyn FnMut([f64; 2]),
    ) -> (Vec<WalkPoint>, EndReason) {
        let mut known = start.reading.companions.clone();
        let mut next = |nodes: &[WalkPoint], expected: Expected| {
            let here = nodes.last().unwrap_or(start);
            let sought = Sought {
                near: &here.reading.indicator.place,
                border: expected.border,
                farthest: 0.5 * expected.step,
                before: Some(here),
            };
            let (node, corrections) = correct(reader, expected.at, &sought)?;
            Ok((self.follows(here, node)?, corrections <= 1))
        };
        let mut seen = |node: &WalkPoint| {
            observer(self.plane.values(node.foot));
            let turned = companion::turn(&mut known, &node.reading.companions);
            // The last point is beyond the end, which lies between it and the one before.
            let ends = turned.is_some() && companion::ends_there(self.start.kind);
            ends.then_some(EndReason::FeatureLost)
        };
        steps(start, (self.options, true), &mut next, &mut seen)
    }

    /// The node as the next one of a curve, or why it is not.
    fn follows(&self, here: &WalkPoint, mut node: WalkPoint) -> Result<WalkPoint, EndReason> {
        let axes = &node.reading.density.axes;
        let places = here.reading.indicator.place.iter();
        let moved = places.zip(&node.reading.indicator.place).zip(axes);
        let moved = moved.map(|((a, b), axis)| ((a - b) / (axis.to() - axis.from())).abs());
        if moved.fold(0.0, f64::max) > ONE_PLACE {
            return Err(EndReason::FeatureLost);
        }
        if dot(node.tangent, here.tangent) < 0.0 {
            node.tangent = node.tangent.map(|part| -part);
        }
        let onward = [0, 1].map(|k| node.foot[k] - here.foot[k]);
        let turns = dot(node.tangent, here.tangent) < SHARP || dot(onward, here.tangent) <= 0.0;
        let distance = hellinger(&here.reading.density, &node.reading.density).unwrap_or(0.0);
        if turns || distance > self.options.largest_distance {
            return Err(not_met(&node.reading));
        }
        node.arclength = here.arclength + apart(node.foot, here.foot);
        Ok(node)
    }
}

impl CurveNode for WalkPoint {
    fn foot(&self) -> [f64; 2] {
        self.foot
    }
    fn tangent(&self) -> [f64; 2] {
        self.tangent
    }
    fn arclength(&self) -> f64 {
        self.arclength
    }
    fn at_arclength(&self, arclength: f64) -> Self {
        Self {
            arclength,
            ..self.clone()
        }
    }
}

/// What a correction looks for.
struct Sought<'a> {
    /// The indicator's place.
    near: &'a [f64],
    /// The side of the box along whose end to look.
    border: Option<usize>,
    /// Longest correction.
    farthest: f64,
    /// The point before.
    before: Option<&'a WalkPoint>,
}

/// The point of the curve near a place, and the number of corrections.
fn correct(
    reader: &mut Reader<'_>,
    mut at: [f64; 2],
    sought: &Sought<'_>,
) -> Result<(WalkPoint, usize), EndReason> {
    let mut last = f64::INFINITY;
    for corrections in 0..MOST_CORRECTIONS {
        let reading = reader
            .read(at, sought.near)
            .map_err(|missing| match missing {
                NoReading::Density(reason) => EndReason::NoDensity(reason),
                NoReading::Indicator => EndReason::FeatureLost,
                NoReading::Symmetry => EndReason::SymmetryLost,
                NoReading::Interrupted => EndReason::Interrupted,
            })?;
        let steepness = reading.steepness();
        if !steepness.is_finite() || steepness == 0.0 {
            return Err(EndReason::Singular);
        }
        let foot = match sought.border {
            None => reading.foot(),
            Some(side) => {
                let mut foot = at;
                foot[1 - side] -= reading.indicator.value / reading.gradient[1 - side];
                foot
            }
        };
        let size = apart(foot, at);
        let noise = reading.indicator.sampling_error / steepness;
        if size <= CLOSE.max(WITHIN_NOISE * noise) {
            let remainder = remainder(&reading, size, sought.before);
            let node = WalkPoint {
                foot,
                tangent: reading.tangent(),
                remainder,
                arclength: 0.0,
                border: sought.border,
                reading,
            };
            return Ok((node, corrections));
        }
        // A place that is not a number is not near.
        let converges = size <= sought.farthest && size <= CONVERGING * last;
        if !converges || corrections + 1 == MOST_CORRECTIONS {
            return Err(not_met(&reading));
        }
        last = size;
        at = foot;
    }
    Err(EndReason::NotConverged)
}

/// Why a curve was not met where this was read: where samples leave more open than a place on the curve may be off,
/// they are to blame.
fn not_met(reading: &Reading) -> EndReason {
    if reading.indicator.sampling_error > CLOSE * reading.steepness() {
        EndReason::Sampling
    } else {
        EndReason::NotConverged
    }
}

/// What the straight line to the foot may leave: half the curvature of the indicator times the square of the distance.
/// By how much the gradient changed since the point before tells it along the curve; across, it may be as much again.
fn remainder(reading: &Reading, size: f64, before: Option<&WalkPoint>) -> f64 {
    let bend = before.map_or(1.0, |before| {
        let change = apart(reading.gradient, before.reading.gradient);
        ACROSS * change / (reading.steepness() * apart(reading.at, before.reading.at))
    });
    0.5 * bend * size * (size + reading.doubt)
}
