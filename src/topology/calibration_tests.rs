//! The detector on sampled densities: how often noise counts as a feature, and whether features are found.

use super::analytic_tests::{joint, marginal};
use super::*;
use crate::density::{Observable, estimate};
use crate::space::{Axis, CellSpace};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Poisson, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

const GROUPS: usize = 8;

/// Normalised mass without one group, from counts a group and cell; no group is left out for `GROUPS`.
fn without(counts: &[Vec<f64>], skipped: usize) -> Vec<f64> {
    let kept = || (0..GROUPS).filter(|&group| group != skipped);
    let cells = counts[0].len();
    let sums: Vec<f64> = (0..cells)
        .map(|c| kept().map(|g| counts[g][c]).sum())
        .collect();
    let total: f64 = sums.iter().sum();
    sums.iter().map(|sum| sum / total).collect()
}

/// A histogram of `samples` draws of a density in eight groups, with errors from its replicates.
fn sampled(truth: &EstimatedDensity, samples: f64, seed: u64) -> EstimatedDensity {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let masses = truth.density.masses();
    let mut draw = |mass: &f64| match Poisson::new(samples / GROUPS as f64 * mass) {
        Ok(poisson) => poisson.sample(&mut random),
        Err(_) => 0.0,
    };
    let counts: Vec<Vec<f64>> = (0..GROUPS)
        .map(|_| masses.iter().map(&mut draw).collect())
        .collect();
    from_counts(truth, &counts)
}

fn from_counts(truth: &EstimatedDensity, counts: &[Vec<f64>]) -> EstimatedDensity {
    let space = CellSpace::new(truth.density.axes.clone()).unwrap();
    let observable = match truth.density.axes.len() {
        1 => Observable::Marginal(0),
        _ => Observable::Joint(0, 1),
    };
    let replicates: Vec<Vec<f64>> = (0..GROUPS).map(|group| without(counts, group)).collect();
    estimate(&space, observable, &without(counts, GROUPS), &replicates).unwrap()
}

/// Of 200 seeds, each a sweep of one look: how many have a feature too many, and how many one unresolved.
fn noise_rate(truth: &EstimatedDensity, expected: (usize, usize), samples: f64) -> (usize, usize) {
    let detector = PersistenceDetector::new(DetectOptions::default(), 1);
    let (mut wrong, mut unresolved) = (0, 0);
    for seed in 0..200 {
        let detection = detector.detect(&sampled(truth, samples, seed));
        // A rim of constant height counts as its top.
        let signature = detection.signature;
        let found = (signature.peaks + signature.rings, signature.craters);
        assert!(
            found.0 >= expected.0 && found.1 >= expected.1,
            "missed: {found:?} seed {seed}"
        );
        wrong += usize::from(found != expected);
        unresolved += usize::from(
            detection
                .features
                .iter()
                .any(|feature| feature.verdict == Verdict::Unresolved),
        );
    }
    (wrong, unresolved)
}

/// The most false alarms that 200 sweeps of 5 % may show: mean 10, and 2.3 standard deviations of 3.1.
const MOST_WRONG: usize = 17;

fn plane() -> Axis {
    Axis::uniform(-3.0, 3.0, 50).unwrap()
}

#[test]
fn noise_makes_no_features_on_joint_densities() {
    let axis = plane();
    let hill = joint(&axis, &axis, |x, y| (-0.5 * (x * x + y * y)).exp());
    // A nearly flat top: neighbouring cells differ by far less than their noise.
    let plateau = joint(&axis, &axis, |x, y| {
        (-((x * x + y * y) / 5.0).powi(4)).exp()
    });
    let ring = joint(&axis, &axis, |x, y| {
        (-8.0 * (x.hypot(y) - 1.5).powi(2)).exp()
    });
    // Hardly wider than a cell: few paths along the rim.
    let thin = joint(&axis, &axis, |x, y| {
        (-25.0 * (x.hypot(y) - 1.5).powi(2)).exp()
    });
    let pair = joint(&axis, &axis, |x, y| {
        (-4.0 * (x * x - 1.5).powi(2) - y * y).exp()
    });
    for (truth, expected) in [
        (hill, (1, 0)),
        (plateau, (1, 0)),
        (ring, (1, 1)),
        (thin, (1, 1)),
        (pair, (2, 0)),
    ] {
        let (wrong, unresolved) = noise_rate(&truth, expected, 1e6);
        assert!(wrong <= MOST_WRONG, "{expected:?}: {wrong} of 200");
        // The typical limit is the median of the largest noise, or above it: half of the densities at most,
        // and the chance of a fair coin to show more than 125 of 200 is 2e-4.
        assert!(unresolved <= 125, "{expected:?}: {unresolved} of 200");
    }
}

