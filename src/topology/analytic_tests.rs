//! The detector on densities whose features are known exactly.

use super::*;
use crate::density::{Density, Kink, Observable};
use crate::space::{Axis, Grading};

/// Gauss points and weights on [-1, 1] for averages over a cell: exact to degree 5.
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 18.0),
    (0.0, 8.0 / 18.0),
    (0.774_596_669_241_483_4, 5.0 / 18.0),
];

/// Density of one axis without sampling errors: averages over cells, ∫ = 1.
pub(super) fn marginal(axis: &Axis, function: impl Fn(f64) -> f64) -> EstimatedDensity {
    let average = |cell: usize| -> f64 {
        let at = |node: f64| axis.centre(cell) + 0.5 * node * axis.width(cell);
        GAUSS
            .iter()
            .map(|&(node, weight)| weight * function(at(node)))
            .sum()
    };
    exact(vec![axis.clone()], (0..axis.count()).map(average).collect())
}

/// Density of two axes without sampling errors: averages over cells, ∫ = 1.
pub(super) fn joint(x: &Axis, y: &Axis, function: impl Fn(f64, f64) -> f64) -> EstimatedDensity {
    let average = |cell: usize| {
        let (i, j) = (cell / y.count(), cell % y.count());
        let mut sum = 0.0;
        for (u, first) in GAUSS {
            for (v, second) in GAUSS {
                let at = (
                    x.centre(i) + 0.5 * u * x.width(i),
                    y.centre(j) + 0.5 * v * y.width(j),
                );
                sum += first * second * function(at.0, at.1);
            }
        }
        sum
    };
    let values = (0..x.count() * y.count()).map(average).collect();
    exact(vec![x.clone(), y.clone()], values)
}

fn exact(axes: Vec<Axis>, values: Vec<f64>) -> EstimatedDensity {
    let observable = match axes.len() {
        1 => Observable::Marginal(0),
        _ => Observable::Joint(0, 1),
    };
    let mut density = Density { axes, values };
    let total: f64 = density.masses().iter().sum();
    density.values.iter_mut().for_each(|value| *value /= total);
    EstimatedDensity {
        observable,
        standard_error: vec![0.0; density.values.len()],
        variants: crate::density::Variants::None,
        structure: crate::density::Structure::default(),
        negligible: crate::density::NEGLIGIBLE,
        density,
    }
}

pub(super) fn detect(estimated: &EstimatedDensity) -> Detection {
    PersistenceDetector::new(DetectOptions::default(), 60).detect(estimated)
}

fn signature(peaks: usize, craters: usize) -> Signature {
    Signature {
        peaks,
        craters,
        ..Signature::default()
    }
}

fn bare_ring() -> Signature {
    Signature {
        craters: 1,
        rings: 1,
        ..Signature::default()
    }
}

fn uniform(half: f64, count: usize) -> Axis {
    Axis::uniform(-half, half, count).unwrap()
}

/// ∫ of a function by the midpoint rule, fine enough to be exact here.
fn integral(half: f64, function: impl Fn(f64) -> f64) -> f64 {
    let axis = uniform(half, 20_000);
    axis.centres()
        .iter()
        .map(|&x| function(x) * axis.width(0))
        .sum()
}

