//! Random systems of two axes with a drift that jumps, as dry friction does, at a place that moves along the sweep or
//! stays: p is a function of y of one axis, times a normal density of x about a straight line over y.

use super::formulas::Formula;
use super::*;

/// Wells in y that move with θ at some speed (or stay), a tilt that is θ, and friction whose jump moves with the wells.
/// Noise is so strong that no well is too low to be counted.
fn belt(seed: u64) -> Option<Case> {
    let mut dice = Dice::new(seed);
    let moves = seed.is_multiple_of(2);
    let (k, f, b) = (
        dice.between(0.4, 1.3),
        dice.between(0.05, 0.4),
        dice.between(-0.6, 0.6),
    );
    let speed = dice.between(0.2, 1.2);
    let (sigma, stiff, slope, turn) = (
        dice.between(0.5, 0.9),
        dice.between(0.5, 2.0),
        dice.between(-0.5, 0.5),
        dice.between(-0.6, 0.6),
    );
    let speed = if moves { speed } else { 0.0 };
    let force = move |u: f64| k * u - u.powi(3) - f * (u - b).signum();
    let u = format!("(y - {speed} theta)");
    let along = format!("(theta + {k} {u} - {u}^3 - {f} sign({u} - {b}))").replace("- -", "+ ");
    let aside = format!("{stiff} (x - {slope} y)").replace("- -", "+ ");
    // -∇V with V = W(y) + stiff (x - slope y)²/2, and a rotation of it.
    let of_y = format!("({along} + ({slope}) * {aside})");
    let formula = Formula {
        family: "",
        drift: of_y.clone(),
        noise: format!("{sigma}"),
        slope: Box::new(move |y, theta| theta + force(y - speed * theta)),
        intensity: Box::new(move |_| sigma * sigma),
        zero: Box::new(move |u| -force(u)),
        speed,
        breaks: vec![b],
        ends: (-0.313, 0.287),
        within: (-6.0, 6.0),
    };
    let (range, truths) = formula.range_and_turns();
    let cells = dice.one_of([45, 50, 54, 60, 71]);
    let half = slope.abs() * range.0.abs().max(range.1) + 8.0 * sigma / (2.0 * stiff).sqrt();
    let half = (half * 100.0).ceil() / 100.0;
    let drifts = [
        format!("-{aside} + ({turn}) * {of_y}"),
        format!("{of_y} + ({turn}) * {aside}"),
    ];
    let model = TypedModel::new("random", "A random system", ["x", "y"])
        .with_equation("x", &drifts[0])
        .with_equation("y", &drifts[1])
        .with_noise("x", [format!("{sigma}")])
        .with_noise("y", [format!("{sigma}")])
        .with_parameters(["theta"])
        .build()
        .unwrap();
    Some(Case {
        family: if moves {
            "a jump that moves"
        } else {
            "a jump that stays"
        },
        words: format!(
            "x' = {}; y' = {}; noise {sigma}, x within {half}, y in {range:?}, {cells} cells",
            drifts[0], drifts[1]
        ),
        model,
        axes: vec![
            Axis::uniform(-half, half, cells).unwrap(),
            Axis::uniform(range.0, range.1, cells).unwrap(),
        ],
        ends: (-0.313, 0.287),
        points: 21,
        truths,
    })
}

#[test]
fn what_is_located_beside_a_jump_that_moves_holds_the_truth() {
    let scores = run(cases(belt, 7000..7002));
    print(&scores);
    for (name, score) in &scores {
        assert_eq!(score.false_located, 0, "{name}");
    }
}

#[test]
#[ignore = "prints the table of docs/location.md"]
fn belts_in_full() {
    let scores = run(cases(belt, 7000..7060));
    print_true(&scores);
}
