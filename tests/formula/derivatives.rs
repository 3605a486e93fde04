//! Derivatives of random formulas against differences of values, away from kinks and jumps.

use crate::support::PARAMETER_VALUES;
use crate::support::random::Random;
use pbif::formula::graph::{Expression, Graph, Point, Symbol};

const TIME: f64 = 0.7;

fn value(
    graph: &Graph,
    expression: Expression,
    symbol: Symbol,
    state: &[f64; 3],
    shift: f64,
) -> f64 {
    let (mut state, mut parameters, mut time) = (*state, PARAMETER_VALUES, TIME);
    match symbol {
        Symbol::State(number) => state[number] += shift,
        Symbol::Parameter(number) => parameters[number] += shift,
        Symbol::Time => time += shift,
    }
    graph.evaluate(
        expression,
        &Point {
            states: &state,
            parameters: &parameters,
            time,
        },
    )
}

/// A derivative from differences, and how much it may be wrong: central differences of two widths, extrapolated, with
/// the change by extrapolation and the rounding as error.
fn difference(f: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let width = 2e-4;
    let central = |h: f64| (f(h) - f(-h)) / (2.0 * h);
    let (wide, narrow, narrower) = (central(width), central(width / 2.0), central(width / 4.0));
    let value = narrower + (narrower - narrow) / 3.0;
    let size = [f(width), f(0.0), f(-width)]
        .iter()
        .fold(0.0, |most: f64, f| most.max(f.abs()));
    // Where the differences do not converge as a smooth function's do, nothing is known.
    let (first, second) = ((wide - narrow).abs(), (narrow - narrower).abs());
    let rounding = 1e-15 * size / width * 100.0;
    let smooth = second <= 0.5 * first + rounding && second < 1e-3 * (1.0 + value.abs());
    (smooth && value.is_finite()).then_some((value, second + rounding + 1e-9 * value.abs()))
}

#[test]
fn derivatives_agree_with_differences() {
    let mut random = Random(11);
    let (mut compared, mut tried) = (0, 0);
    for number in 0..3000 {
        let text = random.formula(1 + number % 12);
        let mut scope = crate::support::scope();
        let expression = scope.formula(&text).unwrap();
        let kinks = scope.graph_mut().kinks(expression).unwrap();
        for symbol in [
            Symbol::State(0),
            Symbol::State(1),
            Symbol::Parameter(1),
            Symbol::Time,
        ] {
            let derivative = scope.graph_mut().derivative(expression, symbol).unwrap();
            let graph = scope.graph();
            let state = std::array::from_fn(|_| 2.0 * random.unit() - 1.0);
            let at = |expression, shift| value(graph, expression, symbol, &state, shift);
            // A kink or an integer power's pole within the differences' reach.
            let far = kinks.iter().all(|kink| {
                let values = [-4e-4, 0.0, 4e-4].map(|shift| at(kink.argument, shift));
                let step = matches!(kink.place, pbif::formula::analysis::KinkPlace::Everywhere);
                let side = values.map(|value| if step { value.floor() } else { value.signum() });
                let constant = values[0] == values[1] && values[1] == values[2];
                constant || (side[0] == side[1] && side[1] == side[2] && values[1].abs() > 1e-3)
            });
            let Some((expected, error)) = far
                .then(|| difference(|shift| at(expression, shift)))
                .flatten()
            else {
                continue;
            };
            tried += 1;
            let found = at(derivative.value, 0.0);
            // 0 log 0 and the like: a formula of the derivative that is not a number at this state alone.
            if !found.is_finite() {
                continue;
            }
            compared += 1;
            assert!(
                (found - expected).abs() <= 10.0 * error,
                "{text} by {symbol:?} at {state:?}: {found} instead of {expected} ± {error}"
            );
        }
    }
    assert!(
        compared > 4000 && tried - compared < tried / 20,
        "{compared} of {tried}"
    );
}
