//! Several changes between two given values: each has its row, as far as they can be told apart.

use super::*;

#[test]
fn a_stage_within_a_narrow_window_has_its_own_rows() {
    // Curvatures θ and θ + 0.002 at the centre: two peaks only for -0.002 < θ < 0, between given values.
    let source = Exact::new(
        2,
        60,
        |_| centred(2),
        |theta: f64, at: &[f64]| {
            let (x, y) = (at[0], at[1]);
            let square = x * x + y * y;
            (0.5 * (theta * x * x + (theta + 0.002) * y * y) - 0.5 * square * square).exp()
        },
    );
    let result = run(&source, (-0.525, 0.475, 11), 1e-5);
    let rows = rows(&result);
    let found: Vec<String> = rows.iter().map(|row| words(row)).collect();
    assert_eq!(
        found,
        [
            "1 peak → 2 peaks, symmetric split",
            "2 peaks → crater with 2 peaks, crater opens"
        ]
    );
    for (row, truth) in rows.iter().zip([-0.002, 0.0]) {
        assert!(
            (row.value - truth).abs() <= row.error && row.error < 1e-4,
            "{row:?}"
        );
    }
}

#[test]
fn two_changes_between_two_given_values_are_both_found() {
    // The curvature (θ - 0.52)² - 0.0004 is positive at all given values; the valley is a peak only from 0.50 to 0.54.
    let source = Exact::new(
        1,
        100,
        |_| centred(1),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            let curvature = (theta - 0.52).powi(2) - 0.0004;
            (4.0 * (0.5 * curvature * x * x - 0.25 * x.powi(4))).exp()
        },
    );
    let result = run(&source, (0.0, 0.95, 11), 1e-3);
    let found: Vec<(String, f64)> = rows(&result)
        .iter()
        .map(|row| (words(row), row.value))
        .collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].0.starts_with("2 peaks → 1 peak") && (found[0].1 - 0.50).abs() < 1e-4);
    assert!(found[1].0.starts_with("1 peak → 2 peaks") && (found[1].1 - 0.54).abs() < 1e-4);
}

#[test]
fn curvatures_that_vanish_together_make_one_row() {
    let source = Exact::new(
        2,
        60,
        |_| centred(2),
        |theta: f64, at: &[f64]| {
            let square = at[0] * at[0] + at[1] * at[1];
            (0.5 * theta * square - 0.5 * square * square).exp()
        },
    );
    let result = run(&source, (-0.5, 0.5, 10), 1e-4);
    let rows = rows(&result);
    assert_eq!(rows.len(), 1, "{rows:?}");
    assert!(
        words(rows[0]).starts_with("1 peak → ring, ring opens"),
        "{}",
        words(rows[0])
    );
    assert!(rows[0].value.abs() <= rows[0].error && rows[0].error < 1e-4);
}

#[test]
fn densities_that_change_fast_get_values_between() {
    // A peak that moves by four of its widths a step.
    let source = Exact::new(
        1,
        200,
        |_| Structure::default(),
        |theta: f64, at: &[f64]| (-0.5 * ((at[0] - theta) / 0.05).powi(2)).exp(),
    );
    let result = run(&source, (-1.0, 1.0, 11), 1e-3);
    let largest = result
        .points
        .iter()
        .filter_map(|point| point.distance)
        .fold(0.0, f64::max);
    assert!(result.points.len() > 11 && largest <= LocateOptions::default().largest_distance);
    assert!(rows(&result).is_empty());
}

#[test]
fn two_folds_within_one_step_have_a_row_each() {
    // (log p)' = -(x - 1.1) (x + 1.1) ... three peaks become one: shoulders of opposite flanks pass zero at 0.1 and
    // 0.11.
    let source = Exact::new(
        1,
        160,
        |_| Structure::default(),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            // A wide hill and two bumps on its flanks, whose heights fall below what makes a peak.
            let bump = |c: f64, w: f64| w * (-0.5 * ((x - c) / 0.15).powi(2)).exp();
            (-0.5 * x * x + bump(-1.0, 0.3 - theta) + bump(1.0, 0.31 - theta)).exp()
        },
    );
    let result = run(&source, (0.0, 0.3, 4), 1e-4);
    let found = lines(&result);
    assert_eq!(found.len(), 2, "{found:#?}");
    let rows = rows(&result);
    assert_eq!(words(rows[0]), "3 peaks → 2 peaks, peak and valley vanish");
    assert_eq!(words(rows[1]), "2 peaks → 1 peak, peak and valley vanish");
    assert!(
        (rows[1].value - rows[0].value - 0.01).abs() < 1e-4,
        "the same bump, 0.01 higher: {found:#?}"
    );
    assert!(
        rows.iter()
            .all(|row| row.status() == BifurcationStatus::Located)
    );
}

#[test]
fn changes_that_undo_each_other_far_apart_keep_their_rows_though_neither_is_located() {
    // One bump of a wide hill grows as much as the other shrinks: by symmetry their pairs are born and vanish at θ and
    // 0.6 - θ.
    let source = Exact::new(
        1,
        160,
        |_| Structure::default(),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            let bump = |c: f64, w: f64| w * (-0.5 * ((x - c) / 0.15).powi(2)).exp();
            (-0.5 * x * x + bump(-1.0, theta) + bump(1.0, 0.6 - theta)).exp()
        },
    );
    let result = run(&source, (0.1, 0.5, 8), 1e-9);
    let rows = rows(&result);
    let found: Vec<String> = rows.iter().map(|row| words(row)).collect();
    assert_eq!(rows.len(), 2, "{found:?}");
    assert_eq!(rows[0].before, rows[1].after, "{found:?}");
    for row in &rows {
        assert_eq!(row.status(), BifurcationStatus::Unresolved);
        assert!(row.error < 1e-3 && row.reason().is_some(), "{row:?}");
    }
    let (sum, error) = (rows[0].value + rows[1].value, rows[0].error + rows[1].error);
    assert!((sum - 0.6).abs() <= error, "{sum} ± {error}");
}
