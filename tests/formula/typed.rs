//! Models made of typed equations: both readings of multiplicative noise, and what is refused.

use std::sync::Arc;

use pbif::formula::language::Fault;
use pbif::system::{
    FormulaPlace, Interpretation, ParameterDescription, ParameterRange, System, TypedModel,
    TypedModelError, contract,
};

use crate::common::steady::even_cells;

/// Steady masses of the cells of one axis, Σ = 1.
fn masses(system: &dyn System, (half, count): (f64, usize)) -> Vec<f64> {
    let space = even_cells(&[(-half, half, count)]);
    super::twins::masses(system, &space)
}

fn total_variation(one: &[f64], other: &[f64]) -> f64 {
    let pairs = one.iter().zip(other);
    0.5 * pairs.map(|(a, b)| (a - b).abs()).sum::<f64>()
}

/// dx = (x - x³) dt + (multiplicative and additive noise), read in one way.
fn multiplicative(drift: &str, interpretation: Interpretation) -> Arc<dyn System> {
    let model = TypedModel::new("multiplicative", "Multiplicative noise", ["x"])
        .with_equation("x", drift)
        .with_noise("x", ["s x", "0.5"])
        .with_interpretation(interpretation)
        .with_parameters([ParameterDescription::from("s").with_default(0.7)])
        .build()
        .unwrap();
    let values = model.values(&[]).unwrap();
    contract::verify_model(&model, &values, &[(-2.0, 2.0)]).unwrap();
    model.system(&values)
}

#[test]
fn the_readings_of_multiplicative_noise_differ_by_the_drift_correction_and_give_their_exact_densities()
 {
    let stratonovich = multiplicative("x - x^3", Interpretation::Stratonovich);
    let corrected = multiplicative("x - x^3 + s^2 x/2", Interpretation::Ito);
    let ito = multiplicative("x - x^3", Interpretation::Ito);
    assert_eq!(stratonovich.noises()[0].additive(), None);
    assert_eq!(stratonovich.noises()[1].additive(), Some(0.5));
    assert!((stratonovich.noises()[0].at(0.0, &[2.0]) - 1.4).abs() < 1e-15);
    for x in [-1.5, 0.3, 2.0] {
        let difference = stratonovich.drift_at(0.0, &[x])[0] - ito.drift_at(0.0, &[x])[0];
        assert!((difference - 0.245 * x).abs() < 1e-14);
    }
    let grid = (3.5, 400);
    let found = masses(&*stratonovich, grid);
    let distance = total_variation(&found, &masses(&*corrected, grid));
    assert!(distance < 1e-12, "{distance:e}");
    // With D = s²x² + 1/4: p ∝ D^(-θ) exp(∫ 2(x - x³)/D dx), θ = 1/2 for Stratonovich and 1 for Itô, where
    // ∫ 2(x - x³)/D dx = (1/s² + 1/(4s⁴)) ln D - x²/s².
    for (system, theta) in [(&stratonovich, 0.5), (&ito, 1.0)] {
        let s2 = 0.49_f64;
        let log_density = |x: f64| {
            let intensity = s2 * x * x + 0.25;
            (1.0 / s2 + 0.25 / (s2 * s2) - theta) * intensity.ln() - x * x / s2
        };
        let width = 7.0 / 400.0;
        let centre = |cell: usize| -3.5 + (cell as f64 + 0.5) * width;
        // Simpson's rule in each cell; its error is far below that of the grid.
        let exact: Vec<f64> = (0..400)
            .map(|cell| {
                let density = |offset: f64| log_density(centre(cell) + offset * width).exp();
                density(-0.5) + 4.0 * density(0.0) + density(0.5)
            })
            .collect();
        let total: f64 = exact.iter().sum();
        let exact: Vec<f64> = exact.iter().map(|mass| mass / total).collect();
        let distance = total_variation(&masses(&**system, grid), &exact);
        assert!(distance < 1e-5, "{theta}: {distance:e}");
    }
}

