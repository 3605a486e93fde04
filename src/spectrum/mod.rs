//! How deviations from a steady state die out, and how states fluctuate in it: the slowest modes of a generator Q, and
//! power spectra, each number with its error.
//!
//! A deviation of the density that has the shape r, Q r = λ r, keeps that shape and goes as e^{λt}: -Re λ is its decay
//! rate and |Im λ| its angular frequency. Eigenvalues are those of a model of a few dozen states, made of the
//! vectors (s - Q)⁻ʲ v and of the rows wᵀ(s - Q)⁻ʲ at one or a few real s (rational Krylov spaces from both sides; A.
//! Ruhe 1984), so that an eigenvalue has the square of the error that either vector has.
//!
//! Every eigenvalue is solved by the scheme, by the same scheme with half its dissipation to first order,
//! lᵀ(Q' - Q) r / lᵀr, and both again on fewer cells. What is given is extrapolated to no dissipation, and its error is
//! what the cells change, with what the ends of the range may do. A number that half of the dissipation changes by
//! more than a third is no eigenvalue of the equation, but of its cells, and is left out.
//!
//! ```
//! use pbif::cancellation::Cancellation;
//! use pbif::generator::{GeneratorOptions, assemble};
//! use pbif::space::{Axis, CellSpace};
//! use pbif::spectrum::{Steady, slow_modes};
//! use pbif::stationary::generator::{RateOptions, RateSolver};
//! use pbif::system::TypedModel;
//!
//! // dx = -x dt + √0.5 dW: the rates are 1, 2, 3 and so on.
//! let model = TypedModel::new("model", "Model", ["x"]);
//! let model = model.with_equation("x", "-x").with_noise("x", ["sqrt(0.5)"]).build()?;
//! let system = model.system_with(&[])?;
//! let space = CellSpace::new(vec![Axis::uniform(-3.5, 3.5, 100)?])?;
//! let (options, rates) = (GeneratorOptions::default(), RateOptions::default());
//! let generator = assemble(&*system, &space, &options)?;
//! let mut solver = RateSolver::new(space.clone(), rates);
//! let masses = solver.solve(&generator.matrix, &generator.escape, None)?.mass;
//! let steady = Steady { masses: &masses, closed: &[[false; 2]], phase: None };
//! let found = slow_modes(&system, &space, 2, steady, (&options, &rates), &Cancellation::new())?;
//! for (mode, exact) in found.modes.iter().zip([1.0, 2.0]) {
//!     assert!((mode.decay.0 - exact).abs() <= mode.decay.1 && mode.decay.1 < 1e-2);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Fluctuations have their spectra from the same kind of model: S(ω) = 2 Re gᵀ (iω - Q)⁻¹ p (g - ⟨g⟩).
//!
//! ```
//! # use pbif::cancellation::Cancellation;
//! # use pbif::generator::{GeneratorOptions, assemble};
//! # use pbif::space::{Axis, CellSpace};
//! use pbif::spectrum::{PowerQuestion, Steady, power_spectra};
//! # use pbif::stationary::generator::{RateOptions, RateSolver};
//! # use pbif::system::TypedModel;
//! # let model = TypedModel::new("model", "Model", ["x"]);
//! # let model = model.with_equation("x", "-x").with_noise("x", ["sqrt(0.5)"]).build()?;
//! # let system = model.system_with(&[])?;
//! # let space = CellSpace::new(vec![Axis::uniform(-3.5, 3.5, 100)?])?;
//! # let (options, rates) = (GeneratorOptions::default(), RateOptions::default());
//! # let generator = assemble(&*system, &space, &options)?;
//! # let mut solver = RateSolver::new(space.clone(), rates);
//! # let masses = solver.solve(&generator.matrix, &generator.escape, None)?.mass;
//! # let steady = Steady { masses: &masses, closed: &[[false; 2]], phase: None };
//! // The same state: a Lorentzian of variance 0.25.
//! let frequencies = [0.0, 0.5, 1.0, 4.0];
//! let question = PowerQuestion {
//!     observables: &[&|state: &[f64]| state[0]],
//!     pairs: &[(0, 0)],
//!     frequencies: &frequencies,
//!     lags: (0.0, 0),
//! };
//! let settings = (&options, &rates);
//! let found = power_spectra(&system, &space, &question, steady, settings, &Cancellation::new())?;
//! for (frequency, (power, error)) in frequencies.iter().zip(&found.spectra[0].real) {
//!     assert!((power - 0.5 / (1.0 + frequency * frequency)).abs() <= *error && *error < 1e-4);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | part | file |
//! | --- | --- |
//! | the generator between walls on the cells of a sweep, or on fewer | `grid.rs` |
//! | the model of a few dozen states | `model.rs` |
//! | eigenvalues, and their errors on one grid | `grid_mode.rs`, `modes.rs` |
//! | the model that has them, at real shifts; at the harmonics of a motion | `real_shifts.rs`, `harmonic_shifts.rs` |
//! | modes of a grid from those of a coarser one | `carried.rs` |
//! | how fast and how far states move | `motion.rs` |
//! | eigenvalues with the errors of the cells | `slow.rs` |
//! | a model of the resolvent that grows until spectra stand, on one grid | `resolvent.rs` |
//! | its vectors at one frequency | `at_frequency.rs` |
//! | the model as a function of frequency and lag | `transfer.rs` |
//! | lines of a spectrum, and what changes its shape | `peak.rs` |
//! | spectra with the errors of the cells | `power.rs` |
//! | both on one axis, from a chain | `on_line.rs` |
//! | errors from half of the dissipation and fewer cells | `errors.rs` |

mod at_frequency;
mod breaks;
mod carried;
mod errors;
mod grid;
mod grid_mode;
mod harmonic_shifts;
mod kramers;
mod model;
mod modes;
mod motion;
mod on_line;
mod peak;
mod power;
mod real_shifts;
mod resolvent;
mod slow;
mod slowest;
mod switching;
mod transfer;

pub(crate) use grid::turning_rate;
pub use kramers::{EscapeFormulas, escape_formulas};
pub(crate) use on_line::{power_spectra_on_line, slow_modes_on_line};
pub(crate) use power::rate_of_change;
pub use power::{Features, Power, PowerQuestion, Spectrum, StateFunction, power_spectra};
pub use slow::{SlowMode, SlowModes, slow_modes};
pub use switching::{Switching, switching};

use crate::generator::GeneratorError;
use crate::space::SpaceError;
use crate::stationary::generator::{RateError, dot};

/// What is known of the steady state.
#[derive(Debug, Clone, Copy)]
pub struct Steady<'a> {
    /// Masses or unknowns of the cells.
    pub masses: &'a [f64],
    /// Per axis, whether its ends are walls of the system, which nothing passes.
    pub closed: &'a [[bool; 2]],
    /// The axis of modes that is the phase of a periodic force, where there is one: it turns at the same rate
    /// everywhere. Fluctuations are then those about the mean at each phase, averaged over the period.
    pub phase: Option<usize>,
}

/// Why there are no numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// The steady state moves along no axis, or has no spread.
    #[error("the steady state has no spread, or nothing moves in it")]
    Still,
    /// The generator could not be assembled.
    #[error(transparent)]
    Generator(#[from] GeneratorError),
    /// The cells could not be laid out.
    #[error(transparent)]
    Space(#[from] SpaceError),
    /// The generator could not be solved.
    #[error(transparent)]
    Rate(#[from] RateError),
}
