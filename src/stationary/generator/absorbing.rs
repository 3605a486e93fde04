//! Processes that end: how long each cell is occupied before, and what is expected of the way from each cell.
//!
//! With Q on the cells that a process may be in, and e the rates at which it ends, a process that starts spread as f
//! occupies the cells for the times z, Q z = -f, and Σ z is the mean time to its end. A process may last for 10¹² units
//! of time: then Q is singular to rounding, and z of a plain solve is worth nothing. So one cell that is occupied for
//! long is held, its balance dropped, and its time follows from e·z = Σf, that everything ends. Nothing in that is a
//! small difference of large numbers, whether ends are rare or not. Where the first solve shows that Q is far from
//! singular, none is held, which saves the solves that holding takes.
//!
//! What another scheme Q' changes follows to first order from both sides, without another factorisation: with w the
//! expected times to the end from each cell, the mean time changes by w·(Q' - Q) z. What is left of either equation
//! makes up for itself the same way.

mod expected;
mod stage;
mod work;

use sprs::CsMat;

use super::balance::{dot, product, transposed_product};
use super::narrowing;
use super::newton::{FirstPass, refined};
use super::passes::{Seat, run_alone, together};
use super::preconditioner::{LARGE, Preconditioner, Structure, estimate_of};
use super::{RateError, RateMethod, RateOptions};
use crate::cancellation::Cancellation;
use crate::space::CellSpace;
pub(crate) use expected::Expected;
pub use work::AbsorbingWork;
pub(crate) use work::FactorMemory;

/// Bytes of factors in double precision, over what is large for iterations, up to which they are made: a pass takes
/// twice as long as in single precision, and a solve half as many.
const ROOM: u64 = 4;

/// What a first pass through factors in single precision may leave of a solution: as much again is left by the second,
/// and the two take as long as one in double precision.
const LIGHT: f64 = 1e-3;

/// Error at which solves by factors in single precision stop, over that which is asked for: numbers have the square of
/// it, because what the equations of both sides leave puts them right.
const LOOSER: f64 = 30.0;

/// Solves a process that ends, with one factorisation.
pub(crate) struct AbsorbingSolver<'s> {
    space: &'s CellSpace,
    options: RateOptions,
    preconditioner: Option<Preconditioner>,
    /// Factors of another matrix, whose structure and memory serve again where the pattern is the same.
    memory: Option<Preconditioner>,
    /// Whether a solve may be left after one pass.
    is_rough: bool,
    /// Whether no cell need be held where solves are left after one pass.
    is_free: bool,
    /// Whether factors in single precision are tried first, where no cell need be held.
    is_light: bool,
    /// Whether solves by such factors leave no more than others.
    is_tight: bool,
    /// Whether the current factors are those of the matrix itself, with no cell held that is coupled to others.
    is_unheld: bool,
    /// What the first pass through the factors did, where solves may be left after one.
    first: Option<FirstPass>,
    /// Factorisations that were made, and passes through them.
    pub(crate) work: AbsorbingWork,
    cancellation: Cancellation,
}

/// A matrix that is being solved.
pub(crate) struct Absorbing<'a> {
    matrix: &'a CsMat<f64>,
    /// Rates at which the process ends.
    ends: &'a [f64],
    held: usize,
    /// What holding a cell takes; `None` where the one that is held is coupled to no other.
    visits: Option<Visits>,
}

/// What holding a cell takes.
struct Visits {
    /// Times in all cells a unit of time in the held one, from visits that begin there.
    unit: Vec<f64>,
    /// Probability that the process ends before it is in the held cell, from each cell; zero from that cell.
    ended: Vec<f64>,
}

impl Absorbing<'_> {
    /// Q z.
    pub(crate) fn balance(&self, times: &[f64]) -> Vec<f64> {
        product(self.matrix, times)
    }

    /// w·Q z, with the product Q z at hand.
    pub(crate) fn of_balance(&self, balance: &[f64], expected: &Expected, times: &[f64]) -> f64 {
        dot(balance, &expected.beside) - expected.at_held * dot(self.ends, times)
    }
}

impl<'s> AbsorbingSolver<'s> {
    /// A solver without a factorisation yet.
    pub(crate) fn new(
        space: &'s CellSpace,
        options: RateOptions,
        cancellation: &Cancellation,
    ) -> Self {
        Self {
            space,
            options,
            preconditioner: None,
            memory: None,
            is_rough: false,
            is_free: false,
            is_light: false,
            is_tight: false,
            is_unheld: false,
            first: None,
            work: AbsorbingWork::default(),
            cancellation: cancellation.clone(),
        }
    }

