//! The generator of a system between walls, with all and with half of its dissipation.

use std::f64::consts::TAU;
use std::sync::Arc;

use sprs::CsMat;

use super::SpectrumError;
use super::model::balanced;
use crate::generator::{Dissipation, GeneratorOptions, assemble_damped};
use crate::space::{Axis, CellSpace};
use crate::system::{Enclosed, System};

/// Fewest modes of an axis that carries a series.
const LEAST_MODES: usize = 2;

/// A frequency below this share of a force's is far enough from all multiples of it.
const NEAR_A_FORCE: f64 = 0.5;

/// The generator on the cells of a sweep, or on fewer of them.
pub(super) struct Grid {
    pub(super) space: CellSpace,
    /// Q, by columns, which sum to zero: what would leave the range waits at a wall.
    pub(super) full: CsMat<f64>,
    /// The same with half of the dissipation of advective fluxes.
    pub(super) half: CsMat<f64>,
    /// Axes of cells along which no noise acts.
    pub(super) still: Vec<usize>,
    /// The axis of the phase of a periodic force, and its angular frequency.
    force: Option<(usize, f64)>,
}

impl Grid {
    /// With `factor` times as many cells, or modes, an axis; `phase` is the axis of the phase of a periodic force.
    pub(super) fn new(
        system: &Arc<dyn System>,
        space: &CellSpace,
        (factor, phase): (f64, Option<usize>),
        options: &GeneratorOptions,
    ) -> Result<Self, SpectrumError> {
        let axes: Result<Vec<Axis>, _> = space
            .axes()
            .iter()
            .map(|axis| fewer(axis, factor))
            .collect();
        let space = CellSpace::new(axes?)?;
        let enclosed = Enclosed::new(Arc::clone(system), &space.ranges());
        let assemble = |dissipation| assemble_damped(&enclosed, &space, options, dissipation);
        let (full, half) = rayon::join(
            || assemble(Dissipation::Full),
            || assemble(Dissipation::Half),
        );
        let (full, half) = (full?.matrix, half?.matrix);
        let force = phase.map(|axis| (axis, turning_rate(system.as_ref(), &space, axis)));
        let axes = space.axes().iter().enumerate();
        let still = axes.filter(|(number, axis)| !axis.is_modes() && !system.is_noisy(*number));
        Ok(Self {
            still: still.map(|(number, _)| number).collect(),
            space,
            full,
            half,
            force,
        })
    }

    /// The numbers of the phases at which cells are, and how many phases there are: one without a periodic force.
    fn phases(&self) -> (usize, impl Fn(usize) -> usize) {
        let axis = self.force.map(|(axis, _)| axis);
        let count = axis.map_or(1, |axis| self.space.axes()[axis].count());
        let at = move |cell| axis.map_or(0, |axis| self.space.position(cell, axis));
        (count, at)
    }

    /// The sums of values over all cells at each phase of the force: of all cells without one.
    fn sums(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let (count, at) = self.phases();
        let mut sums = vec![0.0; count];
        values
            .enumerate()
            .for_each(|(cell, value)| sums[at(cell)] += value);
        sums
    }

    /// With Σ = 0 at each phase of the force. What is known for certain of a phase, that it is as likely as any other
    /// and turns without noise, is left out: its motion has eigenvalues on the imaginary axis.
    pub(super) fn balanced(&self, mut vector: Vec<f64>) -> Vec<f64> {
        if self.force.is_none() {
            return balanced(vector);
        }
        let (count, at) = self.phases();
        let cells = vector.len() / count;
        let sums = self.sums(vector.iter().copied());
        let values = vector.iter_mut().enumerate();
        values.for_each(|(cell, value)| *value -= sums[at(cell)] / cells as f64);
        vector
    }

    /// p (g - ⟨g⟩) of a function with these values, ⟨g⟩ its mean at the phase of the force.
    pub(super) fn deviation(&self, masses: &[f64], values: &[f64]) -> Vec<f64> {
        let (_, at) = self.phases();
        let products = masses.iter().zip(values).map(|(mass, value)| mass * value);
        let (totals, wholes) = (self.sums(products), self.sums(masses.iter().copied()));
        let pairs = masses.iter().zip(values).enumerate();
        let deviations = pairs.map(|(cell, (mass, value))| {
            let phase = at(cell);
            mass * (value - totals[phase] / wholes[phase])
        });
        self.balanced(deviations.collect())
    }

    /// A frequency near the given one at which Q - iω can be factorised: away from the multiples of a force's, at which
    /// the phase turns, halfway between two of them.
    pub(super) fn beside_the_force(&self, frequency: f64) -> f64 {
        match self.force {
            Some((_, force)) if frequency > NEAR_A_FORCE * force => {
                force * ((frequency / force).floor() + 0.5)
            }
            _ => frequency,
        }
    }
}

/// Radians per unit of time by which the phase of a periodic force turns, which is the same everywhere.
pub(crate) fn turning_rate(system: &dyn System, space: &CellSpace, phase: usize) -> f64 {
    let along = &space.axes()[phase];
    TAU * system.drift_at(0.0, &space.place(0))[phase] / (along.to() - along.from())
}

fn fewer(axis: &Axis, factor: f64) -> Result<Axis, SpectrumError> {
    if factor == 1.0 {
        return Ok(axis.clone());
    }
    if !axis.is_modes() {
        return Ok(axis.refined(factor));
    }
    let modes = (axis.mode_number() as f64 * factor) as usize;
    Ok(axis.with_modes(modes.max(LEAST_MODES.min(axis.mode_number())))?)
}

/// s - Q as the generator of a process that ends at the rate s everywhere: Q less s on the diagonal, and the rates.
pub(super) fn ending(matrix: &CsMat<f64>, rate: f64) -> (CsMat<f64>, Vec<f64>) {
    let mut shifted = matrix.clone();
    let mut ends = vec![rate; matrix.cols()];
    for (cell, end) in ends.iter_mut().enumerate() {
        match shifted.get_mut(cell, cell) {
            Some(own) => *own -= rate,
            // A cell that nothing leaves has no place on the diagonal.
            None => *end = 0.0,
        }
    }
    (shifted, ends)
}
