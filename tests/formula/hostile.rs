//! What nobody writes in good faith: everything ends quickly with a value or a message, on a small stack.

use pbif::formula::LANES;
use pbif::formula::analysis::{Domain, Interval};
use pbif::formula::graph::{Point, Symbol};
use pbif::formula::language::Fault;
use pbif::formula::limits;
use pbif::formula::scope::{DefinitionFault, Scope, SymbolError, Symbols};

/// Runs on a stack of 256 KB, far less than a thread has: nothing recurses over what a file says.
fn on_a_small_stack(run: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new()
        .stack_size(256 * 1024)
        .spawn(run)
        .unwrap();
    thread.join().unwrap();
}

fn scope() -> Scope {
    let mut symbols = Symbols::default();
    symbols.add_state("x").unwrap();
    symbols.add_parameter("a").unwrap();
    Scope::new(symbols).unwrap()
}

fn fault(text: &str) -> Fault {
    scope().formula(text).unwrap_err().fault
}

#[test]
fn a_megabyte_is_refused_whatever_it_says() {
    on_a_small_stack(|| {
        for text in ["x", "(", "x+", "1", "^", "\0", "sin(", "é", " "] {
            let text = text.repeat((1 << 20) / text.len());
            assert!(matches!(fault(&text), Fault::TooLong { .. }));
        }
    });
}

#[test]
fn depth_is_refused_and_length_is_not() {
    on_a_small_stack(|| {
        let deep = [
            format!("{}x{}", "(".repeat(30_000), ")".repeat(30_000)),
            format!("x{}", "^x".repeat(30_000)),
            format!("{}x", "-".repeat(60_000)),
            format!("2^{}x", "-".repeat(60_000)),
            format!("{}x{}", "abs(".repeat(10_000), ")".repeat(10_000)),
            "(".repeat(60_000),
        ];
        for text in deep {
            assert_eq!(fault(&text), Fault::TooDeep);
        }
        let hundred_thousand = format!("{}x{}", "(".repeat(100_000), ")".repeat(100_000));
        assert!(matches!(fault(&hundred_thousand), Fault::TooLong { .. }));
        assert_eq!(
            fault(&"(".repeat(limits::NESTING)),
            Fault::Operand {
                found: "the end".to_owned()
            }
        );
        let mut scope = scope();
        for piece in [
            "+sin(x)",
            "*x",
            " x",
            "-x",
            "/a",
            "+x^2",
            "<x",
            "+abs(x+x)",
            "+1/x",
        ] {
            let text = format!("x{}", piece.repeat(60_000 / piece.len()));
            match scope.formula(&text) {
                Ok(expression) => {
                    let tape = scope.compile(&[expression]).bind(&[1.0]).unwrap();
                    let mut values = [[0.0; LANES]];
                    tape.run(0.0, &[[1.0; LANES]], &mut values);
                    let point = Point {
                        states: &[1.0],
                        parameters: &[1.0],
                        time: 0.0,
                    };
                    let value = scope.graph().evaluate(expression, &point);
                    assert!(
                        (values[0][7] - value).abs() <= 1e-12 * value.abs(),
                        "{piece}"
                    );
                    let _ = (scope.text(expression), scope.typeset(expression));
                    let _ = scope.graph_mut().derivative(expression, Symbol::State(0));
                    assert!(scope.graph_mut().kinks(expression).is_ok());
                    let interval = Interval::new(-1.0, 2.0);
                    let (states, parameters) = (vec![interval], vec![Interval::point(1.0)]);
                    let domain = Domain {
                        states,
                        parameters,
                        time: interval,
                    };
                    let _ = scope.graph().hazards(expression, &domain);
                }
                Err(error) => assert!(
                    matches!(error.fault, Fault::Chained | Fault::TooLarge),
                    "{error}"
                ),
            }
        }
    });
}

