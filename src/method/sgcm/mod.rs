//! Stochastic generalized cell mapping: its settings, the choice of its steps, the slope correction, the source.

mod options;
mod slope_correction;
mod source;
mod steps;

pub use options::{Correction, SgcmOptions};
pub use slope_correction::{Corrected, solve_corrected};
pub use source::{SampledPoint, SgcmSource};
