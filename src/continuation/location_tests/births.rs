//! Pairs that are born on a flank, at a kink or in the plane.

use super::*;
use crate::topology::IndicatorKind;

/// A main peak at -1 and, from θ = 0 on, a pair born at 0.5: (log p)' = -(x + 1)(2 (x - 0.5)² - θ); mirrored for sign
/// -1.
fn flank(sign: f64) -> Exact<impl Formula> {
    Exact::new(
        1,
        120,
        |_| Structure::default(),
        move |theta: f64, at: &[f64]| {
            let x = sign * at[0];
            let potential = 0.5 * x.powi(4) - (1.5 + theta) * 0.5 * x * x + (0.5 - theta) * x;
            (-potential).exp()
        },
    )
}

#[test]
fn a_pair_born_on_a_flank_is_located_by_the_slope_at_its_inflection() {
    let result = run(&flank(1.0), (-0.5, 0.55, 22), 1e-3);
    let rows = rows(&result);
    assert_eq!(rows.len(), 1, "{rows:?}");
    let row = rows[0];
    assert_eq!(words(row), "1 peak → 2 peaks, peak and valley are born");
    assert_eq!(row.method(), "slope at the inflection");
    assert_eq!(row.status(), BifurcationStatus::Located, "{row:?}");
    assert!(row.value.abs() <= row.error && row.error < 1e-3, "{row:?}");
}

#[test]
fn mirroring_a_density_without_symmetry_changes_no_row() {
    let located = |sign: f64| {
        let result = run(&flank(sign), (-0.5, 0.55, 22), 1e-3);
        let row = rows(&result)[0].clone();
        (words(&row), row.value, row.error, row.status())
    };
    let (plain, mirrored) = (located(1.0), located(-1.0));
    assert_eq!((&plain.0, plain.3), (&mirrored.0, mirrored.3));
    assert!((plain.1 - mirrored.1).abs() < 1e-9 && (plain.2 - mirrored.2).abs() < 1e-9);
}

/// With a kink at 0.4; mirrored for sign -1.
fn kinked<F: Fn(f64, f64) -> f64 + Clone + Send + Sync + 'static>(
    sign: f64,
    structure: fn(f64) -> Structure,
    log_density: F,
) -> Exact<impl Formula> {
    Exact::new(1, 100, structure, move |theta: f64, at: &[f64]| {
        log_density(theta, sign * at[0] - 0.4).exp()
    })
}

#[test]
fn a_pair_born_at_a_kink_that_is_no_centre_is_located_by_the_slope_beside_it() {
    fn kink(at: f64) -> Structure {
        Structure {
            kinks: vec![Kink {
                axis: 0,
                at,
                jump: vec![1.0],
            }],
            ..Structure::default()
        }
    }
    for sign in [1.0, -1.0] {
        let structure: fn(f64) -> Structure = match sign > 0.0 {
            true => |_| kink(0.4),
            false => |_| kink(-0.4),
        };
        // Slopes 1.2 ± 2θ beside the kink, and -2 from there on: it becomes a valley below a peak at θ = 0.6.
        let notch = kinked(sign, structure, |theta: f64, u: f64| {
            1.2 * u - u * u + 2.0 * theta * u.abs()
        });
        let result = run(&notch, (0.23, 1.0, 12), 1e-4);
        let found = rows(&result);
        assert_eq!(found.len(), 1, "{found:?}");
        let row = found[0];
        assert_eq!(
            words(row),
            "1 peak → 2 peaks, peak and valley are born at a kink"
        );
        assert_eq!(row.status(), BifurcationStatus::Located, "{row:?}");
        assert!(
            (row.value - 0.6).abs() <= row.error && row.error < 1e-4,
            "{row:?}"
        );
        // Above the kink the slope is -θ + 2u - 3u²: a tip and a valley from 0 on, until valley and peak vanish at 1/3.
        let tip = kinked(sign, structure, |theta: f64, u: f64| match u < 0.0 {
            true => u,
            false => -theta * u + u * u - u.powi(3),
        });
        let result = run(&tip, (-0.31, 0.5, 12), 1e-4);
        let found = rows(&result);
        let told: Vec<String> = found.iter().map(|row| words(row)).collect();
        let expected = [
            "1 peak → 2 peaks, peak and valley are born at a kink",
            "2 peaks → 1 peak, peak and valley vanish",
        ];
        assert_eq!(told, expected);
        for (row, truth) in found.iter().zip([0.0, 1.0 / 3.0]) {
            assert_eq!(row.status(), BifurcationStatus::Located, "{row:?}");
            assert!((row.value - truth).abs() <= row.error, "{row:?}");
        }
    }
}

#[test]
fn the_end_of_a_ring_around_a_peak_is_located() {
    let source = Exact::new(
        2,
        80,
        |_| centred(2),
        |c: f64, at: &[f64]| {
            let energy = at[0] * at[0] + at[1] * at[1];
            (-6.0 * (c * energy - 0.5 * energy.powi(2) + energy.powi(3) / 3.0)).exp()
        },
    );
    let result = run(&source, (-0.2, 0.5, 11), 1e-4);
    let found = lines(&result);
    assert_eq!(found.len(), 2, "{found:#?}");
    let rows = rows(&result);
    assert!(
        words(rows[0]).starts_with("ring → peak in a ring"),
        "{found:#?}"
    );
    assert!(
        words(rows[1]).starts_with("peak in a ring → 1 peak, ring vanishes"),
        "{found:#?}"
    );
    for (row, truth) in rows.iter().zip([0.0, 0.25]) {
        assert_eq!(row.status(), BifurcationStatus::Located, "{found:#?}");
        assert!(
            (row.value - truth).abs() <= row.error && row.error < 1e-4,
            "{found:#?}"
        );
    }
}

