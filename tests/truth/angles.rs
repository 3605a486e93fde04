//! Angles through sweep files: changes of a density on a circle at exact values, wherever the seam is.

use std::f64::consts::TAU;

use crate::common::sweeps::{measure, rows, solved, swept};
use pbif::continuation::{BifurcationStatus, Finding};

/// θ' = -sin u - b sin 2u, u = θ - s, with white noise of intensity 2 D: p ∝ exp((cos u + (b/2) cos 2u)/D).
fn circle(shift: f64, d: f64) -> String {
    let (double, noise) = (2.0 * shift, (2.0 * d).sqrt());
    format!(
        "[system.equations]\ntheta = \"-sin(theta - {shift}) - b sin(2 theta - {double})\"\n\
         [system.noise]\ntheta = \"{noise}\"\n[system.bounds]\ntheta = \"periodic\"\n\
         [sweep]\nparameter = \"b\"\nfrom = -1.1\nto = 1.3\npoints = 13\n"
    )
}

#[test]
fn both_places_that_a_reflection_holds_change_where_they_do() {
    // The curvature of the exponent is -1 - 2b at u = 0 and 1 - 2b half a turn from it.
    for (shift, d) in [(0.0, 1.0), (1.2, 1.0), (-2.6, 0.4)] {
        let (_, result) = swept(&circle(shift, d), "");
        let found = rows(&result, "theta");
        let [split, birth] = found[..] else {
            panic!("{shift} {d}: two changes: {found:?}");
        };
        for (row, exact) in [(split, -0.5), (birth, 0.5)] {
            let off = (row.value - exact).abs();
            // A centre inside a bin is read less well: what is known of it by finer harmonics may not tell more.
            let is_located = row.status() == BifurcationStatus::Located;
            assert!(is_located || shift != 0.0, "{shift} {d} {row:?}");
            assert!(off <= row.error && row.error < 1e-3, "{shift} {d}: {row:?}");
        }
        let peaks = |signature: pbif::topology::Signature| signature.peaks;
        assert_eq!([split.before, split.after].map(peaks), [2, 1]);
        assert_eq!([birth.before, birth.after].map(peaks), [1, 2]);
    }
}

#[test]
fn a_pair_is_born_at_the_fold_of_the_potential_wherever_the_seam_is() {
    // θ' = -sin u - 0.8 sin(2u + b): no symmetry. The valley and the peak of the equilibrium density p ∝ e^{-U/D} are
    // equilibria, born where sin u + 0.8 sin(2u + b) and its derivative vanish together.
    let force = |u: f64, b: f64| u.sin() + 0.8 * (2.0 * u + b).sin();
    let slope = |u: f64, b: f64| u.cos() + 1.6 * (2.0 * u + b).cos();
    let (mut u, mut b) = (2.6, 1.0);
    for _ in 0..50 {
        let (f, g) = (force(u, b), slope(u, b));
        let (fu, fb) = (g, 0.8 * (2.0 * u + b).cos());
        let (gu, gb) = (
            -u.sin() - 3.2 * (2.0 * u + b).sin(),
            -1.6 * (2.0 * u + b).sin(),
        );
        let determinant = fu * gb - fb * gu;
        u -= (f * gb - fb * g) / determinant;
        b -= (fu * g - gu * f) / determinant;
    }
    assert!(force(u, b).abs() < 1e-12 && slope(u, b).abs() < 1e-12);
    let mut values = Vec::new();
    for shift in [0.0, 0.7, 3.0] {
        let text = format!(
            "[system.equations]\ntheta = \"-sin(theta - {shift}) - 0.8 sin(2 theta - {} + b)\"\n\
             [system.noise]\ntheta = \"sqrt(2)\"\n[system.bounds]\ntheta = \"periodic\"\n\
             [sweep]\nparameter = \"b\"\nfrom = {}\nto = {}\npoints = 9\n",
            2.0 * shift,
            b - 0.31,
            b + 0.33
        );
        let (_, result) = swept(&text, "");
        let [row] = rows(&result, "theta")[..] else {
            panic!("{shift}: one change");
        };
        assert_eq!(row.status(), BifurcationStatus::Located, "{shift} {row:?}");
        let off = (row.value - b).abs();
        assert!(off <= row.error && row.error < 1e-3, "{shift} {b}: {row:?}");
        values.push(row.value);
    }
    println!("{b} {values:?}");
}

