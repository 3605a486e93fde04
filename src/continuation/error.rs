//! Why a sweep ended without a result.

use super::SourceError;

/// Why a sweep ended without a result.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A parameter value that the source does not accept.
    #[error("{parameter} = {}: {source}", short(*.value))]
    Source {
        /// The swept parameter.
        parameter: String,
        /// Its value.
        value: f64,
        /// What the source says.
        source: SourceError,
    },
    /// More shards than there are steps between the given values.
    #[error("a sweep of {steps} steps cannot be cut into {shards} shards")]
    Shards {
        /// The shards that were asked for.
        shards: usize,
        /// Steps between the given values.
        steps: usize,
    },
    /// The observer could not go on.
    #[error("{0}")]
    Observer(Box<dyn std::error::Error + Send + Sync>),
}

/// A number in few digits: by its power of ten where it has many.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 | 1e-5..1e16 => value.to_string(),
        _ => format!("{value:e}"),
    }
}
