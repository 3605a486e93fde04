//! Coloured noise: every white noise of a model goes through a linear filter with a memory, whose states are axes of
//! their own.
//!
//! A filter of first order turns b ξ(t) into b η/√(2τ) with η' = -η/τ + √(2/τ) w(t), w white noise of unit intensity:
//! an Ornstein-Uhlenbeck process. One of second order turns it into b √(ω_n/(4 ζ_n)) η with η' = ω_n ν and ν' = -ω_n
//! η - 2 ζ_n ω_n ν + 2 √(ζ_n ω_n) w(t): harmonic noise (L. Schimansky-Geier and C. Zülicke, 1990), a spectrum with a
//! peak. All states of a filter have mean 0 and variance 1, whatever its parameters are, so that their axes stay the
//! same along a sweep. The intensity of the force, the integral of its correlation, is b², and it goes to the white
//! noise as its memory goes to 0, in Stratonovich's reading where b depends on the state (E. Wong and M. Zakai, 1965).

mod filter;
mod filtered;
mod model;
#[cfg(test)]
mod tests;

pub use filter::NoiseKind;
pub(super) use model::coloured;

use crate::MAX_DIMENSION;

/// Name of the axis of coloured noise; numbered from 1 where there are several.
pub(crate) const NOISE_AXIS: &str = "noise";

/// Name of the axis of the second state of harmonic noise, its rate over its frequency; numbered likewise.
pub(crate) const NOISE_RATE_AXIS: &str = "noise_rate";

/// Name of the correlation time of coloured noise among the parameters.
pub(crate) const CORRELATION_TIME: &str = "tau";

/// Name of the natural frequency of the filter of harmonic noise among the parameters.
pub(crate) const NOISE_FREQUENCY: &str = "noise_frequency";

/// Name of the damping ratio of the filter of harmonic noise among the parameters.
pub(crate) const NOISE_DAMPING: &str = "noise_damping";

/// Why a model cannot have coloured noise.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ColouredNoiseError {
    /// Typed equations that cannot be read anew with coloured noise, in words.
    #[error("{0}")]
    Equations(String),
    /// The model's noises are so many, or its state so large, that there is no room.
    #[error(
        "coloured noise adds {}{} to the {axes} of the state; at most {MAX_DIMENSION} axes are possible",
        if *each == 1 { "an axis" } else { "two axes" },
        if *noises == 1 { String::new() } else { format!(" for each of {noises} noises") }
    )]
    Axes {
        /// Axes of the model.
        axes: usize,
        /// Its noises.
        noises: usize,
        /// Axes that each of them needs.
        each: usize,
    },
    /// A name that coloured noise needs means something else.
    #[error("coloured noise needs the name `{name}`, which the model has given to something else")]
    Taken {
        /// The name.
        name: String,
    },
}
