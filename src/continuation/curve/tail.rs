//! The points at the end of a fold, and what they tell of where it ends.

use super::found::{CurvePoint, EndReason};
use super::plane::Plane;
use crate::topology::IndicatorKind;

/// Fewest points that polynomials are fitted to.
const FEWEST: usize = 8;

/// Length of the end of a curve that they are taken from, in sides of the box.
pub(super) const LONGEST: f64 = 0.2;

/// The same where these are too few.
const FARTHEST: f64 = 0.6;

/// Farthest that the end may be from where the curve was met last, in sides of the box.
pub(super) const FAR: f64 = 0.05;

/// The end of a fold, beyond the last point that was met.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Beyond {
    pub(super) reason: EndReason,
    /// In the box with sides of length one.
    pub(super) at: [f64; 2],
    pub(super) place: f64,
    pub(super) error: f64,
    /// Direction in which the curve leaves it, of length one.
    pub(super) leaves: [f64; 2],
    /// What the polynomials leave of the points, and what these are therefore uncertain by at least: checks lie too far
    /// apart to show it.
    pub(super) scatter: f64,
    /// Where another curve that begins there passes: in the box, with its indicator and its place.
    pub(super) branch: ([f64; 2], IndicatorKind, f64),
}

/// The points at the end of a fold.
pub(super) struct Tail<'p> {
    pub(super) points: Vec<&'p CurvePoint>,
    /// Where in the density.
    pub(super) places: Vec<f64>,
    /// In the box with sides of length one.
    pub(super) values: Vec<[f64; 2]>,
}

impl<'p> Tail<'p> {
    /// The first of some points that follow each other inward; `None` where they are too few.
    pub(super) fn new(inward: &[&'p CurvePoint], plane: &Plane) -> Option<Self> {
        let first = inward.first()?;
        let near = inward.iter().enumerate().take_while(|(index, point)| {
            // Where steps are long, as many as it takes.
            let longest = if *index <= FEWEST { FARTHEST } else { LONGEST };
            (point.arclength - first.arclength).abs() <= longest
        });
        let points: Vec<&CurvePoint> = near.map(|(_, point)| *point).collect();
        let places = points
            .iter()
            .filter_map(|point| point.place.first().copied());
        let tail = Self {
            places: places.collect(),
            values: points
                .iter()
                .map(|point| plane.place(point.values))
                .collect(),
            points,
        };
        (tail.points.len() >= FEWEST && tail.places.len() == tail.points.len()).then_some(tail)
    }

    /// The largest error of its points.
    pub(super) fn largest_error(&self) -> f64 {
        self.points
            .iter()
            .map(|point| point.error)
            .fold(0.0, f64::max)
    }
}
