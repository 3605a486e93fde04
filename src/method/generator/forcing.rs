//! With what error the generator knows how the mean of a state moves with the forcing: what the second scheme changes,
//! the last harmonic of the mean (what is left out is less), what the solver leaves, and what lies beyond the ends.

use crate::method::forcing::Forced;

/// Times what the second scheme changes: both may err alike.
const SAFETY: f64 = 2.0;

/// A steady state.
pub(super) struct Solved<'a> {
    /// The generator's unknowns, Σ = 1, and by how much those of the second scheme differ.
    pub(super) unknowns: &'a [f64],
    pub(super) change: &'a [f64],
    /// Estimated L1 error of the unknowns.
    pub(super) error: f64,
    /// By how much what lies beyond the ends of the ranges shifts the mean along each axis.
    pub(super) shifts: &'a [f64],
}

/// Amplitude of the mean along an axis, with its error.
pub(super) fn amplitude(forced: &Forced<'_>, solved: &Solved<'_>, axis: usize) -> (f64, f64) {
    let last = forced.space.axes()[forced.phase].mode_number();
    let nodes = forced.space.axes()[axis].nodes();
    let largest = nodes.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let errors = [
        SAFETY * forced.amplitude(axis, 1, solved.change),
        forced.amplitude(axis, last.max(2), solved.unknowns),
        2.0 * largest * solved.error,
        2.0 * solved.shifts.get(axis).copied().unwrap_or(0.0),
    ];
    (
        forced.amplitude(axis, 1, solved.unknowns),
        errors.iter().sum(),
    )
}
