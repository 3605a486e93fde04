//! What is drawn between the cells: its averages, its order, its kinks, and that it has no peak of its own.

use super::*;
use crate::density::{Density, Kink, Observable, Structure};
use crate::space::Grading;

/// A density with these axes and averages, and kinks on faces of its first axis.
fn estimated(axes: Vec<Axis>, values: Vec<f64>, kinks: &[f64]) -> EstimatedDensity {
    let kink = |&at: &f64| Kink {
        axis: 0,
        at,
        jump: vec![-1.0],
    };
    EstimatedDensity {
        structure: Structure {
            kinks: kinks.iter().map(kink).collect(),
            ..Structure::default()
        },
        ..EstimatedDensity::new(Observable::Marginal(0), Density { axes, values })
    }
}

fn graded(count: usize) -> Axis {
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.2 / count as f64,
    };
    Axis::graded(-4.0, 4.0, count, &grading).unwrap()
}

/// Averages over cells by Simpson's rule on 32 parts of each.
fn averages(axis: &Axis, p: impl Fn(f64) -> f64) -> Vec<f64> {
    let edges = axis.edges().windows(2);
    let average = |edge: &[f64]| {
        let at = |k: usize| p(edge[0] + (edge[1] - edge[0]) * k as f64 / 64.0);
        let part = |k: usize| (at(2 * k) + 4.0 * at(2 * k + 1) + at(2 * k + 2)) / 6.0;
        (0..32).map(part).sum::<f64>() / 32.0
    };
    edges.map(average).collect()
}

/// Places that divide every cell of an axis into so many parts.
fn parts(axis: &Axis, count: usize) -> Vec<f64> {
    let edges = axis.edges().windows(2);
    let part =
        |edge: &[f64], k: usize| edge[0] + (edge[1] - edge[0]) * (k as f64 + 0.5) / count as f64;
    edges
        .flat_map(|edge| (0..count).map(|k| part(edge, k)).collect::<Vec<_>>())
        .collect()
}

/// Peaks of a list of numbers; a level top counts once, and what differs by rounding is level.
fn peaks(values: &[f64]) -> usize {
    let largest = values.iter().copied().fold(0.0, f64::max);
    let mut levels = vec![values[0]];
    for &value in values {
        if (value - levels[levels.len() - 1]).abs() > 1e-12 * largest {
            levels.push(value);
        }
    }
    let at = |i: isize| usize::try_from(i).ok().and_then(|i| levels.get(i));
    let is_peak = |&i: &isize| {
        let beside = [at(i - 1), at(i + 1)];
        at(i).is_some_and(|value| beside.iter().flatten().all(|other| *other < value))
    };
    (0..levels.len() as isize).filter(is_peak).count()
}

#[test]
fn smooth_densities_are_drawn_with_order_three_and_their_averages() {
    let p = |x: f64| (x * x - 0.25 * x.powi(4)).exp();
    let error = |count: usize| {
        let axis = graded(count);
        let estimated = estimated(vec![axis.clone()], averages(&axis, p), &[]);
        let drawn = Between::new(&estimated).unwrap();
        let places = parts(&axis, 50);
        let values = drawn.curve(&places);
        for (cell, part) in values.chunks(50).enumerate() {
            // The midpoint rule errs by a 24 · 50²th of the curvature, which is at most twelve times what a cell
            // differs by.
            let average = part.iter().sum::<f64>() / 50.0;
            let wanted = estimated.density.values[cell];
            assert!(
                (average - wanted).abs() < 2e-4 * (wanted + drawn.largest() * 0.1),
                "{cell}"
            );
        }
        let errors = places
            .iter()
            .zip(&values)
            .map(|(&x, value)| (value - p(x)).abs());
        errors.fold(0.0, f64::max) / drawn.largest()
    };
    let (coarse, fine) = (error(60), error(120));
    assert!(coarse < 4e-3, "{coarse}");
    assert!((coarse / fine).log2() > 2.7, "{coarse} {fine}");
}

#[test]
fn a_kink_stays_a_kink_and_its_tip_is_drawn() {
    // p(y) of Coulomb friction without a spring: slopes ∓ 2 f_c/σ² of log p at 0.
    let (kappa, friction, intensity) = (0.01, 0.01, 0.01);
    for friction in [friction, -friction] {
        let p = |y: f64| (-(kappa * y * y + 2.0 * friction * y.abs()) / intensity).exp();
        let axis = Axis::uniform(-4.0, 4.0, 80).unwrap();
        let estimated = estimated(vec![axis.clone()], averages(&axis, p), &[0.0]);
        let drawn = Between::new(&estimated).unwrap();
        let step = 1e-6;
        let values = drawn.curve(&[-step, 0.0, step]);
        // Eight cells of 0.1 on either side give the tip: h⁸ = 1e-8, and the ninth derivative of the primitive is in
        // the hundreds.
        assert!((values[1] - 1.0).abs() < 1e-5, "{values:?}");
        let slopes = [
            (values[1] - values[0]) / step,
            (values[2] - values[1]) / step,
        ];
        let wanted = 2.0 * friction / intensity;
        assert!(
            (slopes[0] - wanted).abs() < 0.02 * wanted.abs(),
            "{slopes:?}"
        );
        assert!(
            (slopes[1] + wanted).abs() < 0.02 * wanted.abs(),
            "{slopes:?}"
        );
        let places = drawn.places(0, (-4.0, 4.0), 400);
        assert!(places.iter().any(|place| place.abs() < 1e-11));
        assert_eq!(
            peaks(&drawn.curve(&places)),
            if friction > 0.0 { 1 } else { 2 }
        );
    }
}