#[test]
fn noise_makes_no_features_on_marginals() {
    let axis = Axis::uniform(-3.0, 3.0, 200).unwrap();
    let hill = marginal(&axis, |x| (-0.5 * x * x).exp());
    let plateau = marginal(&axis, |x| (-(x / 2.0).powi(8)).exp());
    let pair = marginal(&axis, |x| (-2.0 * (x * x - 1.5).powi(2)).exp());
    for (truth, expected) in [(hill, (1, 0)), (plateau, (1, 0)), (pair, (2, 0))] {
        let (wrong, unresolved) = noise_rate(&truth, expected, 1e5);
        assert!(wrong <= MOST_WRONG, "{expected:?}: {wrong} of 200");
        assert!(unresolved <= 125, "{expected:?}: {unresolved} of 200");
    }
}

#[test]
fn noise_that_neighbours_share_makes_no_features() {
    // A solve spreads the noise of a transition over its surroundings: noise smoothed over about σ = 1.5
    // cells, and a common factor a group.
    let axis = plane();
    let truth = joint(&axis, &axis, |x, y| {
        (-((x * x + y * y) / 5.0).powi(4)).exp()
    });
    let masses = truth.density.masses();
    let detector = PersistenceDetector::new(DetectOptions::default(), 1);
    let mut wrong = 0;
    for seed in 0..200 {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut group = || -> Vec<f64> {
            let raw: Vec<f64> = (0..2500).map(|_| random.sample(StandardNormal)).collect();
            let common: f64 = random.sample(StandardNormal);
            let smooth = smoothed(&smoothed(&smoothed(&raw)));
            let noisy = masses.iter().zip(&smooth).enumerate();
            noisy
                .map(|(cell, (mass, noise))| {
                    let tilt = 0.02 * common * axis.centre(cell / 50);
                    mass * (1.0 + 0.3 * noise + tilt).max(0.0) * 1e5
                })
                .collect()
        };
        let counts: Vec<Vec<f64>> = (0..GROUPS).map(|_| group()).collect();
        let signature = detector.detect(&from_counts(&truth, &counts)).signature;
        wrong += usize::from((signature.peaks, signature.craters) != (1, 0));
    }
    assert!(wrong <= MOST_WRONG, "{wrong} of 200");
}

/// Means over 3×3 cells of a 50×50 grid, cut at the border.
fn smoothed(values: &[f64]) -> Vec<f64> {
    let near = |at: usize| at.saturating_sub(1)..(at + 2).min(50);
    let mean = |cell: usize| {
        let cells = near(cell / 50).flat_map(|row| near(cell % 50).map(move |c| row * 50 + c));
        let (sum, count) = cells.fold((0.0, 0.0), |(sum, n), c| (sum + values[c], n + 1.0));
        sum / count
    };
    (0..2500).map(mean).collect()
}

#[test]
fn clear_features_are_found_in_every_sample_at_the_confidence_of_a_long_sweep() {
    let detector = PersistenceDetector::new(DetectOptions::default(), 200);
    let axis = plane();
    let pair = joint(&axis, &axis, |x, y| {
        (-2.0 * ((x - 1.2).powi(2) + y * y)).exp()
            + 0.6 * (-2.0 * ((x + 1.2).powi(2) + y * y)).exp()
    });
    let crater = joint(&axis, &axis, |x, y| {
        (0.8 + x * x + y * y) * (-(x * x + y * y) / 2.0).exp()
    });
    let line = Axis::uniform(-3.0, 3.0, 100).unwrap();
    let notch = marginal(&line, |y| (-0.5 * y * y + 0.6 * y.abs()).exp());
    for (truth, expected) in [(pair, (2, 0)), (crater, (0, 1)), (notch, (2, 0))] {
        for seed in 0..50 {
            let signature = detector.detect(&sampled(&truth, 1e6, seed)).signature;
            assert_eq!(
                (signature.peaks, signature.craters),
                expected,
                "seed {seed}"
            );
        }
    }
}
