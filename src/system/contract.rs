//! What every model must hold, run over the registry, and helpers of the models' own tests.

use std::collections::HashSet;
use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{LANES, Lanes, Model, System, registry};

/// A built-in model with named parameter values.
pub(super) fn bound(model: &str, values: &[(&str, f64)]) -> Arc<dyn System> {
    registry::find(model).unwrap().system_with(values).unwrap()
}

/// Parameter sets that every model accepts, apart from its own defaults.
fn examples(model: &Model) -> Vec<Arc<dyn System>> {
    let with = |first: f64| {
        let values: Vec<f64> = (0..model.parameters.len())
            .map(|index| first + 0.17 * index as f64)
            .collect();
        let named = model.parameters.iter().zip(&values);
        let given: Vec<(&str, f64)> = named.map(|(p, &value)| (p.name.as_str(), value)).collect();
        model.system_with(&given).unwrap()
    };
    vec![with(0.3), with(1.1)]
}

/// States in [-2, 2]^d, inside the bounds that the model knows.
fn states(system: &dyn System, count: usize) -> Vec<Vec<f64>> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut coordinate = |axis: usize| {
        let (from, to) = system.bounds(axis).unwrap_or((-2.0, 2.0));
        random.random_range(from..to)
    };
    (0..count)
        .map(|_| (0..system.dimension()).map(&mut coordinate).collect())
        .collect()
}

fn moved(state: &[f64], axis: usize, by: f64) -> Vec<f64> {
    let mut moved = state.to_vec();
    moved[axis] += by;
    moved
}

/// Checks Σ ∂_i(a_i p) = Σ ∂²_k(b_k² p)/2 for p = exp(φ), divided by p, by central differences. Their error
/// is of order step² times third and fourth derivatives, 1e-7 here, and rounding 1e-16/step² = 1e-8.
pub(super) fn assert_stationary(system: &dyn System, must_be_known: bool) {
    let step = 1e-4;
    for state in states(system, 50) {
        let Some(centre) = system.exact_log_density(&state) else {
            assert!(!must_be_known);
            return;
        };
        let log_density = |state: &[f64]| system.exact_log_density(state).unwrap();
        let sides = |axis| (moved(&state, axis, step), moved(&state, axis, -step));
        let drift = system.drift_at(0.0, &state);
        let (mut residual, mut scale) = (0.0, 1.0);
        for (axis, drift) in drift.iter().enumerate() {
            let (up, down) = sides(axis);
            let slope = (log_density(&up) - log_density(&down)) / (2.0 * step);
            let change = system.drift_at(0.0, &up)[axis] - system.drift_at(0.0, &down)[axis];
            residual += change / (2.0 * step) + drift * slope;
            scale += (drift * slope).abs();
        }
        for (channel, &axis) in system.noise_axes().iter().enumerate() {
            let (up, down) = sides(axis);
            let (up, down) = (log_density(&up), log_density(&down));
            let slope = (up - down) / (2.0 * step);
            let curvature = (up - 2.0 * centre + down) / (step * step);
            let amplitude = system.additive_amplitude(channel).unwrap();
            residual -= 0.5 * amplitude * amplitude * (curvature + slope * slope);
        }
        assert!(residual.abs() < 1e-5 * scale, "{residual} at {state:?}");
    }
}

fn each(check: impl Fn(&Model, &dyn System)) {
    for model in registry::models() {
        for system in examples(model) {
            check(model, &*system);
        }
    }
}

#[test]
fn names_are_unique_and_defaults_allowed() {
    let names: HashSet<&str> = registry::models()
        .iter()
        .map(|model| model.name.as_str())
        .collect();
    assert_eq!(names.len(), registry::models().len());
    for model in registry::models() {
        assert!(Arc::ptr_eq(&registry::find(&model.name).unwrap(), model));
        assert!(!model.title.is_empty() && !model.equations.is_empty() && !model.source.is_empty());
        let axes = model.axes.iter().map(|axis| axis.name.as_str());
        let names: HashSet<&str> = axes
            .chain(model.parameters.iter().map(|p| p.name.as_str()))
            .collect();
        assert_eq!(names.len(), model.axes.len() + model.parameters.len());
        for parameter in &model.parameters {
            assert!(
                parameter
                    .default
                    .is_none_or(|value| parameter.range.contains(value))
            );
        }
    }
}

#[test]
fn the_dimension_is_the_number_of_axes_and_noise_is_on_them() {
    each(|model, system| {
        assert_eq!(system.dimension(), model.axes.len());
        assert!(!system.noise_axes().is_empty());
        assert!(
            system
                .noise_axes()
                .iter()
                .all(|&axis| axis < system.dimension())
        );
    });
}