#[test]
fn bistable_density_has_two_peaks_exactly_for_positive_a() {
    let sigma2 = 0.25;
    for a in [-1.0, -0.3, 0.0, 0.2, 0.5, 1.0f64] {
        let p = |x: f64| (2.0 / sigma2 * (0.5 * a * x * x - 0.25 * x.powi(4))).exp();
        let total = integral(2.5, p);
        for count in [50, 51, 200] {
            let axis = uniform(2.5, count);
            let h = axis.width(0);
            let detection = detect(&marginal(&axis, p));
            assert_eq!(
                detection.signature,
                signature(1 + usize::from(a > 0.0), 0),
                "{a} {count}"
            );
            if a <= 0.0 {
                continue;
            }
            let depth = (p(a.sqrt()) - p(0.0)) / total;
            // Taylor: the parabola's slope is off by 5/24 p''' h² at the cell's centre; p'''/p'' = 3/√a.
            let shift = 1.3 * 5.0 / 24.0 * 3.0 / a.sqrt();
            let peak = detection.ranked(FeatureKind::Peak, 1).unwrap();
            let valley = detection.ranked(FeatureKind::Valley, 0).unwrap();
            assert!(
                (peak.position[0].abs() - a.sqrt()).abs() < shift * h * h,
                "{a} {count}"
            );
            // Heights: 1/12 p''' h³ at the edge of the cell and 1/120 p'''' h⁴, with p''''/p = 3 (p''/p)².
            let third = 1.3 / 12.0 * 6.0 * a.sqrt() * 2.0 / sigma2 * h.powi(3);
            let fourth = 1.3 / 120.0 * 3.0 * (4.0 * a / sigma2).powi(2) * h.powi(4);
            let height = p(a.sqrt()) / total;
            assert!(
                (peak.density - height).abs() < (third + fourth) * height,
                "{a} {count}"
            );
            assert!(valley.position[0].abs() < 1e-9 && valley.persistence == peak.persistence);
            // Cell values miss the top by |p''| h²/6 at most, and the bottom likewise.
            let missed = h * h / 6.0 * (2.0 / sigma2) * 3.0 * a * p(a.sqrt()) / total;
            assert!((peak.persistence - depth).abs() < missed, "{a} {count}");
        }
    }
}

#[test]
fn rayleigh_density_is_a_crater_exactly_for_positive_a() {
    let (b, sigma2) = (1.0, 0.2);
    for a in [-0.5, 0.0, 0.1, 0.3, 1.0f64] {
        let of_energy =
            |energy: f64| (2.0 / sigma2 * (a * energy - 0.5 * b * energy * energy)).exp();
        let p = |x: f64, y: f64| of_energy(0.5 * (x * x + y * y));
        for count in [50, 75, 100] {
            let axis = uniform(3.0, count);
            let estimated = joint(&axis, &axis, p);
            let detection = detect(&estimated);
            assert_eq!(
                detection.signature,
                if a > 0.0 {
                    bare_ring()
                } else {
                    signature(1, 0)
                },
                "{a} {count}"
            );
            if a <= 0.0 {
                continue;
            }
            // 2π r dr = 2π dH.
            let total = std::f64::consts::TAU * 0.5 * integral(9.0, |e| of_energy(e.abs()));
            let crater = detection.ranked(FeatureKind::Crater, 0).unwrap();
            let depth = (of_energy(a / b) - 1.0) / total;
            // Slope off by 5/24 p''' h² at the centre of a cell h/2 away, where p'''/p'' < 3 b h / 2a (and < 2).
            let off = 0.5 * axis.width(0).powi(2);
            assert!(
                crater.position.iter().all(|x| x.abs() < off),
                "{:?}",
                crater.position
            );
            // Across the rim the curvature is (4ab/σ²) p: averages lower it by 1/24 h² of that, the ridge is
            // missed by 1/8 h² and the share kept for the remainder. At the bottom it is (2a/σ²) p each way.
            let rim = 0.25 * 4.0 * a * b / sigma2 * of_energy(a / b);
            let bottom = 0.5 * 2.0 * a / sigma2;
            let missed = axis.width(0).powi(2) * (rim + bottom) / total;
            assert!((crater.persistence - depth).abs() < missed, "{a} {count}");
        }
    }
}