#[test]
fn surfaces_and_symmetry_follow_the_parameters() {
    let model = TypedModel::new("belt", "Friction on a moving belt", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-x - k y - sign(y - v) + tilt + max(x^2 - gap, 0)")
        .with_noise("y", ["1"])
        .with_parameters(
            ["k", "v", "tilt", "gap"]
                .map(|name| ParameterDescription::from(name).with_default(0.0)),
        )
        .build()
        .unwrap();
    let surfaces = |values: &[(&str, f64)]| -> Vec<(usize, f64)> {
        let system = model.system_with(values).unwrap();
        let surfaces = &system.facts().switching_surfaces;
        surfaces
            .iter()
            .map(|surface| (surface.axis, surface.at))
            .collect()
    };
    let mut found = surfaces(&[("v", 0.3), ("gap", 4.0)]);
    found.sort_by(|one, other| one.1.total_cmp(&other.1));
    assert_eq!(found, [(0, -2.0), (1, 0.3), (0, 2.0)]);
    // No plane where x² = -1.
    assert_eq!(surfaces(&[("gap", -1.0)]), [(1, 0.0)]);
    let plain = TypedModel::new("tilted", "Tilted", ["x"])
        .with_equation("x", "tilt - x^3")
        .with_noise("x", ["1"])
        .with_parameters(["tilt"])
        .build()
        .unwrap();
    let symmetry = |tilt| {
        plain
            .system_with(&[("tilt", tilt)])
            .unwrap()
            .facts()
            .symmetry
            .clone()
    };
    assert!(symmetry(0.0).is_some() && symmetry(0.1).is_none());
    // A bound on one side only.
    let half = TypedModel::new("half", "Half", ["x"])
        .with_equation("x", "-x")
        .with_bounds("x", "-1", "2")
        .build()
        .unwrap();
    assert_eq!(half.system_with(&[]).unwrap().facts().symmetry, None);
}

#[test]
fn what_is_not_smooth_off_the_grid_is_named() {
    let model = TypedModel::new("oblique", "Oblique", ["x", "y"])
        .with_equation("x", "-abs(x + y)")
        .with_equation("y", "-y")
        .build()
        .unwrap();
    assert!(model.notes[0].contains("x + y = 0"), "{:?}", model.notes);
    assert_eq!(model.equations[0], "x' = -abs(x + y)");
}

#[test]
fn a_period_is_declared_and_kept() {
    let forced = TypedModel::new("forced", "Forced", ["x"])
        .with_equation("x", "-x + cos(ω t)")
        .with_noise("x", ["0.5"])
        .with_parameters([ParameterDescription::from("omega").within(ParameterRange::Positive)]);
    let model = forced.with_period("2 pi/omega").build().unwrap();
    let values = model.values(&[("omega", 2.0)]).unwrap();
    assert_eq!(
        model.system(&values).facts().period,
        Some(std::f64::consts::PI)
    );
    contract::verify_model(&model, &values, &[(-2.0, 2.0)]).unwrap();
    assert_eq!(model.parameters[0].symbol, "ω");
}

/// x' = y, y' = -x with the parameter k, to be spoilt.
fn sound() -> TypedModel {
    TypedModel::new("sound", "Sound", ["x", "y"])
        .with_equation("x", "y")
        .with_parameters(["k"])
}

fn refused(model: TypedModel) -> TypedModelError {
    model.build().unwrap_err()
}

fn refused_with(equation: &str) -> TypedModelError {
    refused(sound().with_equation("y", equation))
}

#[test]
fn a_fault_of_a_formula_is_shown_in_the_formula() {
    let TypedModelError::Formula { place, text, error } = refused_with("-x + kk y") else {
        panic!("another error")
    };
    let equation = FormulaPlace::Equation { axis: "y".into() };
    assert_eq!((place, text.as_str()), (equation, "-x + kk y"));
    assert_eq!(error.span, 5..7);
    let message = refused_with("-x + kk y").to_string();
    assert!(
        message.contains("the equation of `y`:\n  -x + kk y\n       ^^"),
        "{message}"
    );
    for (text, expected) in [
        ("", Fault::Empty),
        ("(x", Fault::Unclosed),
        ("x < y < 1", Fault::Chained),
    ] {
        let error = refused_with(text);
        let matches =
            matches!(&error, TypedModelError::Formula { error, .. } if error.fault == expected);
        assert!(matches, "{text}: {error}");
    }
    let long = refused_with(&"x + ".repeat(300_000));
    let matches = matches!(&long, TypedModelError::Formula { error, .. } if matches!(error.fault, Fault::TooLong { .. }));
    assert!(matches && long.to_string().len() < 500, "{long}");
    let model = sound().with_equation("y", "a").with_definition("a", "2 +");
    assert!(
        refused(model)
            .to_string()
            .starts_with("the definition of `a`:\n  2 +")
    );
    let model = sound()
        .with_equation("y", "a")
        .with_definition("a", "b")
        .with_definition("b", "a");
    assert!(
        refused(model)
            .to_string()
            .contains("it needs itself: a → b → a")
    );
}

#[test]
fn names_and_equations_that_do_not_fit_are_refused() {
    let whole = || sound().with_equation("y", "-x");
    assert!(whole().build().is_ok());
    let named = |name: &str| refused(whole().with_parameters([name])).to_string();
    assert!(named("x").contains("already a state"), "{}", named("x"));
    assert!(named("sin").contains("a function") && named("2k").contains("not a name"));
    let none: [&str; 0] = [];
    assert_eq!(
        refused(TypedModel::new("m", "m", none)),
        TypedModelError::Axes { given: 0 }
    );
    let many = TypedModel::new("m", "m", ["a", "b", "c", "d", "f"]);
    assert_eq!(refused(many), TypedModelError::Axes { given: 5 });
    assert_eq!(
        refused(sound()),
        TypedModelError::MissingEquation { axis: "y".into() }
    );
    let doubled = refused(whole().with_equation("y", "x"));
    let place = FormulaPlace::Equation { axis: "y".into() };
    assert_eq!(doubled, TypedModelError::Doubled { place });
    for model in [
        whole().with_equation("z", "1"),
        whole().with_noise("z", ["1"]),
        whole().with_bounds("z", "0", "1"),
    ] {
        let error = refused(model);
        assert!(
            matches!(error, TypedModelError::UnknownAxis { .. }),
            "{error}"
        );
        assert!(error.to_string().contains("its axes are x, y"), "{error}");
    }
    let state = refused(whole().with_bounds("x", "-1", "y"));
    assert!(state.to_string().contains("contains `y`"), "{state}");
    let default = ParameterDescription::from("c")
        .with_default(-1.0)
        .within(ParameterRange::Positive);
    let default = refused(whole().with_parameters([default]));
    assert!(
        matches!(default, TypedModelError::Default { value: -1.0, .. }),
        "{default}"
    );
}

#[test]
fn noise_that_no_method_can_take_is_refused() {
    let whole = || sound().with_equation("y", "-x");
    let shared = refused(whole().with_shared_noise([("x", "k"), ("y", "1")]));
    let axes = vec!["`x`".to_owned(), "`y`".to_owned()];
    assert_eq!(shared, TypedModelError::SharedNoise { process: 0, axes });
    assert!(
        shared.to_string().contains("noise 1 drives `x` and `y`"),
        "{shared}"
    );
    // Zero on all axes but one is a noise of that axis.
    let model = whole()
        .with_shared_noise([("x", "0"), ("y", "1")])
        .build()
        .unwrap();
    let system = model.system_with(&[("k", 1.0)]).unwrap();
    assert_eq!(
        (system.noises()[0].axis, system.noises()[0].additive()),
        (1, Some(1.0))
    );
    // Both readings agree while an amplitude does not depend on its own axis.
    assert!(whole().with_noise("y", ["x"]).build().is_ok());
    let unread = refused(whole().with_noise("y", ["y"]));
    assert_eq!(unread, TypedModelError::Interpretation { axis: "y".into() });
    let jumping = whole().with_noise("y", ["1 + step(y)"]);
    let unread = refused(jumping.clone());
    assert!(
        matches!(unread, TypedModelError::Interpretation { .. }),
        "{unread}"
    );
    let jump = refused(
        jumping
            .clone()
            .with_interpretation(Interpretation::Stratonovich),
    );
    assert_eq!(
        jump,
        TypedModelError::JumpingNoise {
            argument: "y".into()
        }
    );
    assert!(
        jumping
            .with_interpretation(Interpretation::Ito)
            .build()
            .is_ok()
    );
}
