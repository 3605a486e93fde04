//! Steady states: of transition matrices (P p = p), given here by name, and of generators (Q p = 0), in [`generator`].
//!
//! # Decisions
//!
//! **Escape is never rescaled away.** Columns of the transition matrix sum to one with the sink. With escape the solver
//! finds the quasi-stationary vector P p = λ p; the rate -ln λ/Δt is a column of `points.csv`. When a larger share than
//! `method.escape_limit` leaves within one relaxation time (from the second eigenvalue), the row says that there is no
//! steady state.
//!
//! **What goes round is lumped last.** The chain of a forced system goes round among its phases, and smoothing
//! damps nothing of that. Multilevel aggregation needs no damping there, since p = (I + P) p / 2 has the same
//! sweeps as p = P p: it lumps cells of one phase only, until each phase is a single lump, and these are solved
//! exactly. Power iteration takes the lazy chain, and the second eigenvalue leaves out all that goes round.
//!
//! **Modes one by one.** The moments of a bounded state take from lower ones only, but for the force of the state,
//! which is weak: in the basis of the moments the generator is nearly block lower triangular.
//! `stationary::generator::modewise` factorises the cells of the other axes for every mode by itself and substitutes
//! forward; GMRES makes good the rest in 10 to 45 iterations, whatever the number of modes. Factors of all modes
//! together cost the cube of their number, these the number itself, so that a density along the state, which takes a
//! hundred modes, costs seconds. Which of the two is made follows from the predicted work; where modes one by one do
//! not converge (an equation that is no polynomial along the state), the others are made, if they fit.
//!
//! **Harmonics one by one.** Under a periodic forcing the average of the generator over the period takes no harmonic
//! of the phase to another; `stationary::generator::harmonics` factorises it minus ikω for each, a complex matrix of
//! the size of the other axes, and takes the forcing's way from even harmonics to odd ones along. GMRES makes good
//! the rest in 10 to 40 iterations where the motion is up to about twice the spread of the density, and in 85 to 120
//! at six times, whatever the number of harmonics. Cosine and sine of a harmonic are one complex number, which holds
//! half the numbers that both as real unknowns would. On one axis factors of all nodes together cost little, and are
//! made.
//!
//! White noise behind a linear filter is an axis of the same kind, with Hermite's polynomials and the nodes of their
//! rule (`Axis::hermite`): there the filter's generator is exact. `system/coloured` puts such filters before the noises
//! of any model, so that no method knows of them.
//!
//! **Half of the cells where the matrix says so.** `stationary::generator` sees from the matrix whether it is the same
//! counted from the other end; the sums of cells and their images are then solved. No module above knows; a change that
//! is not symmetric is answered on all cells.

pub mod generator;
mod hessenberg;
pub(crate) use hessenberg::Triangle;
mod transition_matrix;

pub use transition_matrix::{
    ClassShare, Info, Options, Outcome, SecondEigenvalue, Solver, StationaryError, SteadyState,
    second_eigenvalue, solve,
};
pub(crate) use transition_matrix::{MOST_APPLICATIONS, without_groups};
