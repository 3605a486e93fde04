//! What the ends of ranges that are too narrow do to densities, shares of the time, entropies and transitions against
//! linear oscillators, whose density is normal, also of the noise that drives them; and to counts of peaks.

use std::f64::consts::{E, PI};

use pbif::continuation::Solution;
use pbif::topology::{DetectOptions, Detector as _, FeatureKind, PersistenceDetector, Verdict};
use statrs::function::erf::erfc;

use crate::common::sweeps::{measure, solved, swept};

/// x'' = -k x' - x + √(2 k) ξ with the velocity cut off at so many deviations.
fn cut_off(k: f64, deviations: f64) -> Solution<'static> {
    let text = format!(
        "[system.equations]\nx = \"y\"\ny = \"-x - k y\"\n[system.noise]\ny = \"sqrt(2 k)\"\n\
         [system.parameters]\nk = {k}\n[sweep]\nparameter = \"k\"\nfrom = {k}\nto = {}\npoints = 2\n\
         [cells]\nx = {{ from = -6, to = 6, count = 80 }}\n\
         y = {{ from = -{deviations}, to = {deviations}, count = 64 }}\n\
         [detect]\nmeasures = [\"entropy\"]\n[visits]\nfar = \"x > 1.5\"\n",
        1.1 * k
    );
    solved(&text, "", Some(k)).1
}

/// Probability of values above x.
fn above(x: f64) -> f64 {
    0.5 * erfc(x / 2f64.sqrt())
}

/// Half of what is stated is what leaves and stays beside the ends; it is taken twice.
#[test]
fn what_leaves_through_the_ends_is_a_part_of_all_errors() {
    for (k, deviations) in [
        (0.35, 3.5),
        (0.35, 4.5),
        (0.05, 4.5),
        (0.05, 5.0),
        (0.35, 5.5),
    ] {
        let solution = cut_off(k, deviations);
        let words = format!("k = {k}, {deviations} deviations");
        for density in &solution.densities[..2] {
            let [axis] = density.density.axes.as_slice() else {
                panic!("{words}: not of one axis");
            };
            let errors = density.stated_errors();
            let exact = axis
                .edges()
                .windows(2)
                .map(|edge| (above(edge[0]) - above(edge[1])) / (edge[1] - edge[0]));
            for (cell, exact) in exact.enumerate() {
                let off = (density.density.values[cell] - exact).abs();
                assert!(
                    off <= errors[cell],
                    "{words}: {} in {cell}",
                    off / errors[cell]
                );
            }
        }
        let exact = [
            ("far_time_share", above(1.5)),
            ("far_visits", (-0.5 * 1.5_f64.powi(2)).exp() / (2.0 * PI)),
            ("entropy_xy", (2.0 * PI * E).ln()),
        ];
        for (name, exact) in exact {
            let (value, error) = measure(&solution, name);
            let ratio = (value - exact).abs() / error;
            assert!(ratio <= 1.0, "{words}: {name} {ratio}");
            // An error that is a part of the ends' holds, and says how large they are.
            let is_of_ends = deviations < 5.0;
            assert!(!is_of_ends || ratio > 0.3, "{words}: {name} {ratio}");
        }
    }
}

/// Values of a sweep are solved with factors of their neighbours, and each has its part: the share of the time above
/// 0.513 is 0.15 at m = -0.0925942, by the error function.
#[test]
fn a_level_of_a_share_has_the_ends_in_its_error_all_along_a_sweep() {
    let text = "[sweep]\nparameter = \"m\"\nfrom = -0.3\nto = 0.1\npoints = 9\n[system.equations]\nx = \"y\"\n\
                y = \"-1.45 (x - m) - 1.01 y\"\n[system.noise]\ny = \"1\"\n[system.parameters]\nm = 0\n\
                [cells]\nx = { from = -2.85, to = 2.6, count = 100 }\ny = { from = -3.03, to = 3.03, count = 100 }\n\
                [visits]\nhi = \"x > 0.513\"\n[levels]\nhi_time_share = 0.15\n[locate]\nrelative_tolerance = 1e-3\n";
    let (_, result) = swept(text, "");
    let deviation = (1.0 / (2.0 * 1.01 * 1.45_f64)).sqrt();
    let errors = result.points.iter().map(|point| {
        let family = &result.subject.family;
        assert_eq!(family.parameter(), "m");
        let exact = above((0.513 - point.value) / deviation);
        let mut measures = point.report.measures.iter();
        let share = measures.find(|one| one.name == "hi_time_share").unwrap();
        let error = share.error.unwrap();
        let ratio = (share.value - exact).abs() / error;
        assert!((0.3..1.0).contains(&ratio), "{}: {ratio}", point.value);
        error
    });
    let errors: Vec<f64> = errors.collect();
    let largest = errors.iter().copied().fold(0.0, f64::max);
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(largest < 2.0 * least, "{least} {largest}");
}