#[test]
fn nothing_is_drawn_below_zero_and_no_peak_that_the_cells_do_not_have() {
    let mut state = 12345u64;
    let mut next = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    for trial in 0..300 {
        let axis = if trial % 2 == 0 {
            graded(24)
        } else {
            Axis::uniform(0.0, 1.0, 24).unwrap()
        };
        let mut values: Vec<f64> = (0..24).map(|_| next().powi(1 + trial % 7)).collect();
        if trial % 3 == 0 {
            // A single peak with steep and flat places.
            values.sort_by(f64::total_cmp);
            let (rising, mut falling): (Vec<f64>, Vec<f64>) =
                (values[..14].into(), values[14..].into());
            falling.reverse();
            values = [rising, falling].concat();
        }
        let kinks: &[f64] = if trial % 4 == 2 { &[0.0] } else { &[] };
        let estimated = estimated(vec![axis.clone()], values.clone(), kinks);
        let drawn = Between::new(&estimated).unwrap();
        let curve = drawn.curve(&drawn.places(0, (axis.from(), axis.to()), 2000));
        assert!(curve.iter().all(|&value| value >= 0.0), "{trial}");
        assert!(peaks(&curve) <= peaks(&values), "{trial}: {values:?}");
    }
}

#[test]
fn a_sheet_has_the_averages_of_its_cells_and_a_crater_its_rim() {
    let axes = [graded(40), Axis::uniform(-4.0, 4.0, 36).unwrap()];
    let p = |x: f64, y: f64| {
        let energy = 0.5 * (x * x + y * y);
        (2.0 * energy - energy * energy).exp()
    };
    let rows = axes[1].count();
    let columns: Vec<Vec<f64>> = parts(&axes[0], 8)
        .chunks(8)
        .map(|xs| averages(&axes[1], |y| xs.iter().map(|&x| p(x, y)).sum::<f64>() / 8.0))
        .collect();
    let estimated = estimated(axes.to_vec(), columns.concat(), &[]);
    let drawn = Between::new(&estimated).unwrap();
    let n = 8;
    let sheet = drawn.sheet(&parts(&axes[0], n), &parts(&axes[1], n));
    let width = n * rows;
    let highest = drawn.largest();
    for (cell, &wanted) in estimated.density.values.iter().enumerate() {
        let (i, j) = (cell / rows, cell % rows);
        let row = |a: usize| (0..n).map(move |b| (i * n + a) * width + j * n + b);
        let sum: f64 = (0..n).flat_map(row).map(|at| sheet[at]).sum();
        // The midpoint rule on 8 × 8 parts errs by a 24 · 64th of the curvatures over a cell.
        assert!((sum / 64.0 - wanted).abs() < 5e-3 * highest, "{cell}");
    }
    assert!(sheet.iter().all(|&value| value >= 0.0));
    assert!((drawn.sheet(&[0.0], &[0.0])[0] - 1.0).abs() < 2e-3 * highest);
    assert!((highest - 1f64.exp()).abs() < 2e-3 * highest, "{highest}");
    let section = drawn.section(0, 0.0);
    let wanted = averages(&axes[0], |x| p(x, 0.0));
    let off = section.iter().zip(&wanted).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 5e-3 * highest);
    assert!(drawn.sheet(&[9.0], &[0.0])[0].is_nan());
}

#[test]
fn sampled_and_coarse_densities_are_their_cells() {
    let axis = Axis::uniform(-1.0, 1.0, 20).unwrap();
    let mut one = estimated(vec![axis.clone()], vec![0.5; 20], &[]);
    assert!(Between::new(&one).is_some());
    one.standard_error[3] = 1e-3;
    assert!(Between::new(&one).is_none());
    let few = Axis::uniform(-1.0, 1.0, 7).unwrap();
    assert!(Between::new(&estimated(vec![few], vec![0.5; 7], &[])).is_none());
    let mut broken = estimated(vec![axis], vec![0.5; 20], &[]);
    broken.density.values[2] = f64::NAN;
    assert!(Between::new(&broken).is_none());
}
