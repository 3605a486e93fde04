//! Dependence, kinks, and what noise does to the drift, on formulas with known answers.

mod hazards;
mod symmetry;

use super::*;
use crate::formula::graph::{Expression, Point, Symbol};
use crate::formula::scope::{Scope, Symbols};

fn scope() -> Scope {
    Scope::new(Symbols::of(&["x", "y", "z"], &["a", "b", "d"])).unwrap()
}

fn formula(scope: &mut Scope, text: &str) -> Expression {
    scope
        .formula(text)
        .unwrap_or_else(|error| panic!("{}", error.drawn(text)))
}

fn written(scope: &Scope, expression: Expression) -> String {
    scope.text(expression).unwrap()
}

#[test]
fn dependence_lists_the_symbols() {
    let mut scope = scope();
    let expression = formula(&mut scope, "b z + a x sin(t)");
    let found = scope.graph().dependence(expression);
    assert_eq!(
        (found.states, found.parameters, found.time),
        (vec![0, 2], vec![0, 1], true)
    );
    let constant = formula(&mut scope, "2 + sqrt(3)");
    assert_eq!(scope.graph().dependence(constant), Default::default());
}

#[test]
fn straight_lines_in_a_parameter_are_found() {
    for (text, expected) in [
        ("a x + y", Some(("y", "x"))),
        ("-(a - x)/y", Some(("x/y", "-1/y"))),
        (
            "if(x > 0, a, 2 a + 1)",
            Some(("if(0 < x, 0, 1)", "if(0 < x, 1, 2)")),
        ),
        ("x^2 + b", Some(("x^2 + b", "0"))),
        ("a^2 x", None),
        ("x/a", None),
        ("abs(a)", None),
        ("sin(a x)", None),
    ] {
        let mut scope = scope();
        let expression = formula(&mut scope, text);
        let affine = scope
            .graph_mut()
            .affine(expression, Symbol::Parameter(0))
            .unwrap();
        let found =
            affine.map(|line| (written(&scope, line.constant), written(&scope, line.slope)));
        let expected = expected.map(|(constant, slope)| (constant.to_owned(), slope.to_owned()));
        assert_eq!(found, expected, "{text}");
    }
}

/// Kinks as `kind argument: place`.
fn kinks(text: &str) -> Vec<String> {
    let mut scope = scope();
    let expression = formula(&mut scope, text);
    let found = scope.graph_mut().kinks(expression).unwrap();
    let word = |kink: &Kink| {
        let place = match &kink.place {
            KinkPlace::Surfaces(surfaces) => {
                let surface = |surface: &Surface| {
                    let state = &scope.symbols().states()[surface.state];
                    format!("{state} = {}", written(&scope, surface.at))
                };
                surfaces.iter().map(surface).collect::<Vec<_>>().join(", ")
            }
            other => format!("{other:?}"),
        };
        format!(
            "{:?} {}: {place}",
            kink.kind,
            written(&scope, kink.argument)
        )
    };
    found.iter().map(word).collect()
}

#[test]
fn kinks_are_found_with_their_surfaces() {
    for (text, expected) in [
        ("a x + sin(y)", vec![]),
        ("-y - d sign(y)", vec!["Jump y: y = 0"]),
        ("sign(-y) + abs(y)", vec!["Jump y: y = 0"]),
        ("abs(x - d)", vec!["Corner x - d: x = d"]),
        ("step(2 x - 1)", vec!["Jump 2*x - 1: x = 0.5"]),
        (
            "max(x, a) + min(y, 3)",
            vec!["Corner x - a: x = a", "Corner y - 3: y = 3"],
        ),
        ("if(x >= d, 1, 0)", vec!["Jump d - x: x = d"]),
        ("if(x < d, 1, 0) + (x > d)", vec!["Jump x - d: x = d"]),
        // A dead zone: |x| = d.
        (
            "max(abs(x) - d, 0)",
            vec!["Corner x: x = 0", "Corner abs(x) - d: x = -d, x = d"],
        ),
        (
            "sign(x^2 - d)",
            vec!["Jump x^2 - d: x = -sqrt(d), x = sqrt(d)"],
        ),
        ("abs(x (y - a)/b)", vec!["Corner x*(y - a)/b: Oblique"]),
        ("abs(x (x - a)/b)", vec!["Corner x*(x - a)/b: x = 0, x = a"]),
        ("sign(x - y)", vec!["Jump x - y: Oblique"]),
        ("sign(x - cos(t))", vec!["Jump x - cos(t): Moving"]),
        ("sign(exp(x) - 2)", vec!["Jump exp(x) - 2: Unsolved"]),
        ("floor(x)", vec!["Steps x: Everywhere"]),
        ("sign(a) x + abs(b)", vec![]),
    ] {
        assert_eq!(kinks(text), expected, "{text}");
    }
}

#[test]
fn stratonovich_noise_moves_the_drift() {
    let mut scope = scope();
    let [zero, drift, b_x, other] =
        ["0", "-y", "b x", "sqrt(2 d) y"].map(|text| scope.formula(text).unwrap());
    let y = scope.formula("y").unwrap();
    // b x on y only: its derivative by y is zero, nothing moves.
    let noise = [vec![zero, b_x]];
    let (corrected, jumps) = scope.graph_mut().ito_drift(&[y, drift], &noise).unwrap();
    assert_eq!((corrected, jumps), (vec![y, drift], vec![]));
    // sqrt(2 d) y on y: ½ b ∂b/∂y = d y. One process on both axes: ½ (b_x ∂/∂x + b_y ∂/∂y) b_i.
    let noise = [vec![b_x, other]];
    let (corrected, _) = scope.graph_mut().ito_drift(&[y, drift], &noise).unwrap();
    let values = |scope: &Scope, expression| {
        let point = Point {
            states: &[2.0, 3.0],
            parameters: &[0.0, 1.5, 0.25],
            time: 0.0,
        };
        scope.graph().evaluate(expression, &point)
    };
    assert!((values(&scope, corrected[0]) - (3.0 + 0.5 * 1.5 * 1.5 * 2.0)).abs() < 1e-14);
    assert!((values(&scope, corrected[1]) - (-3.0 + 0.25 * 3.0)).abs() < 1e-14);
    let jumping = scope.formula("sign(y)").unwrap();
    let (_, jumps) = scope
        .graph_mut()
        .ito_drift(&[y, drift], &[vec![zero, jumping]])
        .unwrap();
    assert_eq!(jumps, [y]);
}
