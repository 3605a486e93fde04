//! Simplification, derivatives, substitution, and the bound on size.

use super::*;
use crate::formula::scope::{Scope, Symbols};

fn scope() -> Scope {
    Scope::new(Symbols::of(&["x", "y"], &["a", "b"])).unwrap()
}

fn assert_same(left: &str, right: &str) {
    let mut scope = scope();
    let [first, second] = [left, right].map(|text| scope.formula(text).unwrap());
    assert_eq!(
        first,
        second,
        "{left} is {}, {right} is {}",
        text(&scope, first),
        text(&scope, second)
    );
}

fn assert_different(left: &str, right: &str) {
    let mut scope = scope();
    let [first, second] = [left, right].map(|text| scope.formula(text).unwrap());
    assert_ne!(first, second, "{left} and {right}");
}

fn text(scope: &Scope, expression: Expression) -> String {
    scope.text(expression).unwrap()
}

#[test]
fn what_is_the_same_to_the_last_bit_is_one_expression() {
    for (left, right) in [
        ("x + y", "y + x"),
        ("x*y", "y*x"),
        ("-(-x)", "x"),
        ("(-x)*y", "-(x*y)"),
        ("x*(-2)", "-(2*x)"),
        ("x/(-y)", "-(x/y)"),
        ("x - (-y)", "x + y"),
        ("x + (-2)*y", "x - 2*y"),
        ("1*x", "x"),
        ("x/1", "x"),
        ("x - 0", "x"),
        ("x^1", "x"),
        ("x*x", "x^2"),
        ("x*x*x", "x^3"),
        ("x x^2", "x^3"),
        ("(-x)^2", "x^2"),
        ("(-x)^3", "-(x^3)"),
        ("abs(-x)", "abs(x)"),
        ("abs(abs(x))", "abs(x)"),
        ("sin(-x)", "-sin(x)"),
        ("2 + 3*4", "14"),
        ("1/2", "0.5"),
        ("sqrt(16) + 2^10", "1028"),
        ("sin(0) + cos(0) + exp(0)", "2"),
        ("if(2 > 1, x, y)", "x"),
        ("if(x < y, a, a)", "a"),
        ("min(x, x)", "x"),
        ("x > y", "y < x"),
        ("σ".replace('σ', "x²").as_str(), "x^2"),
    ] {
        assert_same(left, right);
    }
}

#[test]
fn what_differs_in_a_bit_somewhere_stays_different() {
    for (left, right) in [
        ("x + 0", "x"),
        ("0*x", "0"),
        ("x - x", "0"),
        ("x/x", "1"),
        ("x*(y*a)", "(x*y)*a"),
        ("x + (y + a)", "(x + y) + a"),
        ("x*(y + a)", "x*y + x*a"),
        ("-(x - y)", "y - x"),
        ("x^2 x^2", "x^5"),
        ("sqrt(x^2)", "abs(x)"),
        ("min(x, y)", "min(y, x)"),
        ("if(x, a, a)", "a"),
        ("1/3", "0.333333333333333"),
        ("0.1 + 0.2", "0.3"),
    ] {
        assert_different(left, right);
    }
}

#[test]
fn numbers_are_folded_only_where_the_result_is_exact() {
    let mut scope = scope();
    for (formula, printed) in [
        ("0.1 + 0.2", "0.1 + 0.2"),
        ("0.5*4", "2"),
        ("1/3", "1/3"),
        ("sqrt(2)", "sqrt(2)"),
        ("1/0", "1/0"),
        ("log(-1)", "log(-1)"),
        ("2^64", "2^64"),
        ("10^-2", "10^(-2)"),
        ("-(0)", "-0"),
        ("3 < 4", "1"),
        ("step(0)", "0.5"),
        ("1e300*1e300", "1e300^2"),
        ("2 pi", "2*3.141592653589793"),
        ("-pi", "-3.141592653589793"),
    ] {
        let expression = scope.formula(formula).unwrap();
        assert_eq!(text(&scope, expression), printed);
    }
}

