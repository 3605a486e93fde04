//! Where a solver stands, and how another one is brought there.

use sprs::CsMat;

use super::{DirectSolver, shape};
use crate::stationary::generator::RateError;
use crate::stationary::generator::memory::SolverMemory;
use crate::stationary::generator::preconditioner::{
    Estimate, Preconditioner, Structure, estimate_of,
};

impl DirectSolver {
    /// Where the solver stands, but for the matrices.
    pub(in crate::stationary::generator) fn memory(&self) -> SolverMemory {
        let of = |(structure, plan): &(Structure, Estimate)| (structure.reach.clone(), plan.method);
        SolverMemory {
            plan: self.plan.as_ref().map(of),
            factorised: self.factorised.clone(),
            folded: false,
            held: self.preconditioner.as_ref().map_or(0, |kept| kept.held),
            excess: self.excess,
            baseline: self.baseline,
        }
    }

    /// Brings a fresh solver to where another one on the same cells was: `factorised` is the matrix that it had
    /// factorised, `last` that of its last solve with the escape. What is solved then is the same to the bit.
    ///
    /// # Errors
    /// As [`RateSolver::solve`].
    pub(in crate::stationary::generator) fn restore(
        &mut self,
        memory: &SolverMemory,
        factorised: Option<&CsMat<f64>>,
        last: Option<(CsMat<f64>, Vec<f64>)>,
    ) -> Result<(), RateError> {
        let cells = self.space.n_cells();
        shape(
            cells,
            "held cell",
            if memory.held < cells {
                cells
            } else {
                memory.held
            },
        )?;
        for matrix in factorised
            .into_iter()
            .chain(last.as_ref().map(|last| &last.0))
        {
            shape(cells, "columns", matrix.cols())?;
        }
        if let (Some((reach, method)), Some(matrix)) = (&memory.factorised, factorised) {
            let (space, cancellation) = (&self.space, &self.cancellation);
            let held = memory.held;
            let structure = self.structure_of(reach);
            let made =
                Preconditioner::new(space, &structure, *method, matrix, held, None, cancellation)?;
            self.preconditioner = Some(made);
        }
        self.plan = match &memory.plan {
            Some((reach, method)) => {
                let limit = self.options.memory_limit_bytes;
                let structure = self.structure_of(reach);
                let plan = estimate_of(&self.space, &structure, limit, Some(*method))?;
                Some((structure, plan))
            }
            None => None,
        };
        self.factorised.clone_from(&memory.factorised);
        (self.excess, self.baseline) = (memory.excess, memory.baseline);
        self.last = last;
        Ok(())
    }

    /// The structure of a matrix of this reach.
    fn structure_of(&self, reach: &[usize]) -> Structure {
        Structure {
            reach: reach.to_vec(),
            ..self.given.clone().unwrap_or_default()
        }
    }
}