#[test]
fn definitions_that_would_explode_stay_small() {
    on_a_small_stack(|| {
        let mut symbols = Symbols::default();
        symbols.add_state("x").unwrap();
        symbols.define("p0", "x/3").unwrap();
        for n in 1..limits::DEFINITIONS {
            let formula = format!("sin(p{} p{} + p{})", n - 1, n - 1, n / 2);
            symbols.define(&format!("p{n}"), &formula).unwrap();
        }
        assert!(matches!(
            symbols.define("last", "x"),
            Err(SymbolError::TooMany { .. })
        ));
        let mut scope = Scope::new(symbols).unwrap();
        let last = scope.definition("p1023").unwrap();
        assert!(scope.graph().len() < 4 * limits::DEFINITIONS);
        assert!(scope.text(last).is_err());
        let slope = scope
            .graph_mut()
            .derivative(last, Symbol::State(0))
            .unwrap()
            .value;
        let tape = scope.compile(&[last, slope]).bind(&[]).unwrap();
        assert!(tape.at(0.0, &[0.5]).iter().all(|value| value.is_finite()));
        // Derivatives of derivatives grow, and are refused before the memory is full.
        let (mut next, mut count) = (slope, 1);
        while let Ok(derivative) = scope.graph_mut().derivative(next, Symbol::State(0)) {
            (next, count) = (derivative.value, count + 1);
            assert!(scope.graph().len() <= limits::NODES && count < 100);
        }
    });
}

#[test]
fn chains_and_circles_of_definitions_need_no_stack() {
    on_a_small_stack(|| {
        let chain = |last: &str| {
            let mut symbols = Symbols::default();
            symbols.add_state("x").unwrap();
            for n in 0..limits::DEFINITIONS - 1 {
                symbols
                    .define(&format!("p{n}"), &format!("p{} + 1", n + 1))
                    .unwrap();
            }
            symbols
                .define(&format!("p{}", limits::DEFINITIONS - 1), last)
                .unwrap();
            Scope::new(symbols)
        };
        let scope = chain("x").unwrap();
        let point = Point {
            states: &[0.0],
            parameters: &[],
            time: 0.0,
        };
        let first = scope.definition("p0").unwrap();
        assert_eq!(
            scope.graph().evaluate(first, &point),
            (limits::DEFINITIONS - 1) as f64
        );
        let errors = chain("p0").unwrap_err();
        assert_eq!(errors.len(), 1);
        let DefinitionFault::Circle { circle, .. } = &errors[0].fault else {
            panic!("{}", errors[0])
        };
        assert_eq!(circle.len(), limits::DEFINITIONS + 1);
    });
}

#[test]
fn strange_characters_are_named() {
    for (text, message) in [
        ("x\0", "unexpected character U+0000"),
        ("x + \u{1b}[31m", "unexpected character U+001B"),
        ("x\u{202e}", "unexpected character U+202E"),
        ("\u{feff}x", "unexpected character U+FEFF"),
        ("x；", "unexpected character `；`"),
    ] {
        let error = scope().formula(text).unwrap_err();
        assert_eq!(error.to_string(), message);
        assert!(!error.drawn(text).contains(['\0', '\u{1b}']));
    }
    let long = "q".repeat(5000);
    assert_eq!(fault(&long), Fault::LongName { length: 5000 });
    assert!(matches!(fault(&"9".repeat(400)), Fault::NumberRange { .. }));
    assert!(matches!(
        fault(&format!("1e{}", "9".repeat(5000))),
        Fault::NumberRange { .. }
    ));
    assert!(
        scope()
            .formula(&format!("x + 0.{}1", "0".repeat(200)))
            .is_ok()
    );
    assert!(scope().formula(&format!("x + {}", "1".repeat(300))).is_ok());
}

#[test]
fn bounds_on_names_hold() {
    let mut symbols = Symbols::default();
    for n in 0..limits::STATES {
        symbols.add_state(&format!("x{n}")).unwrap();
    }
    let refused = symbols.add_state("y").unwrap_err();
    assert_eq!(refused.to_string(), "there are more than 64 states");
    for n in 0..limits::PARAMETERS {
        symbols.add_parameter(&format!("p{n}")).unwrap();
    }
    assert!(matches!(
        symbols.add_parameter("y"),
        Err(SymbolError::TooMany { .. })
    ));
    assert_eq!(
        symbols.define("y", &"x".repeat(2 << 20)),
        Err(SymbolError::LongDefinitions)
    );
    let mut scope = Scope::new(symbols).unwrap();
    let sum = (0..limits::STATES)
        .map(|n| format!("p{n} x{n}"))
        .collect::<Vec<_>>()
        .join(" + ");
    let expression = scope.formula(&sum).unwrap();
    let tape = scope
        .compile(&[expression])
        .bind(&vec![2.0; limits::PARAMETERS])
        .unwrap();
    assert_eq!(
        tape.at(0.0, &[1.0; limits::STATES]),
        [2.0 * limits::STATES as f64]
    );
    let unknown = scope.formula("p1x2x").unwrap_err();
    assert!(unknown.allowed().unwrap().len() < 1000);
}