    /// The same, with solves that are left after one pass where the first shows that factors are good enough for that.
    pub(crate) fn rough(mut self) -> Self {
        self.is_rough = true;
        self
    }

    /// The same, and no cell is held where one pass a solve is good enough without.
    pub(crate) fn free(mut self) -> Self {
        self.is_free = true;
        self
    }

    /// The same, with factors in single precision where that is asked for and no cell need be held: half of the memory
    /// and of the time, and good for a matrix that is far from singular.
    pub(crate) fn light(mut self, is_light: bool) -> Self {
        self.is_light = is_light;
        self
    }

    /// Whether the matrix is so far from singular that factors in single precision will do for others like it: known
    /// of factors in double precision without a cell held.
    pub(crate) fn is_far_from_singular(&self) -> bool {
        let first = self.first.filter(|_| self.is_unheld && !self.is_light);
        first.is_some_and(|first| {
            first.contraction <= LIGHT * f64::EPSILON / f64::from(f32::EPSILON)
        })
    }

    /// From now on what solves leave is as asked for also where factors are in single precision.
    pub(crate) fn tighten(&mut self) {
        self.is_tight = true;
    }

    /// Error at which a solve stops to be iterated, and most passes.
    fn effort(&self) -> (f64, usize) {
        let times = if self.is_light && !self.is_tight {
            LOOSER
        } else {
            1.0
        };
        (times * self.options.tolerance, self.options.max_iterations)
    }

    /// The same, with the structure and the memory of factors that another solver has left.
    pub(crate) fn with_memory(mut self, memory: FactorMemory) -> Self {
        self.memory = memory.0;
        self
    }

    /// Structure and memory of the factors, for another solver; nothing where they are large.
    pub(crate) fn into_memory(self) -> FactorMemory {
        let kept = self.preconditioner.or(self.memory);
        FactorMemory(kept.filter(|kept| kept.factor_bytes() <= ROOM * LARGE))
    }

    /// Double precision where that is not too large, with which one pass does for a solve; single precision elsewhere.
    fn method(&self, structure: &Structure) -> Result<RateMethod, RateError> {
        let limit = self.options.memory_limit_bytes;
        let of = |method| estimate_of(self.space, structure, limit, Some(method));
        if self.is_light {
            return Ok(of(RateMethod::LuSingle)?.method);
        }
        let room = if self.is_rough { ROOM * LARGE } else { LARGE };
        match of(RateMethod::Lu) {
            Ok(plan) if plan.factor_bytes <= room => Ok(plan.method),
            _ => Ok(of(RateMethod::LuSingle)?.method),
        }
    }

    fn structure(&self, matrix: &CsMat<f64>) -> Structure {
        Structure {
            reach: narrowing::reach(self.space, matrix),
            folded: None,
        }
    }

    /// Factorises; gives the cell that is held.
    fn factorise(
        &mut self,
        matrix: &CsMat<f64>,
        structure: &Structure,
        held: usize,
    ) -> Result<usize, RateError> {
        let method = self.method(structure)?;
        let old = self.preconditioner.take().or_else(|| self.memory.take());
        let (space, cancellation) = (self.space, &self.cancellation);
        let new = Preconditioner::new(space, structure, method, matrix, held, old, cancellation)?;
        self.work.factorisations += 1;
        let held = new.held;
        self.preconditioner = Some(new);
        (self.first, self.is_unheld) = (None, false);
        Ok(held)
    }

    /// The times for which a process that starts spread as `start` (any sum) occupies the cells before it ends.
    ///
    /// # Errors
    /// [`RateError::Sensitivity`] where iterating does not converge, [`RateError::Cancelled`].
    pub(crate) fn times(
        &mut self,
        stage: &Absorbing<'_>,
        start: &[f64],
    ) -> Result<Vec<f64>, RateError> {
        let held = stage.held;
        // What is beside the visits of the held cell.
        let mut times = self.reduced(stage.matrix, held, &without(start, held), false)?;
        let Some(Visits { unit, .. }) = &stage.visits else {
            return Ok(times);
        };
        let ended = start.iter().sum::<f64>() - dot(stage.ends, &times);
        let time = ended / dot(stage.ends, unit);
        let pairs = times.iter_mut().zip(unit);
        pairs.for_each(|(value, unit)| *value += time * unit);
        Ok(times)
    }

