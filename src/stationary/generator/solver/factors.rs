//! When to factorise, how, and where.

use sprs::CsMat;

use super::{DirectSolver, shape};
use crate::stationary::generator::modewise::has_phase;
use crate::stationary::generator::preconditioner::{
    Estimate, Preconditioner, Structure, estimate_of,
};
use crate::stationary::generator::{RateError, RateMethod, narrowing};

/// Iterations that a factorisation takes the time of: so many for moving every number of the factors about, and so many
/// for each arithmetic operation a number. Measured (`benches/rates.rs`) from 50² to 30³ cells, in both precisions,
/// within a third: iterations are bound by memory, factorisations by arithmetic the larger they are.
const RENEWAL: (f64, f64) = (12.0, 0.027);

/// Iterations of a cold solve with factors mode by mode that tell that they do not suit an equation: laws whose rate is
/// a polynomial of the first degree take 10 to 45 (`docs/accuracy.md`).
const PATIENCE: usize = 90;

/// The same of factors harmonic by harmonic, in place of which the others take a hundred times the work: an oscillator
/// driven at its resonance to six deviations of its density takes 90 to 120.
const PATIENCE_WITH_A_PHASE: usize = 240;

impl DirectSolver {
    /// Whether iterating with the factorisation at hand has come to cost more than a new one would.
    pub(in crate::stationary::generator) fn is_worn(&self) -> bool {
        let plan = self.plan.as_ref();
        plan.is_some_and(|(_, plan)| self.excess >= renewal(plan))
    }

    /// Factorises a matrix near those that are solved next, in place of the first of them; `mass` is about its steady
    /// state.
    ///
    /// # Errors
    /// As [`DirectSolver::solve`].
    pub(in crate::stationary::generator) fn renew(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        mass: &[f64],
    ) -> Result<(), RateError> {
        self.check(matrix, escape)?;
        shape(self.space.n_cells(), "mass", mass.len())?;
        let plan = self.plan(matrix)?;
        let held = self.cell_to_hold(self.choose_held(matrix, mass), mass);
        self.factorise(matrix, held, &plan)?;
        Ok(())
    }

    /// Takes the plan to fall back to when factors mode by mode, or single precision, did not converge; later solves
    /// keep it.
    pub(in crate::stationary::generator) fn fall_back(
        &mut self,
        plan: &Estimate,
    ) -> Option<Estimate> {
        let next = self.more_demanding(plan)?;
        if let Some((_, plan)) = &mut self.plan {
            *plan = next;
        }
        Some(next)
    }

    /// The next more demanding plan, where one is allowed and fits.
    fn more_demanding(&self, plan: &Estimate) -> Option<Estimate> {
        let (structure, _) = self.plan.as_ref()?;
        let next = match plan.method {
            RateMethod::Modewise => RateMethod::LuSingle,
            RateMethod::LuSingle => RateMethod::Lu,
            _ => return None,
        };
        if self.options.method.is_some() {
            return None;
        }
        let limit = self.options.memory_limit_bytes;
        estimate_of(&self.space, structure, limit, Some(next)).ok()
    }

    /// Iterations after which factors mode by mode are given up where others could be had.
    pub(in crate::stationary::generator) fn patience(&self, plan: &Estimate) -> usize {
        let is_modewise = plan.method == RateMethod::Modewise;
        match is_modewise && self.more_demanding(plan).is_some() {
            true if has_phase(&self.space) => PATIENCE_WITH_A_PHASE,
            true => PATIENCE,
            false => usize::MAX,
        }
    }

    /// The method, chosen again only when the stencil's reach grows.
    pub(super) fn plan(&mut self, matrix: &CsMat<f64>) -> Result<Estimate, RateError> {
        if let (Some((_, plan)), Some((last, _))) = (&self.plan, &self.last)
            && last.indptr() == matrix.indptr()
            && last.indices() == matrix.indices()
        {
            return Ok(*plan);
        }
        let structure = self.given.clone().unwrap_or_else(|| Structure {
            reach: narrowing::reach(&self.space, matrix),
            folded: None,
        });
        if let Some((planned, plan)) = &self.plan
            && planned
                .reach
                .iter()
                .zip(&structure.reach)
                .all(|(old, new)| new <= old)
        {
            return Ok(*plan);
        }
        let options = &self.options;
        let plan = estimate_of(
            &self.space,
            &structure,
            options.memory_limit_bytes,
            options.method,
        )?;
        self.plan = Some((structure, plan));
        Ok(plan)
    }

    /// Factorises a matrix with a cell held; gives the cell that is.
    ///
    /// # Errors
    /// [`RateError::NoRoom`], [`RateError::Cancelled`].
    pub(super) fn factorise(
        &mut self,
        matrix: &CsMat<f64>,
        held: usize,
        plan: &Estimate,
    ) -> Result<usize, RateError> {
        let unplanned = Structure::default();
        let structure = self
            .plan
            .as_ref()
            .map_or(&unplanned, |(structure, _)| structure);
        let (space, method, cancellation) = (&self.space, plan.method, &self.cancellation);
        // The memory of factors of another kind is given back before more is asked for.
        let last = self.factorised.as_ref().map(|(_, method)| *method);
        let old = self.preconditioner.take().filter(|_| last == Some(method));
        let new = Preconditioner::new(space, structure, method, matrix, held, old, cancellation)?;
        self.factorised = Some((structure.reach.clone(), method));
        let held = new.held;
        self.preconditioner = Some(new);
        self.factorisations += 1;
        self.excess = 0;
        Ok(held)
    }
}

/// Iterations that cost as much as a factorisation.
pub(super) fn renewal(plan: &Estimate) -> usize {
    let numbers = 0.5 * plan.iteration_operations;
    (RENEWAL.0 + RENEWAL.1 * plan.operations / numbers) as usize
}
