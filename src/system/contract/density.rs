//! Whether an exact density solves the stationary Fokker-Planck equation.

use super::ContractViolation;
use super::trial::Trial;

/// Step of the differences, as a share of a range.
const STEP: f64 = 2.5e-5;

/// What the equation may leave, relative to the sum of its terms' magnitudes there and their mean over all states. The
/// differences err by STEP² times third and fourth derivatives over the box, 1e-7 for what changes by e some ten times
/// across it, and by rounding, 1e-16/STEP² = 2e-7 of log p.
const TOLERANCE: f64 = 1e-5;

/// What the equation leaves at a state, and the sum of its terms' magnitudes.
struct Balance<'a> {
    state: &'a [f64],
    residual: f64,
    terms: f64,
}

/// Checks Σ_i ∂_i(a_i p) = ½ Σ_i ∂_i²(B_i p), B_i the noise intensity on axis i, at every state where p = exp(φ) is
/// known. A system that depends on time has no such density.
pub(super) fn check(trial: &Trial<'_>) -> Result<(), ContractViolation> {
    if trial.system.facts().period.is_some() {
        return Ok(());
    }
    let balances: Vec<Balance<'_>> = trial
        .states
        .iter()
        .filter_map(|state| balance(trial, state))
        .collect();
    let mean = balances.iter().map(|one| one.terms).sum::<f64>() / balances.len() as f64;
    let fails = |one: &&Balance<'_>| {
        one.residual.is_nan() || one.residual.abs() > TOLERANCE * (one.terms + mean)
    };
    balances.iter().find(fails).map_or(Ok(()), |one| {
        Err(ContractViolation::NotStationary {
            state: one.state.to_vec(),
            residual: one.residual,
            terms: one.terms,
        })
    })
}

/// The equation divided by p, by central differences: ∂a + a φ' - ½ (B'' + 2 B' φ' + B (φ'' + φ'²)) summed over the
/// axes. `None` where the density is not known, next to a switching surface, and at a bound.
fn balance<'a>(trial: &Trial<'_>, state: &'a [f64]) -> Option<Balance<'a>> {
    let log_density = |state: &[f64]| trial.system.exact_log_density(state);
    let facts = trial.system.facts();
    let drift = trial.system.drift_at(0.0, state);
    let centre = log_density(state)?;
    let (mut residual, mut terms) = (0.0, 0.0);
    for (axis, &drift) in drift.iter().enumerate() {
        let (from, to) = trial.ranges[axis];
        let step = STEP * (to - from);
        let crosses = |at: f64| (state[axis] - at).abs() <= 2.0 * step;
        if facts.surfaces_on(axis).any(crosses) || crosses(from) || crosses(to) {
            return None;
        }
        let moved = |by: f64| {
            let mut moved = state.to_vec();
            moved[axis] += by;
            moved
        };
        let (up, down) = (moved(step), moved(-step));
        let first = |up: f64, down: f64| (up - down) / (2.0 * step);
        let second = |up: f64, here: f64, down: f64| (up - 2.0 * here + down) / (step * step);
        let drift_at = |state: &[f64]| trial.system.drift_at(0.0, state)[axis];
        let noise = |state: &[f64]| trial.system.intensity_at(axis, 0.0, state);
        let (log_up, log_down) = (log_density(&up)?, log_density(&down)?);
        let slope = first(log_up, log_down);
        let curvature = second(log_up, centre, log_down) + slope * slope;
        let intensity = noise(state);
        let (noise_slope, noise_bend) = (
            first(noise(&up), noise(&down)),
            second(noise(&up), intensity, noise(&down)),
        );
        for term in [
            first(drift_at(&up), drift_at(&down)),
            drift * slope,
            -0.5 * noise_bend,
            -noise_slope * slope,
            -0.5 * intensity * curvature,
        ] {
            residual += term;
            terms += term.abs();
        }
    }
    Some(Balance {
        state,
        residual,
        terms,
    })
}
