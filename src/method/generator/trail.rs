//! What the last points of a sweep say of the next one: solutions and differences between schemes, extrapolated.
//!
//! A fine sweep moves along a smooth curve, so a polynomial through the last few points predicts the next one far
//! better than their secant, and what is left for the solver is small.

use crate::numerics::{add_scaled, sort_ascending};
use std::sync::Arc;

use super::relaxation::Relaxation;

/// Points that are remembered: one more than the highest degree of the polynomial.
const POINTS: usize = 6;

/// The same for differences between schemes: they are known to two digits only, which higher degrees would amplify.
const ROUGH_POINTS: usize = 3;

/// A term of the polynomial is used when it is smaller than this share of the one before. Terms of a converging series
/// fall; where they do not, the sweep's step is too wide or the noise of the solver has been reached.
const FALLING: f64 = 0.5;

/// A solved point.
#[derive(Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct TrailPoint {
    /// The parameter's value.
    pub(super) value: f64,
    /// The generator's unknowns, Σ = 1.
    pub(super) mass: Vec<f64>,
    /// By how much the second scheme's unknowns differ, Σ = 0.
    pub(super) difference: Vec<f64>,
}

/// The last points along the sweep, newest first, and what else changes slowly from one to the next.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::method) struct Trail {
    points: Vec<Arc<TrailPoint>>,
    /// How fast deviations die out, where it was needed.
    pub(super) relaxation: Option<Arc<Relaxation>>,
}

/// What a trail has that those before it do not have, lent or owned.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct News<Point, Time> {
    newest: Option<Point>,
    older: Vec<f64>,
    relaxation: Option<Time>,
}

impl Trail {
    /// The trail with one more point; the oldest one is forgotten.
    pub(super) fn with(&self, point: TrailPoint, relaxation: Option<Arc<Relaxation>>) -> Self {
        let mut points = vec![Arc::new(point)];
        let older = self.points.iter();
        let older = older.filter(|older| older.value != points[0].value);
        let older: Vec<_> = older.take(POINTS - 1).cloned().collect();
        points.extend(older);
        Self { points, relaxation }
    }

    /// The trail with the newest points of others, as many as it may have, the nearest to a value first: where a walk
    /// turns, what lies behind tells where to go.
    pub(super) fn completed<'t>(
        mut self,
        value: f64,
        others: impl Iterator<Item = &'t Self>,
    ) -> Self {
        if self.points.len() >= POINTS {
            return self;
        }
        let newest = others.filter_map(Self::newest);
        let is_known =
            |point: &&Arc<TrailPoint>| self.points.iter().any(|one| one.value == point.value);
        let mut more: Vec<&Arc<TrailPoint>> = newest.filter(|point| !is_known(point)).collect();
        let distance = |point: &TrailPoint| (point.value - value).abs();
        sort_ascending(&mut more, |one| distance(one));
        let room = POINTS - self.points.len();
        let more: Vec<_> = more.into_iter().take(room).cloned().collect();
        self.points.extend(more);
        self
    }

    /// What is new in it, and the values of the older points.
    #[cfg(feature = "serde")]
    pub(super) fn news(&self) -> News<&TrailPoint, &Relaxation> {
        News {
            newest: self.newest().map(AsRef::as_ref),
            older: self
                .points
                .iter()
                .skip(1)
                .map(|point| point.value)
                .collect(),
            relaxation: self.relaxation.as_deref(),
        }
    }

    /// The trail with this news, its older points among those that are `known`; `None` where one is not.
    #[cfg(feature = "serde")]
    pub(super) fn of_news(
        news: News<TrailPoint, Relaxation>,
        known: &[Arc<TrailPoint>],
    ) -> Option<Self> {
        let find = |value| known.iter().rev().find(|point| point.value == value);
        let older = news.older.into_iter().take(POINTS - 1);
        let older: Option<Vec<_>> = older.map(|value| find(value).cloned()).collect();
        let mut points: Vec<_> = news.newest.map(Arc::new).into_iter().collect();
        points.extend(older?);
        Some(Self {
            points,
            relaxation: news.relaxation.map(Arc::new),
        })
    }

    /// Lengths of all that has one value a cell.
    pub(super) fn lengths(&self) -> Vec<usize> {
        let points = self.points.iter();
        let mut lengths: Vec<usize> = points
            .flat_map(|point| [point.mass.len(), point.difference.len()])
            .collect();
        lengths.extend(self.relaxation.iter().filter_map(|one| one.cells()));
        lengths
    }

    /// The newest point.
    pub(super) fn newest(&self) -> Option<&Arc<TrailPoint>> {
        self.points.first()
    }

    /// Unknowns expected at a value; `None` without any point.
    pub(super) fn mass_at(&self, value: f64) -> Option<Vec<f64>> {
        self.extrapolation(value, POINTS, |point| &point.mass)
    }

    /// Difference between the schemes expected at a value; `None` without any point.
    pub(super) fn difference_at(&self, value: f64) -> Option<Vec<f64>> {
        self.extrapolation(value, ROUGH_POINTS, |point| &point.difference)
    }

    /// Newton's form of the polynomial through the points nearest to a value, as far as its terms fall.
    fn extrapolation(
        &self,
        value: f64,
        most: usize,
        part: impl Fn(&TrailPoint) -> &[f64],
    ) -> Option<Vec<f64>> {
        let mut nearest: Vec<&TrailPoint> = self.points.iter().map(AsRef::as_ref).collect();
        sort_ascending(&mut nearest, |one| (one.value - value).abs());
        let first = nearest.first()?;
        let mut sum = part(first).to_vec();
        let mut last = f64::INFINITY;
        for degree in 1..nearest.len().min(most) {
            let term = term(&nearest[..=degree], value, &part);
            let size: f64 = term.iter().map(|entry| entry.abs()).sum();
            if size.is_nan() || size > FALLING * last {
                break;
            }
            add_scaled(&mut sum, 1.0, &term);
            last = size;
        }
        Some(sum)
    }
}

