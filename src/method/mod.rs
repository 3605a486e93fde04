//! Methods: sources of densities for a sweep, each made of the modules before it.

mod options;

pub use options::{SgcmOptions, StepChoice};
