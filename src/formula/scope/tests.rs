//! Names, definitions, and what is said of wrong ones.

use super::*;
use crate::formula::graph::Point;
use crate::formula::language::Fault;

fn symbols(states: &[&str], parameters: &[&str], definitions: &[(&str, &str)]) -> Symbols {
    let mut symbols = Symbols::default();
    for name in states {
        symbols.add_state(name).unwrap();
    }
    for name in parameters {
        symbols.add_parameter(name).unwrap();
    }
    for (name, text) in definitions {
        symbols.define(name, text).unwrap();
    }
    symbols
}

fn errors(definitions: &[(&str, &str)]) -> Vec<String> {
    let errors = Scope::new(symbols(&["x", "y"], &["a"], definitions)).unwrap_err();
    errors.iter().map(ToString::to_string).collect()
}

#[test]
fn definitions_use_each_other_in_any_order() {
    let definitions = [
        ("H", "K + U"),
        ("U", "ω² x²/2"),
        ("ω", "sqrt(a)"),
        ("K", "y^2/2"),
    ];
    let mut scope = Scope::new(symbols(&["x", "y"], &["a"], &definitions)).unwrap();
    let energy = scope.formula("H + t").unwrap();
    let point = Point {
        states: &[3.0, 4.0],
        parameters: &[4.0],
        time: 0.5,
    };
    assert_eq!(scope.graph().evaluate(energy, &point), 8.0 + 18.0 + 0.5);
    assert_eq!(scope.definition("omega"), scope.formula("sqrt(a)").ok());
    let names: Vec<&str> = scope.definitions().map(|(name, _)| name).collect();
    assert_eq!(names, ["H", "U", "ω", "K"]);
    assert_eq!(scope.symbol("y"), Some(Symbol::State(1)));
    assert_eq!(scope.symbol("α"), None);
}

#[test]
fn circles_are_named() {
    assert_eq!(
        errors(&[("p", "q + 1"), ("q", "x r"), ("r", "p^2"), ("s", "p + x")]),
        ["definition `p`: it needs itself: p → q → r → p"]
    );
    assert_eq!(
        errors(&[("p", "x + p")]),
        ["definition `p`: it needs itself: p → p"]
    );
    let error = Scope::new(symbols(&["x"], &[], &[("p", "x + q"), ("q", "2 p")])).unwrap_err();
    assert_eq!(error[0].fault.span(), 4..5);
}

#[test]
fn every_definition_that_is_wrong_is_told_once() {
    assert_eq!(
        errors(&[("p", "x +"), ("q", "2 zz"), ("r", "p + q"), ("s", "a(x)")]),
        [
            "definition `p`: expected a number, a name or `(`, found the end",
            "definition `s`: `a` is not a function",
            "definition `q`: unknown symbol `zz`",
        ]
    );
}

#[test]
fn names_cannot_be_given_twice_or_away() {
    let mut symbols = symbols(&["x"], &["alpha", "c_0"], &[("H", "x")]);
    for (error, message) in [
        (symbols.add_parameter("x"), "`x` is already a state"),
        (
            symbols.add_state("α"),
            "`α` is already a parameter (spelled `alpha`)",
        ),
        (
            symbols.add_state("c₀"),
            "`c₀` is already a parameter (spelled `c_0`)",
        ),
        (symbols.add_parameter("H"), "`H` is already a definition"),
        (
            symbols.add_state("t"),
            "`t` is time and cannot name anything else",
        ),
        (
            symbols.add_state("sin"),
            "`sin` is a function and cannot name anything else",
        ),
        (
            symbols.add_state("sgn"),
            "`sgn` is a function and cannot name anything else",
        ),
        (
            symbols.add_state("if"),
            "`if` is a choice by comparison and cannot name anything else",
        ),
    ] {
        assert_eq!(error.unwrap_err().to_string(), message);
    }
    assert!(matches!(
        symbols.add_state("2x"),
        Err(SymbolError::Malformed { .. })
    ));
    assert!(matches!(
        symbols.add_state(&"x".repeat(65)),
        Err(SymbolError::Long { length: 65 })
    ));
    assert!(matches!(
        symbols.add_state("x\0"),
        Err(SymbolError::Malformed { .. })
    ));
}

#[test]
fn constants_may_be_named_anew() {
    let point = Point {
        states: &[7.0],
        parameters: &[],
        time: 0.0,
    };
    let value = |symbols: Symbols, text: &str| {
        let mut scope = Scope::new(symbols).unwrap();
        let formula = scope.formula(text).unwrap();
        scope.graph().evaluate(formula, &point)
    };
    assert_eq!(
        value(symbols(&["x"], &[], &[]), "π + e"),
        std::f64::consts::PI + std::f64::consts::E
    );
    assert_eq!(value(symbols(&["e"], &[], &[]), "2 e"), 14.0);
    assert_eq!(value(symbols(&["x"], &[], &[("pi", "3")]), "pi x"), 21.0);
}

#[test]
fn unknown_names_come_with_what_is_near() {
    let mut scope = Scope::new(symbols(&["x", "y"], &["kappa", "c1", "f_c"], &[])).unwrap();
    for (text, at, remedy) in [
        ("2 kapa", "kapa", "did you mean `kappa`?"),
        ("c1x^2", "c1x", "did you mean the product `c1 x`?"),
        ("κy", "κy", "did you mean the product `kappa y`?"),
        ("X + y", "X", "did you mean `x`?"),
        ("sine(x)", "sine", "did you mean `sin`?"),
        ("H(x)", "H", "write `step(x)` for the unit step"),
        ("arctan(x)", "arctan", "write `atan(x)`"),
        (
            "f_c(x)",
            "f_c",
            "write `f_c (…)` or `f_c*(…)` for a product",
        ),
    ] {
        let error = scope.formula(text).unwrap_err();
        assert_eq!(&text[error.span.clone()], at);
        assert_eq!(error.remedy().as_deref(), Some(remedy), "{text}");
    }
    let error = scope.formula("qqqq").unwrap_err();
    assert_eq!(error.remedy(), None);
    let known = "states x, y; parameters kappa, c1, f_c; time t; constants pi, e";
    assert_eq!(error.allowed().as_deref(), Some(known));
    assert!(matches!(error.fault, Fault::Symbol { .. }));
}