/// The term of highest degree in Newton's form at a value: the divided difference of all points times the distances to
/// all but the last.
fn term<'a>(
    points: &[&'a TrailPoint],
    value: f64,
    part: &impl Fn(&'a TrailPoint) -> &'a [f64],
) -> Vec<f64> {
    let (_, before) = points.split_last().unwrap_or((&points[0], &[]));
    let distances: f64 = before.iter().map(|point| value - point.value).product();
    let mut sum = vec![0.0; part(points[0]).len()];
    for (index, point) in points.iter().enumerate() {
        let others = points
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index);
        let spacing: f64 = others.map(|(_, other)| point.value - other.value).product();
        add_scaled(&mut sum, distances / spacing, part(point));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::distance;

    fn trail(values: &[f64], curve: impl Fn(f64) -> Vec<f64>) -> Trail {
        values.iter().fold(Trail::default(), |trail, &value| {
            let mass = curve(value);
            let difference = curve(2.0 * value);
            let point = TrailPoint {
                value,
                mass,
                difference,
            };
            trail.with(point, None)
        })
    }

    #[test]
    fn a_smooth_curve_is_predicted_to_the_order_of_the_points() {
        let curve = |x: f64| vec![x.sin(), 1.0 - x.sin(), x.exp()];
        let error = |step: f64| {
            let values: Vec<f64> = (0..POINTS).map(|i| step * i as f64).collect();
            let at = step * POINTS as f64;
            let trail = trail(&values, curve);
            let of_difference = trail.difference_at(at).unwrap();
            let difference = distance(&of_difference, &curve(2.0 * at));
            assert!(difference < 1e3 * step.powi(3), "{difference:e}");
            distance(&trail.mass_at(at).unwrap(), &curve(at))
        };
        let order = (error(0.1) / error(0.05)).log2();
        assert!((order - POINTS as f64).abs() < 0.5, "{order}");
    }

    #[test]
    fn a_kink_is_passed_with_the_secant_at_most() {
        // |x| from a long step: the high terms do not fall, and what they would add is left out.
        let trail = trail(&[-0.3, -0.2, -0.1, 0.05, 0.1], |x| vec![x.abs(), 0.0]);
        let at = 0.2;
        assert!((trail.mass_at(at).unwrap()[0] - at).abs() < 0.05);
    }

    #[test]
    fn a_walk_that_turns_goes_on_from_what_lies_behind() {
        let curve = |x: f64| vec![x.exp(), 3.0 - x.exp()];
        // From 0 upward, and back to what is below.
        let ways: Vec<Trail> = (1..=POINTS)
            .map(|count| {
                let values: Vec<f64> = (0..count).map(|step| 0.1 * step as f64).collect();
                trail(&values, curve)
            })
            .collect();
        assert_eq!(ways[0].mass_at(-0.1), Some(curve(0.0)));
        let turned = ways[0].clone().completed(-0.1, ways.iter());
        assert!(distance(&turned.mass_at(-0.1).unwrap(), &curve(-0.1)) < 1e-4);
        assert_eq!(turned.points.len(), POINTS);
        assert_eq!(Trail::default().mass_at(1.0), None);
    }
}
