//! Steady states: of transition matrices (P p = p), given here by name, and of generators (Q p = 0), in [`generator`].

pub mod generator;
mod transition_matrix;

pub use transition_matrix::{
    ClassShare, Info, LARGEST_ESCAPE, Options, Outcome, SecondEigenvalue, Solver, StationaryError,
    SteadyState, second_eigenvalue, solve,
};
