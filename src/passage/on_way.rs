//! Processes on their way from one region to another on one grid: their density and their current, with what schemes
//! and errors of the steady state change of them.

use super::cells::PassageCells;
use super::current::Flow;
use super::field::{FieldQuestion, OnGrid, errors_of};
use super::rim::{mend, rim};
use super::steady::local_volumes;
use super::timed::WithError;
use crate::generator::AbsorbingGenerator;
use crate::stationary::generator::Expected;

/// The region that is left, and the one that is come to, by their places among the parts of a target.
pub(super) const FROM: usize = 0;
pub(super) const TO: usize = 1;

/// Numbers by a grid, with what errors of the steady state change of them.
pub(super) struct OnWayNumbers {
    pub(super) on_grid: OnGrid,
    pub(super) changes: Vec<f64>,
}

impl OnWayNumbers {
    pub(super) fn new(on_grid: OnGrid, changes: Vec<f64>) -> Self {
        Self { on_grid, changes }
    }

    pub(super) fn with_errors(
        &self,
        others: [&OnGrid; 2],
        spread: impl Fn(Vec<f64>) -> Vec<f64>,
    ) -> Vec<WithError> {
        let errors = errors_of(&self.on_grid, others)
            .into_iter()
            .zip(&self.changes);
        let errors = spread(errors.map(|(error, change)| error + change.abs()).collect());
        let values = self.on_grid.values.iter().zip(errors);
        values
            .map(|(value, error)| (value.unwrap_or(f64::NAN), error))
            .collect()
    }
}

/// A vector or a number, with its changes: by half of the dissipation, by a border of lower order, and by errors of the
/// steady state.
pub(super) struct Changed<T> {
    pub(super) own: T,
    pub(super) halved: T,
    pub(super) border: T,
    pub(super) steady: T,
}

/// What is on its way on one grid.
pub(super) struct OnWay<'a> {
    pub(super) found: &'a PassageCells,
    pub(super) kept: &'a [bool],
    /// Unknowns of those that were in the first region last.
    pub(super) last: Changed<Vec<f64>>,
    /// Probabilities to come to the second region next, without dissipation, and their changes.
    pub(super) next: Changed<Vec<f64>>,
    /// Unknowns of those on their way, without dissipation, and their changes.
    pub(super) on_way: Changed<Vec<f64>>,
}

impl<'a> OnWay<'a> {
    pub(super) fn new(
        asked: &FieldQuestion<'_>,
        found: &'a PassageCells,
        full: &'a AbsorbingGenerator,
        (last, next, [mut halved, mut border]): (Changed<Vec<f64>>, Expected, [Vec<f64>; 2]),
    ) -> Self {
        let (system, kept) = (asked.system.as_ref(), full.kept.as_slice());
        let mut own = plus(&next.values(), 2.0, &halved);
        let rim = rim(system, (&found.space, kept), &asked.target.until);
        let to = &asked.target.exits[TO];
        mend(&mut own, &rim, |state| {
            f64::from(u8::from(to.at(state) <= asked.target.exits[FROM].at(state)))
        });
        mend(&mut halved, &rim, |_| 0.0);
        mend(&mut border, &rim, |_| 0.0);
        let steady = Vec::new();
        let next = Changed {
            own,
            halved,
            border,
            steady,
        };
        let extrapolated = plus(&last.own, 2.0, &last.halved);
        let product =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a * b).collect() };
        let both =
            |f: &[f64], q: &[f64]| plus(&product(f, &next.own), 1.0, &product(&extrapolated, q));
        let on_way = Changed {
            own: product(&extrapolated, &next.own),
            halved: both(&last.halved, &next.halved),
            border: both(&last.border, &next.border),
            steady: product(&last.steady, &next.own),
        };
        Self {
            found,
            kept,
            last,
            next,
            on_way,
        }
    }

    /// Density and current at the centres of the sweep's cells.
    pub(super) fn fields(&self, asked: &FieldQuestion<'_>) -> Vec<OnWayNumbers> {
        let space = &self.found.space;
        let volumes = local_volumes(space);
        let per_volume = |unknowns: &[f64]| -> Vec<f64> {
            unknowns
                .iter()
                .zip(&volumes)
                .map(|(unknown, volume)| unknown / volume)
                .collect()
        };
        let found = |of: Changed<Vec<f64>>, is_zero: bool| {
            // On borders it may be zero.
            let on_border = is_zero.then_some(|_: &[f64]| 0.0);
            let at = |field: &[f64]| asked.at_centres((space, self.kept), field, on_border);
            let changes = at(&of.steady)
                .into_iter()
                .map(|change| change.unwrap_or(0.0));
            let changes = changes.collect();
            let (values, halved, border) = (at(&of.own), at(&of.halved), at(&of.border));
            OnWayNumbers::new(
                OnGrid {
                    values,
                    halved,
                    border,
                },
                changes,
            )
        };
        let density = &self.on_way;
        let density = Changed {
            own: per_volume(&density.own),
            halved: per_volume(&density.halved),
            border: per_volume(&density.border),
            steady: per_volume(&density.steady),
        };
        let last = Changed {
            own: per_volume(&plus(&self.last.own, 2.0, &self.last.halved)),
            halved: per_volume(&self.last.halved),
            border: per_volume(&self.last.border),
            steady: per_volume(&self.last.steady),
        };
        let flow = Flow::new(asked.system.as_ref(), space, self.kept);
        let next = &self.next;
        let current = |axis: usize| {
            let of = |density: &[f64], next: &[f64]| flow.current(axis, density, next);
            let both = |density: &[f64], change: &[f64]| {
                plus(&of(density, &next.own), 1.0, &of(&last.own, change))
            };
            Changed {
                own: of(&last.own, &next.own),
                halved: both(&last.halved, &next.halved),
                border: both(&last.border, &next.border),
                steady: of(&last.steady, &next.own),
            }
        };
        let currents = (0..space.dimension()).map(|axis| found(current(axis), false));
        [found(density, true)].into_iter().chain(currents).collect()
    }
}

/// One vector and so many times another.
pub(super) fn plus(one: &[f64], times: f64, other: &[f64]) -> Vec<f64> {
    let pairs = one.iter().zip(other);
    pairs.map(|(one, other)| one + times * other).collect()
}
