//! Where formulas are not numbers, and the ranges of their values.

use super::{formula, scope};
use crate::formula::analysis::{Domain, HazardKind, Interval};
use crate::formula::graph::Point;

fn box_of(half: f64) -> Domain {
    Domain {
        states: vec![Interval::new(-half, half); 3],
        parameters: vec![
            Interval::point(0.0),
            Interval::point(1.5),
            Interval::point(0.25),
        ],
        time: Interval::new(0.0, 10.0),
    }
}

#[test]
fn hazards_are_found_with_a_state_and_safe_formulas_pass() {
    use HazardKind::{DivisionByZero, Inverse, Logarithm, Overflow, Pole, Power, Root};
    for (text, expected) in [
        ("1/(x^2 + y^2 + d)", vec![]),
        ("1/(x - 0.3)", vec![(DivisionByZero, true)]),
        ("y/(x + y z)", vec![(DivisionByZero, true)]),
        ("1/x^2", vec![(DivisionByZero, true)]),
        ("1/(x - 0.3)^2", vec![(DivisionByZero, true)]),
        ("1/sqrt(abs(x - 0.3)^3)", vec![(DivisionByZero, true)]),
        (
            "1/((x - 0.3)^2 + (y - 0.1)^2)",
            vec![(DivisionByZero, false)],
        ),
        ("y/a", vec![(DivisionByZero, true)]),
        // The dependence of x² and x on each other is only seen in small boxes.
        ("1/(x^2 - x + 0.3)", vec![]),
        ("log(x + 5)", vec![]),
        ("log(x)", vec![(Logarithm, true)]),
        ("if(x > 0, log(x), 0) y", vec![]),
        ("if(x > 0, 1, log(x))", vec![(Logarithm, true)]),
        ("if(b > 1, x, log(x))", vec![]),
        ("sqrt(x^2)", vec![]),
        ("sqrt(d + x)", vec![(Root, true)]),
        ("x^1.5", vec![(Power, true)]),
        ("x^3 + abs(x)^1.5", vec![]),
        ("x^-1", vec![(Power, true)]),
        ("asin(tanh(x))", vec![]),
        ("asin(x)", vec![(Inverse, true)]),
        ("tan(x/2)", vec![]),
        ("tan(x) + y", vec![(Pole, true)]),
        ("exp(exp(x))", vec![]),
        ("exp(exp(5 x))", vec![(Overflow, true)]),
        ("sin(t) + sign(x)/(1 + abs(x))", vec![]),
        // Its operand is told, not itself.
        ("sqrt(log(x))", vec![(Logarithm, true)]),
    ] {
        let mut scope = scope();
        let expression = formula(&mut scope, text);
        let found = scope.graph().hazards(expression, &box_of(2.0));
        let kinds: Vec<(HazardKind, bool)> = found
            .iter()
            .map(|hazard| (hazard.kind, hazard.certain))
            .collect();
        assert_eq!(kinds, expected, "{text}: {found:?}");
        for hazard in found {
            let point = Point {
                states: &hazard.state,
                parameters: &hazard.parameters,
                time: hazard.time,
            };
            let value = scope.graph().evaluate(hazard.part, &point);
            assert!(
                !value.is_finite() || value.abs() > 1e5,
                "{text}: {value} at {:?}",
                hazard.state
            );
        }
    }
}

#[test]
fn ranges_contain_all_values() {
    let mut random = 1_u64;
    let mut unit = || {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    for text in [
        "x^2 - x y + z^3",
        "sin(x) cos(3 y) - tanh(z)",
        "exp(-x^2) + abs(y)^1.5",
        "hypot(x, y) - atan2(y, x)",
        "min(x, y) max(y, z)",
        "if(x < y, x^2, -z)",
        "floor(3 x) + step(y) - sign(z)",
        "cosh(x) - sinh(y) + cbrt(z)",
        "(x + 3)^y",
        "sqrt(x + 2) log(y + 3)/(z + 4)",
        "acos(x/3) + asin(y/3) + tan(z/3)",
        "x^-2 y^4 + (x <= y)",
        "sin(50 x)",
    ] {
        let mut scope = scope();
        let expression = formula(&mut scope, text);
        for _ in 0..100 {
            let states: Vec<Interval> = (0..3)
                .map(|_| {
                    let (middle, half) = (3.0 * unit() - 1.5, 0.5 * unit() * unit());
                    Interval::new(middle - half, middle + half)
                })
                .collect();
            let domain = Domain {
                states,
                ..box_of(2.0)
            };
            let range = scope.graph().range(expression, &domain);
            for _ in 0..20 {
                let state: Vec<f64> = domain
                    .states
                    .iter()
                    .map(|x| x.low + unit() * x.width())
                    .collect();
                let point = Point {
                    states: &state,
                    parameters: &[],
                    time: 0.0,
                };
                let value = scope.graph().evaluate(expression, &point);
                assert!(
                    range.contains(value) || value.is_nan(),
                    "{text}: {value} not in {range:?}"
                );
            }
        }
    }
}
