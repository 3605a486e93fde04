//! Random systems of two axes with noise on both and an exact density: exp(-2U/σ²) with U = V(x) - θx + k(y - ax)²/2.
//!
//! The drift is -∇U and a rotation c (∂U/∂y, -∂U/∂x), which follows the level lines and changes no density. V has a
//! hyperbolic sine, a sine, a quotient, a power 3/2 or corners in its slope; cells are 30 to 100 an axis, and ranges
//! too wide, right, or too narrow.

use super::formulas::Formula;
use super::*;

/// V'(x) as a formula and a function.
pub(super) struct Slope {
    pub(super) family: &'static str,
    pub(super) text: String,
    pub(super) value: Box<dyn Fn(f64) -> f64>,
    pub(super) ends: (f64, f64),
}

pub(super) fn slope(dice: &mut Dice, kind: u64) -> Slope {
    let (b, c) = (dice.between(0.3, 1.2), dice.between(1.1, 2.0));
    match kind {
        0 => Slope {
            family: "noise on both axes, hyperbolic sine",
            text: format!("{b} sinh(x) - {b} ({c} x)"),
            value: Box::new(move |x| b * (x.sinh() - c * x)),
            ends: (-0.613, 0.587),
        },
        1 => {
            let q = dice.between(1.5, 3.0);
            Slope {
                family: "noise on both axes, sine",
                text: format!("{b} x + {c} sin({q} x)"),
                value: Box::new(move |x| b * x + c * (q * x).sin()),
                ends: (-0.813, 0.787),
            }
        }
        2 => {
            let d = dice.between(3.0, 6.0);
            Slope {
                family: "noise on both axes, a quotient",
                text: format!("{b} x - {d} x/(1 + {c} x^2)"),
                value: Box::new(move |x| b * x - d * x / (1.0 + c * x * x)),
                ends: (-1.613, 1.587),
            }
        }
        3 => Slope {
            family: "noise on both axes, a power 3/2",
            text: format!("{c} abs(x)^1.5 sign(x) - {b} x"),
            value: Box::new(move |x: f64| c * x.abs().powf(1.5) * x.signum() - b * x),
            ends: (-0.313, 0.287),
        },
        _ => {
            let d = dice.between(0.4, 0.9);
            Slope {
                family: "noise on both axes, corners",
                text: format!("{c} x - {b} ({c}) (abs(x + {d}) - abs(x - {d}))"),
                value: Box::new(move |x: f64| c * x - b * c * ((x + d).abs() - (x - d).abs())),
                ends: (-0.613, 0.587),
            }
        }
    }
}

/// The case of V whose marginal along x is exp(-(V - θx)/T), with 81 cells on the range that this needs.
pub(super) fn of_potential(family: &'static str, of: Slope, t: f64) -> (Case, String) {
    let Slope {
        text, value, ends, ..
    } = of;
    let value = std::rc::Rc::new(value);
    let zero = value.clone();
    let formula = Formula {
        family,
        drift: "theta".to_owned(),
        noise: "1".to_owned(),
        slope: Box::new(move |x, theta| theta - value(x)),
        intensity: Box::new(move |_| 2.0 * t),
        zero: Box::new(move |x| zero(x)),
        speed: 0.0,
        breaks: Vec::new(),
        ends,
        within: (-6.0, 6.0),
    };
    (formula.case(81), text)
}

/// Axes of 30 to `most` cells over two ranges that are widened, or narrowed, by a share.
pub(super) fn axes(dice: &mut Dice, ranges: [(f64, f64); 2], most: usize) -> Option<Vec<Axis>> {
    let wider = [0.0, 0.3, 0.6, -0.08][dice.one_of([0, 0, 1, 2, 3])];
    let axis = |(from, to): (f64, f64)| {
        let more = 0.5 * wider * (to - from);
        let rounded = |x: f64| (x * 100.0).round() / 100.0;
        let cells = dice.one_of([30, 45, 60, 80, most]);
        Axis::uniform(rounded(from - more), rounded(to + more), cells).ok()
    };
    ranges.map(axis).into_iter().collect()
}

/// The equations of a case, what else is said of it, its cells and its range.
pub(super) fn in_words(case: &Case, equations: &[String; 2], further: &str) -> String {
    let axes = case.axes.iter();
    let axes: Vec<String> = axes
        .map(|axis| format!("{} cells in [{}, {}]", axis.count(), axis.from(), axis.to()))
        .collect();
    let [x, y] = equations;
    format!(
        "x' = {x}, y' = {y}{further}, {}, θ in {:?}",
        axes.join(", "),
        case.ends
    )
}

