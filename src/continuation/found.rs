//! What finer cells show of a stretch of a sweep.

use super::label::Located;
use super::look::{CloserLook, counted};
use super::{Doubt, Point};
use crate::density::{EstimatedDensity, Observable};
use crate::topology::Signature;

/// What finer cells show of one observable in a stretch.
pub(super) struct StretchFindings {
    pub(super) rows: Vec<Located>,
    pub(super) points: Vec<Point>,
    /// Values of which finer cells do not tell either whether a pair is there.
    pub(super) unsure: Vec<f64>,
    /// Whether they are wide themselves.
    pub(super) is_wide: bool,
}

/// What is counted in an observable at a value.
pub(super) type Seen = (Observable, f64, Signature);

impl StretchFindings {
    /// What is counted at a value; `None` where it was not solved.
    pub(super) fn counted(&self, value: f64) -> Option<Signature> {
        counted(self.points.iter(), value, 0)
    }

    /// What is counted at all of its values.
    pub(super) fn seen(&self, observable: Observable) -> Vec<Seen> {
        let points = self.points.iter();
        let seen = points.filter_map(|one| Some((observable, one.value, self.counted(one.value)?)));
        seen.collect()
    }

    /// The parts of the stretch in which nothing happens, and nothing is left in doubt, between solved values.
    pub(super) fn settled(&self, observable: Observable) -> Vec<CloserLook> {
        let is_sure = |point: &Point| !self.unsure.contains(&point.value);
        let signature = |point: &Point| Some(point.detections.first()?.signature);
        let has_row = |a: &Point, b: &Point| {
            let mut rows = self.rows.iter().map(Located::hull);
            rows.any(|[from, to]| from <= b.value && a.value <= to)
        };
        let parts = self.points.chunk_by(|a, b| {
            is_sure(a) && is_sure(b) && signature(a) == signature(b) && !has_row(a, b)
        });
        let look = |part: &[Point]| {
            let [first, .., last] = part else { return None };
            Some(CloserLook {
                observable,
                stretch: [first.value, last.value],
                ends: [signature(first)?, signature(last)?],
                rows: Vec::new(),
            })
        };
        parts.filter_map(look).collect()
    }

    /// Whether all is seen whole, and with smaller errors than the sweep states. Where errors are larger, what is not
    /// counted may be there all the same.
    pub(super) fn is_better(
        &self,
        points: &[&Point],
        place: usize,
        [lower, upper]: [f64; 2],
    ) -> bool {
        let is_whole = |point: &Point| {
            let mut densities = point.densities.iter();
            point.report.status.is_resolved()
                && point.detections.iter().all(|one| one.is_seen)
                && densities.all(|one| Doubt::of_negative(&one.density).is_none())
        };
        let within = points
            .iter()
            .filter(|point| (lower..=upper).contains(&point.value));
        let before = within.filter_map(|point| point.densities.get(place));
        let own = self
            .points
            .iter()
            .filter_map(|point| point.densities.first());
        largest_error(own) <= largest_error(before) && self.points.iter().all(is_whole)
    }
}

/// The largest error of densities, as a share of their mass.
fn largest_error<'d>(densities: impl Iterator<Item = &'d EstimatedDensity>) -> f64 {
    let error = |one: &EstimatedDensity| {
        let volumes = one.density.volumes();
        let errors = one.standard_error.iter().zip(&volumes);
        errors.map(|(error, volume)| error * volume).sum()
    };
    densities.map(error).fold(0.0, f64::max)
}
