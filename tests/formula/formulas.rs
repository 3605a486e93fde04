//! 10 000 random and damaged formulas against an independent reader and evaluators: no panic, equal values in every
//! bit, texts that read back to the same expression.

use crate::support::evaluate::{bounded, exact};
use crate::support::random::Random;
use crate::support::read::read;
use crate::support::{PARAMETER_VALUES, lookup, same, scope, states};
use pbif::formula::graph::{Point, Symbol};
use pbif::formula::{LANES, Lanes};

const TIME: f64 = 0.7;

/// What became of the formulas.
#[derive(Debug, Default)]
struct Tally {
    accepted: usize,
    compared: usize,
    within_bound: usize,
    differentiated: usize,
}

fn check(text: &str, random: &mut Random, tally: &mut Tally) {
    let mut scope = scope();
    let expression = match scope.formula(text) {
        Ok(expression) => expression,
        Err(error) => {
            // The place is in the text and the message can be drawn.
            assert!(
                error.span.end <= text.len() && text.is_char_boundary(error.span.start),
                "{text:?}"
            );
            assert!(!error.drawn(text).is_empty());
            let _ = (error.allowed(), error.remedy());
            return;
        }
    };
    tally.accepted += 1;
    let tree = read(text).unwrap_or_else(|| panic!("only the library reads {text:?}"));
    let printed = scope.text(expression).unwrap();
    assert_eq!(
        scope.formula(&printed).unwrap(),
        expression,
        "{text:?} is printed as {printed:?}"
    );
    let _ = scope.typeset(expression);
    let program = scope.compile(&[expression]);
    let tape = program.bind_as_written(&PARAMETER_VALUES).unwrap();
    let nested = program.bind(&PARAMETER_VALUES).unwrap();
    let states = states(random, 10);
    let batch: Vec<Lanes> = (0..3)
        .map(|axis| std::array::from_fn(|lane| states[lane % states.len()][axis]))
        .collect();
    let (mut lanes, mut nested_lanes) = ([[0.0; LANES]], [[0.0; LANES]]);
    tape.run(TIME, &batch, &mut lanes);
    nested.run(TIME, &batch, &mut nested_lanes);
    for (lane, state) in states.iter().enumerate() {
        let point = Point {
            states: state,
            parameters: &PARAMETER_VALUES,
            time: TIME,
        };
        let value = scope.graph().evaluate(expression, &point);
        let expected = exact(&tree, &lookup(state, TIME)).unwrap();
        assert!(
            same(value, expected),
            "{text:?} at {state:?}: {value} instead of {expected}"
        );
        let on_tape = lanes[0][lane];
        assert!(
            same(on_tape, expected),
            "{text:?} at {state:?}: {on_tape} instead of {expected} on tape"
        );
        tally.compared += 1;
        if let Some(bound) = bounded(&tree, &lookup(state, TIME)) {
            let error = (value - bound.value).abs();
            assert!(
                error <= bound.error,
                "{text:?} at {state:?}: {value} instead of {bound:?}"
            );
            // Nesting a polynomial does at most a few times what rounding each term can do.
            let error = (nested_lanes[0][lane] - bound.value).abs();
            assert!(
                error <= 50.0 * bound.error,
                "{text:?} at {state:?} nested: {error} {bound:?}"
            );
            tally.within_bound += 1;
        }
    }
    for symbol in [Symbol::State(0), Symbol::Parameter(0), Symbol::Time] {
        if let Ok(derivative) = scope.graph_mut().derivative(expression, symbol) {
            tally.differentiated += usize::from(scope.text(derivative.value).is_ok());
        }
    }
}

#[test]
fn random_formulas_have_the_values_of_an_independent_evaluator() {
    let (mut random, mut tally) = (Random(1), Tally::default());
    for number in 0..5000 {
        let size = 1 + number % 25;
        let text = random.formula(size);
        let before = tally.accepted;
        check(&text, &mut random, &mut tally);
        assert!(tally.accepted > before, "{text:?} is refused");
    }
    assert!(tally.within_bound > tally.compared / 4, "{tally:?}");
    assert!(tally.differentiated > 14_000, "{tally:?}");
}

#[test]
fn damaged_formulas_are_refused_or_have_equal_values() {
    let (mut random, mut tally) = (Random(2), Tally::default());
    for number in 0..5000 {
        let (text, other) = (random.formula(1 + number % 12), random.formula(3));
        let damaged = random.damaged(&text, &other);
        check(&damaged, &mut random, &mut tally);
    }
    assert!((500..4500).contains(&tally.accepted), "{tally:?}");
}

#[test]
fn garbage_is_refused_or_has_equal_values() {
    let (mut random, mut tally) = (Random(3), Tally::default());
    for _ in 0..3000 {
        let text = random.garbage();
        check(&text, &mut random, &mut tally);
    }
    assert!(tally.accepted < 1500, "{tally:?}");
}
