//! What is asked of a family of systems beside its densities.

use std::sync::Arc;

use super::{MeasureLevel, PassageQuestion, Quantity, Region, SpectrumQuestion, VisitsQuestion};

/// How the largest Lyapunov exponent along the stationary density is worked out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExponentMethod {
    /// From the density of state and direction, its angle by a Fourier series.
    Modes,
    /// By small deviations from free trajectories.
    Trajectories,
}

words! { ExponentMethod, pub(crate) name: Modes: "modes", Trajectories: "trajectories" }

/// What is asked of the systems of a [`Family`](super::Family) beside their densities. By default nothing is.
#[derive(Debug, Clone, Default)]
pub struct Questions {
    /// Quantities of which mean and standard deviation are wanted.
    pub averaged: Vec<Arc<Quantity>>,
    /// Regions that have names.
    pub regions: Vec<Region>,
    /// Questions of first passage.
    pub passages: Vec<PassageQuestion>,
    /// Regions of which it is wanted how often they are visited.
    pub visits: Vec<VisitsQuestion>,
    /// Levels of measures of which the crossings are wanted.
    pub levels: Vec<MeasureLevel>,
    /// A state of which the largest Lyapunov exponent is wanted: one that neither drift nor noise moves, a coordinate
    /// an axis.
    pub fixed_point: Option<Vec<f64>>,
    /// How the largest Lyapunov exponent along the stationary density is worked out, where it is wanted.
    pub largest_exponent: Option<ExponentMethod>,
    /// Steps of all trajectories together that it is worked out by.
    pub exponent_steps: f64,
    /// How many slow modes are wanted of which decay rates are given; 0 for none.
    pub slow_modes: usize,
    /// What is asked of fluctuations in the steady state.
    pub spectrum: Option<SpectrumQuestion>,
}

impl Questions {
    /// Whether slow modes are needed: they are wanted, or rates between two states are.
    pub(crate) fn asks_for_modes(&self) -> bool {
        self.slow_modes > 0 || self.passages.iter().any(|one| one.switching)
    }
}
