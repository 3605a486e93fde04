//! The phase of a forcing among the cells of a map.
//!
//! A cell along the phase stands for the phase at its beginning: cell k of m for the phase k/m, at which all of its
//! trajectories start. A map step is a whole number of such parts of the period, so that all of them end at one phase,
//! which is a cell again: the phase never spreads, and goes round in the chain as it does in the system.

use super::SamplingError;
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Parts of the period by which a map step may differ from a whole number of them: rounding.
const ROUNDING: f64 = 1e-6;

/// The axis that is the phase of a forcing, and the forcing's frequency, in periods per unit of time; `None` without.
pub(crate) fn frequency_of_forcing(system: &dyn System) -> Option<(usize, f64)> {
    let axis = system.facts().phase?;
    let drift = system.drift_at(0.0, &vec![0.0; system.dimension()]);
    Some((axis, drift[axis]))
}

/// Time in which a forced system passes one cell along its phase; `None` without forcing.
pub(crate) fn part_of_period(system: &dyn System, space: &CellSpace) -> Option<f64> {
    let (axis, frequency) = frequency_of_forcing(system)?;
    Some(1.0 / (frequency * space.axes()[axis].count() as f64))
}

/// How a map step moves the phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PhaseStep {
    /// The axis of the phase.
    pub(super) axis: usize,
    /// Cells along it that a map step passes, and all of them.
    passed: usize,
    count: usize,
}

impl PhaseStep {
    /// That of a system; `None` without forcing.
    ///
    /// # Errors
    /// [`SamplingError::Phase`] unless the map step is a whole number of cells of the phase.
    pub(super) fn of(
        system: &dyn System,
        space: &CellSpace,
        map_step: f64,
    ) -> Result<Option<Self>, SamplingError> {
        let (Some(axis), Some(part)) = (system.facts().phase, part_of_period(system, space)) else {
            return Ok(None);
        };
        let count = space.axes()[axis].count();
        let parts = map_step / part;
        // Also for what is not a number.
        if parts >= 0.5 && (parts - parts.round()).abs() <= ROUNDING {
            let passed = parts.round() as usize;
            return Ok(Some(Self {
                axis,
                passed,
                count,
            }));
        }
        Err(SamplingError::Phase { map_step, part })
    }

    /// The cell along the phase in which trajectories from another end.
    pub(super) fn end(&self, start: usize) -> usize {
        (start + self.passed) % self.count
    }

    /// Puts all states of a batch where they are found in a cell along the phase: rounding has moved them.
    pub(super) fn put(&self, states: &mut [Lanes], space: &CellSpace, cell: usize) {
        states[self.axis] = [space.axes()[self.axis].centre(cell); LANES];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::TypedModel;

    #[test]
    fn a_map_step_passes_whole_cells_of_the_phase_or_is_refused() {
        let model = TypedModel::new("forced", "Forced", ["x"])
            .with_equation("x", "-x + cos(w t)")
            .with_noise("x", ["1"])
            .with_parameters(["w"]);
        let system = model.build().unwrap().system_with(&[("w", 2.0)]).unwrap();
        let axes = vec![
            Axis::uniform(-3.0, 3.0, 10).unwrap(),
            Axis::turn(0.0, 1.0, 16).unwrap(),
        ];
        let space = CellSpace::new(axes).unwrap();
        let part = std::f64::consts::PI / 16.0;
        let step = PhaseStep::of(system.as_ref(), &space, 3.0 * part).unwrap();
        let step = step.unwrap();
        assert_eq!((step.axis, step.end(2), step.end(15)), (1, 5, 2));
        let refused = PhaseStep::of(system.as_ref(), &space, 2.5 * part);
        assert!(matches!(refused, Err(SamplingError::Phase { .. })));
    }
}
