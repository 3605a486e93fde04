//! Two changes between two values that a sweep solves: a peak is born while another vanishes, so that as many are
//! counted, or a peak vanishes while a crater closes; and three of one axis.

use crate::common::sweeps::{rows, swept};
use pbif::continuation::{BifurcationStatus, Located};

/// exp(-U/T) of two axes that mix, integrated over x: the density of y but for a factor, by Simpson's rule.
fn density_of_y(tilt: f64, y: f64) -> f64 {
    let energy = |x: f64| {
        0.25 * x.powi(4) - 0.49 * x * x + 0.25 * x * y + 0.166 * x * y * y - tilt * x
            + 0.125 * y.powi(4)
            + 0.3 * y * y
            + 0.19 / 1.66 * (1.66 * y).cos()
    };
    let cells = 160;
    let weight = |k: i32| match k {
        0 | 160 => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let x = |k: i32| -2.8 + 5.6 * f64::from(k) / f64::from(cells);
    let terms = (0..=cells).map(|k| weight(k) * (-energy(x(k)) / 0.1527).exp());
    terms.sum()
}

#[test]
fn a_peak_that_is_born_while_another_vanishes_is_found_though_no_value_shows_both() {
    // The values that are given count one peak of y each, on either side of zero: between them there are two for a
    // sixth of the step.
    let text = r#"
[system.equations]
x = "-(x^3 - 0.98*x + 0.25*y + 0.166*y^2 - h)"
y = "-(0.5*y^3 + 0.6*y + 0.25*x + 0.332*x*y - 0.19*sin(1.66*y))"
[system.noise]
x = "sqrt(2 * 0.1527)"
y = "sqrt(2 * 0.1527)"
[system.parameters]
h = 0.0
[sweep]
parameter = "h"
from = -0.2
to = 0.2
points = 3
[cells]
x = { from = -2.8, to = 2.8, count = 50 }
y = { from = -3.2, to = 3.2, count = 90 }
[detect]
marginals = ["y"]
joint = []
"#;
    let peaks = |tilt: f64| {
        let density: Vec<f64> = (-1000..=1000)
            .map(|k| density_of_y(tilt, 1.6e-3 * f64::from(k)))
            .collect();
        let is_peak = |triple: &&[f64]| triple[1] > triple[0] && triple[1] >= triple[2];
        density.windows(3).filter(is_peak).count()
    };
    let change = |mut below: f64, mut above: f64| {
        let before = peaks(below);
        assert_ne!(before, peaks(above));
        for _ in 0..16 {
            let middle = 0.5 * (below + above);
            if peaks(middle) == before {
                below = middle;
            } else {
                above = middle;
            }
        }
        0.5 * (below + above)
    };
    let exact = [change(-0.2, 0.03), change(0.03, 0.2)];
    let (_, result) = swept(text, "");
    let found = rows(&result, "y");
    println!(
        "{exact:?}: {:?}",
        found
            .iter()
            .map(|row| (row.value, row.error))
            .collect::<Vec<_>>()
    );
    assert_eq!(found.len(), exact.len());
    for (row, exact) in found.iter().zip(exact) {
        assert!(row.status() == BifurcationStatus::Located);
        assert!((row.value - exact).abs() <= row.error + 1e-6, "{exact}");
    }
}

#[test]
#[ignore = "half a minute for closer looks on up to four times as many cells"]
fn a_crater_that_closes_does_not_take_a_peak_with_it_at_length() {
    // Down the gradient of U = (x² + y² - 1)² + k x + 0.3 (x² - y²) and around along its level lines: exp(-U/T).
    let text = r#"
[system.equations]
x = "-4 x (x^2+y^2-1) - k - 0.6 x + w (4 y (x^2+y^2-1) - 0.6 y)"
y = "-4 y (x^2+y^2-1) + 0.6 y - w (4 x (x^2+y^2-1) + k + 0.6 x)"
[system.noise]
x = "sqrt(2 T)"
y = "sqrt(2 T)"
[system.parameters]
k = 0.1
T = 0.3
w = 0.5
[sweep]
parameter = "k"
from = 1.1333333333
to = 1.7
points = 3
[cells]
x = { from = -2.3, to = 2.3, count = 68 }
y = { from = -2.5, to = 2.4, count = 68 }
[detect]
marginals = []
"#;
    let (_, result) = swept(text, "");
    let found = rows(&result, "xy");
    // On y = 0 the maximum of U meets its saddle where 12 x² = 3.4.
    let x = (3.4_f64 / 12.0).sqrt();
    let exact = x * (3.4 - 4.0 * x * x);
    let closing = found.first().expect("the crater closes");
    assert_eq!(closing.status(), BifurcationStatus::Located);
    assert!(
        (closing.value - exact).abs() < closing.error,
        "{} ± {}",
        closing.value,
        closing.error
    );
    // Two peaks are left until they meet at k = 1.287.
    let peaks = |row: &Located| (row.before.peaks, row.after.peaks);
    assert_eq!(
        found.iter().map(|row| peaks(row)).collect::<Vec<_>>(),
        [(2, 2), (2, 1)]
    );
}

#[test]
fn a_stage_between_two_folds_of_one_step_has_its_rows() {
    // Peaks are zeros of the drift a + q(x), so that they are born and vanish at the extrema of -q: -0.00206, -0.00160
    // and -0.00124 all lie within a step of the sweep, and one of them is found without the others.
    let text = r#"
system.equations = { x = "a + b x - 0.328 x^2 + 0.759 x^3 - 0.224 x^4 - 0.7 x^5" }
system.noise = { x = "0.652" }
system.parameters = { b = 0.046 }
sweep = { parameter = "a", from = -0.5, to = 0.5, points = 11 }
cells.x = { from = -2.5, to = 2.5, count = 160 }
"#;
    let (_, result) = swept(text, "");
    let q = |x: f64| {
        0.046 * x - 0.328 * x.powi(2) + 0.759 * x.powi(3) - 0.224 * x.powi(4) - 0.7 * x.powi(5)
    };
    let at = |k: i32| -2.5 + 1e-4 * f64::from(k);
    let is_turn = |k: &i32| (q(at(*k)) - q(at(k - 1))) * (q(at(k + 1)) - q(at(*k))) < 0.0;
    let mut exact: Vec<f64> = (1..50_000).filter(is_turn).map(|k| -q(at(k))).collect();
    exact.retain(|fold| fold.abs() < 0.5);
    exact.sort_by(f64::total_cmp);
    let rows = rows(&result, "x");
    assert_eq!(rows.len(), exact.len(), "{exact:?}");
    for (row, exact) in rows.iter().zip(exact) {
        assert_eq!(row.status(), BifurcationStatus::Located);
        assert!(
            (row.value - exact).abs() <= row.error,
            "{} for {exact}",
            row.value
        );
    }
}
