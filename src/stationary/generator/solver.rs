//! The solver: iterates with the factorisation it has, factorises when iterating would cost more.

use sprs::CsMat;

use super::balance::{Balance, add_product};
use super::memory::SolverMemory;
use super::narrowing;
use super::newton::{Newton, Progress, linear};
use super::preconditioner::{Estimate, Preconditioner, Structure, estimate_of};
use super::{RateError, RateInfo, RateMethod, RateOptions, RateSteadyState};
use crate::cancellation::{Cancellation, Cancelled};
use crate::space::CellSpace;

/// Iterations that a factorisation takes the time of: so many for moving every number of the factors about, and so many
/// for each arithmetic operation a number. Measured (`benches/rates.rs`) from 50² to 30³ cells, in both precisions, within
/// a third: iterations are bound by memory, factorisations by arithmetic the larger they are.
const RENEWAL: (f64, f64) = (12.0, 0.027);
/// Iterations of a [`DirectSolver::response`] to two digits with the factors of its own matrix.
const FRESH_RESPONSE: usize = 2;
/// If the held cell carries less than this share of the largest mass, another one is held in new factors, and new ones are
/// made if a solve fails.
const WEAK_HELD_SHARE: f64 = 1e-2;
/// The held cell must carry at least this share of the largest mass, or another one is held.
const LEAST_HELD_SHARE: f64 = 1e-8;

/// Solves generators on one cell space, keeping the factorisation from one to the next.
pub(super) struct DirectSolver {
    space: CellSpace,
    options: RateOptions,
    /// Of a folded matrix, whose entries do not show it.
    given: Option<Structure>,
    plan: Option<(Structure, Estimate)>,
    preconditioner: Option<Preconditioner>,
    /// Iterations that a new factorisation would have saved since this one was made.
    excess: usize,
    /// Iterations that the solve took for which the factorisation was made.
    baseline: usize,
    last: Option<(CsMat<f64>, Vec<f64>)>,
    /// Factorisations that were made, and the reach and method of the last.
    factorisations: usize,
    factorised: Option<(Vec<usize>, RateMethod)>,
    cancellation: Cancellation,
}

impl DirectSolver {
    /// A solver without a factorisation yet.
    pub(super) fn new(space: CellSpace, options: RateOptions, given: Option<Structure>) -> Self {
        Self {
            space,
            given,
            options,
            plan: None,
            preconditioner: None,
            excess: 0,
            baseline: 0,
            last: None,
            factorisations: 0,
            factorised: None,
            cancellation: Cancellation::new(),
        }
    }

    /// The solver with a token that is looked at in every front of a factorisation and in every iteration.
    #[must_use]
    pub(super) fn cancelled_by(self, cancellation: &Cancellation) -> Self {
        let cancellation = cancellation.clone();
        Self {
            cancellation,
            ..self
        }
    }

    /// Factorisations that were made since the solver was.
    pub(super) fn factorisations(&self) -> usize {
        self.factorisations
    }

