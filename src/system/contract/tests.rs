//! Built-in models keep the contract, and systems that break it are found out.

use std::collections::HashSet;
use std::f64::consts::PI;
use std::sync::Arc;

use super::*;
use crate::system::{
    AxisDescription, LANES, Lanes, ParameterDescription, ParameterRange, SwitchingSurface, registry,
};

mod patient;
use patient::{Patient, WELL, healthy};

/// A built-in model with named parameter values.
pub(in crate::system) fn bound(model: &str, values: &[(&str, f64)]) -> Arc<dyn System> {
    registry::find(model).unwrap().system_with(values).unwrap()
}

fn box_of(system: &dyn System) -> Vec<(f64, f64)> {
    vec![(-2.0, 2.0); system.dimension()]
}

/// The contract holds (but for surfaces that a level of zero makes smooth), and the exact density is known.
pub(in crate::system) fn assert_stationary(system: &dyn System) {
    match verify(system, &box_of(system)) {
        Ok(()) | Err(ContractViolation::SmoothSurface { .. }) => {}
        Err(violation) => panic!("{violation}"),
    }
    let state = vec![0.3; system.dimension()];
    assert!(system.exact_log_density(&state).is_some());
}

#[test]
fn every_built_in_model_keeps_the_contract() {
    let mut names = HashSet::new();
    for model in registry::models() {
        assert!(names.insert(&model.name) && !model.title.is_empty());
        assert!(Arc::ptr_eq(&registry::find(&model.name).unwrap(), model));
        assert!(!model.equations.is_empty() && !model.source.is_empty());
        // Values that every model accepts.
        for first in [0.3, 1.1] {
            let value = |index: usize| first + 0.17 * index as f64;
            let named = model.parameters.iter().enumerate();
            let given: Vec<_> = named.map(|(i, p)| (p.name.as_str(), value(i))).collect();
            let values = model.values(&given).unwrap();
            let ranges = vec![(-2.0, 2.0); model.axes.len()];
            let verified = verify_model(model, &values, &ranges);
            assert_eq!(verified, Ok(()), "{} from {first}", model.name);
            assert!(!model.system(&values).noise_axes().is_empty());
        }
    }
}

#[test]
fn a_model_that_contradicts_itself_is_found_out() {
    let axis = |name: &str| AxisDescription::new(name, name, "an axis");
    let level = || ParameterDescription::new("f", "f", "level").within(ParameterRange::Positive);
    let model = || Model::new("patient", "Made wrong", |_| Arc::new(healthy()));
    let whole = || [axis("x"), axis("y"), axis("z")];
    let verified = |model: Model| {
        let values = model.values(&[("f", 1.0)]).unwrap();
        verify_model(&model, &values, &[(-2.0, 2.0); 3])
    };
    let right = model().with_axes(whole()).with_parameters([level()]);
    assert_eq!(verified(right), Ok(()));
    let mut named_alike = whole();
    named_alike[2] = axis("f");
    let twice = verified(model().with_axes(named_alike).with_parameters([level()]));
    let name = "f".to_owned();
    assert_eq!(twice, Err(ContractViolation::NameTwice { name }));
    let few = verified(model().with_axes([axis("x")]).with_parameters([level()]));
    let described = ContractViolation::AxesDescribed {
        described: 1,
        dimension: 3,
    };
    assert_eq!(few, Err(described));
    let negative = level().with_default(-1.0);
    let default = verified(model().with_axes(whole()).with_parameters([negative]));
    assert!(
        matches!(default, Err(ContractViolation::Default { .. })),
        "{default:?}"
    );
}

fn violation(change: impl FnOnce(&mut Patient)) -> ContractViolation {
    let mut patient = healthy();
    change(&mut patient);
    verify(&patient, &[(-2.0, 2.0), (-3.0, 1.0), (-2.0, 2.0)]).unwrap_err()
}

#[test]
fn the_system_that_is_made_wrong_below_is_right() {
    let ranges = [(-2.0, 2.0), (-3.0, 1.0), (-2.0, 2.0)];
    assert_eq!(verify(&healthy(), &ranges), Ok(()));
    // A bound that noise comes up to, but does not cross, is one.
    let fading = Patient {
        noise_axis: 2,
        constant: f64::NAN,
        amplitude: |state| 1.0 - state[2] * state[2],
        ..healthy()
    };
    assert_eq!(verify(&fading, &ranges), Ok(()));
    // A period that is kept.
    let forced = Patient {
        period: Some(2.0),
        centre: Vec::new(),
        drift: |time, state| {
            let [x, y, z] = WELL(time, state);
            [x, y + (PI * time).cos(), z]
        },
        ..healthy()
    };
    assert_eq!(verify(&forced, &ranges), Ok(()));
}

