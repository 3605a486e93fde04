//! Indicators on densities known in closed form.

use super::shoulder::shoulder;
use super::*;
use crate::density::{Density, Kink, Observable, Structure};
use crate::space::Axis;
use crate::topology::{
    DetectOptions, Detector, FeatureKind, PersistenceDetector, Signature, Verdict,
    analytic_tests::{joint, marginal},
};

fn axis(count: usize) -> Axis {
    Axis::uniform(-2.0, 2.0, count).unwrap()
}

fn symmetric(mut estimated: EstimatedDensity) -> EstimatedDensity {
    let axes = estimated.density.axes.len();
    estimated.structure.centre = Some(vec![0.0; axes]);
    estimated
}

/// exp(2(a x²/2 - x⁴/4)/σ²), σ² = 0.5: p''(0)/p(0) = 2a/σ² = 4a.
fn bistable(a: f64, count: usize) -> EstimatedDensity {
    symmetric(marginal(&axis(count), |x| {
        (4.0 * (0.5 * a * x * x - 0.25 * x.powi(4))).exp()
    }))
}

#[test]
fn curvature_at_the_centre_is_exact_to_high_order() {
    for a in [-0.3, -1e-3, 1e-3, 0.3] {
        let error = |count: usize| {
            let found = at_centre(&bistable(a, count));
            assert_eq!(found[0].kind, IndicatorKind::CURVATURE);
            assert!((found[0].value - 4.0 * a).abs() <= found[0].systematic_error);
            (found[0].value - 4.0 * a).abs()
        };
        // Sixth order: 40 to 80 cells cut the error by 2⁶.
        assert!(
            error(80) < 2e-5 && error(80) < error(40) / 30.0,
            "{}",
            error(80)
        );
    }
}

#[test]
fn the_signature_follows_the_centre_long_before_peaks_stand_out() {
    let detector = PersistenceDetector::new(DetectOptions::default(), 61);
    for (a, peaks) in [(-1e-3, 1), (1e-3, 2)] {
        let detection = detector.detect(&bistable(a, 100));
        assert_eq!(detection.signature, Signature::of_peaks(peaks));
    }
    // Without the symmetry persistence alone decides, and is late.
    let mut plain = bistable(1e-3, 100);
    plain.structure = Structure::default();
    assert_eq!(detector.detect(&plain).signature.peaks, 1);
}

#[test]
fn principal_curvatures_tell_peak_saddle_and_crater() {
    let detector = PersistenceDetector::new(DetectOptions::default(), 61);
    // Curvatures a and b along directions turned by 30°, walls beyond; eigenvalues times 16 (the range squared).
    let density = |a: f64, b: f64| {
        let (cos, sin) = (0.75f64.sqrt(), 0.5);
        symmetric(joint(&axis(60), &axis(60), |x, y| {
            let (u, v) = (cos * x + sin * y, cos * y - sin * x);
            (0.5 * (a * u * u + b * v * v) - (u * u + v * v).powi(2)).exp()
        }))
    };
    for (a, b, peaks, crater) in [(-0.2, -0.1, 1, 0), (-0.2, 0.01, 2, 0), (0.005, 0.01, 2, 1)] {
        let estimated = density(a, b);
        let found = at_centre(&estimated);
        for (one, curvature) in found.iter().zip([a, b]) {
            assert!(
                (one.value - 16.0 * curvature).abs() <= one.systematic_error,
                "{one:?}"
            );
            assert!(one.systematic_error < 0.02, "{one:?}");
        }
        let signature = detector.detect(&estimated).signature;
        assert_eq!(signature.craters, crater, "{a} {b}");
        // On the rim of a crater persistence decides alone.
        assert!(
            signature.peaks == peaks || crater == 1,
            "{a} {b} {signature}"
        );
    }
}

#[test]
fn at_a_kink_the_jump_law_decides() {
    let detector = PersistenceDetector::new(DetectOptions::default(), 61);
    for (slope, peaks) in [(-1e-4, 1), (1e-4, 2)] {
        let mut estimated = symmetric(marginal(&axis(100), |x| (slope * x.abs() - x * x).exp()));
        estimated.structure.kinks = vec![Kink {
            axis: 0,
            at: 0.0,
            jump: vec![2.0 * slope],
        }];
        let found = at_centre(&estimated);
        assert_eq!(
            (found[0].kind, found[0].value),
            (IndicatorKind::KINK_SLOPE, slope)
        );
        assert_eq!(detector.detect(&estimated).signature.peaks, peaks);
    }
}

