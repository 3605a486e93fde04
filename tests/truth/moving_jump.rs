//! A drift that jumps at a place which moves along the sweep, as the friction of a belt does whose velocity is swept:
//! the cells of the sweep stay where they are, and the jump lies inside of them. Its density is exact.

use pbif::cancellation::Cancellation;
use pbif::continuation::{BifurcationStatus, DensitySource as _, Want};

use crate::common::sweeps::{prepared, rows, swept};

/// p is proportional to exp(-2 V/σ²) with V = y⁴/4 - y²/2 - θ y/2 + |y - θ|/10 + x² + (x - y)²/4: the drift is the
/// gradient -∇V and a rotation that leaves p as it is. At critical points x = y/5, which leaves
/// y³ - 0.6 y - θ/2 ± 1/10 = 0 above and below y = θ, for the marginal of y too.
const BELT: &str = r#"
[system.define]
fx = "2 x + 0.5 (x - y)"
fy = "y^3 - y - theta/2 + 0.1 sign(y - theta) - 0.5 (x - y)"
[system.equations]
x = "-fx + 0.4 fy"
y = "-fy - 0.4 fx"
[system.noise]
x = "0.4"
y = "0.4"
[system.parameters]
theta = 0.1
[sweep]
parameter = "theta"
from = 0.03
to = 0.23
points = 11
[cells]
x = { from = -1.6, to = 1.6, count = 61 }
y = { from = -2.1, to = 2.1, count = 67 }
[detect]
marginals = ["y"]
joint = [["x", "y"]]
"#;

/// The valley above y = θ is at y = θ where θ³ - 1.1 θ + 0.1 = 0: it takes the peak on the jump with it.
fn collision() -> f64 {
    let residual = |theta: f64| theta.powi(3) - 1.1 * theta + 0.1;
    let (mut low, mut high) = (0.0, 0.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if residual(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Below y = θ peak and valley are one where y³ - 0.6 y has its maximum: y = -√0.2, where it is 0.4 √0.2.
fn fold() -> f64 {
    2.0 * (0.4 * 0.2_f64.sqrt() - 0.1)
}

#[test]
fn changes_are_located_by_cells_that_move_with_a_jump() {
    let (_, result) = swept(BELT, "");
    for observable in ["y", "xy"] {
        let rows = rows(&result, observable);
        let counted: Vec<_> = rows
            .iter()
            .map(|row| (row.before.peaks, row.after.peaks))
            .collect();
        assert_eq!(counted, [(3, 2), (2, 1)], "{observable}");
        assert_eq!(rows[1].status(), BifurcationStatus::Located);
        // The valley beside the jump is a cell wide: the collision need not be located, and is not called so wrongly.
        for (row, exact) in rows.iter().zip([collision(), fold()]) {
            let off = (row.value - exact).abs();
            let is_right = off <= row.error && row.error < 1e-4;
            assert!(
                is_right || row.status() != BifurcationStatus::Located,
                "{observable}: {off:e} {row:?}"
            );
        }
    }
}

#[test]
fn finer_cells_have_a_face_on_the_jump_and_their_densities_lie_where_the_sweep_has_them() {
    let sweep = prepared(BELT, "");
    let never = Cancellation::new();
    let source = sweep.source(&never).unwrap();
    let want = Want {
        errors: true,
        ..Want::densities(sweep.problem.observables())
    };
    let finer = source.finer(&want).unwrap().unwrap();
    let mut session = finer.open(&never);
    for theta in [0.03, 0.1, 0.23] {
        let solution = session.solve(theta).unwrap().detached();
        let of_y = &solution.densities[0];
        let axis = &of_y.density.axes[0];
        let nearest = axis.edges().iter().map(|edge| (edge - theta).abs());
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-9, "{theta}");
        assert!((of_y.structure.kinks[0].at - theta).abs() < 1e-9);
        // The exact density, averaged over cells by Simpson's rule, in which the jump is no cell's inner point.
        let log = |y: f64| {
            let energy = y.powi(4) / 4.0 - 0.3 * y * y - theta * y / 2.0 + 0.1 * (y - theta).abs();
            -2.0 * energy / 0.16
        };
        let cells = axis.edges().windows(2);
        let masses = cells.map(|ends| {
            let middle = 0.5 * (ends[0] + ends[1]);
            let [a, m, b] = [ends[0], middle, ends[1]].map(|y| log(y).exp());
            (ends[1] - ends[0]) * (a + 4.0 * m + b) / 6.0
        });
        let masses: Vec<f64> = masses.collect();
        let total: f64 = masses.iter().sum();
        let own = of_y.density.masses();
        let apart = own
            .iter()
            .zip(&masses)
            .map(|(one, other)| (one - other / total).abs());
        let apart: f64 = 0.5 * apart.sum::<f64>();
        let widths = axis.edges().windows(2).map(|ends| ends[1] - ends[0]);
        let stated = of_y.stated_errors().into_iter().zip(widths);
        let stated: f64 = 0.5 * stated.map(|(error, width)| error * width).sum::<f64>();
        assert!(
            apart < stated && stated < 1e-4,
            "{theta}: {apart:e} {stated:e}"
        );
    }
}