/// Noise of deviation 1 that modes carry drives an oscillator whose range ends where some of its states are: what is
/// cut off goes with noise that is larger than elsewhere, and before, its moments were off by eight of their errors.
#[test]
fn ends_of_one_axis_are_a_part_of_the_errors_of_another() {
    for (stiffness, damping, tau, [from, to], depth) in [
        (1.013, 1.03, 0.827, [-4.34, 4.34], 2.16),
        (1.737, 0.99, 1.004, [-3.24, 1.96], 3.02),
        (0.8, 0.6, 0.5, [-4.5, 4.5], 4.5),
    ] {
        let text = format!(
            "[system.equations]\nx = \"y\"\ny = \"-{stiffness} x - k y\"\n[system.noise]\n\
             kind = \"ornstein-uhlenbeck\"\ny = \"sqrt(2 tau)\"\n[system.parameters]\nk = {damping}\ntau = {tau}\n\
             [sweep]\nparameter = \"k\"\nfrom = {damping}\nto = 2\npoints = 2\n\
             [cells]\nx = {{ from = {from}, to = {to}, count = 60 }}\n\
             y = {{ from = -{depth}, to = {depth}, count = 64 }}\nnoise = {{ modes = 8 }}\n\
             [detect]\nmarginals = [\"x\"]\njoint = []\n"
        );
        let (_, solution) = solved(&text, "", Some(damping));
        for (name, exact) in [("mean_noise", 0.0), ("sd_noise", 1.0)] {
            let (value, error) = measure(&solution, name);
            let off = (value - exact).abs();
            let words = format!("{stiffness} {damping}: {name} {value} +- {error}");
            assert!(off <= error && error < 0.01, "{words}");
            // What the ends of both axes make of the deviation is what it is off by.
            assert!(name == "mean_noise" || off > 0.05 * error, "{words}");
        }
    }
}

/// A well with a second one beside an end of y, in which the density is no higher than at that end: what is left of its
/// peak lies where no critical point is, and the density there is a third of what it is without the end. It is not
/// counted, and the peak that is there on the whole range is.
#[test]
fn a_peak_that_is_no_higher_than_the_density_at_an_open_end_is_not_counted() {
    let [stiff, lean, turn, drift] = [1.5786, 0.5378, -0.1931, 0.1716];
    let of_y = format!("({stiff} (y - {lean} x))");
    let of_x = format!("(x^3 - x - {drift} - {lean} {of_y})");
    let text = format!(
        "[system.equations]\nx = \"q - {of_x} + ({turn}) {of_y}\"\ny = \"-{of_y} - ({turn}) {of_x}\"\n\
         [system.noise]\nx = \"0.48383\"\ny = \"0.48383\"\n[system.parameters]\nq = 0\n\
         [sweep]\nparameter = \"q\"\nfrom = 0\nto = 1\npoints = 2\n\
         [cells]\nx = {{ from = -1.79, to = 1.87, count = 71 }}\n"
    );
    let counted = |cells: &str| {
        let text = format!("{text}{cells}\n[detect]\nmarginals = []\njoint = [[\"x\", \"y\"]]\n");
        let (_, solution) = solved(&text, "", Some(0.0));
        let found =
            PersistenceDetector::new(DetectOptions::default(), 1).detect(&solution.densities[0]);
        let of = |verdict| {
            let features = found.features.iter();
            let all =
                features.filter(|one| one.kind == FeatureKind::Peak && one.verdict == verdict);
            all.filter(|one| one.position[0] < 0.0 && one.persistence > 0.0)
                .count()
        };
        [Verdict::Present, Verdict::Unresolved, Verdict::Absent].map(of)
    };
    let narrow = counted("y = { from = -0.8814, to = 2.0395, count = 42 }");
    assert!(narrow[0] == 0 && narrow[1] + narrow[2] > 0, "{narrow:?}");
    let [present, unresolved, _] = counted("y = { from = -2.2, to = 2.2, count = 64 }");
    assert_eq!([present, unresolved], [1, 0]);
}
