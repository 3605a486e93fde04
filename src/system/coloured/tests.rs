//! Coloured noise of built-in and typed models: contracts, symmetry, refusals.

use super::*;
use crate::system::{Model, TypedModel, contract, registry};

const KINDS: [NoiseKind; 2] = [NoiseKind::OrnsteinUhlenbeck, NoiseKind::Harmonic];

#[test]
fn every_built_in_model_keeps_its_contract_with_coloured_noise() {
    let cases = registry::models()
        .iter()
        .flat_map(|white| KINDS.map(|kind| (white, kind)));
    for (white, kind) in cases {
        let model = match Model::with_coloured_noise(white, kind) {
            Ok(model) => model,
            Err(error) => {
                assert!(
                    white.axes.len() + kind.filter_states() > MAX_DIMENSION,
                    "{error}"
                );
                continue;
            }
        };
        let given = model.parameters.iter().map(|one| {
            let value = one.default.filter(|&value| value != 0.0).unwrap_or(0.3);
            (one.name.as_str(), value)
        });
        let values = model.values(&given.collect::<Vec<_>>()).unwrap();
        let ranges = vec![(-1.5, 1.5); model.axes.len()];
        match contract::verify_model(&model, &values, &ranges) {
            Ok(()) | Err(contract::ContractViolation::SmoothSurface { .. }) => {}
            Err(violation) => panic!("{}: {violation}", model.name),
        }
        let (system, inner) = (model.system(&values), white.bound(values.as_slice()));
        assert_eq!(
            system.facts().symmetry.is_some(),
            inner.facts().symmetry.is_some()
        );
        assert_eq!(system.dimension(), inner.dimension() + kind.filter_states());
    }
}

fn typed(noise: &[&str]) -> TypedModel {
    TypedModel::new("test", "test", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-x - x^3 - y")
        .with_noise("y", noise.iter().copied())
        .with_parameters(["tau"])
}

#[test]
fn a_noise_is_reflected_with_its_axis_unless_its_amplitude_is_odd() {
    let reflected = |noise: &[&str]| {
        let model = typed(noise)
            .with_coloured_noise(NoiseKind::OrnsteinUhlenbeck)
            .build()
            .unwrap();
        let values = model.values(&[("tau", 0.7)]).unwrap();
        let ranges = vec![(-2.0, 2.0); model.axes.len()];
        contract::verify_model(&model, &values, &ranges).unwrap();
        model
            .system(&values)
            .facts()
            .symmetry
            .clone()
            .map(|one| one.reflected)
    };
    assert_eq!(reflected(&["0.5"]), Some(vec![true; 3]));
    assert_eq!(reflected(&["x^2 + 1"]), Some(vec![true; 3]));
    assert_eq!(reflected(&["x"]), Some(vec![true, true, false]));
    assert_eq!(
        reflected(&["0.5", "y"]),
        Some(vec![true, true, true, false])
    );
    assert_eq!(reflected(&["1 + x"]), None);
}

#[test]
fn what_cannot_be_coloured_is_refused() {
    let refused = |model: TypedModel| model.build().unwrap_err().to_string();
    let three = typed(&["1", "x", "y"]).with_coloured_noise(NoiseKind::OrnsteinUhlenbeck);
    assert!(refused(three).contains("adds an axis for each of 3 noises"));
    let ito = typed(&["1 + y"]).with_coloured_noise(NoiseKind::OrnsteinUhlenbeck);
    let ito = ito.with_interpretation(crate::system::Interpretation::Ito);
    assert!(refused(ito).contains("Stratonovich"));
    let taken = typed(&["1"])
        .with_definition("noise", "x")
        .with_coloured_noise(NoiseKind::OrnsteinUhlenbeck);
    assert!(refused(taken).contains("`noise`"));
    let four = Model::with_coloured_noise(
        &registry::find("bliman_sorine").unwrap(),
        NoiseKind::OrnsteinUhlenbeck,
    );
    assert!(matches!(
        four,
        Err(ColouredNoiseError::Axes {
            axes: 4,
            noises: 1,
            each: 1
        })
    ));
}

#[test]
fn harmonic_noise_has_two_axes_and_two_parameters() {
    let white = registry::find("bistable").unwrap();
    let model = Model::with_coloured_noise(&white, NoiseKind::Harmonic).unwrap();
    let axes: Vec<&str> = model.axes.iter().map(|axis| axis.name.as_str()).collect();
    assert_eq!(axes, ["x", "noise", "noise_rate"]);
    let given = [
        ("a", -0.1),
        ("sigma2", 0.2),
        (NOISE_FREQUENCY, 3.0),
        (NOISE_DAMPING, 0.25),
    ];
    let system = model.system_with(&given).unwrap();
    // x' = a x - x³ + σ √(ω_n/(4 ζ_n)) η, η' = ω_n ν, ν' = -ω_n η - 2 ζ_n ω_n ν.
    let drift = system.drift_at(0.0, &[1.0, 2.0, 0.5]);
    let exact = [
        -1.1 + 0.2_f64.sqrt() * 3.0_f64.sqrt() * 2.0,
        1.5,
        -6.0 - 0.75,
    ];
    for (found, exact) in drift.iter().zip(exact) {
        assert!((found - exact).abs() < 1e-14, "{drift:?}");
    }
    // Σ = 1 of both states: 2 · 2 ζ_n ω_n = 4 ζ_n ω_n.
    assert_eq!(system.noises()[0].axis, 2);
    assert!((system.noises()[0].additive().unwrap().powi(2) - 3.0).abs() < 1e-14);
    let two = typed(&["0.5", "y"]).with_coloured_noise(NoiseKind::Harmonic);
    assert!(two.build().unwrap_err().to_string().contains("two axes"));
}