#[test]
fn along_a_kink_the_curvature_is_that_of_the_trace() {
    let slope = -0.8;
    let mut estimated = symmetric(joint(&axis(60), &axis(60), |x, y| {
        (0.3 * x * x - x.powi(4) + slope * y.abs() - y * y).exp()
    }));
    estimated.structure.kinks = vec![Kink {
        axis: 1,
        at: 0.0,
        jump: vec![2.0 * slope; 60],
    }];
    let found = at_centre(&estimated);
    assert_eq!(found[0].value, slope);
    assert_eq!(found[1].kind, IndicatorKind::CURVATURE_ALONG_KINK);
    let error = (found[1].value - 0.6).abs();
    assert!(
        error <= found[1].systematic_error && error < 1e-3,
        "{found:?}"
    );
}

/// A peak at 0 and a tilted shoulder about 1.2 that becomes a peak as `tilt` passes the root.
fn tilted(tilt: f64, count: usize) -> EstimatedDensity {
    // (log p)' = -u (u² - 1)… with u = x - 1.2 near the shoulder: slope tilt - 3 (x - 0.9)² there, a wall beyond.
    marginal(&Axis::uniform(-1.0, 3.0, count).unwrap(), |x| {
        (tilt * x - (x - 0.9).powi(3) - 0.1 * x.powi(4)).exp()
    })
}

#[test]
fn the_slope_at_a_shoulder_changes_sign_where_peak_and_valley_are_born() {
    // (log p)' = tilt - 3 (x - 0.9)² - 0.4 x³ has a double zero where its own slope vanishes: 6 (x - 0.9) + 1.2 x² = 0.
    let x = (-6.0 + (36.0f64 + 4.0 * 1.2 * 5.4).sqrt()) / 2.4;
    let root = 3.0 * (x - 0.9).powi(2) + 0.4 * x.powi(3);
    for (tilt, sign) in [(root - 0.02, -1.0), (root + 0.02, 1.0)] {
        let found = shoulder(&tilted(tilt, 100), x, true).unwrap();
        assert!((found.place[0] - x).abs() < 0.05, "{found:?} {x}");
        assert!(found.value * sign > 0.0, "{found:?}");
        assert!(
            (found.value - (tilt - root)).abs() <= found.systematic_error + 1e-3,
            "{found:?}"
        );
    }
}

#[test]
fn the_slope_at_a_shoulder_is_of_order_six_wherever_its_place_lies_in_a_cell() {
    // Over many tilts the place takes every part of a cell.
    let worst = |count: usize| {
        let tilts = (0..9).map(|k| 0.01 * f64::from(k));
        let error = |tilt: f64| {
            let value = |count: usize| shoulder(&tilted(tilt, count), 0.9, true).unwrap().value;
            (value(count) - value(800)).abs()
        };
        tilts.map(error).fold(0.0, f64::max)
    };
    let (coarse, fine) = (worst(40), worst(80));
    // With halved cells 2^6 times smaller; the windows of eight cells jump by a cell, hence the allowance.
    assert!(fine < coarse / 24.0, "{coarse} {fine}");
}

#[test]
fn closed_forms_without_a_profile_have_extrema_of_the_slope_at_their_jumps_and_bends() {
    // Of a closed form that tells where its slope jumps or bends, by this much.
    let of = |log: &dyn Fn(f64) -> f64, jump: Vec<f64>| {
        let mut estimated = marginal(&axis(80), |x| log(x).exp());
        estimated.negligible = 0.0;
        let (axis, at) = (0, 0.4);
        estimated.structure.kinks = vec![Kink { axis, at, jump }];
        estimated
    };
    // At an end of eight cells the slope of the polynomial through their averages is off by 0.6 p⁽⁸⁾ h⁷, with
    // p⁽⁸⁾ < 2000 p and h = 0.05 by 1e-6.
    let near = |value: f64, exact: f64| (value - exact).abs() < 1e-5;
    // (log p)' = -2x ± 0.5: falls to -1.3 below 0.4, and from -0.3 above.
    let jumping = of(&|x| -x * x + 0.5 * (x - 0.4).abs(), vec![1.0]);
    let [highest, lowest] = shoulders(&jumping)[..] else {
        panic!("two flanks: {:?}", shoulders(&jumping));
    };
    assert!(highest.rising && near(highest.place, 0.4) && near(highest.value, -0.3));
    assert!(!lowest.rising && near(lowest.place, 0.4) && near(lowest.value, 1.3));
    // (log p)' = -0.2 - |x - 0.4|: a maximum at the bend, which no parabola through the cells has.
    let bending = of(
        &|x| -0.2 * x - 0.5 * (x - 0.4) * (x - 0.4).abs(),
        Vec::new(),
    );
    let [flank] = shoulders(&bending)[..] else {
        panic!("one flank: {:?}", shoulders(&bending));
    };
    assert!(flank.rising && near(flank.place, 0.4) && near(flank.value, -0.2));
    let followed = shoulder(&bending, 0.3, true).unwrap();
    assert!(near(followed.place[0], 0.4) && near(followed.value, -0.2));
}

