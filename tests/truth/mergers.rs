//! Peaks that merge away from any centre of symmetry, where densities depend on the energy: pitchforks in systems that
//! are not symmetric; folds that are hardly any; and craters that become peaks.

use pbif::continuation::BifurcationStatus;

use crate::common::sweeps::{rows, swept};

/// The integral of a function from -8 to 8: what is integrated falls off like a normal density.
fn integral(function: impl Fn(f64) -> f64) -> f64 {
    let step = 2e-3;
    (-4000..=4000)
        .map(|at| function(f64::from(at) * step))
        .sum::<f64>()
        * step
}

/// The zero of a function that changes its sign between two places.
fn zero(function: impl Fn(f64) -> f64, (mut from, mut to): (f64, f64)) -> f64 {
    let below = function(from) < 0.0;
    for _ in 0..50 {
        let middle = 0.5 * (from + to);
        if (function(middle) < 0.0) == below {
            from = middle;
        } else {
            to = middle;
        }
    }
    0.5 * (from + to)
}

/// x'' = -V'(x) - (q + 0.6 H) x' + √0.3 ξ with the energy H = x'²/2 + V, V = x²/2 - 0.2 x³ + 0.1 x⁴: the density is
/// proportional to exp(-(q H + 0.3 H²)/0.15). That of x has two peaks, either side of the state of rest x = 0, which
/// merge there; that of y = x' has two that merge at y = 0. V is no mirror image of itself, and neither are the
/// equations, of y least of all.
#[test]
fn peaks_of_an_oscillator_whose_damping_follows_its_energy_merge_where_they_should() {
    let potential = |x: f64| x * x / 2.0 - 0.2 * x.powi(3) + 0.1 * x.powi(4);
    let force = "(x - 0.6 x^2 + 0.4 x^3)";
    let energy = "(y^2/2 + x^2/2 - 0.2 x^3 + 0.1 x^4)";
    // The damping over all states with V, or with y²/2, of the state of rest.
    let mean = |of: &dyn Fn(f64) -> f64, q: f64| {
        integral(|at| {
            let h = of(at);
            (q + 0.6 * h) * (-(q * h + 0.3 * h * h) / 0.15).exp()
        })
    };
    let of_x = zero(|q| mean(&|y| y * y / 2.0, q), (-0.6, 0.0));
    let of_y = zero(|q| mean(&potential, q), (-0.6, 0.0));
    let text = format!(
        "[system.equations]\nx = \"y\"\ny = \"-{force} - (q + 0.6 {energy}) y\"\n[system.noise]\ny = \"sqrt(0.3)\"\n\
         [system.parameters]\nq = 0\n[sweep]\nparameter = \"q\"\nfrom = -0.4\nto = 0.05\npoints = 6\n\
         [cells]\nx = {{ from = -3, to = 3.6, count = 80 }}\ny = {{ from = -3.2, to = 3.2, count = 80 }}\n\
         [detect]\nmarginals = [\"x\", \"y\"]\njoint = []\n[locate]\nrelative_tolerance = 1e-3\n"
    );
    let (_, result) = swept(&text, "");
    for (name, exact) in [("x", of_x), ("y", of_y)] {
        let [row] = rows(&result, name)[..] else {
            panic!("one change of {name}");
        };
        assert_eq!((row.before.peaks, row.after.peaks), (2, 1), "{name}");
        assert_eq!(row.status(), BifurcationStatus::Located, "{name} {row:?}");
        let off = (row.value - exact).abs();
        assert!(
            off <= row.error,
            "{name}: {off:e} of {:e}, exact {exact}",
            row.error
        );
    }
}