#[test]
fn the_grid_makes_no_peaks_on_rings_of_any_width_radius_and_centre() {
    // σ of the rim from 1.5 to 6 cells; elliptic and off-centre rings cross the cells at all angles.
    let axis = uniform(3.0, 100);
    for width in [0.09, 0.12, 0.18, 0.36] {
        for (radius, stretch, shift) in [(1.1, 1.0, 0.0), (1.7, 1.3, 0.017), (1.3, 0.7, 0.031)] {
            let ring = |x: f64, y: f64| {
                let r = (x - shift).hypot(stretch * (y + 0.5 * shift));
                (-0.5 * ((r - radius) / width).powi(2)).exp()
            };
            let detection = detect(&joint(&axis, &axis, ring));
            assert_eq!(
                detection.signature,
                bare_ring(),
                "{width} {radius} {stretch}"
            );
        }
    }
}

#[test]
fn a_ring_with_two_rim_peaks_has_both_and_the_saddles_between() {
    let axis = uniform(3.0, 90);
    let ring = |x: f64, y: f64| {
        let (r, angle) = (x.hypot(y), y.atan2(x));
        (-0.5 * ((r - 1.5) / 0.3).powi(2)).exp() * (1.0 + 0.2 * (2.0 * angle).cos())
    };
    let estimated = joint(&axis, &axis, ring);
    let detection = detect(&estimated);
    assert_eq!(detection.signature, signature(2, 1));
    let second = detection.ranked(FeatureKind::Peak, 1).unwrap();
    // Heights on the rim are 1.2 and 0.8; averaging over a cell takes h²/24 of the curvature, 0.2 %.
    let ratio = second.persistence / detection.ranked(FeatureKind::Peak, 0).unwrap().persistence;
    assert!((ratio - 0.4 / 1.2).abs() < 5e-3, "{ratio}");
    let saddle = &detection.ranked(FeatureKind::Valley, 0).unwrap().position;
    assert!(
        saddle[0].abs() < 1e-2 && (saddle[1].abs() - 1.5).abs() < 1e-2,
        "{saddle:?}"
    );
    assert!(second.position[1].abs() < 1e-2 && (second.position[0].abs() - 1.5).abs() < 1e-2);
}

#[test]
fn several_craters_and_several_peaks_are_all_found() {
    // cos²-like egg box on [-3, 3]²: 9 hills, 4 pits enclosed; a tilt makes heights differ.
    let axis = uniform(3.0, 72);
    let egg = |x: f64, y: f64| {
        let wave = |t: f64| (std::f64::consts::PI * t).cos();
        2.2 + (wave(x) * 0.5 + wave(y) * 0.5) * (1.0 + 0.05 * x + 0.02 * y)
    };
    let detection = detect(&joint(&axis, &axis, |x, y| {
        egg(x, y)
            * if x.abs() < 2.9 && y.abs() < 2.9 {
                1.0
            } else {
                0.0
            }
    }));
    // Hills at 0, ±2 in each coordinate; pits at ±1; those at ±3 are cut off by the frame.
    assert_eq!(detection.signature, signature(9, 4));
    for crater in detection
        .features
        .iter()
        .filter(|f| f.kind == FeatureKind::Crater)
    {
        assert!(
            crater.position.iter().all(|x| (x.abs() - 1.0).abs() < 0.05),
            "{crater:?}"
        );
    }
}

#[test]
fn a_notch_at_a_switching_surface_counts_and_its_place_is_the_surface() {
    // p ∝ exp(-y²/2 + k |y|) with a kink: a V down to the face y = 0, in one and two dimensions.
    let notch = |y: f64| (-0.5 * y * y + 0.3 * y.abs()).exp();
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.005,
    };
    for axis in [
        uniform(4.0, 80),
        Axis::graded(-4.0, 4.0, 80, &grading).unwrap(),
    ] {
        let detection = detect(&marginal(&axis, notch));
        assert_eq!(detection.signature, signature(2, 0));
        let valley = detection.ranked(FeatureKind::Valley, 0).unwrap();
        assert!(valley.position[0].abs() < 1e-9, "{valley:?}");
        let estimated = joint(&uniform(4.0, 60), &axis, |x, y| {
            (-0.5 * x * x).exp() * notch(y)
        });
        assert_eq!(detect(&estimated).signature, signature(2, 0));
    }
}