#[test]
fn noise_makes_a_sign_doubtful() {
    let indicator = |value: f64| Indicator {
        kind: IndicatorKind::CURVATURE,
        place: vec![0.0],
        value,
        sampling_error: 1.0,
        degrees_of_freedom: 7.0,
        systematic_error: 0.5,
        sensitivity: 0.0,
        replicates: Vec::new(),
    };
    // Student with 7 degrees of freedom: 2.365 at 5 %.
    assert_eq!(indicator(2.86).sign(0.05), None);
    assert_eq!(indicator(2.87).sign(0.05), Some(true));
    assert_eq!(indicator(-2.87).sign(0.05), Some(false));
}

#[test]
fn where_a_density_is_less_than_the_solver_leaves_nothing_is_read() {
    // A ring with a centre of e⁻ᵈ of its height: p ∝ exp(-d (r² - 1)²).
    let ring = |depth: f64| {
        let of = |x: f64, y: f64| (-depth * (x * x + y * y - 1.0).powi(2)).exp();
        symmetric(joint(&axis(60), &axis(60), of))
    };
    let told = at_centre(&ring(12.0));
    assert_eq!(told.len(), 2);
    // ∂²p/∂x² / p = 4 d at the centre, times the range squared.
    let wanted = 16.0 * 48.0;
    assert!(
        told.iter()
            .all(|one| (one.value - wanted).abs() <= one.systematic_error),
        "{told:?}"
    );
    assert!(at_centre(&ring(20.0)).is_empty(), "e⁻²⁰ is less than 1e-7");
    // The same by quadrature has its digits everywhere.
    let exact = EstimatedDensity {
        negligible: 0.0,
        truncation: Default::default(),
        ..ring(20.0)
    };
    assert_eq!(at_centre(&exact).len(), 2);
}

#[test]
fn densities_too_coarse_or_without_symmetry_have_no_indicator() {
    assert!(at_centre(&bistable(0.1, 4)).is_empty());
    let plain = EstimatedDensity {
        structure: Structure::default(),
        ..bistable(0.1, 40)
    };
    assert!(at_centre(&plain).is_empty());
    let joint = EstimatedDensity {
        observable: Observable::Joint(0, 1),
        density: Density {
            axes: vec![axis(3), axis(3)],
            values: vec![1.0; 9],
        },
        ..symmetric(joint(&axis(3), &axis(3), |_, _| 1.0))
    };
    assert!(at_centre(&joint).is_empty());
    assert!(shoulder(&joint, 0.0, true).is_none());
}

/// The same density as if sampled: eight replicates, each with its own smooth and rough distortion of size `noise`.
fn sampled(exact: &EstimatedDensity, noise: f64) -> EstimatedDensity {
    let replicate = |group: usize| {
        let values = exact.density.values.iter().enumerate();
        let distort = |(cell, value): (usize, &f64)| {
            let phase = (cell * 7 + group * 13) as f64 * 0.618_033_988_749_895;
            value * (1.0 + noise * (phase.fract() - 0.5))
        };
        values.map(distort).collect::<Vec<f64>>()
    };
    EstimatedDensity {
        variants: Variants::Jackknife((0..8).map(replicate).collect()),
        ..exact.clone()
    }
}

#[test]
fn curvatures_of_a_sampled_density_are_fitted_to_its_logarithm() {
    // Exponentials of polynomials of degree four are fitted exactly, but for averages over cells (h²/24 of p'''').
    for a in [-0.3, 0.0, 0.3] {
        let found = at_centre(&sampled(&bistable(a, 100), 1e-3));
        assert!((found[0].value - 4.0 * a).abs() < 0.02, "{found:?}");
        assert!(found[0].sampling_error > 0.0 && found[0].replicates.len() == 8);
    }
    let joint = symmetric(joint(&axis(60), &axis(60), |x, y| {
        (0.2 * x * x + 0.1 * x * y - 0.3 * y * y - (x * x + y * y).powi(2)).exp()
    }));
    // Hessian [[0.4, 0.1], [0.1, -0.6]]: eigenvalues -0.1 ± √0.26, times the range squared.
    for (one, expected) in at_centre(&sampled(&joint, 1e-3))
        .iter()
        .zip([-0.1 - 0.26f64.sqrt(), -0.1 + 0.26f64.sqrt()])
    {
        assert!(
            (one.value - 16.0 * expected).abs() < 0.1,
            "{one:?} {expected}"
        );
    }
}