#[test]
fn drift_is_finite_and_the_lanes_of_a_batch_do_not_mix() {
    each(|model, system| {
        let states = states(system, LANES);
        let mut batch = vec![[0.0; LANES]; system.dimension()];
        for (lane, state) in states.iter().enumerate() {
            for (axis, &value) in state.iter().enumerate() {
                batch[axis][lane] = value;
            }
        }
        let mut drift: Vec<Lanes> = vec![[f64::NAN; LANES]; system.dimension()];
        system.drift(0.0, &batch, &mut drift);
        for (lane, state) in states.iter().enumerate() {
            let single = system.drift_at(0.0, state);
            let of_batch: Vec<f64> = drift.iter().map(|axis| axis[lane]).collect();
            assert!(
                single.iter().all(|value| value.is_finite()),
                "{}",
                model.name
            );
            assert_eq!(single, of_batch, "{}", model.name);
        }
    });
}

#[test]
fn amplitudes_agree_with_the_constant_ones() {
    each(|_, system| {
        for (channel, _) in system.noise_axes().iter().enumerate() {
            let state = vec![0.3; system.dimension()];
            let amplitude = system.amplitude_at(channel, 0.0, &state);
            if let Some(constant) = system.additive_amplitude(channel) {
                assert!(constant > 0.0 && amplitude == constant);
            }
        }
    });
}

#[test]
fn a_declared_symmetry_is_one_of_drift_and_density() {
    each(|model, system| {
        let Some(symmetry) = system.symmetry() else {
            return;
        };
        assert_eq!(symmetry.centre.len(), system.dimension());
        assert_eq!(symmetry.reflected.len(), system.dimension());
        for state in states(system, 50) {
            let reflect = |axis: usize| match symmetry.reflected[axis] {
                true => 2.0 * symmetry.centre[axis] - state[axis],
                false => state[axis],
            };
            let image: Vec<f64> = (0..state.len()).map(reflect).collect();
            let drifts = (system.drift_at(0.0, &state), system.drift_at(0.0, &image));
            for axis in 0..state.len() {
                let sign = if symmetry.reflected[axis] { -1.0 } else { 1.0 };
                let difference = drifts.0[axis] - sign * drifts.1[axis];
                assert!(difference.abs() < 1e-12, "{} axis {axis}", model.name);
            }
            let densities = (
                system.exact_log_density(&state),
                system.exact_log_density(&image),
            );
            if let (Some(there), Some(image)) = densities {
                assert!((there - image).abs() < 1e-10 * (1.0 + there.abs()));
            }
        }
    });
}

#[test]
fn known_bounds_are_never_crossed() {
    each(|model, system| {
        for mut state in states(system, 50) {
            for axis in 0..state.len() {
                let Some((from, to)) = system.bounds(axis) else {
                    continue;
                };
                assert!(from < to && !system.noise_axes().contains(&axis));
                for (bound, outward) in [(from, -1.0), (to, 1.0)] {
                    state[axis] = bound;
                    let speed = outward * system.drift_at(0.0, &state)[axis];
                    assert!(speed <= 1e-12, "{} leaves {bound} at {speed}", model.name);
                }
            }
        }
    });
}

#[test]
fn drift_or_its_slope_jumps_at_a_switching_surface() {
    each(|model, system| {
        for surface in system.switching_surfaces() {
            let step = 1e-5;
            let jump = |state: &Vec<f64>| -> f64 {
                let at = |by: f64| {
                    let mut state = state.clone();
                    state[surface.axis] = surface.at + by;
                    system.drift_at(0.0, &state)
                };
                let (down, up) = ([at(-2.0 * step), at(-step)], [at(step), at(2.0 * step)]);
                let change = |axis: usize| {
                    let value = (up[0][axis] - down[1][axis]).abs();
                    let slopes = (up[1][axis] - up[0][axis]) - (down[1][axis] - down[0][axis]);
                    // A smooth drift changes by O(step) in value and O(step) in slope.
                    value.max(slopes.abs() / step)
                };
                (0..state.len()).map(change).fold(0.0, f64::max)
            };
            let largest = states(system, 50).iter().map(jump).fold(0.0, f64::max);
            assert!(largest > 0.01, "{}: {surface:?} is smooth", model.name);
        }
    });
}

#[test]
fn exact_densities_are_stationary() {
    each(|_, system| assert_stationary(system, false));
}