#[test]
fn a_peak_at_the_end_of_the_range_counts() {
    let axis = Axis::uniform(0.0, 4.0, 64).unwrap();
    let detection = detect(&marginal(&axis, |x| {
        (-3.0 * x).exp() + (-8.0 * (x - 2.5).powi(2)).exp()
    }));
    assert_eq!(detection.signature, signature(2, 0));
    let at_end = |f: &&Feature| f.kind == FeatureKind::Peak && f.position[0] < axis.width(0);
    assert_eq!(detection.features.iter().filter(at_end).count(), 1);
}

#[test]
fn gaussian_mixtures_in_the_plane_have_their_peaks_where_they_are() {
    let centres = [(-1.4, -1.2, 1.0), (0.2, 0.3, 0.7), (1.8, 1.4, 0.4)];
    let width: f64 = 0.35;
    let p = |x: f64, y: f64| -> f64 {
        let hill = |&(a, b, w): &(f64, f64, f64)| {
            w * (-0.5 * ((x - a).powi(2) + (y - b).powi(2)) / width.powi(2)).exp()
        };
        centres.iter().map(hill).sum()
    };
    let (x, y) = (uniform(3.0, 60), uniform(3.5, 50));
    let detection = detect(&joint(&x, &y, p));
    assert_eq!(detection.signature, signature(3, 0));
    for (rank, (a, b, _)) in centres.into_iter().enumerate() {
        let position = &detection.ranked(FeatureKind::Peak, rank).unwrap().position;
        // Hills are 5 widths apart: they shift each other by less than 1e-3; h²-errors are below 2e-3.
        assert!(
            (position[0] - a).abs() < 3e-3 && (position[1] - b).abs() < 3e-3,
            "{position:?}"
        );
    }
}

#[test]
fn a_peak_inside_a_ring_is_told_from_a_bare_ring_and_both_from_a_peak() {
    // p = f(H) with ln f' ∝ -(c - H + H²): the centre turns from bottom to peak at c = 0, the ring ends at c = 1/4.
    let axis = uniform(3.0, 60);
    let peak_in_a_ring = Signature {
        peaks: 1,
        enclosed_peaks: 1,
        ..bare_ring()
    };
    for (c, expected) in [
        (-0.2, bare_ring()),
        (-0.01, bare_ring()),
        (0.05, peak_in_a_ring),
        (0.2, peak_in_a_ring),
        (0.245, peak_in_a_ring),
        (0.255, signature(1, 0)),
        (0.3, signature(1, 0)),
    ] {
        let density = joint(&axis, &axis, |x, y| {
            let energy = 0.5 * (x * x + y * y);
            (-10.0 * (c * energy - 0.5 * energy.powi(2) + energy.powi(3) / 3.0)).exp()
        });
        assert_eq!(detect(&density).signature, expected, "{c}");
    }
}

#[test]
fn two_rings_merge_into_one_around_two_craters() {
    // p = f(H), H = y²/2 - x²/2 + x⁴/4, f highest at H = e: around each well for e < 0, around both for e > 0.
    let (x, y) = (uniform(2.6, 100), uniform(2.6, 100));
    for (e, rings) in [(-0.12, 2), (0.12, 1)] {
        let density = joint(&x, &y, |x, y| {
            let energy = 0.5 * y * y - 0.5 * x * x + 0.25 * x.powi(4);
            (-30.0 * (energy - e).powi(2)).exp()
        });
        let expected = Signature {
            craters: 2,
            rings,
            ..Signature::default()
        };
        assert_eq!(detect(&density).signature, expected, "{e}");
    }
}

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
            .indicator(&density, IndicatorKind::Ring, &[0.0, 0.0])
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
            .indicator(&density, IndicatorKind::Fold, &[-0.5, -0.3])
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
    // log p = b u² - u⁴ + v² - v⁴: a crater of relative depth b²/4 among four peaks. Its floor is a trench, and of the four cells at
    // the centre the two along it are both lower than their neighbours.
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
