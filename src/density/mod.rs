//! From cell masses to densities that are watched: marginals, joint densities, moments, distances.
//!
//! *Mass* is a cell's probability, Σ = 1; *density* is mass over volume, ∫ = 1. They never share a variable.
//!
//! # Decisions
//!
//! **Equations travel with densities.** `EstimatedDensity` carries what the equations imply (`Structure`: centre of
//! symmetry, kinks and their jumps; on one axis by quadrature the extrema themselves, `Profile`) and other estimates of
//! itself (`Variants`: replicates, a second scheme). So `topology` knows no system, and whatever is derived from a
//! density has an error by deriving it from the variants too. Both are stored, which is why `pbif detect` can repeat
//! detection.
//!
//! **A quantity is an axis beyond the axes.** Formulas that are watched belong to the `Family` and are numbered on from
//! the axes of the state, so that names, tables, figures and the store need no second kind of observable.
//! `density::spread` maps masses of cells to bins linearly (trapezoids of a linear function over sub-cells), once a
//! sweep where no swept parameter occurs in the formula; a coarser map is the second discretisation.

mod discretisation;
mod distance;
mod moments;
mod profile;
mod projection;
mod series_map;
mod spread;
mod structure;
mod sub_cell_values;
mod sub_cells;
mod uncertainty;

pub(crate) use discretisation::WIGGLE;
pub(crate) use discretisation::{
    errors_by_schemes, estimate_from_difference, estimate_from_second,
};
pub(crate) use distance::{half_difference, negative_part};
pub use distance::{hellinger, hellinger_of_masses, total_variation, total_variation_of_masses};
pub use moments::moments;
pub(crate) use moments::{EstimatedMoments, Roughness, excess_variances};
pub use profile::{Extremum, Profile, SlopeJump, Turn};
pub use projection::Projection;
pub(crate) use projection::{QuantityMoments, phase_factors, times};
pub(crate) use series_map::{BINS_OF_A_TURN, layout_axis};
pub(crate) use spread::{Coordinate, Detail};
pub use structure::{Kink, Structure, Variants};
pub use uncertainty::estimate;
pub(crate) use uncertainty::estimate_projected;

use crate::space::Axis;
use crate::system::{Family, joined_names};

/// A density that is watched. Numbers beyond the axes of the state are those of the family's quantities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Observable {
    /// Marginal of one axis.
    Marginal(usize),
    /// Joint density of two axes, in this order.
    Joint(usize, usize),
}

impl Observable {
    /// The axes of the state it keeps, in its order.
    pub fn axes(self) -> Vec<usize> {
        match self {
            Self::Marginal(axis) => vec![axis],
            Self::Joint(first, second) => vec![first, second],
        }
    }

    /// Its name in files, for systems of a family: the names of its axes run together, for example `xy`; with `_`
    /// between them where one is longer than a letter.
    pub fn name(self, family: &Family) -> String {
        let axes = self.axes().into_iter();
        let names: Vec<&str> = axes.map(|axis| family.axis(axis)).collect();
        joined_names(&names)
    }

    /// Symbols of its axes, with `_{}` and `^{}`, for systems of a family.
    pub(crate) fn symbols(self, family: &Family) -> Vec<&str> {
        let axes = self.axes();
        axes.into_iter()
            .map(|axis| family.axis_symbol(axis))
            .collect()
    }
}

/// A probability density that is constant on the cells of one or two axes, ∫ = 1.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Density {
    /// One axis for a marginal, two for a joint density.
    pub axes: Vec<Axis>,
    /// One value a cell, the last axis fastest.
    pub values: Vec<f64>,
}

impl Density {
    /// Volume of every cell (length in one dimension, area in two), the last axis fastest.
    pub fn volumes(&self) -> Vec<f64> {
        cell_volumes(&self.axes)
    }

    /// Probability of every cell, the last axis fastest.
    pub fn masses(&self) -> Vec<f64> {
        let cells = self.values.iter().zip(self.volumes());
        cells.map(|(value, volume)| value * volume).collect()
    }

