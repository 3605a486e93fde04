//! A tape gives the bits of evaluation at a point, in every lane, on every instruction set.

use super::*;
use crate::formula::graph::{Expression, Point};
use crate::formula::scope::{Scope, Symbols};
use crate::formula::{LANES, Lanes};

const PARAMETERS: [(&str, f64); 5] = [
    ("a", 1.3),
    ("b", -0.7),
    ("c", 0.01),
    ("zero", 0.0),
    ("two", 2.0),
];

fn scope() -> Scope {
    Scope::new(Symbols::of(
        &["x", "y", "z"],
        &PARAMETERS.map(|(name, _)| name),
    ))
    .unwrap()
}

fn values() -> Vec<f64> {
    PARAMETERS.iter().map(|(_, value)| *value).collect()
}

/// Different numbers in every lane, special ones among them.
fn states() -> [Lanes; 3] {
    let special = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::INFINITY,
        -f64::INFINITY,
        f64::NAN,
        1e300,
        1e-310,
        5e6,
    ];
    std::array::from_fn(|axis| {
        std::array::from_fn(|lane| match special.get((lane + 3 * axis) % 20) {
            Some(&value) => value,
            None => 2.5 * f64::sin(1.7 * (lane * (axis + 1)) as f64 + axis as f64),
        })
    })
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn assert_bits(texts: &[&str]) {
    let mut scope = scope();
    let formulas: Vec<Expression> = texts
        .iter()
        .map(|text| scope.formula(text).unwrap())
        .collect();
    let tape = scope.compile(&formulas).bind_as_written(&values()).unwrap();
    let (states, parameters) = (states(), values());
    let mut outputs = vec![[7.0; LANES]; texts.len()];
    tape.run(0.3, &states, &mut outputs);
    for lane in 0..LANES {
        let state: Vec<f64> = states.iter().map(|axis| axis[lane]).collect();
        let point = Point {
            states: &state,
            parameters: &parameters,
            time: 0.3,
        };
        for ((formula, text), output) in formulas.iter().zip(texts).zip(&outputs) {
            let expected = scope.graph().evaluate(*formula, &point);
            assert!(
                same(output[lane], expected),
                "{text} at {state:?}: {} {expected}",
                output[lane]
            );
        }
    }
}

#[test]
fn every_operation_has_the_bits_of_evaluation() {
    for text in [
        "-x",
        "abs(x)",
        "sign(x)",
        "step(x)",
        "floor(x)",
        "sqrt(x)",
        "cbrt(x)",
        "exp(x)",
        "log(x)",
        "log10(x)",
        "sin(x)",
        "cos(x)",
        "tan(x)",
        "asin(x)",
        "acos(x)",
        "atan(x)",
        "sinh(x)",
        "cosh(x)",
        "tanh(x)",
        "x + y",
        "x - y",
        "x*y",
        "x/y",
        "x^y",
        "min(x, y)",
        "max(x, y)",
        "hypot(x, y)",
        "atan2(x, y)",
        "x < y",
        "x <= y",
        "x == y",
        "x != y",
        "if(x, y, z)",
        "if(x < y, 1, z)",
        "if(x < y, z, 2)",
        "if(x < y, 1, 2)",
        "if(t, x, y)",
        "x + 2",
        "2 - x",
        "2/x",
        "x/2",
        "x/3",
        "x/a",
        "min(x, a)",
        "max(a, x)",
        "x < a",
        "a <= x",
        "x^a",
        "a^x",
        "x^2",
        "x^3",
        "x^7",
        "x^-1",
        "x^-4",
        "x^0.5",
        "x^two",
        "x^(-two)",
        "x^a",
        "x^1.5",
        "x^64",
        "x^65",
    ] {
        assert_bits(&[text]);
    }
}

#[test]
fn every_fused_instruction_has_the_bits_of_evaluation() {
    for factor in ["x", "x^2", "sign(x)", "abs(x)"] {
        for other in ["y", "a"] {
            let product = format!("{factor}*{other}");
            assert_bits(&[&product]);
            for addend in [
                "z", "b", "z*a", "z*y", "abs(z)*y", "-z", "-(z*y)", "(-z^2)*b",
            ] {
                for sum in ["P + Q", "P - Q", "Q - P", "-P - Q", "-P + Q", "-(P + Q)"] {
                    let text = sum
                        .replace('P', &format!("({product})"))
                        .replace('Q', &format!("({addend})"));
                    assert_bits(&[&text]);
                }
            }
        }
    }
}

