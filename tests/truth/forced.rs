//! Systems under a periodic force: what is called located against exact answers.

use crate::common::numbers::{Numbers, given};
use crate::common::sweeps::{measure, rows, solved, swept};
use pbif::continuation::BifurcationStatus;
use pbif::density::Density;

/// Amplitude over standard deviation from where on the density of a moving normal density has two peaks over a period:
/// the zero of the confluent hypergeometric function ₁F₁(3/2; 1; -r²/2), by its series.
fn ratio() -> f64 {
    let series = |r: f64| {
        let mut term = 1.0;
        let terms = (0..100).map(|n| {
            let n = f64::from(n);
            term *= -(1.5 + n) / ((1.0 + n) * (1.0 + n)) * 0.5 * r * r;
            term
        });
        1.0 + terms.sum::<f64>()
    };
    let (mut low, mut high) = (1.7, 1.85);
    assert!(series(low) > 0.0 && series(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if series(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[test]
fn the_split_over_a_period_of_random_linear_systems_is_within_its_error() {
    let mut dice = Numbers(given("OTHER_SEEDS", 300));
    let mut between = |from, to| dice.between(from, to);
    for case in 0..6 {
        let (k, w, d) = (
            between(0.3, 2.0),
            between(0.2, 4.0),
            10.0_f64.powf(between(-2.0, 0.0)),
        );
        // x' = -k x + A cos(w t) moves with the amplitude A/√(k² + w²), with the variance D/k about it.
        let exact = ratio() * (d / k).sqrt() * k.hypot(w);
        let (from, to) = (exact * between(0.4, 0.8), exact * between(1.2, 1.6));
        let text = format!(
            "[system.equations]\nx = \"-k x + A cos(w t)\"\n[system.noise]\nx = \"sqrt(2 D)\"\n\
             [system.parameters]\nk = {k}\nw = {w}\nD = {d}\n\
             [sweep]\nparameter = \"A\"\nfrom = {from}\nto = {to}\npoints = 9\n\
             [detect]\nmarginals = [\"x @ mean\", \"x @ phase 1/8\"]\n"
        );
        let (_, result) = swept(&text, "");
        assert_eq!(rows(&result, "x_phase_1_8").len(), 0, "{case}");
        let [row] = rows(&result, "x")[..] else {
            panic!("{case}: one change of the density over the period\n{text}");
        };
        let off = (row.value - exact).abs();
        println!(
            "{case}: {} ± {:.1e}, off by {off:.1e}",
            row.value, row.error
        );
        assert_eq!(row.status(), BifurcationStatus::Located, "{case}");
        assert!(off <= row.error, "{case}: {off:e} of {:e}", row.error);
        assert!(row.error < 3e-4 * exact, "{case}: {:e}", row.error);
    }
}

/// Half of the L1 distance between a density over a period and that of a place that is normal, with this deviation,
/// about a mean that moves as a cosine with this amplitude.
fn off_by(density: &Density, amplitude: f64, deviation: f64) -> f64 {
    let below = |x: f64| 0.5 * statrs::function::erf::erfc(-x / deviation / 2_f64.sqrt());
    let phases = 400;
    let edges = density.axes[0].edges();
    let cells = edges.windows(2).zip(density.masses());
    let distances = cells.map(|(edge, mass)| {
        let at = |step: i32| {
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(phases);
            let mean = amplitude * angle.cos();
            below(edge[1] - mean) - below(edge[0] - mean)
        };
        (mass - (0..phases).map(at).sum::<f64>() / f64::from(phases)).abs()
    });
    0.5 * distances.sum::<f64>()
}

/// Each has both of its splits located and its densities known; more systems only find that other numbers do as well.
#[test]
fn splits_over_a_period_of_random_linear_oscillators_are_within_their_errors() {
    assert_splits(0..1);
}

#[test]
#[ignore = "a minute: the same of more systems"]
fn splits_over_a_period_of_random_linear_oscillators_at_length() {
    assert_splits(1..4);
}

fn assert_splits(cases: std::ops::Range<usize>) {
    let mut dice = Numbers(given("OTHER_SEEDS", 310));
    let mut between = |from, to| dice.between(from, to);
    for case in 0..cases.end {
        let (k, g, w) = (between(0.5, 2.0), between(0.3, 1.2), between(0.4, 2.0));
        let temperature = 10.0_f64.powf(between(-1.0, 0.5));
        // x'' = -g x' - k x + F cos(w t) + √(2 g T) ξ: variances T/k of x and T of y about means that move with the
        // amplitudes F/Z and w F/Z.
        if !cases.contains(&case) {
            continue;
        }
        let resistance = (k - w * w).hypot(g * w);
        let deviations = [(temperature / k).sqrt(), temperature.sqrt()];
        let amplitudes = [1.0 / resistance, w / resistance];
        let exact: Vec<f64> = (0..2)
            .map(|axis| ratio() * deviations[axis] / amplitudes[axis])
            .collect();
        let from = 0.7 * exact[0].min(exact[1]);
        let to = 1.2 * exact[0].max(exact[1]);
        let text = format!(
            "[system.equations]\nx = \"y\"\ny = \"-g y - k x + F cos(w t)\"\n\
             [system.noise]\ny = \"sqrt(2 g T)\"\n\
             [system.parameters]\nk = {k}\ng = {g}\nw = {w}\nT = {temperature}\n\
             [sweep]\nparameter = \"F\"\nfrom = {from}\nto = {to}\npoints = 5\n\
             [detect]\nmarginals = [\"x @ mean\", \"y @ mean\"]\njoint = []\n\
             [locate]\nrelative_tolerance = 0.01\n"
        );
        let (_, result) = swept(&text, "");
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let [row] = rows(&result, name)[..] else {
                panic!("{case}: one change of {name} over the period\n{text}");
            };
            let off = (row.value - exact[axis]).abs();
            println!(
                "{case} {name}: {} ± {:.1e}, off by {off:.1e}",
                row.value, row.error
            );
            assert_eq!(row.status(), BifurcationStatus::Located, "{case} {name}");
            assert!(off <= row.error, "{case}: {off:e} of {:e}", row.error);
        }
        for point in [&result.points[0], &result.points[result.points.len() - 1]] {
            for axis in 0..2 {
                let density = &point.densities[axis].density;
                let off = off_by(density, point.value * amplitudes[axis], deviations[axis]);
                // What is asked of the cells, `cells.accuracy`.
                assert!(off < 1e-3, "{case}, {}, {axis}: {off:e}", point.value);
            }
        }
    }
}

#[test]
fn paths_under_a_force_forget_their_start_before_they_are_counted() {
    // x'' + g x' + x = F cos w t: the amplitude of the mean is F/√((1 - w²)² + g² w²), and deviations forget slowly.
    let (g, w, force): (f64, f64, f64) = (0.04, 1.05, 0.25);
    let text = format!(
        "[system.equations]\nx = \"y\"\ny = \"-g y - x + F cos(w t)\"\n[system.noise]\ny = \"sqrt(0.2 g)\"\n\
         [system.parameters]\ng = {g}\nw = {w}\nF = {force}\n[sweep]\nparameter = \"F\"\nfrom = 0.2\nto = {force}\n\
         points = 2\n[method]\nkind = \"monte-carlo\"\nerror = 0.01\n[detect]\nmarginals = [\"x @ mean\"]\njoint = []\n"
    );
    let (_, solution) = solved(&text, "figures.draw=[]", None);
    let (found, error) = measure(&solution, "amplitude_x");
    let exact = force / ((1.0 - w * w).powi(2) + (g * w).powi(2)).sqrt();
    let off = (found - exact).abs();
    assert!(
        off < 3.5 * error && error < 0.01 * exact,
        "{found} ± {error}, exact {exact}"
    );
}

/// Of a symmetric well one of two neighbouring harmonics moves means alone, and the other deviations.
#[test]
fn moments_at_phases_are_off_by_no_more_than_few_harmonics_say() {
    let solve = |modes: usize| {
        let text = format!(
            "[system.equations]\nx = \"x - x^3 + 0.3 cos(0.1 t)\"\n[system.noise]\nx = \"sqrt(2 D)\"\n\
             [system.parameters]\nD = 0.12\n[sweep]\nparameter = \"D\"\nfrom = 0.11\nto = 0.12\npoints = 2\n\
             [detect]\nmarginals = [\"x @ phase 0\", \"x @ phase 1/8\", \"x @ phase 3/8\"]\n\
             [cells]\nx = {{ from = -2.5, to = 2.5, count = 100 }}\nt = {{ modes = {modes} }}\n"
        );
        solved(&text, "figures.draw=[]", None).1
    };
    let many = solve(24);
    for modes in [4, 5, 6, 8] {
        let few = solve(modes);
        for moment in ["mean", "sd"] {
            for phase in ["0", "1_8", "3_8"] {
                let name = format!("{moment}_x_phase_{phase}");
                let [(value, error), (exact, _)] = [&few, &many].map(|one| measure(one, &name));
                let off = (value - exact).abs();
                assert!(off <= error, "{modes} {name}: {off:e} of {error:e}");
            }
        }
    }
}

#[test]
fn an_amplitude_has_the_error_of_the_ends_of_the_range() {
    // x' = -k x + A cos(w t): the mean moves with A/√(k² + w²), about which the density has the deviation √(D/k). Three
    // to four and a half deviations beyond it what is cut off shifts the mean by far more than cells do.
    let (k, w, d, a) = (1.0_f64, 0.5_f64, 0.25_f64, 0.4_f64);
    let exact = a / k.hypot(w);
    for reach in [3.0, 3.7, 4.5] {
        let end = exact + reach * (d / k).sqrt();
        let text = format!(
            "[system.equations]\nx = \"-k x + A cos(w t)\"\n[system.noise]\nx = \"sqrt(2 D)\"\n\
             [system.parameters]\nk = {k}\nw = {w}\nD = {d}\nA = {a}\n\
             [sweep]\nparameter = \"A\"\nfrom = 0.1\nto = {a}\npoints = 2\n\
             [cells]\nx = {{ from = -{end}, to = {end}, count = 80 }}\n"
        );
        let (_, solution) = solved(&text, "", None);
        for (name, exact) in [
            ("amplitude_x", exact),
            ("amplification_x", (exact / a).powi(2)),
        ] {
            let (value, error) = measure(&solution, name);
            println!("{reach} {name}: {value} ± {error:.1e}, exact {exact}");
            assert!(
                (value - exact).abs() <= error,
                "{reach} {name}: {value} ± {error:e}"
            );
        }
    }
}