    /// Largest value; zero if there is no positive one.
    pub fn maximum(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }
}

/// Volumes of the cells of a product of axes, the last axis fastest.
fn cell_volumes(axes: &[Axis]) -> Vec<f64> {
    let mut volumes = vec![1.0];
    for axis in axes {
        let widths: Vec<f64> = (0..axis.count()).map(|cell| axis.width(cell)).collect();
        let mut longer = Vec::with_capacity(volumes.len() * widths.len());
        for volume in volumes {
            longer.extend(widths.iter().map(|width| volume * width));
        }
        volumes = longer;
    }
    volumes
}

/// A density with the uncertainty of its values.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EstimatedDensity {
    /// What it is the density of.
    pub observable: Observable,
    /// The density.
    pub density: Density,
    /// Standard error of each value of the density from sampling; all zero for a method without sampling.
    pub standard_error: Vec<f64>,
    /// Other estimates of the density, from which errors of what is derived from it follow.
    pub variants: Variants,
    /// Symmetry and kinks that the system's equations imply.
    pub structure: Structure,
    /// Share of the maximum below which values are what the solver leaves; zero where every cell has its digits,
    /// whatever its mass.
    pub negligible: f64,
    /// What the ends of the ranges, and modes that are not there, may have changed. It changes from cell to cell as the
    /// density itself does, and makes no feature but where the density is as low as at the ends: so it is no part of
    /// the standard errors, by which neighbours are told apart, but of what is stated.
    pub truncation: Truncation,
}

/// [`EstimatedDensity::negligible`] of a density whose solver bounds the error of all masses together.
pub const NEGLIGIBLE: f64 = 1e-7;

/// [`EstimatedDensity::negligible`] of a density of quantities: values that the solver leaves in single cells add up
/// along level lines.
pub(crate) const NEGLIGIBLE_OF_QUANTITIES: f64 = 1e-5;

/// What leaves a range does not come back where it leaves from: so many times what the mass would change by, or a value
/// move by, if it did is allowed for.
pub(crate) const LEAK_ALLOWANCE: f64 = 2.0;

/// What the ends of the ranges, and modes that are not there, may have changed of a density.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Truncation {
    /// Share by which all values may be off alike.
    pub share: f64,
    /// By how much each value may be off besides, with its sign; nothing where no more than the share is.
    pub change: Vec<f64>,
    /// The density at open ends of the ranges: what is as low elsewhere may be off by as much, because the states there
    /// may be those that come from beyond the ends.
    pub level: f64,
}

impl Truncation {
    /// Adds what else each value may be off by, with the sign that cancels nothing of what is there.
    pub(crate) fn add(&mut self, change: &[f64]) {
        if self.change.is_empty() {
            self.change = change.to_vec();
            return;
        }
        let together: f64 = self.change.iter().zip(change).map(|(a, b)| a * b).sum();
        let sign = if together < 0.0 { -1.0 } else { 1.0 };
        let pairs = self.change.iter_mut().zip(change);
        pairs.for_each(|(own, more)| *own += sign * more);
    }
}

impl EstimatedDensity {
    /// A density without errors, other estimates of it and a structure; values below [`NEGLIGIBLE`] are what a solver
    /// leaves.
    pub fn new(observable: Observable, density: Density) -> Self {
        Self {
            observable,
            standard_error: vec![0.0; density.values.len()],
            density,
            variants: Variants::None,
            structure: Structure::default(),
            negligible: NEGLIGIBLE,
            truncation: Truncation::default(),
        }
    }

    /// Whether there is one value a cell of every estimate: what was read from a file may not have it.
    pub(crate) fn is_sound(&self) -> bool {
        let axes = &self.density.axes;
        let cells: usize = axes.iter().map(Axis::count).product();
        let fits = |values: &Vec<f64>| values.len() == cells;
        let variants = match &self.variants {
            Variants::None => &[],
            Variants::Scheme(second) => std::slice::from_ref(second),
            Variants::Jackknife(replicates) => replicates.as_slice(),
        };
        axes.len() == self.observable.axes().len()
            && axes.iter().all(Axis::is_sound)
            && [&self.density.values, &self.standard_error]
                .into_iter()
                .all(fits)
            && variants.iter().all(fits)
            && (self.truncation.change.is_empty() || fits(&self.truncation.change))
    }