#[test]
fn a_peak_born_beside_another_in_the_plane_is_located() {
    let source = Exact::new(
        2,
        90,
        |_| Structure::default(),
        |h: f64, at: &[f64]| {
            let (x, y) = (0.8 * at[0] + 0.6 * at[1], 0.8 * at[1] - 0.6 * at[0]);
            (-6.0 * (0.5 * y * y - h * x - 0.5 * x * x + 0.25 * x.powi(4))).exp()
        },
    );
    let result = run(&source, (-0.55, 0.5, 12), 1e-4);
    let found = lines(&result);
    assert_eq!(found.len(), 2, "{found:#?}");
    let truth = (4.0f64 / 27.0).sqrt();
    for (row, truth) in rows(&result).iter().zip([-truth, truth]) {
        assert_eq!(row.status(), BifurcationStatus::Located, "{found:#?}");
        assert!(
            (row.value - truth).abs() <= row.error && row.error < 1e-4,
            "{found:#?}"
        );
    }
}

#[test]
fn a_split_that_is_not_quite_symmetric_is_located_where_its_pair_is_born() {
    // (log p)' = 8 (0.001 + θ x - x³): 27 · 0.001² = 4 θ³.
    let source = Exact::new(
        1,
        100,
        |_| Structure::default(),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            (8.0 * (0.001 * x + 0.5 * theta * x * x - 0.25 * x.powi(4))).exp()
        },
    );
    let result = run(&source, (-1.0, 1.0, 41), 2e-4);
    let truth = 3.0 * (0.0005f64).powf(2.0 / 3.0);
    let found = lines(&result);
    assert_eq!(found.len(), 1, "{found:#?}");
    let row = rows(&result)[0];
    assert!((row.value - truth).abs() <= row.error, "{found:#?}");
}

/// Two bistable units coupled by θ: where θ = 1/3 the peaks on the line x₁ = -x₂ become saddles, both at once.
fn coupled(tilt: f64) -> Exact<impl Formula> {
    Exact::new(
        2,
        60,
        |_| Structure::default(),
        move |theta: f64, at: &[f64]| {
            let well = |x: f64| 0.25 * x.powi(4) - 0.5 * x * x;
            let potential = well(at[0]) + well(at[1]) + 0.5 * theta * (at[0] - at[1]).powi(2);
            (-5.0 * (potential - tilt * (at[0] + at[1]))).exp()
        },
    )
}

#[test]
fn a_pitchfork_off_the_centre_is_told_from_a_fold() {
    let result = run(&coupled(0.0), (0.26, 0.40, 8), 1e-4);
    let rows = rows(&result);
    assert_eq!(rows.len(), 1, "{:?}", lines(&result));
    let row = rows[0];
    assert!(
        words(row).ends_with("peak becomes a saddle"),
        "{}",
        words(row)
    );
    assert_eq!(row.status(), BifurcationStatus::Located, "{row:?}");
    assert!(
        (row.value - 1.0 / 3.0).abs() <= row.error && row.error < 5e-5,
        "{row:?}"
    );
}

#[test]
fn a_broken_pitchfork_is_a_fold() {
    // On the line across, V' = -h + (2 - 6θ) s + s³ with higher terms: folds lie below 1/3 by the power 2/3 of the
    // tilt.
    let result = run(&coupled(0.02), (0.20, 0.34, 8), 1e-4);
    let rows = rows(&result);
    assert!(!rows.is_empty(), "{:?}", lines(&result));
    for row in rows {
        assert_eq!(row.indicator(), Some(IndicatorKind::FOLD), "{row:?}");
        assert!(row.upper < 0.33, "{row:?}");
    }
}

/// Peaks at -0.64 and 0.1 with a valley at -0.42 between them, and up to θ = 0 a peak and a valley about -0.8:
/// (log p)' = -200 ((x + 0.8)² + θ) (x + 0.64) (x + 0.42) (x - 0.1). Beyond θ = 0 the shoulder about -0.8 soon vanishes
/// and leaves the flank at -0.5 as the nearest inflection of its direction.
fn beside_another_flank() -> Exact<impl Formula> {
    let slope = |theta: f64, x: f64| {
        let pair = (x + 0.8).powi(2) + theta;
        -200.0 * pair * (x + 0.64) * (x + 0.42) * (x - 0.1)
    };
    Exact::new(
        1,
        200,
        |_| Structure::default(),
        move |theta: f64, at: &[f64]| {
            // Three nodes integrate a polynomial of fifth degree exactly.
            let nodes = GAUSS.iter();
            let mean: f64 = nodes
                .map(|(node, weight)| weight * slope(theta, 0.5 * at[0] * (1.0 + node)))
                .sum();
            (at[0] * mean).exp()
        },
    )
}

#[test]
fn a_pair_that_vanishes_beside_the_flank_of_another_is_not_followed_to_that_flank() {
    for points in [6, 8, 11] {
        let result = run(&beside_another_flank(), (-0.015, 0.1, points), 1e-4);
        let found = rows(&result);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(words(found[0]), "3 peaks → 2 peaks, peak and valley vanish");
        assert_eq!(
            found[0].status(),
            BifurcationStatus::Located,
            "{:?}",
            found[0]
        );
        assert!(found[0].value.abs() <= found[0].error, "{:?}", found[0]);
    }
}