/// The theta neuron, θ' = 1 - cos θ + (1 + cos θ) (I + σ ξ) in Stratonovich's reading: x = tan(θ/2) obeys
/// x' = x² + I + σ ξ, so that p(x) ∝ ∫₀^∞ exp(-(2/σ²)(u³/3 + x u² + (x² + I) u)) du. Noise dies at θ = π.
#[test]
fn a_theta_neuron_has_its_exact_density_and_no_doubt_in_its_harmonics() {
    let text = "[system.equations]\ntheta = \"1 - cos(theta) + (1 + cos(theta)) I\"\n\
         [system.noise]\ntheta = \"s (1 + cos(theta))\"\ninterpretation = \"stratonovich\"\n\
         [system.parameters]\nI = 0.1\ns = 0.5\n[system.bounds]\ntheta = \"periodic\"\n\
         [sweep]\nparameter = \"I\"\nfrom = -0.5\nto = 0.5\npoints = 3\n";
    for current in [-0.5, 0.0, 0.5] {
        let exact = |theta: f64| {
            let x = (0.5 * theta).tan();
            let scale = 1.0 + x * x;
            let integrand = |s: f64| {
                let u = s / scale;
                (-8.0 * u * (u * u / 3.0 + x * u + x * x + current)).exp()
            };
            let (step, half_steps) = (0.005, 2000);
            let terms = (0..half_steps).map(|term| {
                let s = 2.0 * step * f64::from(term);
                integrand(s) + 4.0 * integrand(s + step) + integrand(s + 2.0 * step)
            });
            terms.sum::<f64>()
        };
        let (_, solution) = solved(text, "", Some(current));
        let doubtful = solution.report.findings.iter();
        let few = doubtful.filter(|one| matches!(one, Finding::FewModes { .. }));
        assert_eq!(few.count(), 0, "{current}");
        let density = &solution.densities[0].density;
        let cells = density.axes[0].edges().windows(2);
        let masses = cells.map(|ends| {
            let values = [ends[0], 0.5 * (ends[0] + ends[1]), ends[1]].map(exact);
            (ends[1] - ends[0]) * (values[0] + 4.0 * values[1] + values[2]) / 6.0
        });
        let masses: Vec<f64> = masses.collect();
        let total: f64 = masses.iter().sum();
        let pairs = density.masses().into_iter().zip(&masses);
        let apart = 0.5
            * pairs
                .map(|(own, exact)| (own - exact / total).abs())
                .sum::<f64>();
        assert!(apart < 1e-6, "{current}: {apart:e}");
    }
}

/// Two rotors in a field, coupled by the second harmonic: exp(-2 U), U = -cos a - cos b - k cos(2 a - 2 b).
const TWO_ROTORS: &str = r#"
[system.equations]
a = "-sin(a) - 2 k sin(2 a - 2 b)"
b = "-sin(b) + 2 k sin(2 a - 2 b)"
[system.noise]
a = "1"
b = "1"
[system.bounds]
a = "periodic"
b = "periodic"
[sweep]
parameter = "k"
from = 0.36
to = 0.54
points = 4
[detect]
marginals = []
"#;

#[test]
fn as_many_harmonics_of_two_angles_are_chosen_as_their_density_needs() {
    let (sweep, result) = swept(TWO_ROTORS, "");
    // A constant, and two functions a harmonic.
    let functions = sweep.problem.space().axes()[0].count();
    assert!((33..=49).contains(&functions), "{functions}");
    // On a = -b, where 2 sin a + 4 k sin 4a and its derivative vanish: tan² a = 5.
    let a = 5.0_f64.sqrt().atan();
    let exact = -0.5 * a.sin() / (4.0 * a).sin();
    let found = rows(&result, "ab");
    let [fold] = found[..] else {
        panic!("{} rows", found.len());
    };
    assert_eq!(fold.status(), BifurcationStatus::Located);
    assert!((fold.value - exact).abs() < fold.error && fold.error < 1e-4);

    let words = "sweep.from=-0.8 sweep.to=-0.7 detect.marginals=[\"a\"] detect.joint=[]";
    let (_, result) = swept(TWO_ROTORS, words);
    let found = rows(&result, "a");
    let [split] = found[..] else {
        panic!("{} rows", found.len());
    };
    // The density of a, ∫ exp(-2 U) db, is flat at 0 there: the trapezoidal rule of 200 nodes and a bisection.
    let curvature = |k: f64| -> f64 {
        let nodes = (0..200).map(|node| f64::from(node) * TAU / 200.0);
        let terms = nodes.map(|b| {
            let slope = 4.0 * k * (2.0 * b).sin();
            (slope * slope - 2.0 - 8.0 * k * (2.0 * b).cos())
                * (2.0 * b.cos() + 2.0 * k * (2.0 * b).cos()).exp()
        });
        terms.sum()
    };
    let (mut low, mut high) = (-0.8, -0.7);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let is_below = curvature(middle) * curvature(low) > 0.0;
        *(if is_below { &mut low } else { &mut high }) = middle;
    }
    assert_eq!(split.status(), BifurcationStatus::Located);
    assert!(
        (split.value - low).abs() < split.error,
        "{} ± {}, {low}",
        split.value,
        split.error
    );
}

/// ⟨cos φ⟩ of p ∝ exp(cos(φ)/D).
fn of_gibbs(d: f64) -> f64 {
    let places = (0..2000).map(|place| (TAU * f64::from(place) / 2000.0).cos());
    let (whole, first) = places.fold((0.0, 0.0), |(whole, first), cosine| {
        let weight = ((cosine - 1.0) / d).exp();
        (whole + weight, first + weight * cosine)
    });
    first / whole
}

#[test]
fn means_of_formulas_of_an_angle_have_an_error_of_its_harmonics() {
    for (d, modes) in [(0.1, 8), (0.2, 6), (0.05, 12), (0.3, 6), (0.5, 5), (1.0, 4)] {
        let text = format!(
            "[system.equations]\nphi = \"-w sin(phi)\"\n[system.noise]\nphi = \"sqrt(2*{d})\"\n\
             [system.bounds]\nphi = \"periodic\"\n[sweep]\nparameter = \"w\"\nfrom = 0.9\nto = 1.0\n\
             points = 2\n[cells]\nphi = {{ modes = {modes} }}\n[watch]\nc = \"cos(phi)\"\n"
        );
        let (_, solution) = solved(&text, "", None);
        let (value, error) = measure(&solution, "mean_c");
        let exact = of_gibbs(d);
        assert!(
            (value - exact).abs() <= error + 1e-12,
            "{d} {modes}: {value} ± {error:e}, {exact}"
        );
    }
}