    /// [`AbsorbingSolver::times`] of two starts, which share their passes where no cell is held.
    ///
    /// # Errors
    /// As [`AbsorbingSolver::times`].
    pub(crate) fn times_of_both(
        &mut self,
        stage: &Absorbing<'_>,
        starts: [&[f64]; 2],
    ) -> Result<[Vec<f64>; 2], RateError> {
        let is_zero = |start: &[f64]| start.iter().all(|&value| value == 0.0);
        let kept = match &self.preconditioner {
            Some(kept) if stage.visits.is_none() && !starts.into_iter().any(is_zero) => kept,
            _ => {
                let [one, other] = starts;
                return Ok([self.times(stage, one)?, self.times(stage, other)?]);
            }
        };
        let sources = starts.map(|start| without(start, stage.held));
        let operator = |x: &[f64]| applied((stage.matrix, stage.held), x, false);
        let seats = [Seat::default(), Seat::default()];
        let effort = self.effort();
        let [one, other] = [0, 1].map(|at| {
            let source = (sources[at].as_slice(), self.first);
            refined(&seats[at], &operator, source, effort, &self.cancellation)
        });
        let (one, other, _) = together(kept, seats.each_ref(), one, other);
        let [one, other] = [one?, other?].map(|found| found.ok_or(RateError::Sensitivity));
        let (one, other) = (one?, other?);
        self.work.passes += one.used + other.used;
        if self.is_rough {
            self.first = self.first.or(one.first);
        }
        Ok([one.solution, other.solution])
    }

    /// What a process that starts in each cell is expected to gather before it ends, where a cell that is occupied
    /// gives `gain` per unit of time: with a gain of one the mean time to the end, with the rates into one of several
    /// ends the probability of that.
    ///
    /// # Errors
    /// As [`AbsorbingSolver::times`].
    pub(crate) fn expected(
        &mut self,
        stage: &Absorbing<'_>,
        gain: &[f64],
    ) -> Result<Expected, RateError> {
        let (matrix, held) = (stage.matrix, stage.held);
        // Before the held cell is reached.
        let gathered = self.reduced(matrix, held, &without(gain, held), true)?;
        let Some(Visits { ended, .. }) = &stage.visits else {
            return Ok(Expected {
                at_held: 0.0,
                beside: gathered,
            });
        };
        let from_held = |values: &[f64]| -> f64 {
            let column = matrix.outer_view(held);
            let terms =
                column.map(|column| column.iter().map(|(row, rate)| rate * values[row]).sum());
            terms.unwrap_or(0.0)
        };
        let ending = stage.ends[held] + from_held(ended);
        let at_held = (gain[held] + from_held(&gathered)) / ending;
        let pairs = gathered.iter().zip(ended);
        Ok(Expected {
            at_held,
            beside: pairs.map(|(gain, end)| gain - end * at_held).collect(),
        })
    }

    /// Solves Q x = source (Qᵀ x where it is transposed) with a cell held at zero.
    fn reduced(
        &mut self,
        matrix: &CsMat<f64>,
        held: usize,
        source: &[f64],
        is_transposed: bool,
    ) -> Result<Vec<f64>, RateError> {
        let Some(kept) = &self.preconditioner else {
            return Err(RateError::NoSteadyState);
        };
        if source.iter().all(|&value| value == 0.0) {
            return Ok(source.to_vec());
        }
        let operator = |x: &[f64]| applied((matrix, held), x, is_transposed);
        let seat = Seat::default();
        let effort = self.effort();
        let source = (source, self.first);
        let work = refined(&seat, &operator, source, effort, &self.cancellation);
        let apply = |rest: &[f64]| {
            if is_transposed {
                kept.apply_transposed(rest)
            } else {
                kept.apply_one(rest)
            }
        };
        let found = run_alone(apply, &seat, work)?;
        let found = found.ok_or(RateError::Sensitivity)?;
        self.work.passes += found.used;
        if self.is_rough {
            self.first = self.first.or(found.first);
        }
        Ok(found.solution)
    }
}

/// Zero at the cell that is held, if one is.
fn clear(values: &mut [f64], held: usize) {
    if let Some(value) = values.get_mut(held) {
        *value = 0.0;
    }
}

/// Q x (Qᵀ x where it is transposed), zero at the cell that is held.
fn applied((matrix, held): (&CsMat<f64>, usize), x: &[f64], is_transposed: bool) -> Vec<f64> {
    let mut out = match is_transposed {
        true => transposed_product(matrix, x),
        false => product(matrix, x),
    };
    clear(&mut out, held);
    out
}

/// The right side of what is spread or gathered beside a cell that is held.
fn without(gain: &[f64], held: usize) -> Vec<f64> {
    let mut negative: Vec<f64> = gain.iter().map(|value| -value).collect();
    clear(&mut negative, held);
    negative
}
