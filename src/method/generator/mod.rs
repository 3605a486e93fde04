//! The generator, solved directly: its settings, what a point costs, the source, its session, what the last points say
//! of the next one, relaxation, and derivatives.

#[cfg(test)]
pub(in crate::method) mod angles_tests;
mod at_phases;
mod basins;
mod bends;
mod coarse;
mod cost;
mod forcing;
mod judgement;
mod jumps;
mod largest_exponent;
#[cfg(test)]
#[allow(clippy::print_stdout)]
mod largest_exponent_tests;
mod last_modes;
mod line_moments;
#[cfg(feature = "serde")]
mod memory;
mod modes;
mod one_axis;
mod open;
mod options;
mod passages;
mod relaxation;
mod rotation;
mod second;
mod sensitivity;
mod session;
mod slow_modes;
mod source;
mod spectra;
mod stand;
mod still_noise;
mod third;
mod trail;
mod truncation;
#[cfg(test)]
pub(in crate::method) mod turns_tests;
mod unknowns;

pub(super) use coarse::rough_masses;
pub(crate) use cost::GeneratorCost;
pub(crate) use largest_exponent::cost_of_largest_exponent;
pub(crate) use modes::{automatic_modes, change_by_more_modes};
pub(crate) use one_axis::OneAxisFamily;
pub use options::GeneratorMethodOptions;
pub use source::GeneratorSource;
pub(crate) use spectra::highest_frequency;
