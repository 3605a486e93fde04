//! Means, deviations and shares of the time where probability circulates beside walls and beside planes at which a
//! force bends. What a flux across them leaves out is nothing in a potential, and of second order in the cells here.
//!
//! The density is exp(-U) by construction: the drift is -D ∇U + k (∂a/∂y - a ∂U/∂y, -∂a/∂x + a ∂U/∂x), whose second
//! part turns about without changing it, and flows along walls on which a is zero.

use crate::common::numbers::assert_holds;
use crate::common::sweeps::{measure, solved};

type Function = fn(f64, f64) -> f64;

/// What is watched, and where the time is spent.
const WATCHED: &str = r#"
[sweep]
parameter = "k"
from = -0.6
to = 0.5
points = 2
[watch]
v = "y^2/(1 + x^2)"
u = "exp(x/2) cos(y)"
w = "x y"
[visits]
above = "x > 0.3"
"#;

const BORDER: f64 = 0.3;

const FUNCTIONS: [(&str, Function); 5] = [
    ("x", |x, _| x),
    ("y", |_, y| y),
    ("v", |x, y| y * y / (1.0 + x * x)),
    ("u", |x, y| (0.5 * x).exp() * y.cos()),
    ("w", |x, y| x * y),
];

/// Places and weights of Gauss's rule of two between places, in many steps.
fn rule(cuts: &[f64]) -> Vec<(f64, f64)> {
    const STEPS: i32 = 250;
    let pieces = cuts.windows(2).flat_map(|ends| {
        let step = (ends[1] - ends[0]) / f64::from(STEPS);
        (0..STEPS).flat_map(move |k| {
            let middle = ends[0] + step * (f64::from(k) + 0.5);
            [-1.0, 1.0].map(|sign| (middle + sign * step / 12.0_f64.sqrt(), 0.5 * step))
        })
    });
    pieces.collect()
}

/// Means, deviations and the share of the time differ from those of the density exp(-U), which is smooth between cuts,
/// by no more than their errors, at both ends of the sweep.
fn all_hold(text: &str, potential: fn(f64, f64) -> f64, cuts: [&[f64]; 2]) {
    let [along_x, along_y] = cuts.map(rule);
    let points = along_x.iter().flat_map(|&(x, a)| {
        let weight = move |y: f64, b: f64| a * b * (-potential(x, y)).exp();
        along_y.iter().map(move |&(y, b)| (x, y, weight(y, b)))
    });
    let points: Vec<(f64, f64, f64)> = points.collect();
    let whole: f64 = points.iter().map(|point| point.2).sum();
    let mean = |function: &dyn Fn(f64, f64) -> f64| {
        let terms = points.iter().map(|&(x, y, weight)| weight * function(x, y));
        terms.sum::<f64>() / whole
    };
    for k in [-0.6, 0.5] {
        let (_, found) = solved(&format!("{text}{WATCHED}"), "", Some(k));
        let check = |name: &str, exact: f64| {
            let (value, error) = measure(&found, name);
            let off = value - exact;
            println!("{name} at {k}: {value:.7} ± {error:.1e}, off by {off:.1e}");
            assert_holds([value, error], exact, 2e-2);
        };
        for (name, function) in FUNCTIONS {
            let middle = mean(&function);
            let spread = mean(&|x, y| (function(x, y) - middle).powi(2)).sqrt();
            check(&format!("mean_{name}"), middle);
            check(&format!("sd_{name}"), spread);
        }
        let above = |x: f64, _: f64| if x > BORDER { 1.0 } else { 0.0 };
        check("above_time_share", mean(&above));
    }
}

/// A well with a hill beside its middle.
fn hilly(x: f64, y: f64) -> f64 {
    0.8 * x * x + 0.6 * y * y + 0.3 * x * y + 0.7 * (-(x - 0.5).powi(2) - (y + 0.3).powi(2)).exp()
}

/// Errors hold what the central scheme of fourth order leaves out of fluxes through walls.
#[test]
fn means_beside_walls_along_which_probability_circulates_hold() {
    let hill = "exp(-(x - 0.5)^2 - (y + 0.3)^2)";
    let system = |bounds: &str, a: [&str; 3]| {
        let [a, slope_x, slope_y] = a;
        format!(
            r#"
[system.equations]
x = "-0.4 ux + k (({slope_y}) - ({a}) uy)"
y = "-0.5 uy - k (({slope_x}) - ({a}) ux)"
[system.define]
ux = "1.6 x + 0.3 y - 1.4 (x - 0.5) {hill}"
uy = "1.2 y + 0.3 x - 1.4 (y + 0.3) {hill}"
[system.noise]
x = "sqrt(0.8)"
y = "1"
[system.bounds]
{bounds}
"#
        )
    };
    let wall = system("x = [\"reflecting\", \"open\"]", ["x + 0.4", "1", "0"]);
    let corner = system(
        "x = [\"reflecting\", \"open\"]\ny = [\"open\", \"reflecting\"]",
        ["(x + 0.4) (0.9 - y)", "0.9 - y", "-(x + 0.4)"],
    );
    for (cells_x, cells_y) in [(30, 40), (41, 57), (60, 80)] {
        let cells = |upper: f64| {
            format!(
                "[cells]\nx = {{ from = -0.4, to = 5.1, count = {cells_x} }}\ny = {{ from = -5.8, to = {upper}, count = {cells_y} }}\n"
            )
        };
        println!("{cells_x} x {cells_y} cells");
        let x = [-0.4, BORDER, 5.1];
        all_hold(&format!("{wall}{}", cells(5.8)), hilly, [&x, &[-5.8, 5.8]]);
        all_hold(
            &format!("{corner}{}", cells(0.9)),
            hilly,
            [&x, &[-5.8, 0.9]],
        );
    }
}

/// A well with springs that touch beyond 0.4 and below -0.8 of x, and above 0.5 of y.
fn touched(x: f64, y: f64) -> f64 {
    let spring = |compression: f64| compression.max(0.0).powi(2);
    0.5 * x * x
        + 0.6 * y * y
        + 0.3 * x * y
        + 1.4 * spring(x - 0.4)
        + 2.1 * spring(-0.8 - x)
        + 1.7 * spring(y - 0.5)
}

#[test]
fn means_beside_bends_of_forces_around_which_probability_circulates_hold() {
    let system = r#"
[system.equations]
x = "-0.4 ux + k uy"
y = "-0.5 uy - k ux"
[system.define]
ux = "x + 0.3 y + 2.8 max(0, x - 0.4) - 4.2 max(0, -0.8 - x)"
uy = "1.2 y + 0.3 x + 3.4 max(0, y - 0.5)"
[system.noise]
x = "sqrt(0.8)"
y = "1"
"#;
    for (cells_x, cells_y) in [(44, 40), (56, 50), (88, 76)] {
        let cells = format!(
            "[cells]\nx = {{ from = -4.4, to = 4.4, count = {cells_x} }}\ny = {{ from = -5.5, to = 4, count = {cells_y} }}\n"
        );
        println!("{cells_x} x {cells_y} cells");
        let cuts: [&[f64]; 2] = [&[-4.4, -0.8, BORDER, 0.4, 4.4], &[-5.5, 0.5, 4.0]];
        all_hold(&format!("{system}{cells}"), touched, cuts);
    }
}
