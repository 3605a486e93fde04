//! Parity of formulas and reflections of systems.

use super::{formula, scope};
use crate::formula::analysis::Reflection;
use crate::formula::analysis::reflection::{Parity, ReflectionError};
use crate::formula::graph::{Expression, Point};

fn parity(text: &str, reflected: [bool; 3], centre: [f64; 3]) -> (Parity, bool) {
    let mut scope = scope();
    let expression = formula(&mut scope, text);
    let reflection = Reflection {
        centre: centre.to_vec(),
        reflected: reflected.to_vec(),
    };
    let found = scope
        .graph_mut()
        .parity(expression, &reflection, &[0.0, 1.5, 0.25])
        .unwrap();
    // What is said to differ does differ.
    for (state, sign) in [(&found.not_even, 1.0), (&found.not_odd, -1.0)] {
        let Some(state) = state else { continue };
        let mirrored = reflection.mirrored(state);
        let value = |state: &[f64]| {
            let point = Point {
                states: state,
                parameters: &[0.0, 1.5, 0.25],
                time: 0.0,
            };
            scope.graph().evaluate(expression, &point)
        };
        assert!(
            (value(state) - sign * value(&mirrored)).abs() > 1e-9 * value(state).abs().min(1.0),
            "{text}"
        );
    }
    (found.parity, found.proven)
}

#[test]
fn parity_is_seen_from_the_form_or_found_by_trial() {
    let all = [true; 3];
    for (text, reflected, centre, expected) in [
        (
            "-b y - x (1 + x^2) - d sign(y)",
            all,
            [0.0; 3],
            (Parity::Odd, true),
        ),
        (
            "x y + cos(z) + abs(x)^3",
            all,
            [0.0; 3],
            (Parity::Even, true),
        ),
        ("b + t", all, [0.0; 3], (Parity::Even, true)),
        // a = 0: the tilt is switched off.
        ("x - x^3 + a", all, [0.0; 3], (Parity::Odd, true)),
        ("a x^2", all, [0.0; 3], (Parity::Zero, true)),
        ("x - x^3 + b", all, [0.0; 3], (Parity::Neither, false)),
        // A tilt that is seen at states of its own size only.
        (
            "4e-7 + 0.4 x - 1e12 x^3",
            all,
            [0.0; 3],
            (Parity::Neither, false),
        ),
        // Terms that cancel leave nothing but rounding at small states: no sign of a tilt.
        (
            "(x + 1)^3 - 1 - 3 x - 3 x^2",
            all,
            [0.0; 3],
            (Parity::Odd, false),
        ),
        (
            "(x - 1)^3 - (x - 1)",
            all,
            [1.0, 0.0, 0.0],
            (Parity::Odd, true),
        ),
        (
            "(x - 0.1)^3 (y + 0.7)",
            all,
            [0.1, -0.7, 0.0],
            (Parity::Even, true),
        ),
        (
            "x^3 - 3 x^2 + 3 x - 1",
            all,
            [1.0, 0.0, 0.0],
            (Parity::Odd, false),
        ),
        ("exp(x) - exp(-x)", all, [0.0; 3], (Parity::Odd, false)),
        ("step(x) - 0.5", all, [0.0; 3], (Parity::Odd, false)),
        ("if(x > 0, d, -d)", all, [0.0; 3], (Parity::Odd, false)),
        ("exp(x)", all, [0.0; 3], (Parity::Neither, false)),
        (
            "abs(x)*if(x > 1, 1, -1)",
            all,
            [0.0; 3],
            (Parity::Neither, false),
        ),
        ("x y", [true, false, false], [0.0; 3], (Parity::Odd, true)),
        (
            "x^2 + y",
            [true, false, false],
            [0.0; 3],
            (Parity::Even, true),
        ),
        (
            "atan2(y, z) + y hypot(x, y)",
            [true, true, false],
            [0.0; 3],
            (Parity::Odd, true),
        ),
    ] {
        assert_eq!(parity(text, reflected, centre), expected, "{text}");
    }
}

#[test]
fn reflections_of_systems_are_found_and_checked() {
    let mut scope = scope();
    let parameters = [0.0, 1.5, 0.25];
    let mut all = |texts: &[&str]| -> Vec<Expression> {
        texts
            .iter()
            .map(|text| scope.formula(text).unwrap())
            .collect()
    };
    let dahl = all(&["y", "-b y - x^3 - d z", "y - b abs(y) z"]);
    let additive = vec![all(&["0", "d", "0"])];
    let tilted = all(&["y", "-b y - x^3 + d", "-z"]);
    let lorenz = all(&["10 (y - x)", "x (28 - z) - y", "x y - 8 z/3"]);
    let multiplicative = vec![all(&["0", "b x", "0"])];
    let mixed = vec![all(&["0", "d + x", "0"])];
    let graph = scope.graph_mut();
    let mut find = |drift: &[Expression], noise: &[Vec<Expression>]| {
        let found = graph
            .find_reflection(drift, noise, &[0.0; 3], &parameters)
            .unwrap();
        found.map(|(reflection, proven)| (reflection.reflected, proven))
    };
    assert_eq!(find(&dahl, &additive), Some((vec![true; 3], true)));
    assert_eq!(find(&lorenz, &[]), Some((vec![true, true, false], true)));
    assert_eq!(find(&dahl, &multiplicative), Some((vec![true; 3], true)));
    assert_eq!(find(&dahl, &mixed), None);
    // Only z, which drives nothing, can be reflected.
    assert_eq!(
        find(&tilted, &additive),
        Some((vec![false, false, true], true))
    );
    let reflection = Reflection {
        centre: vec![0.0; 3],
        reflected: vec![true; 3],
    };
    let error = graph
        .check_reflection(&tilted, &additive, &reflection, &parameters)
        .unwrap_err();
    assert!(
        matches!(
            &error,
            ReflectionError::Drift {
                state: 1,
                at: Some(_),
                ..
            }
        ),
        "{error:?}"
    );
    let error = graph
        .check_reflection(&dahl, &mixed, &reflection, &parameters)
        .unwrap_err();
    assert!(matches!(
        error,
        ReflectionError::Noise {
            process: 0,
            at: Some(_)
        }
    ));
}
