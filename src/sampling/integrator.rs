//! Integrators of sampled trajectories.

/// Integrators by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrator {
    /// Heun's predictor-corrector for the drift with Itô noise: weak order 2 for additive noise, 1 otherwise.
    StochasticHeun,
    /// Euler-Maruyama: weak order 1; takes ω² dt away from the damping of an oscillator.
    EulerMaruyama,
}

impl Integrator {
    /// All integrators.
    pub const ALL: [Self; 2] = [Self::StochasticHeun, Self::EulerMaruyama];

    /// Name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::StochasticHeun => "heun",
            Self::EulerMaruyama => "euler-maruyama",
        }
    }
}
