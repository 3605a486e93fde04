//! Two changes between two values that a sweep solves, which count the same peaks: one is born, and another vanishes.

use crate::common::sweeps::{rows, swept};
use pbif::continuation::BifurcationStatus;

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