fn gibbs(seed: u64) -> Option<Case> {
    let mut dice = Dice::new(seed);
    let of = slope(&mut dice, seed % 5);
    let sigma2 = dice.between(0.15, 0.9);
    let (a, c) = (dice.between(-0.8, 0.8), dice.between(-1.0, 1.0));
    let k = dice.between(0.5, 2.0);
    let (mut case, text) = of_potential(of.family, of, 0.5 * sigma2);
    // 32 below the maximum is what the range of the marginal holds.
    let d = (32.0 * sigma2 / k).sqrt();
    let (from, to) = (case.axes[0].from(), case.axes[0].to());
    let reach = [a * from, a * to];
    let (low, high) = (reach[0].min(reach[1]) - d, reach[0].max(reach[1]) + d);
    case.axes = axes(&mut dice, [(from, to), (low, high)], 100)?;
    let along_x = format!("({text} - theta - {k} ({a}) (y - ({a}) x))");
    let along_y = format!("({k} (y - ({a}) x))");
    let drift = [
        format!("-{along_x} + ({c}) {along_y}"),
        format!("-{along_y} - ({c}) {along_x}"),
    ];
    case.model = TypedModel::new("random", "A random system", ["x", "y"])
        .with_equation("x", &drift[0])
        .with_equation("y", &drift[1])
        .with_noise("x", [format!("sqrt({sigma2})")])
        .with_noise("y", [format!("sqrt({sigma2})")])
        .with_parameters(["theta"])
        .build()
        .unwrap();
    case.words = in_words(&case, &drift, &format!(", noise sqrt({sigma2}) on both"));
    case.points = 17;
    Some(case)
}

#[test]
fn what_is_located_under_noise_on_both_axes_holds_the_truth() {
    let scores = run(cases(gibbs, 8000..8001));
    print_true(&scores);
}

/// What is found in a system with closer looks that may take so much work.
fn with_effort(seed: u64, effort: f64) -> Score {
    let case = gibbs(seed).unwrap();
    let options = LocateOptions {
        effort,
        ..LocateOptions::default()
    };
    Score::of(&case.truths, &solve_with(&case, &options))
}

/// What is found in a system without closer looks, and with them.
fn without_and_with_closer_looks(seed: u64) -> [Score; 2] {
    [0.0, 1.0].map(|effort| with_effort(seed, effort))
}

/// On 80 × 30 cells and on 120 × 45 the change is found at the same value to a tenth of its error, which is what the
/// second scheme changes of it there.
#[test]
fn two_grids_of_wide_cells_that_agree_by_chance_locate_nothing() {
    let found = with_effort(1_268_026, 0.0);
    assert_eq!((found.located, found.in_band, found.missed), (0, 2, 0));
}

/// Two peaks 2.2 cells apart last for two steps of the sweep: on 30 × 30 cells no value shows them, and the slope along
/// the crest has an extremum whose sign is not sure.
#[test]
fn a_pair_that_coarse_cells_hide_is_told_by_finer_ones() {
    let [coarse, closer] = without_and_with_closer_looks(848_003);
    assert_eq!((coarse.missed, coarse.in_band), (2, 0));
    assert_eq!((closer.missed, closer.false_located), (0, 0));
}

/// Two peaks last between two changes, whose errors on 60 × 30 cells are larger than wanted.
#[test]
fn what_coarse_cells_leave_in_doubt_is_located_on_finer_ones() {
    let [coarse, closer] = without_and_with_closer_looks(848_013);
    assert_eq!((coarse.located, coarse.missed), (0, 0));
    assert_eq!((closer.located, closer.located_right), (2, 2));
}

/// The second peak has a hundred-thousandth of the density of the first where it is counted, and a few millionths where
/// it is born: less than what differences between schemes are off by where they need say no more than how large errors
/// are.
#[test]
#[ignore = "half a minute: what finer cells do for a peak that is not low is tried always"]
fn a_peak_five_orders_of_magnitude_lower_is_located_at_length() {
    let [coarse, closer] = without_and_with_closer_looks(848_010);
    assert_eq!((coarse.located, coarse.in_band), (0, 2));
    assert_eq!((closer.located, closer.located_right), (2, 2));
}

/// On 30 × 45 cells one peak is counted from one end of the sweep to the other, of two that are there at both ends.
#[test]
#[ignore = "ten seconds: what finer cells count between the ends of a sweep is tried always"]
fn what_wide_cells_do_not_count_at_the_ends_of_a_sweep_is_told_by_finer_ones_at_length() {
    let [coarse, closer] = without_and_with_closer_looks(848_011);
    assert_eq!((coarse.located, coarse.missed), (0, 2));
    assert_eq!((closer.located, closer.located_right), (2, 2));
}

/// A force of the power 3/2 bends inside a cell, and no value of the sweep on 45 × 45 cells shows the two peaks that
/// last for less than two of its steps. Cells are not wide there, and finer ones have a face on the bend.
#[test]
#[ignore = "half a minute: what three grids do beside a bend is tried always, of rows alone"]
fn a_pair_beside_a_bend_inside_a_cell_is_told_by_finer_cells_at_length() {
    let [coarse, closer] = without_and_with_closer_looks(1_688_003);
    assert_eq!((coarse.missed, coarse.in_band), (2, 0));
    assert_eq!((closer.missed, closer.false_located), (0, 0));
}

#[test]
#[ignore = "prints the table of docs/location.md"]
fn gibbs_in_full() {
    let scores = run(cases(gibbs, 8000..8060));
    print_nearly_true(&scores);
}