#[test]
fn declarations_that_do_not_fit_are_found_out() {
    use ContractViolation as V;
    assert_eq!(
        violation(|system| system.dimension = 5),
        V::Dimension { dimension: 5 }
    );
    assert_eq!(
        verify(&healthy(), &[(-1.0, 1.0)]),
        Err(V::Ranges {
            given: 1,
            dimension: 3
        })
    );
    let empty = verify(&healthy(), &[(-1.0, 1.0), (-1.0, 1.0), (2.0, 3.0)]);
    assert!(matches!(empty, Err(V::Range { axis: 2, .. })), "{empty:?}");
    assert!(matches!(
        violation(|system| system.noise_axis = 3),
        V::NoiseAxis { axis: 3, .. }
    ));
    assert!(matches!(
        violation(|system| system.period = Some(0.0)),
        V::Period { .. }
    ));
    assert!(matches!(
        violation(|system| system.bounds = (1.0, f64::NAN)),
        V::Bounds { axis: 2, .. }
    ));
    let far = SwitchingSurface { axis: 7, at: 0.0 };
    assert!(matches!(
        violation(|system| system.surfaces.push(far)),
        V::Surface { .. }
    ));
    assert!(matches!(
        violation(|system| system.centre = vec![0.0]),
        V::SymmetryShape { centre: 1, .. }
    ));
}

#[test]
fn what_does_not_hold_is_found_out_at_a_state() {
    use ContractViolation as V;
    let infinite = violation(|system| system.drift = |_, [x, _, _]| [x.ln(), 0.0, 0.0]);
    let V::NotFinite {
        quantity: Quantity::Drift(0),
        state,
        ..
    } = &infinite
    else {
        panic!("{infinite}");
    };
    assert!(state[0] < 0.0);
    let amplitude = violation(|system| system.constant = 0.4);
    assert!(
        matches!(
            amplitude,
            V::Amplitude {
                declared: 0.4,
                found: 0.5,
                ..
            }
        ),
        "{amplitude}"
    );
    let time = violation(|system| system.drift = |time, [x, y, z]| [y, -x - y + time.sin(), -z]);
    assert!(
        matches!(
            time,
            V::Time {
                quantity: Quantity::Drift(1),
                from: 0.0,
                ..
            }
        ),
        "{time}"
    );
    let period = violation(|system| {
        system.period = Some(2.0);
        system.drift = |time, [x, y, z]| [y, -x - y + time.sin(), -z];
    });
    assert!(
        matches!(
            period,
            V::Time {
                period: Some(2.0),
                ..
            }
        ),
        "{period}"
    );
    // A tilt of a millionth of the drift, and another centre.
    let tilted = |system: &mut Patient| system.drift = |_, [x, y, z]| [y, -x - y + 1e-6, -z];
    let asymmetric = violation(tilted);
    let V::Asymmetric {
        quantity: Quantity::Drift(1),
        state,
        image,
        ..
    } = &asymmetric
    else {
        panic!("{asymmetric}");
    };
    assert!(state.iter().zip(image).all(|(one, other)| *one == -other));
    let elsewhere = violation(|system| system.centre = vec![0.1, 0.0, 0.0]);
    assert!(matches!(elsewhere, V::Asymmetric { .. }), "{elsewhere}");
    let noise = violation(|system| {
        system.constant = f64::NAN;
        system.amplitude = |state| 1.0 + 0.1 * state[0];
    });
    assert!(
        matches!(
            noise,
            V::Asymmetric {
                quantity: Quantity::Noise(1),
                ..
            }
        ),
        "{noise}"
    );
    let left = violation(|system| system.bounds = (-1.0, 0.9));
    let V::BoundLeft {
        axis: 2,
        bound: 0.9,
        state,
        speed,
    } = &left
    else {
        panic!("{left}");
    };
    assert!(state[2] == 0.9 && *speed > 0.0);
    let across = violation(|system| system.noise_axis = 2);
    assert!(
        matches!(
            across,
            V::BoundNoise {
                axis: 2,
                amplitude: 0.5,
                ..
            }
        ),
        "{across}"
    );
    let smooth = SwitchingSurface { axis: 0, at: 0.5 };
    assert_eq!(
        violation(|system| system.surfaces.push(smooth)),
        V::SmoothSurface { surface: smooth }
    );
}