    /// Where the solver stands, but for the matrices.
    pub(super) fn memory(&self) -> SolverMemory {
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

    /// Brings a fresh solver to where another one on the same cells was: `factorised` is the matrix that it had factorised, `last`
    /// that of its last solve with the escape. What is solved then is the same to the bit.
    ///
    /// # Errors
    /// As [`RateSolver::solve`].
    pub(super) fn restore(
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

    /// The (quasi-)steady state of a generator: `matrix` is n × n by columns (CSC), column j the rates out of
    /// cell j, summing to -`escape[j]`. `guess` is a neighbour's mass vector, or one predicted from it.
    ///
    /// # Errors
    /// [`RateError`] when the input is no generator, the memory does not suffice, or the solve is cancelled.
    pub(super) fn solve(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        guess: Option<&[f64]>,
    ) -> Result<RateSteadyState, RateError> {
        self.check(matrix, escape)?;
        let mut mass = match guess {
            Some(guess) => self.normalised(guess)?,
            None => Vec::new(),
        };
        let mut plan = self.plan(matrix)?;
        let mut progress = Progress::default();
        let mut held = self.choose_held(matrix, &mass);
        let worn = self.excess >= renewal(&plan);
        let mut fresh = worn
            || self
                .preconditioner
                .as_ref()
                .is_none_or(|kept| kept.held != held);
        // At most: the old factorisation, a new one, one with a better cell held, one in double precision.
        for _ in 0..4 {
            if fresh {
                held = self.better_held(held, &mass);
                self.factorise(matrix, held, &plan)?;
                progress.factorisations += 1;
            }
            if mass.is_empty() || !mass.iter().sum::<f64>().is_finite() {
                mass = vec![0.0; matrix.cols()];
                mass[held] = 1.0;
            }
            let balance = Balance {
                matrix,
                escape,
                held,
            };
            self.iterate(&balance, &mut mass, &mut progress, fresh, &plan)?;
            // The sign is arbitrary: on a grid too coarse, wiggles may make the held cell's mass negative.
            if mass.iter().sum::<f64>() < 0.0 {
                mass.iter_mut().for_each(|value| *value = -*value);
            }
            if progress.converged {
                break;
            }
            let (best, largest) = largest(&mass);
            if best != held && mass[held].abs() < WEAK_HELD_SHARE * largest {
                held = best;
            } else if fresh {
                let Some(double) = self.in_double_precision(&plan) else {
                    break;
                };
                plan = double;
            }
            fresh = true;
        }
        Ok(self.finish(matrix, escape, mass, &progress, plan.method))
    }

    /// The plan to fall back to when single precision did not converge; kept for later solves.
    fn in_double_precision(&mut self, plan: &Estimate) -> Option<Estimate> {
        let (structure, _) = self.plan.as_ref()?;
        let limit = self.options.memory_limit_bytes;
        if plan.method != RateMethod::LuSingle || self.options.method.is_some() {
            return None;
        }
        let double = estimate_of(&self.space, structure, limit, Some(RateMethod::Lu)).ok()?;
        self.plan = Some((structure.clone(), double));
        Some(double)
    }

    /// By how much more mass enters each cell when Q changes by `derivative` (CSC).
    ///
    /// # Errors
    /// [`RateError::Shape`] for wrong sizes, [`RateError::Storage`].
    pub(super) fn change(
        &self,
        derivative: &CsMat<f64>,
        mass: &[f64],
    ) -> Result<Vec<f64>, RateError> {
        let cells = self.space.n_cells();
        shape(cells, "derivative's rows", derivative.rows())?;
        shape(cells, "derivative's columns", derivative.cols())?;
        shape(cells, "mass", mass.len())?;
        if !derivative.is_csc() {
            return Err(RateError::Storage);
        }
        let mut change = vec![0.0; cells];
        add_product(derivative, mass, &mut change);
        Ok(change)
    }

    /// Nothing, if the vectors of a response have one entry a cell.
    ///
    /// # Errors
    /// [`RateError::Shape`].
    pub(super) fn shapes(
        &self,
        change: &[f64],
        mass: &[f64],
        guess: Option<&[f64]>,
    ) -> Result<(), RateError> {
        let cells = self.space.n_cells();
        shape(cells, "change", change.len())?;
        shape(cells, "mass", mass.len())?;
        shape(cells, "guess", guess.map_or(cells, <[f64]>::len))
    }

    /// Whether the last matrix that was solved is this one.
    pub(super) fn has_solved(&self, matrix: &CsMat<f64>) -> bool {
        self.last.as_ref().is_some_and(|(last, _)| last == matrix)
    }

    /// How the last steady state `mass` answers to a change of its balance: p' (Σ = 0) from Q p' = -`change`, where `change`
    /// is by how much more mass enters each cell than before, per unit time; what its sum lacks escapes.
    ///
    /// # Errors
    /// As [`super::RateSolver::sensitivity`].
    pub(super) fn response(
        &mut self,
        change: &[f64],
        mass: &[f64],
        guess: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<Vec<f64>, RateError> {
        let (Some((matrix, escape)), Some(kept)) = (&self.last, &self.preconditioner) else {
            return Err(RateError::NoSteadyState);
        };
        self.shapes(change, mass, guess)?;
        let balance = Balance {
            matrix,
            escape,
            held: kept.held,
        };
        let total: f64 = mass.iter().sum();
        // dF/dθ: rates change, and with them the escape, by minus the column sums.
        let lost: f64 = -change.iter().sum::<f64>() / total;
        let pairs = change.iter().zip(mass);
        let mut source: Vec<f64> = pairs.map(|(c, p)| -(c + lost * p)).collect();
        source[kept.held] = 0.0;
        // The cell that is held does not answer; p may be added freely.
        let start = guess.map(|guess| {
            let share = guess[kept.held] / mass[kept.held];
            let pairs = guess.iter().zip(mass);
            pairs.map(|(x, p)| x - share * p).collect::<Vec<f64>>()
        });
        let start = start.filter(|start| start.iter().all(|value| value.is_finite()));
        let effort = (tolerance, self.options.max_iterations);
        let cancellation = &self.cancellation;
        let response = linear(&balance, kept, mass, (&source, start), effort, cancellation)?;
        let (mut response, used) = response.ok_or(RateError::Sensitivity)?;
        self.excess += used.saturating_sub(FRESH_RESPONSE);
        let excess: f64 = response.iter().sum::<f64>() / total;
        for (slot, value) in response.iter_mut().zip(mass) {
            *slot -= excess * value;
        }
        Ok(response)
    }

    pub(super) fn check(&self, matrix: &CsMat<f64>, escape: &[f64]) -> Result<(), RateError> {
        let cells = self.space.n_cells();
        shape(cells, "rows", matrix.rows())?;
        shape(cells, "columns", matrix.cols())?;
        shape(cells, "escape", escape.len())?;
        if !matrix.is_csc() {
            return Err(RateError::Storage);
        }
        for (cell, (column, &escape)) in matrix.outer_iterator().zip(escape).enumerate() {
            let sum: f64 = column.data().iter().sum();
            let size: f64 = column.data().iter().map(|rate| rate.abs()).sum();
            let gap = (sum + escape).abs();
            if !gap.is_finite() || gap > 1e-10 * (size + escape.abs()) {
                return Err(RateError::Column { cell, sum, escape });
            }
        }
        Ok(())
    }

    fn normalised(&self, guess: &[f64]) -> Result<Vec<f64>, RateError> {
        shape(self.space.n_cells(), "guess", guess.len())?;
        let sum: f64 = guess.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(RateError::Guess);
        }
        Ok(guess.iter().map(|value| value / sum).collect())
    }

    /// The method, chosen again only when the stencil's reach grows.
    fn plan(&mut self, matrix: &CsMat<f64>) -> Result<Estimate, RateError> {
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

    /// The cell to hold: the one that is held, if it carries mass; the most probable one of the guess; without
    /// a guess the one that is left most slowly, which is near a point of rest.
    fn choose_held(&self, matrix: &CsMat<f64>, mass: &[f64]) -> usize {
        if mass.is_empty() {
            let rate = |cell: usize| matrix.get(cell, cell).map_or(0.0, |rate| rate.abs());
            let cells = 0..matrix.cols();
            let slowest = cells.min_by(|&a, &b| rate(a).total_cmp(&rate(b)));
            return slowest.unwrap_or(0);
        }
        let (best, largest) = largest(mass);
        let kept = self.preconditioner.as_ref().map(|kept| kept.held);
        // Between wiggles, and at the nodes of a series, a cell's mass may be below zero: its size is what holds.
        kept.filter(|&held| mass[held].abs() >= LEAST_HELD_SHARE * largest)
            .unwrap_or(best)
    }

    /// The cell to hold in new factors: the old one unless it carries little mass, which would be lost in the next
    /// points.
    fn better_held(&self, held: usize, mass: &[f64]) -> usize {
        if mass.is_empty() {
            return held;
        }
        let (best, largest) = largest(mass);
        if mass[held].abs() < WEAK_HELD_SHARE * largest {
            best
        } else {
            held
        }
    }

    fn factorise(
        &mut self,
        matrix: &CsMat<f64>,
        held: usize,
        plan: &Estimate,
    ) -> Result<(), Cancelled> {
        let unplanned = Structure::default();
        let structure = self
            .plan
            .as_ref()
            .map_or(&unplanned, |(structure, _)| structure);
        let old = self.preconditioner.take();
        let (space, method, cancellation) = (&self.space, plan.method, &self.cancellation);
        let new = Preconditioner::new(space, structure, method, matrix, held, old, cancellation)?;
        self.factorised = Some((structure.reach.clone(), method));
        self.preconditioner = Some(new);
        self.factorisations += 1;
        self.excess = 0;
        Ok(())
    }

    fn iterate(
        &mut self,
        balance: &Balance<'_>,
        mass: &mut [f64],
        progress: &mut Progress,
        fresh: bool,
        plan: &Estimate,
    ) -> Result<(), Cancelled> {
        let Some(kept) = &self.preconditioner else {
            return Ok(());
        };
        let worth = if fresh {
            usize::MAX
        } else {
            self.baseline + renewal(plan)
        };
        let newton = Newton {
            balance,
            kept,
            tolerance: self.options.tolerance,
            limit: worth.min(self.options.max_iterations),
            fresh,
            narrow: plan.method.is_narrow(),
            cancellation: &self.cancellation,
        };
        let used = newton.run(mass, progress)?;
        if fresh {
            self.baseline = used;
        }
        self.excess += used.saturating_sub(self.baseline);
        Ok(())
    }

    fn finish(
        &mut self,
        matrix: &CsMat<f64>,
        escape: &[f64],
        mut mass: Vec<f64>,
        progress: &Progress,
        method: RateMethod,
    ) -> RateSteadyState {
        let sum: f64 = mass.iter().sum();
        mass.iter_mut().for_each(|value| *value /= sum);
        let balance = Balance {
            matrix,
            escape,
            held: 0,
        };
        let info = RateInfo {
            method,
            factorisations: progress.factorisations,
            iterations: progress.iterations,
            residual: balance.relative_residual(&mass),
            error_estimate: progress.error,
            escape_rate: balance.escape_rate(&mass),
            negative_mass: mass.iter().map(|value| (-value).max(0.0)).sum(),
            unknowns: mass.len(),
            factor_bytes: self
                .preconditioner
                .as_ref()
                .map_or(0, Preconditioner::factor_bytes),
            converged: progress.converged && sum > 0.0,
        };
        self.last = Some((matrix.clone(), escape.to_vec()));
        RateSteadyState { mass, info }
    }
}

fn shape(cells: usize, part: &'static str, found: usize) -> Result<(), RateError> {
    if found == cells {
        Ok(())
    } else {
        Err(RateError::Shape { cells, part, found })
    }
}

/// Iterations that cost as much as a factorisation.
fn renewal(plan: &Estimate) -> usize {
    let numbers = 0.5 * plan.iteration_operations;
    (RENEWAL.0 + RENEWAL.1 * plan.operations / numbers) as usize
}

/// The cell with the largest mass, and that mass.
fn largest(mass: &[f64]) -> (usize, f64) {
    let cells = mass.iter().copied().enumerate();
    cells.fold((0, f64::NEG_INFINITY), |best, cell| {
        if cell.1 > best.1 { cell } else { best }
    })
}
