//! What a source of densities is made for, and what it leaves for a neighbour.

use std::sync::Arc;

use super::MethodError;
use crate::density::Observable;
use crate::space::CellSpace;
use crate::system::{Model, ParameterValues, System};

/// What is swept, on which cells, and what is watched.
#[derive(Debug, Clone)]
pub struct Setting<'a> {
    /// The model.
    pub model: &'static Model,
    /// Its parameters; the swept one is replaced by every value in turn.
    pub values: &'a ParameterValues,
    /// Name of the swept parameter.
    pub parameter: &'a str,
    /// First and last value of the sweep.
    pub range: (f64, f64),
    /// The cells.
    pub space: &'a CellSpace,
    /// What is watched, in this order.
    pub observables: &'a [Observable],
}

impl Setting<'_> {
    /// The system at both ends and in the middle of the sweep.
    pub(super) fn systems_along(&self) -> Result<Vec<Arc<dyn System>>, MethodError> {
        let (from, to) = self.range;
        [from, 0.5 * (from + to), to]
            .into_iter()
            .map(|value| {
                let values = self.model.with(self.values, self.parameter, value)?;
                Ok(self.model.system(&values))
            })
            .collect()
    }
}

/// What a solved point leaves for its neighbour.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// The parameter's value.
    pub(super) value: f64,
    /// Mass of every cell (for the generator its unknowns), Σ = 1.
    pub(super) mass: Vec<f64>,
    /// Its derivative by the parameter, where known; Σ = 0.
    pub(super) slope: Option<Vec<f64>>,
}

impl State {
    /// Memory that the state takes.
    pub(super) fn bytes(&self) -> usize {
        let slope = self.slope.as_ref().map_or(0, Vec::len);
        size_of::<f64>() * (self.mass.len() + slope)
    }

    /// Slope of the secant to another state, which lies at another value.
    pub(super) fn secant(&self, other: &Self) -> Vec<f64> {
        let step = other.value - self.value;
        let pairs = self.mass.iter().zip(&other.mass);
        pairs.map(|(from, to)| (to - from) / step).collect()
    }

    /// Mass expected at another value: along the tangent, but never to less than nothing in total.
    pub(super) fn predicted(&self, value: f64) -> Vec<f64> {
        let step = value - self.value;
        match &self.slope {
            Some(slope) => {
                let pairs = self.mass.iter().zip(slope);
                pairs.map(|(mass, slope)| mass + step * slope).collect()
            }
            None => self.mass.clone(),
        }
    }
}