#[test]
fn an_exact_density_must_solve_the_fokker_planck_equation() {
    // Three uncoupled axes, noise on the second only: p is what that axis makes of it, whatever its noise.
    let linear = |system: &mut Patient| {
        system.drift = |_, [_, y, _]| [0.0, -y, 0.0];
        system.surfaces = Vec::new();
        system.density = Some(|state| -4.0 * state[1] * state[1]);
    };
    let verified = |change: &dyn Fn(&mut Patient)| {
        let mut patient = healthy();
        linear(&mut patient);
        change(&mut patient);
        verify(&patient, &[(-2.0, 2.0); 3])
    };
    assert_eq!(verified(&|_| {}), Ok(()));
    let wrong = verified(&|system| system.density = Some(|state| -4.01 * state[1] * state[1]));
    assert!(
        matches!(wrong, Err(ContractViolation::NotStationary { .. })),
        "{wrong:?}"
    );
    let lopsided =
        verified(&|system| system.density = Some(|state| -4.0 * (state[1] - 0.1).powi(2)));
    let density = Quantity::Density;
    assert!(
        matches!(lopsided, Err(ContractViolation::Asymmetric { quantity, .. }) if quantity == density),
        "{lopsided:?}"
    );
    // b² = (1 + y²)/4: (-y p) = (b² p)'/2 gives p = (1 + y²)^(-5).
    let state_dependent = |power: fn(&[f64]) -> f64| {
        verified(&|system| {
            system.constant = f64::NAN;
            system.amplitude = |state| 0.5 * (1.0 + state[1] * state[1]).sqrt();
            system.density = Some(power);
        })
    };
    assert_eq!(
        state_dependent(|state| -5.0 * state[1].mul_add(state[1], 1.0).ln()),
        Ok(())
    );
    let stratonovich = state_dependent(|state| -4.5 * state[1].mul_add(state[1], 1.0).ln());
    assert!(
        matches!(stratonovich, Err(ContractViolation::NotStationary { .. })),
        "{stratonovich:?}"
    );
}

/// What is declared to be the two states of a filter with white noise on the second: drifts by both.
struct Pair {
    drift: fn(f64, f64) -> [f64; 2],
}

impl System for Pair {
    fn dimension(&self) -> usize {
        2
    }

    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        for lane in 0..LANES {
            let [first, second] = (self.drift)(states[0][lane], states[1][lane]);
            (drift[0][lane], drift[1][lane]) = (first, second);
        }
    }

    fn noise_axes(&self) -> &[usize] {
        &[1]
    }

    fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
        Some(1.0)
    }

    fn filtered_noise(&self, _axis: usize) -> Option<(f64, f64)> {
        Some((0.0, 1.0))
    }
}

#[test]
fn states_of_a_filter_must_have_the_normal_density_that_is_declared() {
    let verified =
        |drift: fn(f64, f64) -> [f64; 2]| verify(&Pair { drift }, &[(-2.0, 2.0); 2]).is_ok();
    // The noise of intensity 1 damps at the rate 1/2 of the unit variance; both turn into one another.
    assert!(verified(|u, v| [3.0 * v, -3.0 * u - 0.5 * v]));
    for wrong in [
        |u: f64, v: f64| [3.0 * v, -2.0 * u - 0.5 * v],
        |u: f64, v: f64| [3.0 * v, -3.0 * u - 0.6 * v],
        |u: f64, v: f64| [3.0 * v - 0.1 * u, -3.0 * u - 0.5 * v],
        |u: f64, v: f64| [3.0 * v.sin(), -3.0 * u - 0.5 * v],
        |u: f64, v: f64| [3.0 * v + 0.2, -3.0 * u - 0.5 * v],
    ] {
        assert!(!verified(wrong));
    }
}

/// v' = drift(x, v) on the second axis, said to relax at the rate 2; noise on the first.
struct Circuit {
    drift: fn(f64, f64) -> f64,
    driven: [usize; 1],
}

impl System for Circuit {
    fn dimension(&self) -> usize {
        2
    }

    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        for lane in 0..LANES {
            drift[0][lane] = -states[0][lane];
            drift[1][lane] = (self.drift)(states[0][lane], states[1][lane]);
        }
    }

    fn noise_axes(&self) -> &[usize] {
        &self.driven
    }

    fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
        Some(1.0)
    }

    fn relaxation_rate(&self, axis: usize) -> Option<f64> {
        (axis == 1).then_some(2.0)
    }
}

#[test]
fn a_coordinate_that_relaxes_does_so_at_the_declared_rate_and_without_noise() {
    let found = |drift: fn(f64, f64) -> f64, driven: usize| {
        let system = Circuit {
            drift,
            driven: [driven],
        };
        verify(&system, &[(-2.0, 2.0); 2])
    };
    assert_eq!(found(|x, v| x * x - 2.0 * v, 0), Ok(()));
    for (wrong, driven) in [
        ((|x, v| x - 1.9 * v) as fn(f64, f64) -> f64, 0),
        (|x, v| x - 2.0 * v + 0.1 * v * v, 0),
        (|x, v| x - (2.0 + 0.1 * x) * v, 0),
        (|x, v| x - 2.0 * v, 1),
    ] {
        let found = found(wrong, driven);
        let is_it = matches!(found, Err(ContractViolation::Relaxation { axis: 1, .. }));
        assert!(is_it, "{found:?}");
    }
}
