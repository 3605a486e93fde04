//! A number of the steady state read at places of a plane, and where on a line across a curve it is at its level.

use super::steps::{CLOSE, CurveNode, dot};
use super::walk::{MOST_CORRECTIONS, WITHIN_NOISE};
use super::walked::within;
use super::{CurveWork, EndReason, Plane};
use crate::continuation::levels::{measure_of, over};
use crate::continuation::{Doubt, Session, SourceError};
use crate::system::MeasureLevel;

/// Distance of the two places of a point at least, and of numbers that are sampled; sides of the box have length one.
const APART: f64 = 5e-4;
const APART_SAMPLED: f64 = 0.04;

/// Share that a point has in the slope of a number that is sampled, the rest being that of the points before.
const NEW: f64 = 0.3;

/// A point as it was met, in the box with sides of length one.
#[derive(Debug, Clone)]
pub(super) struct LevelNode {
    pub(super) foot: [f64; 2],
    /// Toward rising arclength, of length one.
    pub(super) along: [f64; 2],
    /// Change of the number per length to the left of that direction.
    pub(super) slope: f64,
    pub(super) arclength: f64,
    /// The two places that it lies between, or beside: the product of its distances from them.
    pub(super) spread: f64,
    pub(super) read: NumberRead,
}

/// The number at a place.
#[derive(Debug, Clone)]
pub(super) struct NumberRead {
    /// The number less its level, or the logarithm of the ratio of both.
    pub(super) over: f64,
    /// What is believed to hold the true one, in the same unit.
    pub(super) error: f64,
    /// Whether the number states an error.
    pub(super) is_judged: bool,
    /// What the solve says against it.
    pub(super) doubt: Option<Doubt>,
}

/// A session with the number that is read in it.
pub(super) struct NumberSession<'a> {
    pub(super) session: Box<dyn Session>,
    pub(super) plane: &'a Plane,
    pub(super) asked: &'a MeasureLevel,
    /// Whether logarithms of ratios are taken.
    pub(super) is_ratio: bool,
    /// Whether neighbouring values differ by samples of their own.
    pub(super) is_sampled: bool,
    /// How many errors of the number are believed to hold the true one.
    pub(super) limit: f64,
    pub(super) work: CurveWork,
}

/// A straight line on which a point of the curve is looked for.
#[derive(Clone, Copy)]
pub(super) struct Transversal {
    from: [f64; 2],
    /// Of length one.
    direction: [f64; 2],
    /// Change of the number per length, as far as it is known.
    slope: f64,
    farthest: f64,
}

impl Transversal {
    fn at(&self, length: f64) -> [f64; 2] {
        [0, 1].map(|k| self.from[k] + length * self.direction[k])
    }
}

impl LevelNode {
    /// Takes the direction from a point far behind, which samples tell better than the one before, and as much of the
    /// slope there as is known by more than this point.
    pub(super) fn smooth(&mut self, before: &Self, far: &Self) {
        let chord = [0, 1].map(|k| self.foot[k] - far.foot[k]);
        let length = chord[0].hypot(chord[1]);
        if length > 0.0 {
            self.along = chord.map(|part| part / length);
        }
        self.slope = before.slope + NEW * (self.slope - before.slope);
    }

    /// The same seen from the other end of the curve.
    pub(super) fn turned(&self) -> Self {
        Self {
            along: self.along.map(|part| -part),
            slope: -self.slope,
            arclength: -self.arclength,
            ..self.clone()
        }
    }
}

impl CurveNode for LevelNode {
    fn foot(&self) -> [f64; 2] {
        self.foot
    }
    fn tangent(&self) -> [f64; 2] {
        self.along
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

/// The direction to the left of another one.
pub(super) fn left_of([x, y]: [f64; 2]) -> [f64; 2] {
    [-y, x]
}

/// The line across a curve at a place, along the end of a side of the box where the place is on it.
pub(super) fn across(
    from: [f64; 2],
    along: [f64; 2],
    (border, slope): (Option<usize>, f64),
    farthest: f64,
) -> Transversal {
    let left = left_of(along);
    let Some(side) = border else {
        return Transversal {
            from,
            direction: left,
            slope,
            farthest,
        };
    };
    let mut direction = [0.0; 2];
    direction[1 - side] = 1.0;
    Transversal {
        from,
        direction,
        slope: slope * dot(left, direction),
        farthest,
    }
}

impl NumberSession<'_> {
    /// Distance of the two places of a point at least.
    pub(super) fn apart(&self) -> f64 {
        if self.is_sampled {
            APART_SAMPLED
        } else {
            APART
        }
    }

    /// The number at a place.
    pub(super) fn read(&mut self, at: [f64; 2]) -> Result<NumberRead, EndReason> {
        let coordinate = self.plane.lay(at);
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
        let asked = self.asked;
        let measure = measure_of(report, asked).ok_or(EndReason::NumberLost)?;
        if self.is_ratio && measure.value <= 0.0 {
            return Err(EndReason::NumberLost);
        }
        let (over, error) = over(measure, asked.level, self.is_ratio);
        Ok(NumberRead {
            over,
            error: self.limit * error,
            is_judged: measure.error.is_some(),
            doubt: Doubt::of_status(report.status, None),
        })
    }

    /// The point of the curve on a line across it, which has this direction there.
    pub(super) fn meet(
        &mut self,
        line: &Transversal,
        along: [f64; 2],
    ) -> Result<LevelNode, EndReason> {
        let mut before: Option<(f64, NumberRead)> = None;
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
            let is_near = gap.abs() <= self.apart().max(if self.is_sampled { noise } else { 0.0 });
            if let Some((at, _)) = before.as_ref().filter(|_| is_near) {
                let spread = (root - at).abs() * gap.abs();
                let foot = line.at(root).map(|part| part.clamp(0.0, 1.0));
                // Across the curve, which the line may meet obliquely.
                let slope = slope / dot(left_of(along), line.direction);
                return Ok(LevelNode {
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
        match self.is_sampled {
            true => Err(EndReason::Sampling),
            false => Err(EndReason::NotConverged),
        }
    }

    /// Where the number is read next: where its level is expected, or farther, so that the two places tell its slope.
    fn beside(&self, line: &Transversal, length: f64, gap: f64) -> f64 {
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
