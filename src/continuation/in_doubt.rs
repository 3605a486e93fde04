//! Where finer cells may tell more than those of a sweep.
//!
//! Around rows that are not located; where the slope along a crest is level within its error, so that a pair of peak
//! and saddle may be there; where a feature may be what errors make, or a slope rises to a peak that is not counted;
//! and where cells are wide, and so are not sure that nothing is there.

use super::found::StretchFindings;
use super::label::Located;
use super::locate::has_wide_cells;
use super::look::counted_around;
use super::walk::Walk;
use super::{Doubt, Finding, Point};
use crate::density::Observable;
use crate::numerics::sort_ascending;

/// An observable by its place among those that are watched.
pub(super) type Watched = (usize, Observable);

/// The values of a sweep at which its cells leave something in doubt.
pub(super) struct InDoubt<'p> {
    /// Of the sweep, with densities; ascending.
    points: Vec<&'p Point>,
    /// Distance between given values.
    step: f64,
    /// Places of observables, and values, at which it is not known whether a pair of peak and saddle is there.
    unsure: Vec<(usize, f64)>,
    /// The same where cells are wide, or hold what is not smooth.
    wide: Vec<(usize, f64)>,
}

/// How often cells are refined at most where nothing is counted.
const MOST_UNCOUNTED: u8 = 3;

impl<'p> InDoubt<'p> {
    /// Of a sweep that watches these, with so long a step.
    pub(super) fn of(walk: &'p Walk<'_>, observables: &[Observable], step: f64) -> Self {
        let solved = walk.points.iter();
        Self {
            points: solved.filter(|one| !one.detections.is_empty()).collect(),
            step,
            unsure: walk.unsure.clone(),
            wide: in_wide_cells(&walk.points, observables),
        }
    }

    pub(super) fn points(&self) -> &[&'p Point] {
        &self.points
    }

    /// Stretches around the rows of an observable that cells which are refined so many times may tell better, and
    /// around values at which they may tell whether a pair is there, apart from each other.
    pub(super) fn stretches(&self, rows: &[Located], of: Watched, times: u8) -> Vec<[f64; 2]> {
        let in_doubt = rows
            .iter()
            .filter(|row| row.observable == of.1 && is_of_cells(row))
            .filter(|row| !self.lacks_modes(row.hull()));
        // Beside a row that is located its own pair is what is not sure, up to where it is counted.
        let is_told = |value: f64| {
            let told = |row: &&Located| row.observable == of.1 && row.doubts.is_empty();
            let mut told = rows
                .iter()
                .filter(told)
                .map(|row| counted_around(self.points.iter().copied(), row, of.0));
            told.any(|[lower, upper]| (lower..=upper).contains(&value))
        };
        let unsure = self.unsure.iter().filter(|one| !is_told(one.1));
        let unsure = unsure.chain(&self.wide);
        let unsure = unsure.filter(|one| one.0 == of.0 && times <= MOST_UNCOUNTED);
        let unsure = unsure.filter(|one| !self.lacks_modes([one.1; 2]));
        let in_doubt = (in_doubt.map(Located::hull)).chain(unsure.map(|one| [one.1; 2]));
        let mut in_doubt: Vec<[f64; 2]> = in_doubt.collect();
        sort_ascending(&mut in_doubt, |one| one[0]);
        let mut found: Vec<[f64; 2]> = Vec::new();
        for [lower, upper] in in_doubt {
            let margin = (0.25 * (upper - lower)).max(0.5 * self.step);
            let around = self.wider([lower, upper], margin);
            let mut around = self.around_rows(rows, of.1, around);
            while let Some(last) = found.pop_if(|last| last[1] >= around[0]) {
                around = [last[0].min(around[0]), last[1].max(around[1])];
            }
            found.push(around);
        }
        found
    }

    /// Whether modes are too few at all values of a stretch: finer cells mend nothing there.
    fn lacks_modes(&self, [lower, upper]: [f64; 2]) -> bool {
        let inside = (self.points.iter()).filter(|one| (lower..=upper).contains(&one.value));
        let has_few = |one: &Finding| matches!(one, Finding::FewModes { .. });
        let few: Vec<bool> = inside
            .map(|point| point.report.findings.iter().any(has_few))
            .collect();
        !few.is_empty() && few.iter().all(|&is_few| is_few)
    }

