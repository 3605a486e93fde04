//! What must not change a detection: scale, mirror, shift, exchange of axes.

use super::*;
use crate::density::{Density, Observable};
use crate::space::Axis;
use proptest::prelude::*;

/// A rough density over 9 × 11 cells with errors: random heights on two hills, so that some features are
/// present, some unresolved, some absent.
fn rough(noise: &[f64]) -> EstimatedDensity {
    let x = Axis::uniform(-1.0, 1.0, 9).unwrap();
    let y = Axis::uniform(-2.0, 2.0, 11).unwrap();
    let value = |cell: usize| {
        let (x, y) = (x.centre(cell / 11), y.centre(cell % 11));
        2.0 * (-(y.abs() - 1.2).powi(2) - x * x).exp() + noise[cell]
    };
    EstimatedDensity {
        standard_error: (0..99).map(|cell| 0.05 + 0.02 * noise[cell]).collect(),
        ..EstimatedDensity::new(
            Observable::Joint(0, 1),
            Density {
                values: (0..99).map(value).collect(),
                axes: vec![x, y],
            },
        )
    }
}

/// The same cells in another order, on other axes.
fn rearranged(
    of: &EstimatedDensity,
    axes: Vec<Axis>,
    source: impl Fn(usize) -> usize,
) -> EstimatedDensity {
    let take = |values: &[f64]| (0..values.len()).map(|cell| values[source(cell)]).collect();
    EstimatedDensity {
        standard_error: take(&of.standard_error),
        ..EstimatedDensity::new(
            of.observable,
            Density {
                axes,
                values: take(&of.density.values),
            },
        )
    }
}

fn detect(density: &EstimatedDensity) -> Detection {
    PersistenceDetector::new(DetectOptions::default(), 10).detect(density)
}

/// Whether both list the same features once places are mapped and heights scaled.
fn check_same(
    first: &Detection,
    second: &Detection,
    place: impl Fn(&[f64]) -> Vec<f64>,
    scale: f64,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(first.signature, second.signature);
    prop_assert_eq!(first.features.len(), second.features.len());
    for (a, b) in first.features.iter().zip(&second.features) {
        prop_assert_eq!((a.kind, a.verdict), (b.kind, b.verdict));
        prop_assert!((a.significance - b.significance).abs() < 1e-6 * (1.0 + a.significance));
        let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * scale;
        prop_assert!(close(a.persistence * scale, b.persistence));
        prop_assert!(close(a.standard_error * scale, b.standard_error));
        prop_assert!(close(a.density * scale, b.density));
        for (expected, found) in place(&a.position).iter().zip(&b.position) {
            prop_assert!((expected - found).abs() < 1e-5, "{:?} {:?}", a, b);
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn scaling_scales_the_heights_alone(noise in prop::collection::vec(0.0..0.8f64, 99)) {
        let density = rough(&noise);
        let mut scaled = density.clone();
        scaled.density.values.iter_mut().for_each(|value| *value *= 10.0);
        scaled.standard_error.iter_mut().for_each(|error| *error *= 10.0);
        check_same(&detect(&density), &detect(&scaled), |p| p.to_vec(), 10.0)?;
    }

    #[test]
    fn mirroring_mirrors_the_places_alone(noise in prop::collection::vec(0.0..0.8f64, 99)) {
        let density = rough(&noise);
        let axes = density.density.axes.clone();
        let mirrored = rearranged(&density, axes.clone(), |cell| (8 - cell / 11) * 11 + cell % 11);
        check_same(&detect(&density), &detect(&mirrored), |p| vec![-p[0], p[1]], 1.0)?;
        let mirrored = rearranged(&density, axes, |cell| cell / 11 * 11 + 10 - cell % 11);
        check_same(&detect(&density), &detect(&mirrored), |p| vec![p[0], -p[1]], 1.0)?;
    }

    #[test]
    fn shifting_shifts_the_places_alone(noise in prop::collection::vec(0.0..0.8f64, 99)) {
        let density = rough(&noise);
        let axes = vec![Axis::uniform(4.0, 6.0, 9).unwrap(), Axis::uniform(-9.0, -5.0, 11).unwrap()];
        let shifted = rearranged(&density, axes, |cell| cell);
        check_same(&detect(&density), &detect(&shifted), |p| vec![p[0] + 5.0, p[1] - 7.0], 1.0)?;
    }

    #[test]
    fn exchanging_the_axes_exchanges_coordinates_alone(noise in prop::collection::vec(0.0..0.8f64, 99)) {
        let density = rough(&noise);
        let axes = density.density.axes.iter().rev().cloned().collect();
        let transposed = rearranged(&density, axes, |cell| cell % 9 * 11 + cell / 9);
        check_same(&detect(&density), &detect(&transposed), |p| vec![p[1], p[0]], 1.0)?;
    }
}
