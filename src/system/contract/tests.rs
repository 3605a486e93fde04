//! Built-in models keep the contract, and systems that break it are found out.

use std::collections::HashSet;
use std::f64::consts::PI;
use std::sync::Arc;

use super::*;
use crate::system::{
    AxisDescription, Facts, Noise, ParameterDescription, ParameterRange, SwitchingSurface,
    TypedModel, registry,
};

mod patient;
use patient::{Drift, Patient, WELL, healthy, noise};

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
            assert!(!model.system(&values).noises().is_empty());
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

fn centre(system: &mut Patient) -> &mut Vec<f64> {
    &mut system.facts.symmetry.as_mut().unwrap().centre
}

#[test]
fn the_system_that_is_made_wrong_below_is_right() {
    let ranges = [(-2.0, 2.0), (-3.0, 1.0), (-2.0, 2.0)];
    assert_eq!(verify(&healthy(), &ranges), Ok(()));
    // A bound that noise comes up to, but does not cross, is one.
    let fading = Patient {
        noises: noise(2, |[_, _, z]| 1.0 - z * z),
        ..healthy()
    };
    assert_eq!(verify(&fading, &ranges), Ok(()));
    // A period that is kept.
    let mut forced = Patient {
        drift: |time, state| {
            let [x, y, z] = WELL(time, state);
            [x, y + (PI * time).cos(), z]
        },
        ..healthy()
    };
    (forced.facts.period, forced.facts.symmetry) = (Some(2.0), None);
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
        violation(|system| system.noises[0].axis = 3),
        V::NoiseAxis { axis: 3, .. }
    ));
    assert!(matches!(
        violation(|system| system.facts.period = Some(0.0)),
        V::Period { .. }
    ));
    assert!(matches!(
        violation(|system| _ = system.facts.bounds.insert(2, (1.0, f64::NAN))),
        V::Bounds { axis: 2, .. }
    ));
    assert_eq!(
        violation(|system| _ = system.facts.relaxation_rates.insert(3, 1.0)),
        V::Axis {
            axis: 3,
            dimension: 3
        }
    );
    let far = SwitchingSurface { axis: 7, at: 0.0 };
    assert!(matches!(
        violation(|system| system.facts.switching_surfaces.push(far)),
        V::Surface { .. }
    ));
    assert!(matches!(
        violation(|system| centre(system).truncate(1)),
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
        system.facts.period = Some(2.0);
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
    let elsewhere = violation(|system| centre(system)[0] = 0.1);
    assert!(matches!(elsewhere, V::Asymmetric { .. }), "{elsewhere}");
    let uneven = violation(|system| system.noises = noise(1, |[x, ..]| 1.0 + 0.1 * x));
    assert!(
        matches!(
            uneven,
            V::Asymmetric {
                quantity: Quantity::Noise(1),
                ..
            }
        ),
        "{uneven}"
    );
    let left = violation(|system| _ = system.facts.bounds.insert(2, (-1.0, 0.9)));
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
    let across = violation(|system| system.noises[0].axis = 2);
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
        violation(|system| system.facts.switching_surfaces.push(smooth)),
        V::SmoothSurface { surface: smooth }
    );
}

#[test]
fn a_compiled_drift_must_be_what_the_formulas_say() {
    let verified = |stiffness: f64| {
        let model = TypedModel::new("linear", "Linear", ["x"])
            .with_equation("x", "-2 x")
            .with_noise("x", ["0.5"])
            .with_compiled_drift(move |_| {
                Box::new(move |_, states, drift| drift[0] = states[0].map(|x| -stiffness * x))
            });
        let model = model.build().unwrap();
        verify_model(&model, &model.values(&[]).unwrap(), &[(-2.0, 2.0)])
    };
    assert_eq!(verified(2.0), Ok(()));
    let wrong = verified(2.0 + 1e-6);
    assert!(
        matches!(wrong, Err(ContractViolation::Formula { axis: 0, .. })),
        "{wrong:?}"
    );
}

#[test]
fn an_exact_density_must_solve_the_fokker_planck_equation() {
    // Three uncoupled axes, noise on the second only: p is what that axis makes of it, whatever its noise.
    let linear = |system: &mut Patient| {
        system.drift = |_, [_, y, _]| [0.0, -y, 0.0];
        system.facts.switching_surfaces = Vec::new();
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
            system.noises = noise(1, |[_, y, _]| 0.5 * (1.0 + y * y).sqrt());
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

/// A patient with these noises, of which nothing is known.
fn plain(drift: Drift, noises: Vec<Noise>) -> Patient {
    Patient {
        noises,
        drift,
        facts: Facts::default(),
        ..healthy()
    }
}

const BOX: [(f64, f64); 3] = [(-2.0, 2.0); 3];

/// The first two states are declared to be those of a filter, with white noise on the second.
#[test]
fn states_of_a_filter_must_have_the_normal_density_that_is_declared() {
    let verified = |drift: Drift| {
        let mut system = plain(drift, vec![Noise::constant(1, 1.0)]);
        let facts = [0, 1].map(|axis| (axis, (0.0, 1.0)));
        system.facts.filtered_noise = facts.into();
        verify(&system, &BOX).is_ok()
    };
    // The noise of intensity 1 damps at the rate 1/2 of the unit variance; both turn into one another.
    assert!(verified(|_, [u, v, z]| [3.0 * v, -3.0 * u - 0.5 * v, -z]));
    let wrong: [Drift; 5] = [
        |_, [u, v, z]| [3.0 * v, -2.0 * u - 0.5 * v, -z],
        |_, [u, v, z]| [3.0 * v, -3.0 * u - 0.6 * v, -z],
        |_, [u, v, z]| [3.0 * v - 0.1 * u, -3.0 * u - 0.5 * v, -z],
        |_, [u, v, z]| [3.0 * v.sin(), -3.0 * u - 0.5 * v, -z],
        |_, [u, v, z]| [3.0 * v + 0.2, -3.0 * u - 0.5 * v, -z],
    ];
    assert!(!wrong.into_iter().any(verified));
}

/// The second coordinate is said to relax at the rate 2.
#[test]
fn a_coordinate_that_relaxes_does_so_at_the_declared_rate_and_without_noise() {
    let found = |drift: Drift, driven: usize| {
        let mut system = plain(drift, vec![Noise::constant(driven, 1.0)]);
        system.facts.relaxation_rates = [(1, 2.0)].into();
        verify(&system, &BOX)
    };
    assert_eq!(found(|_, [x, v, z]| [-x, x * x - 2.0 * v, -z], 0), Ok(()));
    let wrong: [(Drift, usize); 4] = [
        (|_, [x, v, z]| [-x, x - 1.9 * v, -z], 0),
        (|_, [x, v, z]| [-x, x - 2.0 * v + 0.1 * v * v, -z], 0),
        (|_, [x, v, z]| [-x, x - (2.0 + 0.1 * x) * v, -z], 0),
        (|_, [x, v, z]| [-x, x - 2.0 * v, -z], 1),
    ];
    for (wrong, driven) in wrong {
        let found = found(wrong, driven);
        let is_it = matches!(found, Err(ContractViolation::Relaxation { axis: 1, .. }));
        assert!(is_it, "{found:?}");
    }
}