    /// Forgets of a stretch what finer cells have settled there, whether a pair is there: those that are not wide, or,
    /// where the sweep's are wide, those whose rows were taken. What finer cells do not tell either takes its place.
    pub(super) fn settle(
        &mut self,
        (place, [lower, upper]): (usize, [f64; 2]),
        by: &StretchFindings,
        is_taken: bool,
    ) {
        let is_there = |one: &(usize, f64)| one.0 == place && (lower..=upper).contains(&one.1);
        if !by.is_wide || is_taken {
            self.wide.retain(|one| !is_there(one));
        }
        if !by.is_wide {
            self.unsure.retain(|one| !is_there(one));
        }
        self.unsure
            .extend(by.unsure.iter().map(|&value| (place, value)));
    }

    /// A stretch that reaches a step farther to either side, with all of the rows that lie in a part of it; `None`
    /// where it is the whole sweep.
    pub(super) fn next_wider(
        &self,
        stretch: [f64; 2],
        rows: &[Located],
        observable: Observable,
    ) -> Option<[f64; 2]> {
        let wider = self.wider(stretch, self.step);
        (wider != stretch).then(|| self.around_rows(rows, observable, wider))
    }

    /// The solved values that lie outside of a stretch by a margin, or the ends of the sweep.
    fn wider(&self, [lower, upper]: [f64; 2], margin: f64) -> [f64; 2] {
        let values = || self.points.iter().map(|point| point.value);
        let below = values().rfind(|value| *value <= lower - margin);
        let above = values().find(|value| *value >= upper + margin);
        let ends = [values().next(), values().next_back()];
        [
            below.or(ends[0]).unwrap_or(lower),
            above.or(ends[1]).unwrap_or(upper),
        ]
    }

    /// A stretch with all of the rows that lie in a part of it.
    fn around_rows(
        &self,
        rows: &[Located],
        observable: Observable,
        mut stretch: [f64; 2],
    ) -> [f64; 2] {
        for _ in 0..rows.len() {
            let cut = rows
                .iter()
                .filter(|row| row.observable == observable)
                .find(|row| {
                    let [lower, upper] = row.hull();
                    let is_inside = stretch[0] < lower && upper < stretch[1];
                    let is_at_end = stretch == self.wider([lower, upper], 0.0);
                    let is_outside = upper < stretch[0] || stretch[1] < lower;
                    !is_inside && !is_outside && !is_at_end
                });
            let Some(cut) = cut else { break };
            let [lower, upper] = cut.hull();
            let wider = self.wider([lower.min(stretch[0]), upper.max(stretch[1])], 0.0);
            if wider == stretch {
                break;
            }
            stretch = wider;
        }
        stretch
    }
}

/// Places of joint densities, and values, at which cells are wide, or hold a place at which the drift is not smooth.
/// None where there is a centre of symmetry, at which indicators are read.
fn in_wide_cells(points: &[Point], observables: &[Observable]) -> Vec<(usize, f64)> {
    let is_free = |point: &Point, place: usize| {
        let density = point.densities.get(place);
        density.is_some_and(|one| one.structure.centre.is_none())
    };
    let joint = observables.iter().enumerate();
    let joint: Vec<usize> = (joint.filter(|(_, one)| one.axes().len() > 1))
        .map(|(place, _)| place)
        .collect();
    let is_blurred = |point: &&Point| has_wide_cells(point) || has_surfaces_in_cells(point);
    let wide = points.iter().filter(is_blurred);
    wide.flat_map(|point| {
        let places = joint.iter().filter(|place| is_free(point, **place));
        places.map(|&place| (place, point.value))
    })
    .collect()
}

/// Whether the drift is not smooth at a place inside of cells.
fn has_surfaces_in_cells(point: &Point) -> bool {
    let mut findings = point.report.findings.iter();
    findings.any(|finding| {
        matches!(
            finding,
            Finding::SurfaceOffFaces { .. } | Finding::JumpInsideCells { .. }
        )
    })
}

/// Whether finer cells may tell more of a row.
fn is_of_cells(row: &Located) -> bool {
    row.reason().is_some_and(Doubt::is_of_cells)
}