    /// Moves the density along an axis of the system: what lies at x lies at x + `by` then.
    pub(crate) fn displace(&mut self, axis: usize, by: f64) {
        let place = self.observable.axes().iter().position(|&one| one == axis);
        let Some(place) = place else {
            return;
        };
        self.density.axes[place] = self.density.axes[place].displaced(by);
        if let Some(centre) = &mut self.structure.centre {
            centre[place] += by;
        }
        let kinks = self.structure.kinks.iter_mut();
        for kink in kinks.filter(|kink| kink.axis == place) {
            kink.at += by;
        }
    }

    /// Errors as they are stated, of each value: those by which neighbours are told apart, and what the ends of the
    /// ranges may have changed.
    pub fn stated_errors(&self) -> Vec<f64> {
        if self.truncation == Truncation::default() {
            return self.standard_error.clone();
        }
        let errors = self.standard_error.iter().enumerate();
        errors
            .map(|(cell, error)| error + self.truncated(cell))
            .collect()
    }

    /// Values and their stated errors as other programs get them, each one a cell in the order of `density.values` and
    /// in its unit: what the solver leaves below zero is zero, and what is left is scaled so that the integral stays.
    /// Where nothing is above zero, values are zero and errors stay.
    pub fn above_zero(&self) -> [Vec<f64>; 2] {
        let masses = self.density.masses();
        let below = negative_part(&masses);
        let all: f64 = masses.iter().sum();
        let scale = match all + below {
            left if left > 0.0 => all / left,
            _ => 1.0,
        };
        let above = |&value: &f64| if value < 0.0 { 0.0 } else { value * scale };
        let errors = self.stated_errors().into_iter();
        [
            self.density.values.iter().map(above).collect(),
            errors.map(|error| error * scale).collect(),
        ]
    }

    /// What the ends of the ranges may have changed of a value.
    pub(crate) fn truncated(&self, cell: usize) -> f64 {
        let value = self.density.values.get(cell).unwrap_or(&0.0);
        let change = self.truncation.change.get(cell).unwrap_or(&0.0);
        self.truncation.share * value.abs() + change.abs() + self.truncation.level
    }

    /// Whether its values carry noise, as those of sampled methods do; else its errors are those of a grid.
    pub(crate) fn is_noisy(&self) -> bool {
        match self.variants {
            Variants::Jackknife(_) => true,
            Variants::Scheme(_) => false,
            Variants::None => self.standard_error.iter().any(|&error| error > 0.0),
        }
    }
}

/// Mean and standard deviation of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
}

/// Why a density, or a distance between two, could not be computed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DensityError {
    /// A vector does not have one value a cell.
    #[error("{given} values were given for {wanted} cells")]
    Length {
        /// Number of values that was given.
        given: usize,
        /// Number of cells.
        wanted: usize,
    },
    /// The observable names an axis that the cell space does not have.
    #[error("axis {axis} does not exist in a cell space of {dimension} axes")]
    Axis {
        /// The axis that was given, counted from 0.
        axis: usize,
        /// Number of axes.
        dimension: usize,
    },
    /// Neither one coordinate nor two.
    #[error("a density of {given} coordinates; one or two are watched")]
    Coordinates {
        /// Number of coordinates that was given.
        given: usize,
    },
    /// A joint density of an axis with itself.
    #[error("a joint density needs two different axes; both are axis {axis}")]
    RepeatedAxis {
        /// The axis that was given twice.
        axis: usize,
    },
    /// A single replicate, from which no spread can be taken.
    #[error("standard errors need at least 2 replicates; {given} was given")]
    Replicates {
        /// Number of replicates that was given.
        given: usize,
    },
    /// Two densities that do not live on the same cells.
    #[error("the two densities are on different cells")]
    DifferentAxes,
}
