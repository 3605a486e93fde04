//! The detector on densities whose features are known exactly.

mod births;
mod ends;
mod plane;
mod turns;

use super::*;
use crate::density::{Density, Observable, Variants};
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
    EstimatedDensity::new(observable, density)
}

/// Values of one axis that are given by their primitive, so that they are exact averages.
pub(super) fn averages(axis: &Axis, primitive: impl Fn(f64) -> f64) -> EstimatedDensity {
    let edges = axis.edges().windows(2);
    let values = edges.map(|edge| (primitive(edge[1]) - primitive(edge[0])) / (edge[1] - edge[0]));
    let density = Density {
        axes: vec![axis.clone()],
        values: values.collect(),
    };
    EstimatedDensity::new(Observable::Marginal(0), density)
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

/// Away from its edge the density is as smooth as can be; beyond it nothing is left within two cells.
#[test]
fn a_peak_beside_a_steep_edge_counts_wherever_the_edge_lies_in_its_cell() {
    let axis = uniform(2.65, 60);
    for step in 0..20 {
        let edge = 1.72 + axis.width(0) * f64::from(step) / 20.0;
        let hump = |x: f64| (-(x - 0.2).powi(2)).exp();
        let shore = |x: f64| 0.5 * (1.0 - ((x - edge) / 0.04).tanh());
        let p = |x: f64| (hump(x) + 0.8 * (-(x - 1.9).powi(2) / 0.5).exp()) * shore(x);
        let mut estimated = marginal(&axis, p);
        estimated.standard_error.fill(1e-3);
        estimated.variants = Variants::Scheme(estimated.density.values.clone());
        let found = detect(&estimated).signature;
        assert_eq!(found, signature(2, 0), "edge at {edge}");
    }
}
