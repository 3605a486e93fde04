//! Features in the plane: rings, craters and peaks, one inside another.

use super::*;

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
