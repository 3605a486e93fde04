//! Texts read back to the same expression; people see what they are used to.

use crate::formula::scope::{Scope, Symbols};

fn scope() -> Scope {
    let mut symbols = Symbols::of(&["x", "y"], &["c0", "c1", "omega", "alpha", "f_c", "D1"]);
    symbols.define("H", "y^2/2 + ω² x²/2").unwrap();
    symbols.define("k", "alpha").unwrap();
    Scope::new(symbols).unwrap()
}

#[test]
fn texts_read_back_to_the_same_expression() {
    for (formula, text) in [
        ("-(c0 + c1 x^2) y - ω² x", "-(c0 + c1*x^2)*y - omega^2*x"),
        ("x - (y - 1) + (x + y)", "x - (y - 1) + (x + y)"),
        ("x*(y*c0)/(c1/2)", "x*(y*c0)/(c1/2)"),
        ("(x^y)^c0^2", "(x^y)^(c0^2)"),
        ("(-x)^2 + (-x)^y", "x^2 + (-x)^y"),
        ("x^-2 + 2^x - (-2)^x", "x^(-2) + 2^x - (-2)^x"),
        ("-x/y*2", "-x/y*2"),
        ("(-3)*x + x*(-y)", "-3*x - x*y"),
        ("x - -3", "x + 3"),
        ("x + -3", "x - 3"),
        ("-0 x", "-0*x"),
        ("x x x", "x^3"),
        ("2 + 3 x/(1/3)", "2 + 3*x/(1/3)"),
        (
            "(x < y)*(x >= 1) + (x == y) + (x != 0)",
            "(x < y)*(1 <= x) + (x == y) + (x != 0)",
        ),
        ("(x < y) < 1", "(x < y) < 1"),
        (
            "if(x > 0, -y, min(x, y, 1))",
            "if(0 < x, -y, min(min(x, y), 1))",
        ),
        (
            "sqrt(2)*sgn(y) + cbrt(x) + step(x) floor(y)",
            "sqrt(2)*sign(y) + cbrt(x) + step(x)*floor(y)",
        ),
        (
            "hypot(x, y) atan2(y, x) pow(x, 1.5)",
            "hypot(x, y)*atan2(y, x)*x^1.5",
        ),
        ("1e-7 x + 1e20 + 0.1", "1e-7*x + 1e20 + 0.1"),
        ("H + t + π", "y^2/2 + omega^2*x^2/2 + t + 3.141592653589793"),
        ("1/0", "1/0"),
        ("abs(-x) + sin(-x) + cos(-x)", "abs(x) - sin(x) + cos(x)"),
    ] {
        let mut scope = scope();
        let expression = scope.formula(formula).unwrap();
        assert_eq!(scope.text(expression).unwrap(), text);
        assert_eq!(scope.formula(text).unwrap(), expression, "{text}");
    }
}

#[test]
fn people_see_greek_letters_powers_and_products() {
    for (formula, shown) in [
        ("-(c0 + c1 x^2) y - omega^2*x", "-(c₀ + c₁ x²) y - ω² x"),
        ("sqrt(2 D1)*x", "√(2 D₁) x"),
        ("-alpha*x - f_c*sign(y)", "-α x - f_c sign(y)"),
        ("2*3^x*0.5", "2·3^x·0.5"),
        ("x/y*c0", "(x/y) c₀"),
        ("x*(y*c0)/2", "x y c₀/2"),
        ("abs(x)^-1 + e^x + pi", "|x|⁻¹ + e^x + π"),
        ("H*y + k", "H y + α"),
        ("if(x >= 0, 1, 2)", "if(0 ≤ x, 1, 2)"),
        ("x/(2*pi)", "x/(2 π)"),
        ("(x + 1)^3*(x - 1)", "(x + 1)³ (x - 1)"),
    ] {
        let mut scope = scope();
        let expression = scope.formula(formula).unwrap();
        assert_eq!(scope.typeset(expression), shown);
    }
    let scope = scope();
    let energy = scope.definition("H").unwrap();
    assert_eq!(scope.typeset(energy), "y²/2 + ω² x²/2");
}

#[test]
fn texts_that_would_grow_without_end_are_cut() {
    let mut symbols = Symbols::default();
    symbols.add_state("x").unwrap();
    symbols.define("p0", "x + 1").unwrap();
    for n in 1..200 {
        symbols
            .define(&format!("p{n}"), &format!("p{} sin(p{}) + x", n - 1, n - 1))
            .unwrap();
    }
    let mut scope = Scope::new(symbols).unwrap();
    let large = scope.definition("p199").unwrap();
    assert!(scope.text(large).is_err());
    assert_eq!(scope.typeset(large), "p₁₉₈ sin(p₁₉₈) + x");
    let slope = scope
        .graph_mut()
        .derivative(large, crate::formula::graph::Symbol::State(0))
        .unwrap();
    let shown = scope.typeset(slope.value);
    assert!(shown.len() < crate::formula::limits::PRINTED_BYTES + 10);
}
