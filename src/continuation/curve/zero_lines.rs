//! The lines in a plane of two parameters on which a cheap function is zero.
//!
//! A lattice of the box shows where the function changes its sign; from each such place the line is walked by steps
//! along its tangent, and found again across each of them by halving.

use super::{Plane, distance};

/// Steps of the lattice along either side of the box.
const LATTICE: usize = 32;

/// Longest and shortest step of a walk, in sides of the box.
const STEPS: [f64; 2] = [0.0125, 1e-7];

/// Largest distance of a curve from the predicted point that is accepted, in steps, and the one up to which steps grow.
const ASIDE: [f64; 2] = [0.15, 0.05];

/// Half of the width in which the curve is looked for across a step, in steps.
const WIDTH: f64 = 0.5;

/// Halvings of a bracket: as many as there are digits.
const HALVINGS: usize = 60;

/// Most points in each direction.
const MOST_POINTS: usize = 2000;

/// Largest distance, in sides of the box, of a place on a line from the chords between its points.
pub(super) const ON_IT: f64 = 1e-3;

/// Half of the distance across a curve over which the slope is taken, in sides of the box.
const SLOPE: f64 = 1e-4;

/// Rounding of numbers, relative to them.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A function over the box with sides of length one, and its error.
pub(super) struct Field<'a> {
    pub(super) plane: &'a Plane,
    pub(super) value: &'a dyn Fn([f64; 2]) -> Option<[f64; 2]>,
}

/// A point of a walk with the direction in which it goes on.
#[derive(Clone, Copy)]
struct Pace {
    at: [f64; 2],
    along: [f64; 2],
}