#[test]
fn derivatives_are_those_of_the_book() {
    for (formula, by, expected) in [
        ("a x^2 + b x + y", "x", "a*(2*x) + b"),
        ("x^3", "x", "3*x^2"),
        ("x^a", "x", "a*x^(a - 1)"),
        ("a^x", "x", "a^x*log(a)"),
        ("sin(2 x)", "x", "cos(2*x)*2"),
        ("exp(-x^2)", "x", "-exp(-x^2)*(2*x)"),
        ("x/y", "x", "1/y"),
        ("x/y", "y", "-x/y/y"),
        ("sqrt(x)", "x", "1/(2*sqrt(x))"),
        ("log(a x)", "a", "x/(a*x)"),
        ("abs(x) y", "x", "sign(x)*y"),
        ("min(x, y)", "x", "if(x < y, 1, 0)"),
        ("max(x, y)", "x", "if(y < x, 1, 0)"),
        ("if(y > 0, x^2, x)", "x", "if(0 < y, 2*x, 1)"),
        ("tanh(x)", "x", "1 - tanh(x)^2"),
        ("a + b", "x", "0"),
        ("t x", "t", "x"),
        ("atan2(y, x)", "x", "-y/(y^2 + x^2)"),
    ] {
        let mut scope = scope();
        let expression = scope.formula(formula).unwrap();
        let by = scope.symbol(by).unwrap();
        let derivative = scope.graph_mut().derivative(expression, by).unwrap();
        assert_eq!(text(&scope, derivative.value), expected, "d({formula})");
        assert_eq!(derivative.jumps, []);
    }
}

#[test]
fn derivatives_say_where_they_do_not_hold() {
    for (formula, value, jumps) in [
        ("a sign(x - b) + x", "1", vec!["x - b"]),
        ("step(2 x) + floor(y)", "0", vec!["2*x"]),
        ("if(x < a, x, y)", "if(x < a, 1, 0)", vec!["x - a"]),
        ("if(x - a, x, y)", "if(x - a, 1, 0)", vec!["x - a"]),
        ("(x > 0)*(x > 0)", "0", vec!["-x"]),
        ("sign(y) x", "sign(y)", vec![]),
    ] {
        let mut scope = scope();
        let expression = scope.formula(formula).unwrap();
        let derivative = scope
            .graph_mut()
            .derivative(expression, Symbol::State(0))
            .unwrap();
        assert_eq!(text(&scope, derivative.value), value, "d({formula})");
        let found: Vec<String> = derivative
            .jumps
            .iter()
            .map(|&jump| text(&scope, jump))
            .collect();
        assert_eq!(found, jumps, "d({formula})");
    }
}

#[test]
fn parameters_are_bound() {
    let mut scope = scope();
    let expression = scope.formula("a x + b y^2").unwrap();
    let bound = scope.graph_mut().bound(expression, &[2.0, 0.0]).unwrap();
    assert_eq!(text(&scope, bound), "2*x");
    let graph = scope.graph();
    assert!(graph.contains(expression, Symbol::Parameter(1)));
    assert!(!graph.contains(bound, Symbol::Parameter(0)));
    assert!(!graph.contains(bound, Symbol::State(1)));
    assert!(!graph.contains(expression, Symbol::Time));
}

#[test]
fn a_graph_that_is_full_is_left_as_it_was() {
    let mut scope = scope();
    let x = scope.formula("x").unwrap();
    let before = scope.graph().len();
    let chain = |builder: &mut Builder<'_>| {
        let mut sum = x;
        for n in 0..=crate::formula::limits::NODES {
            let number = builder.constant(n as f64 + 0.5);
            sum = builder.add(sum, number);
        }
        sum
    };
    assert_eq!(scope.graph_mut().build(chain), Err(TooLarge));
    assert_eq!(scope.graph().len(), before);
    assert!(scope.formula("sin(x) + 1.5").is_ok());
    // Twice the derivative of a deep chain of products stays small, for common parts are shared.
    let product = (0..500).map(|n| format!("(x + {n})")).collect::<String>();
    let product = scope.formula(&product).unwrap();
    let first = scope
        .graph_mut()
        .derivative(product, Symbol::State(0))
        .unwrap()
        .value;
    let second = scope
        .graph_mut()
        .derivative(first, Symbol::State(0))
        .unwrap()
        .value;
    assert!(scope.graph().parts(&[second]).len() < 10_000);
}
