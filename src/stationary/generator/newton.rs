//! Newton's method on the balance, its linear systems by refinement or GMRES with a factorisation at hand.
//!
//! A correction M⁻¹ F, divided by the smallest singular value seen of M⁻¹ F', estimates the error of the masses;
//! a residual would not, because slow modes hide in it.

use super::balance::Balance;
use super::krylov::{Limits, Operator, gmres};
use super::passes::Seat;
use crate::cancellation::{Cancellation, Cancelled};

/// How much worse than for one source a first pass may be for another that leaves the same residual.
const OTHER_SOURCES: f64 = 10.0;
/// Contraction per iteration below which plain refinement needs no GMRES.
const FAST: f64 = 0.1;
/// Least reduction asked of one run of GMRES: beyond, rounding of its basis shows.
const LEAST_REDUCTION: f64 = 1e-9;
/// Vectors that GMRES keeps before it restarts.
const BASIS: usize = 120;

/// Share of the tolerance that is asked of GMRES, whose norm is not ours.
const UNSEEN: f64 = 0.2;
/// Tolerance from which on a result is not looked at again.
const ROUGH: f64 = 1e-3;

/// Work and state of one solve.
#[derive(Default)]
pub(super) struct SolveWork {
    pub(super) factorisations: usize,
    pub(super) iterations: usize,
    pub(super) error: f64,
    pub(super) converged: bool,
}

/// One attempt with one factorisation.
pub(super) struct Newton<'a> {
    pub(super) balance: &'a Balance<'a>,
    /// Where M⁻¹ is applied.
    pub(super) seat: &'a Seat,
    pub(super) tolerance: f64,
    /// Largest number of iterations.
    pub(super) limit: usize,
    /// Whether the factors are those of this matrix.
    pub(super) fresh: bool,
    /// Whether the factors are those of the matrix, not of a stand-in.
    pub(super) exact: bool,
    pub(super) cancellation: &'a Cancellation,
}

impl Newton<'_> {
    /// Improves `mass` until converged, stalled or out of iterations; gives the iterations used.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub(super) async fn run(
        &self,
        mass: &mut [f64],
        progress: &mut SolveWork,
    ) -> Result<usize, Cancelled> {
        let (mut used, mut smallest, mut previous) = (0, 1.0f64, f64::INFINITY);
        let (mut rounds, mut stalls) = (0, 0);
        progress.converged = false;
        while used < self.limit {
            self.cancellation.check()?;
            let mut step = self.seat.pass(self.balance.residual(mass)).await;
            used += 1;
            step.iter_mut().for_each(|value| *value = -*value);
            let size = norm(&step) / norm(mass);
            progress.error = size / smallest;
            if !progress.error.is_finite() {
                break;
            }
            progress.converged = progress.error <= self.tolerance;
            stalls = if size > 0.5 * previous { stalls + 1 } else { 0 };
            let exact = self.fresh && self.exact;
            let plain = exact && (rounds == 0 || size <= FAST * previous);
            if progress.converged || plain {
                add(mass, &step);
            }
            if progress.converged || stalls > 2 {
                break;
            }
            previous = size;
            rounds += 1;
            if plain {
                continue;
            }
            let limits = self.limits(progress.error, rounds, self.limit - used);
            let jacobian = self.balance.jacobian(mass);
            let derivative = |vector: &[f64]| jacobian.apply(vector);
            let outcome = gmres(self.seat, &derivative, step, limits, self.cancellation).await?;
            used += outcome.iterations;
            // Newton's first steps may pass by a singular matrix that says nothing of the solution.
            let early = self.balance.leaks() && rounds <= 2;
            smallest = outcome.smallest.min(if early { 1.0 } else { smallest });
            add(mass, &outcome.solution);
            if !outcome.reached && !self.fresh && self.exact {
                break;
            }
        }
        progress.iterations += used;
        Ok(used)
    }

    fn limits(&self, error: f64, rounds: usize, left: usize) -> Limits {
        // The first step is not worth more while the escape rate is unknown.
        let unknown_rate = self.fresh && rounds == 1 && self.balance.leaks();
        let least = if unknown_rate { 1e-4 } else { LEAST_REDUCTION };
        Limits {
            reduction: (0.1 * self.tolerance / error).max(least),
            iterations: left.min(BASIS),
            give_up_early: !self.fresh && self.exact,
        }
    }
}

