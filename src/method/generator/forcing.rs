//! With what error the generator knows how the mean of a state moves with the forcing: what the second scheme changes,
//! the last harmonic of the mean (what is left out is less), what the solver leaves, and what lies beyond the ends.

use crate::density::Roughness;
use crate::method::forcing::Forced;

/// Times what the second scheme changes: both may err alike.
const SAFETY: f64 = 2.0;

/// A steady state.
pub(super) struct ForcedState<'a> {
    /// The generator's unknowns, Σ = 1, and by how much those of the second scheme differ.
    pub(super) unknowns: &'a [f64],
    pub(super) change: &'a [f64],
    /// Estimated L1 error of the unknowns.
    pub(super) error: f64,
    /// By how much what lies beyond the ends of the ranges shifts the mean along each axis.
    pub(super) shifts: &'a [f64],
    /// Axes with coordinates of planes on which the derivative of the density jumps.
    pub(super) planes: &'a [(usize, f64)],
}

/// Amplitude of the mean along an axis, with its error.
pub(super) fn amplitude(forced: &Forced<'_>, solved: &ForcedState<'_>, axis: usize) -> (f64, f64) {
    let last = forced.space.axes()[forced.phase].mode_number();
    let nodes = forced.space.axes()[axis].nodes();
    let largest = nodes.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // What schemes differ by may pass zero by chance: not so were the differences of neighbouring layers independent.
    let roughness = Roughness {
        space: forced.space,
        weights: solved.unknowns,
        differences: solved.change,
        planes: solved.planes,
    };
    let [first, second] = forced.quadratures(axis);
    let errors = [
        2.0 * roughness.of(&first).hypot(roughness.of(&second)),
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
