//! Peaks, rings and craters about to be born or to vanish, where what is there is known exactly.

use super::*;
use crate::density::Kink;

#[test]
fn the_birth_of_a_ring_is_where_its_slope_passes_zero() {
    let axis = uniform(3.0, 60);
    let slope = |c: f64| {
        let density = joint(&axis, &axis, |x, y| {
            let energy = 0.5 * (x * x + y * y);
            (-10.0 * (c * energy - 0.5 * energy.powi(2) + energy.powi(3) / 3.0)).exp()
        });
        let detector = PersistenceDetector::new(DetectOptions::default(), 60);
        let found = detector
            .indicator(&density, IndicatorKind::RING, &[0.0, 0.0])
            .unwrap();
        (found.value, found.systematic_error)
    };
    let ((low, low_error), (high, high_error)) = (slope(0.248), slope(0.252));
    assert!(low > 0.0 && high < 0.0, "there below 1/4, gone above");
    let zero = 0.248 + 0.004 * low / (low - high);
    let error = 0.004 * low_error.max(high_error) / (low - high);
    assert!(
        (zero - 0.25).abs() < error && error < 2e-4,
        "{zero} {error}"
    );
}

#[test]
fn the_birth_of_a_peak_beside_another_is_where_the_slope_between_passes_zero() {
    // p = exp(-6 (y²/2 - h x - x²/2 + x⁴/4)) turned by an angle: the fold of 27 h² = 4.
    let (x, y) = (uniform(2.4, 90), uniform(2.4, 100));
    let (cos, sin) = (0.8, 0.6);
    let slope = |h: f64| {
        let density = joint(&x, &y, |u, v| {
            let (x, y) = (cos * u + sin * v, cos * v - sin * u);
            (-6.0 * (0.5 * y * y - h * x - 0.5 * x * x + 0.25 * x.powi(4))).exp()
        });
        let detector = PersistenceDetector::new(DetectOptions::default(), 60);
        let found = detector
            .indicator(&density, IndicatorKind::FOLD, &[-0.5, -0.3])
            .unwrap();
        let along = cos * found.place[0] + sin * found.place[1];
        assert!((along + 0.5774).abs() < 1e-2, "{along}");
        (found.value, found.systematic_error)
    };
    let ((low, low_error), (high, high_error)) = (slope(0.383), slope(0.387));
    assert!(low > 0.0 && high < 0.0, "there below, gone above");
    let zero = 0.383 + 0.004 * low / (low - high);
    let error = 0.004 * low_error.max(high_error) / (low - high);
    assert!(
        (zero - (4.0f64 / 27.0).sqrt()).abs() < error + 1e-6 && error < 1e-5,
        "{zero} {error}"
    );
}

#[test]
fn a_crater_about_to_close_is_one_however_its_floor_lies_among_the_cells() {
    // log p = b u² - u⁴ + v² - v⁴: a crater of relative depth b²/4 among four peaks. Its floor is a trench, and of the
    // four cells at the centre the two along it are both lower than their neighbours.
    for count in [50, 51, 100] {
        let axis = uniform(2.5, count);
        for step in 0..6 {
            let (sine, cosine) = (0.27 * f64::from(step)).sin_cos();
            for b in [0.1, 0.2, 0.4] {
                let density = joint(&axis, &axis, |x, y| {
                    let (u, v) = (cosine * x + sine * y, cosine * y - sine * x);
                    (b * u * u - u.powi(4) + v * v - v.powi(4)).exp()
                });
                let detection = detect(&density);
                assert_eq!(detection.signature.craters, 1, "{count} {step} {b}");
            }
        }
    }
}

#[test]
fn a_rim_that_is_nearly_level_has_its_peaks() {
    // Heights along the rim differ by 1e-4 of the density and less, a tenth of what oblique cells make of it.
    let axis = uniform(2.0, 60);
    for theta in [0.075, 0.175, 0.275, 0.375f64, 0.475] {
        let density = joint(&axis, &axis, |x, y| {
            let square = x * x + y * y;
            (0.5 * (theta * x * x + (theta + 0.002) * y * y) - 0.5 * square * square).exp()
        });
        let detection = detect(&density);
        assert_eq!(detection.signature, signature(2, 1), "{theta}");
        let second = detection.ranked(FeatureKind::Peak, 1).unwrap();
        // On the axis of y where (θ + 0.002)/2 = y².
        let expected = (0.5 * (theta + 0.002)).sqrt();
        assert!(second.position[0].abs() < 1e-6);
        assert!(
            (second.position[1].abs() - expected).abs() < 1e-5,
            "{second:?}"
        );
    }
}

