//! Starts that are spread as the steady state is, and what the errors of its density do to numbers of a passage.

use super::start::at_nodes_of;
use super::{Passage, Start};
use crate::density::{LEAK_ALLOWANCE, Roughness};
use crate::generator::{GeneratorError, levels};
use crate::space::CellSpace;

/// A steady state on the cells of a sweep, as it is known to a solve.
#[derive(Debug, Clone, Copy)]
pub struct KnownDensity<'a> {
    /// Density at a node times the local volume, one a cell.
    pub unknowns: &'a [f64],
    /// By how much those of a second discretisation differ, Σ = 0; `None` where the density has all its digits.
    pub changes: Option<&'a [f64]>,
    /// By how much modes that are not there may change them; `None` where no axis is carried by modes, or they are told
    /// otherwise.
    pub by_modes: Option<&'a [f64]>,
    /// By how much they would differ if what leaves the range stayed in the cells that it leaves from; `None` where
    /// next to nothing leaves.
    pub returning: Option<&'a [f64]>,
    /// Share of the mass that lies beyond the ends of the range.
    pub beyond: f64,
    /// Axes with coordinates of planes on which the derivative of the density jumps.
    pub planes: &'a [(usize, f64)],
}

impl KnownDensity<'_> {
    /// The unknowns of the second discretisation, with what returns.
    pub(super) fn second(&self) -> Option<Vec<f64>> {
        let mut second = self.unknowns.to_vec();
        let changes = second.iter_mut().zip(self.changes?);
        changes.for_each(|(own, change)| *own += change);
        if let Some(returning) = self.returning {
            let pairs = second.iter_mut().zip(returning);
            pairs.for_each(|(own, change)| *own += LEAK_ALLOWANCE * change);
        }
        Some(second)
    }

    /// By how much each unknown may be off: the changes of the second discretisation and what returns.
    pub(super) fn sizes_of_changes(&self) -> Option<Vec<f64>> {
        let mut sizes: Vec<f64> = self.changes?.iter().map(|change| change.abs()).collect();
        if let Some(returning) = self.returning {
            let pairs = sizes.iter_mut().zip(returning);
            pairs.for_each(|(size, change)| *size += LEAK_ALLOWANCE * change.abs());
        }
        Some(sizes)
    }

    /// What the ends of the range may change of a number, given what returning masses change of it, and how far it may
    /// be from what holds beyond the ends.
    pub(super) fn of_ends(&self, returning: f64, farthest: f64) -> f64 {
        LEAK_ALLOWANCE * returning.abs() + self.beyond * farthest
    }
}

/// A start that is spread as a density with errors of its own.
pub(super) struct DensityStart<'a> {
    density: KnownDensity<'a>,
    changes: &'a [f64],
    /// Levels of the target at the nodes of the density's cells, and of the region of the start.
    levels: [Vec<f64>; 2],
    /// The cells of the density.
    space: &'a CellSpace,
    /// The cells on which the passage is solved, and which of them are kept.
    cells: (&'a CellSpace, &'a [bool]),
}

impl<'a> DensityStart<'a> {
    /// `None` where the start is a state, or its density has all its digits.
    ///
    /// # Errors
    /// [`GeneratorError::NotFinite`] for levels that have no value at a node.
    pub(super) fn new(
        passage: &'a Passage,
        density: KnownDensity<'a>,
        space: &'a CellSpace,
        cells: (&'a CellSpace, &'a [bool]),
    ) -> Result<Option<Self>, GeneratorError> {
        let is_spread = matches!(passage.start, Start::Density(_));
        let Some(changes) = density.changes.filter(|_| is_spread) else {
            return Ok(None);
        };
        Ok(Some(Self {
            density,
            changes,
            levels: [levels(space, &passage.until)?, passage.start_levels(space)?],
            space,
            cells,
        }))
    }

    /// Error of the average over the start of a field that is known at the kept cells: what the second discretisation
    /// changes, what its changes would do were those of neighbouring layers of cells independent, and what the ends of
    /// the ranges do.
    pub(super) fn error(&self, field: &[f64]) -> f64 {
        let space = self.space;
        let [target, start] = &self.levels;
        let field = at_nodes_of(space, self.cells, target, field);
        let starts = |cell: usize| start[cell] < 0.0;
        let inside = |(cell, value): (usize, Option<f64>)| value.filter(|_| starts(cell));
        let field: Vec<Option<f64>> = field.into_iter().enumerate().map(inside).collect();
        let weighed = || field.iter().zip(self.density.unknowns);
        let mass: f64 = weighed()
            .filter_map(|(value, mass)| value.map(|_| mass))
            .sum();
        let sum: f64 = weighed()
            .filter_map(|(value, mass)| value.map(|value| value * mass))
            .sum();
        let aside = |value: &Option<f64>| value.map_or(0.0, |value| (value - sum / mass) / mass);
        let values: Vec<f64> = field.iter().map(aside).collect();
        let roughness = Roughness {
            space,
            weights: self.density.unknowns,
            differences: self.changes,
            planes: self.density.planes,
        };
        let returning = self.density.returning;
        let returning = returning.map_or(0.0, |change| super::dot(&values, change));
        let farthest = values
            .iter()
            .fold(0.0, |most: f64, one| most.max(one.abs()));
        let of_ends = self.density.of_ends(returning, farthest);
        super::dot(&values, self.changes).abs() + roughness.of(&values) + of_ends
    }
}
