//! Whether the drift, or its slope, jumps at the declared switching surfaces.

use super::super::SwitchingSurface;
use super::ContractViolation;
use super::trial::Trial;

/// Distance from a surface at which its sides are looked at, as a share of the range.
const DISTANCE: f64 = 1e-4;

/// Jump that is none, in units of the root mean square of the drift on the axis: a smooth drift leaves about DISTANCE³.
const NO_JUMP: f64 = 1e-9;

/// A surface inside the box, across which no state shows a jump, is a violation.
pub(super) fn check(trial: &Trial<'_>) -> Result<(), ContractViolation> {
    for &surface in &trial.system.facts().switching_surfaces {
        let (from, to) = trial.ranges[surface.axis];
        let inside = surface.at > from && surface.at < to;
        let jumps = |state: &Vec<f64>| jumps(trial, surface, state);
        if inside && !trial.states.iter().any(jumps) {
            return Err(ContractViolation::SmoothSurface { surface });
        }
    }
    Ok(())
}

fn jumps(trial: &Trial<'_>, surface: SwitchingSurface, state: &[f64]) -> bool {
    let (from, to) = trial.ranges[surface.axis];
    let distance = DISTANCE * (to - from);
    let value = surface.drift_jump(trial.system, state, distance);
    let bend = bend(trial, surface, state, distance);
    let axes = value.iter().zip(&bend).zip(&trial.drift_size);
    axes.into_iter()
        .any(|((value, bend), size)| value.abs().max(bend.abs()) > NO_JUMP * size)
}

/// 2h times the jump of the slope of every component. The slopes over [h, 2h] on both sides differ by 3h times the
/// curvature where the drift is smooth, which is taken off by looking twice as far.
fn bend(trial: &Trial<'_>, surface: SwitchingSurface, state: &[f64], distance: f64) -> Vec<f64> {
    let mut state = state.to_vec();
    let mut at = |offset: f64| {
        state[surface.axis] = surface.at + offset;
        trial.system.drift_at(0.0, &state)
    };
    let mut change = |h: f64| -> Vec<f64> {
        let values = [at(2.0 * h), at(h), at(-h), at(-2.0 * h)];
        (0..values[0].len())
            .map(|axis| values[0][axis] - values[1][axis] - values[2][axis] + values[3][axis])
            .collect()
    };
    let (near, far) = (change(distance), change(2.0 * distance));
    near.iter()
        .zip(far)
        .map(|(near, far)| 4.0 * near - far)
        .collect()
}
