//! From cell masses to densities that are watched: marginals, joint densities, moments, distances.
//!
//! *Mass* is a cell's probability, Σ = 1; *density* is mass over volume, ∫ = 1. They never share a variable.

use crate::space::Axis;

/// A density that is watched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Observable {
    /// Marginal of one axis.
    Marginal(usize),
    /// Joint density of two axes, in this order.
    Joint(usize, usize),
}

/// A probability density that is constant on the cells of one or two axes, ∫ = 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Density {
    /// One axis for a marginal, two for a joint density.
    pub axes: Vec<Axis>,
    /// One value a cell, the last axis fastest.
    pub values: Vec<f64>,
}

/// A density with the uncertainty of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimatedDensity {
    /// What it is the density of.
    pub observable: Observable,
    /// The density.
    pub density: Density,
    /// Standard error of each value of the density from sampling; all zero for a method without sampling.
    pub standard_error: Vec<f64>,
}

/// Mean and standard deviation of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
}

/// Hellinger distance of two densities on the same axes; `None` when the axes differ.
pub fn hellinger(_a: &Density, _b: &Density) -> Option<f64> {
    None
}