impl Field<'_> {
    fn is_below(&self, at: [f64; 2]) -> Option<bool> {
        (self.value)(at).map(|[value, _]| value < 0.0)
    }

    /// All lines on which it is zero: values of both parameters, with the error across the line in sides of the box.
    pub(super) fn lines(&self) -> Vec<Vec<([f64; 2], f64)>> {
        let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
        for [a, b] in self.crossed_edges() {
            let Some(start) = self.zero(a, b) else {
                continue;
            };
            if lines.iter().all(|line| distance(line, start) > ON_IT) {
                lines.push(self.line(start));
            }
        }
        let lines = lines.into_iter().filter(|line| line.len() > 1);
        let point = |at: [f64; 2]| (self.plane.values(at), self.error(at));
        lines
            .map(|line| line.into_iter().map(point).collect())
            .collect()
    }

    /// Edges of the lattice at whose ends it has other signs.
    fn crossed_edges(&self) -> Vec<[[f64; 2]; 2]> {
        let place = |[column, row]: [usize; 2]| [column, row].map(|n| n as f64 / LATTICE as f64);
        let nodes: Vec<Vec<Option<bool>>> = (0..=LATTICE)
            .map(|row| {
                let column = |column| self.is_below(place([column, row]));
                (0..=LATTICE).map(column).collect()
            })
            .collect();
        let mut edges = Vec::new();
        for row in 0..=LATTICE {
            for column in 0..=LATTICE {
                for [right, up] in [[1, 0], [0, 1]] {
                    let there = [column + right, row + up];
                    let beside = nodes.get(there[1]).and_then(|row| row.get(there[0]));
                    let both = nodes[row][column].zip(beside.copied().flatten());
                    if both.is_some_and(|(one, other)| one != other) {
                        edges.push([place([column, row]), place(there)]);
                    }
                }
            }
        }
        edges
    }

    /// A zero between two places; `None` where it has the same sign at both, or is not known somewhere between.
    fn zero(&self, from: [f64; 2], to: [f64; 2]) -> Option<[f64; 2]> {
        let is_below = self.is_below(from)?;
        if self.is_below(to)? == is_below {
            return None;
        }
        let place = |share: f64| [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match self.is_below(place(middle))? == is_below {
                true => low = middle,
                false => high = middle,
            }
        }
        Some(place(0.5 * (low + high)))
    }

    /// The line through a zero, from end to end; that alone where none goes on from there.
    fn line(&self, start: [f64; 2]) -> Vec<[f64; 2]> {
        let Some(uphill) = self.uphill(start) else {
            return vec![start];
        };
        let along = [-uphill[1], uphill[0]];
        let (ahead, is_closed) = self.walk(Pace { at: start, along });
        if is_closed {
            return std::iter::once(start).chain(ahead).collect();
        }
        let along = along.map(|part| -part);
        let (behind, _) = self.walk(Pace { at: start, along });
        let behind = behind.into_iter().rev();
        behind.chain([start]).chain(ahead).collect()
    }

    /// The points after a start, and whether the last one is the start again.
    fn walk(&self, start: Pace) -> (Vec<[f64; 2]>, bool) {
        let (mut here, mut step) = (start, STEPS[0]);
        let mut points: Vec<[f64; 2]> = Vec::new();
        while points.len() < MOST_POINTS && step >= STEPS[1] {
            let there = [0, 1].map(|k| here.at[k] + step * here.along[k]);
            if let Some(side) = (0..2).find(|&k| !(0.0..=1.0).contains(&there[k])) {
                if let Some(end) = self.border(here, side) {
                    points.extend(end.filter(|end| apart(*end, here.at) > 0.0));
                    break;
                }
                step *= 0.5;
                continue;
            }
            let across = [-here.along[1], here.along[0]].map(|part| WIDTH * step * part);
            let [left, right] = [1.0, -1.0].map(|sign| [0, 1].map(|k| there[k] + sign * across[k]));
            let next = self.zero(left, right);
            let Some(next) = next.filter(|&next| apart(next, there) <= ASIDE[0] * step) else {
                step *= 0.5;
                continue;
            };
            if points.len() > 2 && distance(&[here.at, next], start.at) <= 0.2 * step {
                points.push(start.at);
                return (points, true);
            }
            let aside = apart(next, there);
            points.push(next);
            let length = apart(next, here.at);
            let chord = [0, 1].map(|k| (next[k] - here.at[k]) / length);
            // The chord is the tangent in the middle of the step.
            let along = [0, 1].map(|k| 2.0 * chord[k] - here.along[k]);
            let size = along[0].hypot(along[1]);
            here = Pace {
                at: next,
                along: along.map(|part| part / size),
            };
            if aside <= ASIDE[1] * step {
                step = (1.5 * step).min(STEPS[0]);
            }
        }
        (points, false)
    }

    /// Where a walk leaves the box by a side: `None` where the curve was not met on that border, `Some(None)` where the
    /// walk stands on it already.
    fn border(&self, here: Pace, side: usize) -> Option<Option<[f64; 2]>> {
        let end = if here.along[side] < 0.0 { 0.0 } else { 1.0 };
        let step = (end - here.at[side]) / here.along[side];
        if step <= STEPS[1] {
            return Some(None);
        }
        let other = 1 - side;
        let expected = here.at[other] + step * here.along[other];
        let half = WIDTH * step.max(ASIDE[0] * STEPS[0]);
        let place = |off: f64| {
            let mut place = [end; 2];
            place[other] = (expected + off).clamp(0.0, 1.0);
            place
        };
        self.zero(place(-half), place(half)).map(Some)
    }

    /// The direction in which it rises fastest at a place.
    fn uphill(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let (slopes, size) = self.gradient(at)?;
        Some(slopes.map(|slope| slope / size))
    }

    /// Its change along both sides of the box at a place, and the length of that, which is not zero.
    fn gradient(&self, at: [f64; 2]) -> Option<([f64; 2], f64)> {
        let slopes = [self.slope(at, 0)?, self.slope(at, 1)?];
        let size = slopes[0].hypot(slopes[1]);
        (size > 0.0 && size.is_finite()).then_some((slopes, size))
    }

    /// Its change along a side of the box, from both sides of a place as far as it is known there.
    fn slope(&self, at: [f64; 2], side: usize) -> Option<f64> {
        let value = |off: f64| {
            let mut place = at;
            place[side] += off;
            Some((off, (self.value)(place)?[0]))
        };
        let (low, below) = value(-SLOPE).or_else(|| value(0.0))?;
        let (high, above) = value(SLOPE).or_else(|| value(0.0))?;
        (high > low).then(|| (above - below) / (high - low))
    }

    /// Error across the curve of a point on it, in sides of the box.
    fn error(&self, at: [f64; 2]) -> f64 {
        let own = (self.value)(at).map_or(f64::INFINITY, |[value, error]| value.abs() + error);
        let sides = self.plane.sides().iter();
        let rounding = sides.map(|side| side.from.abs().max(side.to.abs()) / side.length());
        let rounding = ROUNDING * rounding.fold(1.0, f64::max);
        let size = self.gradient(at).map_or(0.0, |(_, size)| size);
        let error = own / size;
        // What is not a number is not small.
        if error.is_finite() {
            error + rounding
        } else {
            1.0
        }
    }
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(value: &dyn Fn([f64; 2]) -> Option<[f64; 2]>) -> Vec<Vec<([f64; 2], f64)>> {
        let plane = Plane::new(("a", 0.0, 1.0), ("b", 0.0, 1.0)).unwrap();
        let field = Field {
            plane: &plane,
            value,
        };
        field.lines()
    }

    #[test]
    fn a_circle_is_closed_and_an_arc_goes_from_border_to_border() {
        let about = |middle: [f64; 2], radius: f64| {
            move |at: [f64; 2]| Some([apart(at, middle) - radius, 0.0])
        };
        for (middle, radius, is_closed) in [([0.5, 0.5], 0.3, true), ([0.0, 1.0], 0.6, false)] {
            let found = lines(&about(middle, radius));
            let [line] = found.as_slice() else {
                panic!("{} lines", found.len());
            };
            for point in line {
                let off = (apart(point.0, middle) - radius).abs();
                assert!(off <= point.1 && point.1 < 1e-13, "{off:e}");
            }
            let length: f64 = line.windows(2).map(|two| apart(two[0].0, two[1].0)).sum();
            let turn = if is_closed { 2.0 } else { 0.5 } * std::f64::consts::PI;
            assert!((length / (turn * radius) - 1.0).abs() < 1e-3, "{length}");
            let ends = [line[0].0, line[line.len() - 1].0];
            assert_eq!(ends[0] == ends[1], is_closed);
            assert!(
                is_closed
                    || ends
                        .iter()
                        .all(|end| end.contains(&0.0) || end.contains(&1.0))
            );
        }
    }

    #[test]
    fn two_lines_are_told_apart_and_one_ends_where_the_function_does() {
        let found = lines(&|[x, y]| Some([(x - 0.3 - 0.1 * y) * (x - 0.7), 0.0]));
        assert_eq!(found.len(), 2);
        let found = lines(&|[x, y]| (y < 0.5).then_some([x - 0.4 - 0.2 * y * y, 0.0]));
        let [line] = found.as_slice() else {
            panic!("{} lines", found.len());
        };
        let highest = line.iter().map(|point| point.0[1]).fold(0.0, f64::max);
        assert!((highest - 0.5).abs() < 1e-5, "{highest}");
        // Where it is nowhere zero there is none.
        assert!(lines(&|_| Some([1.0, 0.0])).is_empty() && lines(&|_| None).is_empty());
    }
}