#[test]
fn outputs_share_parts_repeat_and_may_be_constant() {
    assert_bits(&[
        "y",
        "-a y - x (b + c x^2) - two*sign(y)",
        "x^2 + y^2",
        "sqrt(x^2 + y^2)",
        "x^2 + y^2",
        "3",
        "a b",
        "x",
        "cos(two t)",
        "x cos(two t) + t",
        "1/(x^2 + y^2 + a)",
    ]);
    let mut scope = scope();
    let formulas =
        ["a + 2", "x", "t", "a t^2", "sqrt(-1)"].map(|text| scope.formula(text).unwrap());
    let tape = scope.compile(&formulas).bind(&values()).unwrap();
    assert_eq!(tape.constant(0), Some(3.3));
    assert_eq!([1, 2, 3, 9].map(|output| tape.constant(output)), [None; 4]);
    assert!(tape.constant(4).unwrap().is_nan());
    assert_eq!(tape.at(2.0, &[5.0, 0.0, 0.0])[..4], [3.3, 5.0, 2.0, 5.2]);
}

#[test]
fn polynomials_in_nested_form_agree_to_rounding_and_keep_their_parity() {
    for (text, instructions) in [
        ("a + b x + c x^2 + two x^3", 1),
        ("1 - 2 x^2 + 3 x^4", 2),
        ("a x - b x^3 + c x^5", 3),
        ("-(a + b x^2 + c x^4 + two x^6) y - two^2 x", 3),
        ("(x - y)^3 + 2 (x - y)^2 + 5", 2),
        ("cos(t) + x sin(t) + x^2 t", 1),
    ] {
        let mut scope = scope();
        let formula = [scope.formula(text).unwrap()];
        let program = scope.compile(&formula);
        let nested = program.bind(&values()).unwrap();
        let written = program.bind_as_written(&values()).unwrap();
        assert_eq!(nested.instructions(), instructions, "{text}");
        assert!(nested.instructions() <= written.instructions(), "{text}");
        for lane in 0..LANES {
            let [x, y] = [0, 1].map(|k| 1.9 * f64::sin((3 * lane + k) as f64));
            let (left, right) = (
                nested.at(0.4, &[x, y, 0.0])[0],
                written.at(0.4, &[x, y, 0.0])[0],
            );
            // Terms are at most about 200; a rounding is half a unit of 2e-16 of them.
            assert!((left - right).abs() < 1e-13, "{text}: {left} {right}");
        }
    }
    let mut scope = scope();
    let formulas =
        ["a - b x^2 + c x^4", "a x - b x^3 + c x^5"].map(|text| scope.formula(text).unwrap());
    let tape = scope.compile(&formulas).bind(&values()).unwrap();
    for x in [0.3, 1.7, 12.9] {
        let (left, right) = (tape.at(0.0, &[-x, 0.0, 0.0]), tape.at(0.0, &[x, 0.0, 0.0]));
        assert_eq!([left[0], left[1]], [right[0], -right[1]]);
    }
}

#[test]
fn a_tape_keeps_few_results_and_common_parts_are_worked_out_once() {
    let mut scope = scope();
    let sum = (1..200)
        .map(|n| format!("sin({n} x)*cos({n} y)"))
        .collect::<Vec<_>>()
        .join(" + ");
    let balanced = scope.formula(&sum).unwrap();
    let tape = scope.compile(&[balanced]).bind(&values()).unwrap();
    assert!(tape.registers() <= 5, "{}", tape.registers());
    let formulas =
        ["exp(x) + y", "exp(x) - y", "exp(x)*y"].map(|text| scope.formula(text).unwrap());
    assert_eq!(
        scope
            .compile(&formulas)
            .bind(&values())
            .unwrap()
            .instructions(),
        4
    );
}

#[test]
fn wrong_sizes_are_told_or_give_nan() {
    let mut scope = scope();
    let formulas = ["x + y", "z"].map(|text| scope.formula(text).unwrap());
    let program = scope.compile(&formulas);
    let counts = BindError::Count {
        given: 1,
        wanted: 5,
    };
    assert_eq!(program.bind(&[1.0]).unwrap_err(), counts);
    let tape = program.bind(&values()).unwrap();
    let mut outputs = [[1.0; LANES]; 2];
    tape.run(0.0, &states()[..2], &mut outputs);
    assert!(outputs.iter().flatten().all(|value| value.is_nan()));
    let mut outputs = [[1.0; LANES]; 1];
    tape.run(0.0, &states(), &mut outputs);
    assert!(outputs.iter().flatten().all(|value| value.is_nan()));
    // More room than needed is left alone.
    let mut outputs = [[1.0; LANES]; 3];
    tape.run(0.0, &states(), &mut outputs);
    assert_eq!(outputs[2], [1.0; LANES]);
}

#[test]
fn many_threads_may_run_one_tape() {
    fn assert_shared<T: Send + Sync>() {}
    assert_shared::<(Tape, Program, Scope)>();
    let mut scope = scope();
    let formula = [scope.formula("exp(x) sin(y) + z^3/(1 + x^2)").unwrap()];
    let tape = scope.compile(&formula).bind(&values()).unwrap();
    let expected = tape.at(0.0, &[0.5, 0.25, 2.0]);
    std::thread::scope(|threads| {
        for _ in 0..4 {
            threads.spawn(|| {
                for _ in 0..1000 {
                    assert_eq!(tape.at(0.0, &[0.5, 0.25, 2.0]), expected);
                }
            });
        }
    });
}
