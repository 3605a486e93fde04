//! Which method, and what the settings of all methods share. Each method's settings and defaults stand in its wing.

use crate::continuation::CellCheck;

use super::{GeneratorMethodOptions, MonteCarloOptions, Problem, SgcmOptions};

/// A method with its settings.
#[derive(Debug, Clone, PartialEq)]
pub enum MethodOptions {
    /// The generator, solved directly.
    Generator(GeneratorMethodOptions),
    /// Stochastic generalized cell mapping.
    Sgcm(SgcmOptions),
    /// Free trajectories.
    MonteCarlo(MonteCarloOptions),
}

impl Default for MethodOptions {
    fn default() -> Self {
        Self::Generator(GeneratorMethodOptions::default())
    }
}

impl MethodOptions {
    /// Names used in files, the default first.
    pub(crate) const KINDS: [&'static str; 3] = ["generator", "sgcm", "monte-carlo"];

    /// Whether what the cells of this space do to the densities can be checked.
    pub(crate) fn cell_check(&self, problem: &Problem) -> CellCheck {
        match self {
            Self::Generator(_) => GeneratorMethodOptions::cell_check(problem),
            Self::Sgcm(_) => SgcmOptions::CELL_CHECK,
            Self::MonteCarlo(_) => MonteCarloOptions::CELL_CHECK,
        }
    }

    /// Seed of the random streams; zero for a method without any.
    pub(crate) fn seed(&self) -> u64 {
        match self {
            Self::Generator(_) => 0,
            Self::Sgcm(options) => options.seed,
            Self::MonteCarlo(options) => options.seed,
        }
    }
}