/// Peaks and valleys that are present, by place.
fn present(detection: &Detection, kind: FeatureKind) -> Vec<f64> {
    let features = detection.features.iter();
    let wanted = features.filter(|one| one.kind == kind && one.verdict == Verdict::Present);
    let mut places: Vec<f64> = wanted.map(|one| one.position[0]).collect();
    places.sort_by(f64::total_cmp);
    places
}

#[test]
fn a_pair_is_followed_to_its_birth_without_a_seam() {
    // dx = (ax - x³)dt + σdW: peaks at ±√a, from far outside of a cell of the centre down to a twentieth of one.
    let sigma2 = 0.25;
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.02,
    };
    for axis in [
        uniform(2.5, 100),
        Axis::graded(-2.5, 2.5, 100, &grading).unwrap(),
    ] {
        let width = axis.width(50);
        for step in 0..400 {
            let x = 0.05 * width + 0.0025 * f64::from(step);
            let a = x * x;
            let p = |x: f64| (2.0 / sigma2 * (0.5 * a * x * x - 0.25 * x.powi(4))).exp();
            let mut estimated = marginal(&axis, p);
            estimated.structure.centre = Some(vec![0.0]);
            let detection = detect(&estimated);
            let peaks = present(&detection, FeatureKind::Peak);
            assert_eq!(peaks.len(), 2, "{x}: {peaks:?}");
            let valleys = present(&detection, FeatureKind::Valley);
            assert!(
                valleys.len() == 1 && valleys[0].abs() < 1e-9,
                "{x}: {valleys:?}"
            );
            // What is off is the curvature at the centre, a small part of σ²: √a moves fast near the birth, a does not.
            let error = (peaks[1] * peaks[1] - a).abs();
            assert!(error < 4e-6 + 5e-5 * a, "{x}: {error:e}");
            assert!((peaks[0] + peaks[1]).abs() < 1e-9, "{x}: {peaks:?}");
        }
    }
}

#[test]
fn at_the_birth_itself_a_lone_peak_stands_on_the_centre() {
    let axis = uniform(2.5, 100);
    for a in [0.0, 1e-7, -1e-7] {
        let p = |x: f64| (8.0 * (0.5 * a * x * x - 0.25 * x.powi(4))).exp();
        let mut estimated = marginal(&axis, p);
        estimated.structure.centre = Some(vec![0.0]);
        let detection = detect(&estimated);
        assert_eq!(present(&detection, FeatureKind::Peak), [0.0], "{a}");
        let peak = detection.ranked(FeatureKind::Peak, 0).unwrap();
        // p = 1 - 2x⁴ + 2x⁸ …: eight cells of width h miss the last term, 2 (0.5 · 1.5 · 2.5 · 3.5)² h⁸ = 3e-9.
        let error = peak.density / p(0.0) * integral(2.5, p) - 1.0;
        assert!(error.abs() < 1e-6, "{a}: {error:e}");
    }
}

#[test]
fn a_pair_at_a_kink_is_followed_to_its_birth_and_the_notch_is_the_kink() {
    // p ∝ exp(s|y| - y²/2): peaks at ±s, a notch at 0, and for s < 0 a tip there.
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.005,
    };
    let axis = Axis::graded(-4.0, 4.0, 100, &grading).unwrap();
    for step in -20..200 {
        let s = 0.0021 * f64::from(step) + 0.0005;
        let mut estimated = marginal(&axis, |y: f64| (s * y.abs() - 0.5 * y * y).exp());
        estimated.structure.centre = Some(vec![0.0]);
        estimated.structure.kinks = vec![Kink {
            axis: 0,
            at: 0.0,
            jump: vec![2.0 * s],
        }];
        let detection = detect(&estimated);
        let peaks = present(&detection, FeatureKind::Peak);
        let valleys = present(&detection, FeatureKind::Valley);
        if s < 0.0 {
            assert_eq!((peaks.as_slice(), valleys.len()), (&[0.0][..], 0), "{s}");
            continue;
        }
        assert_eq!(valleys, [0.0], "{s}");
        assert_eq!(peaks.len(), 2, "{s}: {peaks:?}");
        let error = (peaks[1] - s).abs().max((peaks[0] + s).abs());
        let h = axis.width(axis.find(s).unwrap());
        assert!(error < 1e-4 * h, "{s}: {error:e} {h}");
    }
}