/// Solves A x = source from a start that is zero at the held cell, restarted until the correction is small against x;
/// gives x and the iterations used, `None` when it is not after `limit` of them.
///
/// # Errors
/// [`Cancelled`].
pub(super) async fn linear(
    seat: &Seat,
    operator: &Operator<'_>,
    (source, start): (&[f64], Option<Vec<f64>>),
    (tolerance, limit): (f64, usize),
    cancellation: &Cancellation,
) -> Result<Option<(Vec<f64>, usize)>, Cancelled> {
    let mut solution = start.unwrap_or_else(|| vec![0.0; source.len()]);
    let mut used = 0;
    while used < limit {
        cancellation.check()?;
        let mut rest = source.to_vec();
        if norm(&solution) > 0.0 {
            let product = operator(&solution);
            rest.iter_mut().zip(product).for_each(|(a, b)| *a -= b);
        }
        let correction = seat.pass(rest).await;
        used += 1;
        let (size, total) = (norm(&correction), norm(&solution));
        if size <= tolerance * total || size == 0.0 {
            add(&mut solution, &correction);
            return Ok(Some((solution, used)));
        }
        // Without a start the first correction is itself of the size of x.
        let wanted = UNSEEN * tolerance * if total > 0.0 { total } else { size };
        let limits = Limits {
            reduction: (wanted / size).clamp(LEAST_REDUCTION, 0.1),
            iterations: (limit - used).min(BASIS),
            give_up_early: false,
        };
        let outcome = gmres(seat, operator, correction, limits, cancellation).await?;
        used += outcome.iterations;
        add(&mut solution, &outcome.solution);
        // GMRES knows its residual, which a look at it confirms; two digits need no look.
        let left = limits.reduction * size;
        if outcome.reached && tolerance >= ROUGH && left <= tolerance * norm(&solution) {
            return Ok(Some((solution, used)));
        }
    }
    Ok(None)
}

/// A solution of [`refined`].
pub(super) struct Refined {
    pub(super) solution: Vec<f64>,
    /// Passes.
    pub(super) used: usize,
    /// What its first pass did.
    pub(super) first: Option<FirstPass>,
}

/// What a first pass through factors did for one source, which tells of others.
#[derive(Debug, Clone, Copy)]
pub(super) struct FirstPass {
    /// Size of the first correction over that of the solution.
    pub(super) contraction: f64,
    /// Residual after the pass over the source.
    pub(super) left: f64,
}

impl FirstPass {
    /// Whether a first pass alone will do for another source, of which it leaves so much.
    pub(super) fn is_enough(self, left: f64, tolerance: f64) -> bool {
        let worse = (left / self.left.max(f64::EPSILON)).max(1.0);
        OTHER_SOURCES * worse * self.contraction <= tolerance
    }
}

/// Solves A x = source with the factors of A itself, which refinement makes exact: as long as each correction is much
/// smaller than the one before, the next one is as much smaller again and need not be made. Where corrections do not
/// shrink so, [`linear`] goes on. Where `known` says what one pass does with these factors, and leaves no more than
/// that of this source, one is enough.
///
/// # Errors
/// [`Cancelled`].
pub(super) async fn refined(
    seat: &Seat,
    operator: &Operator<'_>,
    (source, known): (&[f64], Option<FirstPass>),
    (tolerance, limit): (f64, usize),
    cancellation: &Cancellation,
) -> Result<Option<Refined>, Cancelled> {
    let mut solution = seat.pass(source.to_vec()).await;
    let (mut used, mut before) = (1, norm(&solution));
    let mut first = None;
    while used < limit {
        cancellation.check()?;
        let mut rest = source.to_vec();
        let product = operator(&solution);
        rest.iter_mut().zip(product).for_each(|(a, b)| *a -= b);
        let left = norm(&rest) / norm(source);
        if used == 1 && known.is_some_and(|known| known.is_enough(left, tolerance)) {
            return Ok(Some(Refined {
                solution,
                used,
                first: known,
            }));
        }
        let correction = seat.pass(rest).await;
        used += 1;
        let size = norm(&correction);
        let contraction = size / before;
        first = first.or(Some(FirstPass { contraction, left }));
        // What is not a number contracts neither.
        if !(contraction <= FAST || size == 0.0) {
            break;
        }
        add(&mut solution, &correction);
        if size * contraction <= tolerance * norm(&solution) {
            return Ok(Some(Refined {
                solution,
                used,
                first,
            }));
        }
        before = size;
    }
    let start = solution.iter().all(|value| value.is_finite());
    let start = start.then_some(solution);
    let left = (tolerance, limit.saturating_sub(used));
    let found = linear(seat, operator, (source, start), left, cancellation).await?;
    Ok(found.map(|(solution, more)| Refined {
        solution,
        used: used + more,
        first,
    }))
}

fn add(mass: &mut [f64], step: &[f64]) {
    mass.iter_mut().zip(step).for_each(|(p, z)| *p += z);
}

/// L1 norm.
pub(super) fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).sum()
}