#[test]
fn along_a_kink_a_sampled_density_is_fitted_on_both_sides_at_once() {
    let mut estimated = symmetric(joint(&axis(60), &axis(60), |x, y| {
        (0.3 * x * x - x.powi(4) - 0.8 * y.abs() - y * y).exp()
    }));
    estimated.structure.kinks = vec![Kink {
        axis: 1,
        at: 0.0,
        jump: vec![-1.6; 60],
    }];
    let found = at_centre(&sampled(&estimated, 1e-3));
    assert!((found[1].value - 0.6).abs() < 0.02, "{found:?}");
}

#[test]
fn features_about_the_centre_say_what_the_signature_says() {
    let detector = PersistenceDetector::new(DetectOptions::default(), 61);
    for a in [-0.05, -1e-3, 1e-4, 1e-3, 1e-2, 0.05, 0.2] {
        let detection = detector.detect(&bistable(a, 100));
        let of = |kind: FeatureKind| -> Vec<f64> {
            let features = detection.features.iter();
            let present =
                features.filter(|one| one.kind == kind && one.verdict == Verdict::Present);
            present.map(|one| one.position[0]).collect()
        };
        let (peaks, valleys) = (of(FeatureKind::Peak), of(FeatureKind::Valley));
        assert_eq!(peaks.len(), detection.signature.peaks, "{a}: {peaks:?}");
        assert_eq!(valleys.len() + 1, peaks.len());
        // Peaks of exp(4(a x²/2 - x⁴/4)) stand at ±√a; a quarter of a cell, 0.04 wide, is what a parabola is off by.
        let place = a.max(0.0).sqrt();
        assert!(
            peaks.iter().all(|peak| (peak.abs() - place).abs() < 0.01),
            "{a}: {peaks:?}"
        );
        assert!(
            valleys.iter().all(|valley| valley.abs() < 1e-3),
            "{a}: {valleys:?}"
        );
    }
}

#[test]
fn nothing_is_read_where_a_density_is_no_clear_multiple_of_its_error() {
    // A shoulder at x = 1 at a thousandth of the maximum, and a second scheme that is off by a share of that.
    let shoulder_with = |off: f64| {
        let mut estimated = marginal(&axis(80), |x| {
            (-8.0 * x * x).exp() + 1e-3 * (-0.5 * (x - 1.0).powi(2)).exp()
        });
        let scale = estimated.density.maximum();
        let second = estimated.density.values.iter();
        let second = second.map(|value| value + off * 1e-3 * scale).collect();
        estimated.variants = Variants::Scheme(second);
        shoulder(&estimated, 0.9, true)
    };
    assert!(shoulder_with(0.01).is_some());
    assert!(shoulder_with(10.0).is_none());
    // Where the solver leaves as much as there is, nothing is read either.
    let mut estimated = bistable(0.3, 80);
    assert!(!at_centre(&estimated).is_empty());
    estimated.negligible = 1.0;
    assert!(at_centre(&estimated).is_empty());
}

/// Two bistable units coupled by k, exp(-V/T) with V = Σ (x⁴/4 - x²/2) + k (x₁ - x₂)²/2, T = 0.2, tilted by `tilt`
/// across the line x₁ = -x₂. Its peaks on that line, at x₁² = 1 - 2k, have V'' = 2 - 6k across it.
fn coupled(k: f64, tilt: f64) -> EstimatedDensity {
    joint(&axis(60), &axis(60), |x, y| {
        let well = |x: f64| 0.25 * x.powi(4) - 0.5 * x * x;
        let potential = well(x) + well(y) + 0.5 * k * (x - y).powi(2) - tilt * (x + y);
        (-5.0 * potential).exp()
    })
}

#[test]
fn the_curvature_across_a_line_of_symmetry_tells_when_a_peak_becomes_a_saddle() {
    for k in [0.3f64, 0.333, 0.35] {
        let at = (1.0 - 2.0 * k).sqrt();
        // Axes of length 4: curvatures are 16 times those in units of x, and p''/p = -V''/T.
        let exact = 5.0 * 16.0 * (2.0 - 6.0 * k);
        for (is_it, sign) in [(true, 1.0), (false, -1.0)] {
            let kind = IndicatorKind::split(true, is_it);
            let near = [at + 0.002, -at + 0.004];
            let found = kind.traits().read;
            let found = found(&coupled(k, 0.0), &near);
            let found = found.unwrap_or_else(|| panic!("nothing at k = {k}"));
            assert!((found.value - sign * exact).abs() <= found.systematic_error + 1e-6);
            assert!(found.systematic_error < 5e-2, "{found:?}");
            assert!((found.place[0] - at).abs() < 1e-5 && (found.place[1] + at).abs() < 1e-5);
        }
    }
    // Without the mirror image the pitchfork breaks.
    let broken = IndicatorKind::split(true, true).traits().read;
    assert!(broken(&coupled(0.33, 1e-3), &[0.58, -0.58]).is_none());
}
