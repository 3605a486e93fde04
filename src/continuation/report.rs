//! What a solve says of itself: how it ended, numbers, findings.

use super::Finding;

/// How a point ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointStatus {
    /// Solved.
    Solved,
    /// Solved, but mass leaves Ω: the densities are quasi-stationary, conditioned on staying.
    Escaping,
    /// The solver stopped before it reached its tolerance; the densities are its last iterate.
    NotConverged,
    /// So much mass leaves that there is no steady state in Ω; no densities.
    NoSteadyState,
    /// The cell map has several closed classes: several steady states; no densities.
    SeveralClasses,
    /// The source refused the value, or the solver gave up; no densities. A finding says why.
    Failed,
}

impl PointStatus {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Solved,
        Self::Escaping,
        Self::NotConverged,
        Self::NoSteadyState,
        Self::SeveralClasses,
        Self::Failed,
    ];

    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Escaping => "escaping",
            Self::NotConverged => "not-converged",
            Self::NoSteadyState => "no-steady-state",
            Self::SeveralClasses => "several-classes",
            Self::Failed => "failed",
        }
    }

    /// Whether the point has a density that a user may rely on.
    pub fn is_resolved(self) -> bool {
        matches!(self, Self::Solved | Self::Escaping)
    }
}

/// What a solve says of itself; a row of `points.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveReport {
    /// How it ended.
    pub status: PointStatus,
    /// Name of the method, for example `sgcm`.
    pub method: &'static str,
    /// Solver iterations (cycles).
    pub iterations: usize,
    /// What is left of the equation at the result, Σ p = 1: ‖P p - λ p‖₁ for a cell map,
    /// ‖Q p + r p‖₁ / ‖|Q| |p|‖₁ for a generator.
    pub residual: f64,
    /// L1 error of the masses that the solver estimates for itself.
    pub solver_error: f64,
    /// Mass that leaves Ω per unit time.
    pub escape_rate: f64,
    /// Mass in cells that touch an end of a range, walls that the model knows not counted: one value an axis.
    pub edge_mass: Vec<f64>,
    /// What only some methods can say.
    pub own: MethodPart,
    /// What the user must know of this point.
    pub findings: Vec<Finding>,
}

/// The part of a report that only some methods have; the others leave it as it is by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MethodPart {
    /// Factorisations made for this point; zero for solvers that make none.
    pub factorisations: usize,
    /// Sum of the magnitudes of negative masses; zero for methods whose masses are probabilities.
    pub negative_mass: f64,
    /// Diffusion that the cells add, one value an axis, in units of the axis squared per unit time; empty for methods
    /// whose cells add none.
    pub numerical_diffusion: Vec<f64>,
    /// Time one transition spans; `None` for methods without a map step.
    pub map_step: Option<f64>,
    /// Relative shift of the variances (or of the mass beside a switching surface) by the time step of trajectories,
    /// the largest that halving the step makes certain; `None` for methods without trajectories.
    pub time_step_bias: Option<f64>,
}

impl SolveReport {
    /// The report of a solve by a method of this name of which nothing is to be said.
    pub fn solved(method: &'static str) -> Self {
        Self {
            status: PointStatus::Solved,
            method,
            iterations: 0,
            residual: 0.0,
            solver_error: 0.0,
            escape_rate: 0.0,
            edge_mass: Vec::new(),
            own: MethodPart::default(),
            findings: Vec::new(),
        }
    }
}
