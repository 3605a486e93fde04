//! What the formulas of a family say beside its systems: how small deviations move, and whether it is a particle in a
//! potential.

use std::sync::Arc;

use super::Family;
use crate::system::{
    DampedParticle, ExponentMethod, FixedPointFault, Linearised, NoiseKind, ParameterValues,
    System, SystemError, Tangent, TangentFault,
};

impl Family {
    /// The linear equation of small deviations from a state that neither drift nor noise moves, at a coordinate of
    /// the path.
    ///
    /// # Errors
    /// [`FixedPointFault`].
    pub(crate) fn linearised(
        &self,
        coordinate: f64,
        state: &[f64],
    ) -> Result<Linearised, FixedPointFault> {
        let values = self.values_at(coordinate);
        self.linearised_of(values, state)
    }

    /// The same at values of some parameters, wherever the path goes.
    ///
    /// # Errors
    /// [`FixedPointFault`].
    pub(crate) fn linearised_with(
        &self,
        moved: &[(&str, f64)],
        state: &[f64],
    ) -> Result<Linearised, FixedPointFault> {
        let mut moved = moved.iter();
        let values = moved.try_fold(self.values.clone(), |values, (name, value)| {
            self.model.with(&values, name, *value)
        });
        self.linearised_of(values, state)
    }

    fn linearised_of(
        &self,
        values: Result<ParameterValues, SystemError>,
        state: &[f64],
    ) -> Result<Linearised, FixedPointFault> {
        let values = values.map_err(|_| FixedPointFault::NotAllowed)?;
        let formulas = self.model.formulas().ok_or(FixedPointFault::NoFormulas)?;
        formulas.linearised(values.as_slice(), state)
    }

    /// The damped particle in a potential that the formulas are at a coordinate of the path; `None` where their form
    /// shows none.
    pub(crate) fn particle_at(&self, coordinate: f64) -> Option<DampedParticle> {
        let values = self.values_at(coordinate).ok()?;
        self.model.formulas()?.particle(values.as_slice())
    }

    /// Why there is no largest Lyapunov exponent along the density at a coordinate of the path; `None` where there is
    /// one.
    pub(crate) fn tangent_fault(
        &self,
        coordinate: f64,
        by: ExponentMethod,
    ) -> Option<TangentFault> {
        let formulas = self.model.formulas();
        let Some(formulas) = formulas.filter(|_| self.model.noise_kind() == NoiseKind::White)
        else {
            return Some(TangentFault::NoFormulas);
        };
        let system = self.at(coordinate).ok()?;
        formulas.tangent_fault(system.facts(), by)
    }

    /// A system of the path at a coordinate with the angle of small deviations from its paths; `scales` are lengths
    /// along the axes that count as equal.
    ///
    /// # Errors
    /// [`TangentFault`].
    pub(crate) fn tangent(
        &self,
        coordinate: f64,
        system: &Arc<dyn System>,
        (scales, by): (&[f64], ExponentMethod),
    ) -> Result<Tangent, TangentFault> {
        let values = self.values_at(coordinate);
        let values = values.map_err(|_| TangentFault::NoFormulas)?;
        let formulas = self.model.formulas().ok_or(TangentFault::NoFormulas)?;
        formulas.tangent(system.clone(), values.as_slice(), (scales, by))
    }
}
