//! Kinks of densities on planes across which noise acts.
//!
//! On a plane where the drift across it jumps by Δa and the slope of b² by Δ(b²)', flux and density are continuous, so
//! the derivative of log p across the plane jumps by (2 Δa - Δ(b²)')/b²: the jump law. Where axes are summed over, Δa
//! is the mean over the mass beside the plane.

use crate::density::Kink;
use crate::space::CellSpace;
use crate::system::{SwitchingSurface, System};

/// Distance from the plane, in widths of the cell beside it, at which the drift on either side is taken.
pub(super) const BESIDE: f64 = 1e-6;
/// Times that distance, for slopes of the noise.
const FARTHER: f64 = 100.0;

/// The kink that a surface makes in the density of the given axes, if it stands on one of them and noise acts across
/// it.
pub(super) fn kink(
    system: &dyn System,
    space: &CellSpace,
    masses: &[f64],
    axes: &[usize],
    surface: SwitchingSurface,
) -> Option<Kink> {
    let place = axes.iter().position(|&axis| axis == surface.axis)?;
    let axis = &space.axes()[surface.axis];
    let cell = axis.find(surface.at)?;
    let step = BESIDE * axis.width(cell);
    let other = beside_axis(space, axes, surface.axis);
    let bins = bins(space, axes, surface.axis);
    let (mut sums, mut weights) = (vec![0.0; bins], vec![0.0; bins]);
    for index in beside(space, surface) {
        let mut state = space.centre(index);
        let drop = surface.drift_jump(system, &state, step)[surface.axis];
        let mut intensity_at = |offset: f64| {
            state[surface.axis] = surface.at + offset;
            system.intensity_at(surface.axis, 0.0, &state)
        };
        let intensity = intensity_at(0.0);
        let slope = slope_jump(&mut intensity_at, step * FARTHER);
        // Without mass beside the plane every state counts alike, and little.
        let weight = masses[index].max(0.0) + f64::MIN_POSITIVE.sqrt();
        let bin = other.map_or(0, |axis| space.position(index, axis));
        if intensity > 0.0 {
            sums[bin] += weight * (2.0 * drop - slope) / intensity;
        }
        weights[bin] += weight;
    }
    let jump: Vec<f64> = sums.iter().zip(&weights).map(|(s, w)| s / w).collect();
    let is_kink = system.is_noisy(surface.axis) && jump.iter().all(|jump| jump.is_finite());
    is_kink.then_some(Kink {
        axis: place,
        at: surface.at,
        jump,
    })
}

/// The intensity b² of the noise across a surface, the mean over the mass of the cells beside it.
pub(in crate::method) fn intensity_beside(
    system: &dyn System,
    space: &CellSpace,
    masses: &[f64],
    surface: SwitchingSurface,
) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for index in beside(space, surface) {
        let mut state = space.centre(index);
        state[surface.axis] = surface.at;
        let weight = masses[index].max(0.0) + f64::MIN_POSITIVE.sqrt();
        sum += weight * system.intensity_at(surface.axis, 0.0, &state);
        weights += weight;
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

/// The axis along which a kink of a joint density is told. Along an axis of modes nodes are no bins: the mean of all
/// holds for each.
fn beside_axis(space: &CellSpace, axes: &[usize], across: usize) -> Option<usize> {
    let mut others = axes.iter().copied();
    others.find(|&axis| axis != across && !space.axes()[axis].is_modes())
}

/// Values that a kink is told by.
fn bins(space: &CellSpace, axes: &[usize], across: usize) -> usize {
    beside_axis(space, axes, across).map_or(1, |axis| space.axes()[axis].count())
}

/// Jump of the slope of a continuous function at zero, to the second order of a distance.
fn slope_jump(of: &mut impl FnMut(f64) -> f64, distance: f64) -> f64 {
    let mut side = |sign: f64| {
        let [near, middle, far] = [1.0, 2.0, 3.0].map(|k| of(sign * k * distance));
        (-2.5 * near + 4.0 * middle - 1.5 * far) / distance
    };
    side(1.0) + side(-1.0)
}

/// Cells of the space on both sides of a surface (those that hold it, where it falls into cells).
fn beside(space: &CellSpace, surface: SwitchingSurface) -> Vec<usize> {
    let Some(beside) = space.axes()[surface.axis].cells_beside(surface.at) else {
        return Vec::new();
    };
    (0..space.n_cells())
        .filter(|&index| beside.contains(&space.position(index, surface.axis)))
        .collect()
}
