//! Means and deviations of formulas that grow fast, on cells that are wide for them, and of the divergence.

use pbif::continuation::Solution;

use nalgebra::{Matrix3, SMatrix, SVector};

use crate::common::numbers::assert_holds;
use crate::common::sweeps::{measure, solved};

/// A measure holds its exact value within its stated error, which is no larger than the value.
#[track_caller]
fn holds(solution: &Solution<'_>, name: &str, exact: f64) {
    assert_holds(measure(solution, name).into(), exact, exact.abs());
}

/// x' = -g x - w y, y' = w x - g y with the same noise b on both: normal, with variance b²/2g on either axis.
fn turning(g: f64, w: f64, b: f64, (cells, deviations): (usize, f64)) -> (f64, String) {
    let variance = b * b / (2.0 * g);
    let end = deviations * variance.sqrt();
    let text = format!(
        r#"
[system.equations]
x = "-{g} x - ({w}) y + 0 dummy"
y = "({w}) x - {g} y"
[system.noise]
x = "{b}"
y = "{b}"
[sweep]
parameter = "dummy"
from = 0
to = 1
points = 2
[cells]
x = {{ from = -{end}, to = {end}, count = {cells} }}
y = {{ from = -{end}, to = {end}, count = {cells} }}
[watch]
square = "x^2"
third = "abs(x)^3"
fourth = "x^4"
sixth = "y^6"
root = "sqrt(abs(y))"
"#
    );
    (variance, text)
}

#[test]
fn high_powers_on_few_cells_have_errors_that_hold() {
    let systems = [
        (0.477, 0.069, 0.46, (30, 7.213)),
        (0.8, 1.1, 0.7, (33, 8.2)),
        (0.35, -0.6, 0.9, (40, 7.4)),
        (0.9, 0.4, 0.5, (44, 6.0)),
    ];
    for (g, w, b, cells) in systems {
        let (v, text) = turning(g, w, b, cells);
        let (_, found) = solved(&text, "", None);
        let root =
            v.powf(0.25) * 2_f64.powf(0.25) * 1.225_416_702_465_177_6 / std::f64::consts::PI.sqrt();
        let exact = [
            ("mean_square", v),
            ("sd_square", 2_f64.sqrt() * v),
            (
                "sd_third",
                (15.0 - 8.0 / std::f64::consts::PI).sqrt() * v.powf(1.5),
            ),
            ("mean_fourth", 3.0 * v * v),
            ("sd_fourth", 96_f64.sqrt() * v * v),
            ("mean_sixth", 15.0 * v.powi(3)),
            ("sd_sixth", 10_170_f64.sqrt() * v.powi(3)),
            ("mean_root", root),
        ];
        for (name, exact) in exact {
            holds(&found, name, exact);
        }
        // What the cells resolve is not told to be worse than it is.
        let (value, error) = measure(&found, "mean_square");
        assert!(error < 5e-3 * value, "{error:e} of {value}");
    }
}

/// The variance of the first state by Lyapunov's equation A S + S Aᵀ = -N, as nine linear equations.
fn variance_of_first(a: Matrix3<f64>, noise: [f64; 3]) -> f64 {
    let one = Matrix3::identity();
    let equations: SMatrix<f64, 9, 9> = one.kronecker(&a) + a.kronecker(&one);
    let right = SVector::<f64, 9>::from_fn(|k, _| match k % 4 {
        0 => -noise[k / 4],
        _ => 0.0,
    });
    equations.lu().solve(&right).unwrap()[0]
}

#[test]
fn a_high_power_on_three_axes_of_few_cells_has_an_error_that_holds() {
    let text = r#"
[system.equations]
x = "-1.027 x + 0.18 y + 0.334 z"
y = "0.093 x - 0.531 y - 0.522 z"
z = "0.102 x + 0.057 y - 0.91 z"
[system.noise]
x = "0.648*sqrt(D)"
y = "0.397*sqrt(D)"
z = "0.497*sqrt(D)"
[sweep]
parameter = "D"
from = 0.7
to = 1.0
points = 2
[cells]
x = { from = -2.426, to = 2.426, count = 20 }
y = { from = -2.263, to = 2.263, count = 20 }
z = { from = -1.924, to = 1.924, count = 20 }
[watch]
fourth = "x^4"
"#;
    let (_, found) = solved(text, "", Some(0.7));
    let drift = Matrix3::new(
        -1.027, 0.18, 0.334, 0.093, -0.531, -0.522, 0.102, 0.057, -0.91,
    );
    let noise = [0.648_f64, 0.397, 0.497].map(|amplitude| 0.7 * amplitude * amplitude);
    let v = variance_of_first(drift, noise);
    holds(&found, "mean_fourth", 3.0 * v * v);
    holds(&found, "sd_fourth", 96_f64.sqrt() * v * v);
}

/// A linear oscillator with damping k in the coordinates x + a x³ and y - c x²: exponents do not change with
/// coordinates, so that their sum is -k.
#[test]
fn the_error_of_the_mean_divergence_holds_the_true_one() {
    let text = r#"
[system.equations]
x = "v/(1 + 3*0.125*x^2) + 0*dummy"
y = "-1.5625*(x + 0.125*x^3) - 0.04*v + 2*0.014*x*v/(1 + 3*0.125*x^2)"
[system.define]
v = "y - 0.014*x^2"
[system.noise]
y = "0.2475"
[sweep]
parameter = "dummy"
from = 0
to = 1
points = 2
[cells]
x = { from = -2.240, to = 2.240, count = 48 }
y = { from = -4.550, to = 4.585, count = 48 }
[exponent]
kind = "largest"
"#;
    let (_, found) = solved(text, "", None);
    assert_holds(measure(&found, "divergence").into(), -0.04, 4e-4);
}
