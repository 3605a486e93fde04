//! Joint densities over an angle and a line, whose crest runs around.

use std::f64::consts::PI;

use super::*;

/// p ∝ (1 + ε cos φ) exp(-(w - 4 - 0.15 sin φ)²/0.5) over a turn of 120 bins and a line of few cells: along the crest,
/// which crosses the cells obliquely, the density changes by less than its values at the centres of cells do.
fn running(epsilon: f64, cells: usize) -> Detection {
    let turn = Axis::turn(-PI, PI, 120).unwrap();
    let line = Axis::uniform(-3.0, 8.0, cells).unwrap();
    let density = joint(&turn, &line, |angle, w| {
        let away = w - 4.0 - 0.15 * angle.sin();
        (1.0 + epsilon * angle.cos()) * (-away * away / 0.5).exp()
    });
    PersistenceDetector::new(DetectOptions::default(), 1).detect(&density)
}

/// The highest cells of a crest that is nearly level lie many bins of the turn from its peak.
#[test]
fn a_peak_of_a_crest_that_runs_around_is_found_far_from_its_highest_cell() {
    // The integral of the exponential is √(π/2), that over the turn 2π.
    let mean = 1.0 / (2.0 * PI * (0.5 * PI).sqrt());
    for cells in [80, 90, 100, 110, 120] {
        let found = running(0.01, cells);
        assert_eq!(found.signature.to_string(), "1 peak", "{cells} cells");
        let valley = found.ranked(FeatureKind::Valley, 0).unwrap();
        let height = valley.persistence / mean;
        assert!((height - 0.02).abs() < 2e-4, "{height} on {cells} cells");
        let level = running(0.0, cells);
        assert_eq!(level.signature.to_string(), "ring", "{cells} cells");
    }
}