/// Along x the density is that of x' = d + q x - x³: without d one peak splits at q = 0, with it a second one is born
/// at q = 3 (d/2)^(2/3). A slope of d that is no more than errors of the density leaves the two apart by that much.
#[test]
fn a_fold_that_is_hardly_apart_from_a_split_is_held_by_its_error() {
    for d in [1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2_f64] {
        let exact = 3.0 * (0.5 * d).powf(2.0 / 3.0);
        // A rotation that leaves the density as it is couples the two: no equation has a profile.
        let text = format!(
            "[system.define]\nfx = \"-d - q x + x^3\"\n[system.equations]\nx = \"-fx + 0.5 y\"\ny = \"-y - 0.5 fx\"\n\
             [system.noise]\nx = \"0.5\"\ny = \"0.5\"\n[system.parameters]\nq = 0\nd = {d}\n[sweep]\n\
             parameter = \"q\"\nfrom = -0.33\nto = 0.37\npoints = 6\n\
             [cells]\nx = {{ from = -1.9, to = 1.9, count = 60 }}\ny = {{ from = -1.8, to = 1.8, count = 50 }}\n\
             [detect]\nmarginals = [\"x\"]\njoint = []\n"
        );
        let (_, result) = swept(&text, "");
        let [row] = rows(&result, "x")[..] else {
            panic!("{d:e}: one change");
        };
        let (lower, upper) = (row.lower, row.upper);
        println!(
            "{d:e}: {} ± {:.1e}, exact {exact}, {:?}",
            row.value,
            row.error,
            row.status()
        );
        assert!(
            (lower..=upper).contains(&exact),
            "{d:e}: exact {exact}, {row:?}"
        );
        let is_located = row.status() == BifurcationStatus::Located;
        assert!(
            !is_located || (row.value - exact).abs() <= row.error,
            "{d:e}: exact {exact}, {row:?}"
        );
    }
}

/// x'' = -V'(x) - (q + H) x' + √0.2 ξ with a double well V that is lower on the right: the density has a ring where
/// H = -q, which goes around craters at the lowest points of both wells as long as that is above the valley between
/// them. At q = -V of the left one its crater becomes a peak. Just before, at q = -V of the valley, the ring parts:
/// one step of the sweep has both.
#[test]
fn a_crater_beside_another_becomes_a_peak_at_its_state_of_rest() {
    let potential = |x: f64| 0.16 * x.powi(4) - 0.28 * x * x - 0.15 * x;
    let slope = |x: f64| 0.64 * x.powi(3) - 0.56 * x - 0.15;
    let [left, valley] = [(-1.0, -0.55), (-0.5, 0.0)].map(|ends| -potential(zero(slope, ends)));
    let text = "[system.define]\nH = \"y^2/2 + 0.16 x^4 - 0.28 x^2 - 0.15 x\"\n[system.equations]\nx = \"y\"\n\
                y = \"-0.64 x^3 + 0.56 x + 0.15 - (q + H) y\"\n[system.noise]\ny = \"sqrt(0.2)\"\n\
                [system.parameters]\nq = 0\n[sweep]\nparameter = \"q\"\nfrom = -0.6\nto = 0.2\npoints = 9\n\
                [cells]\nx = { from = -2.4, to = 2.8, count = 100 }\ny = { from = -2.4, to = 2.4, count = 90 }\n\
                [detect]\nmarginals = []\njoint = [[\"x\", \"y\"]]\n[locate]\neffort = 0\n\
                relative_tolerance = 1e-3\n";
    let (_, result) = swept(text, "");
    assert!(valley < left);
    let all = rows(&result, "xy");
    let row = all
        .iter()
        .find(|row| row.before.craters > row.after.craters);
    let row = row.expect("a crater that closes");
    assert_eq!((row.before.peaks, row.after.peaks), (0, 1), "{row:?}");
    assert_eq!(row.status(), BifurcationStatus::Located, "{row:?}");
    let off = (row.value - left).abs();
    assert!(off <= row.error, "{off:e} of {:e}, exact {left}", row.error);
}

/// A crater between three peaks becomes a peak where both curvatures vanish together too, at q = 0. Third derivatives
/// are not zero there: no ring is about it, and what is read where they vanish would be off.
#[test]
fn a_crater_between_three_peaks_is_not_located_where_third_derivatives_vanish() {
    let text = "[system.equations]\nx = \"-x (x^2 + y^2) - q x - 0.9 (x^2 - y^2)\"\n\
                y = \"-y (x^2 + y^2) - q y + 1.8 x y\"\n[system.noise]\nx = \"sqrt(0.1)\"\ny = \"sqrt(0.1)\"\n\
                [system.parameters]\nq = 0\n[sweep]\nparameter = \"q\"\nfrom = -0.1\nto = 0.12\npoints = 6\n\
                [cells]\nx = { from = -2.3, to = 2.1, count = 80 }\ny = { from = -2.2, to = 2.2, count = 80 }\n\
                [detect]\nmarginals = []\njoint = [[\"x\", \"y\"]]\n[locate]\neffort = 0\n";
    let (_, result) = swept(text, "");
    let all = rows(&result, "xy");
    assert!(!all.is_empty());
    for row in all {
        let is_located = row.status() == BifurcationStatus::Located;
        assert!((row.lower..=row.upper).contains(&0.0), "{row:?}");
        assert!(!is_located || row.value.abs() <= row.error, "{row:?}");
    }
}
