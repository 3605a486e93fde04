//! Fields over the state: what is known of a process that starts in each.

use crate::space::Axis;

/// A field over the cells of a system at a value of the parameter: the mean time or the committor of a passage
/// ([`Family::fields`](crate::system::Family::fields)).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StateField {
    /// Its name, that of its array: `exit_mean_time`.
    pub name: String,
    /// The axes of the cells.
    pub axes: Vec<Axis>,
    /// Values at the centres of the cells, the last axis fastest; NaN where none is known.
    pub values: Vec<f64>,
    /// Their errors.
    pub errors: Vec<f64>,
}
