//! The seam of a sweep: whatever can give densities at a parameter value, starting from a neighbour's.

use crate::density::{EstimatedDensity, Moments};

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
}

impl PointStatus {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Solved,
        Self::Escaping,
        Self::NotConverged,
        Self::NoSteadyState,
        Self::SeveralClasses,
    ];

    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Escaping => "escaping",
            Self::NotConverged => "not-converged",
            Self::NoSteadyState => "no-steady-state",
            Self::SeveralClasses => "several-classes",
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
    /// Factorisations made for this point; zero for solvers that make none.
    pub factorisations: usize,
    /// What is left of the equation at the result, Σ p = 1: ‖P p - λ p‖₁ for a cell map,
    /// ‖Q p + r p‖₁ / ‖|Q| |p|‖₁ for a generator.
    pub residual: f64,
    /// L1 error of the masses that the solver estimates for itself.
    pub solver_error: f64,
    /// Mass that leaves Ω per unit time.
    pub escape_rate: f64,
    /// Sum of the magnitudes of negative masses; zero for cell maps.
    pub negative_mass: f64,
    /// Mass in cells that touch an end of a range, walls that the model knows not counted: one value an axis.
    pub edge_mass: Vec<f64>,
    /// Diffusion that the cells add, one value an axis, in units of the axis squared per unit time.
    pub numerical_diffusion: Vec<f64>,
    /// Time one transition spans; `None` for methods without a map step.
    pub map_step: Option<f64>,
    /// Relative shift of the variances (or of the mass beside a switching surface) by the time step of trajectories, the
    /// largest that halving the step makes certain; `None` for methods without trajectories.
    pub time_step_bias: Option<f64>,
    /// Anything the user should know of this point, one sentence each.
    pub warnings: Vec<String>,
}

/// A solve's result: densities, report, and what warm-starts the neighbour.
#[derive(Debug, Clone)]
pub struct Solution<State> {
    /// How it went.
    pub report: SolveReport,
    /// Mean and standard deviation of every axis; empty without a density.
    pub moments: Vec<Moments>,
    /// The observed densities in the order the source was asked for; empty without a density.
    pub densities: Vec<EstimatedDensity>,
    /// Start for a neighbour; `None` without a density.
    pub state: Option<State>,
}

/// Why a source cannot give a solution at all. A failed solve is data, not an error: see [`PointStatus`].
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The source was asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// The method refuses, for example because the parameter value is not allowed.
    #[error(transparent)]
    Method(#[from] Box<dyn std::error::Error + Send + Sync>),
}

/// A source of densities along one parameter.
pub trait DensitySource {
    /// What a solution leaves for its neighbour (a mass vector, a factorisation).
    type State;

    /// Densities at a parameter value, warm-started from a neighbour's state where one is given.
    ///
    /// # Errors
    /// [`SourceError`] when the value is not allowed. Failed solves are reported in the solution.
    fn solve(
        &self,
        value: f64,
        start: Option<&Self::State>,
    ) -> Result<Solution<Self::State>, SourceError>;

    /// The same source on finer cells, to check what was found; `None` where there is none, or it would say
    /// nothing (sampling errors differ from grid to grid).
    fn finer(&self) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// Bytes that a state takes, for the sweep to decide how many to keep.
    fn state_bytes(&self, state: &Self::State) -> usize {
        size_of_val(state)
    }
}
