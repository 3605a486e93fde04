//! Peaks at walls and in corners, where the density rises up to the end of its range.

use super::*;

/// Two wells, tilted.
fn wells(x: f64, tilt: f64) -> f64 {
    (2.0 * (x * x - 0.5 * x.powi(4)) + 2.0 * tilt * x).exp()
}

/// ∫ of a function, by the midpoint rule.
fn integral(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    let count = 200_000;
    let width = (to - from) / f64::from(count);
    (0..count)
        .map(|one| function(from + (f64::from(one) + 0.5) * width) * width)
        .sum()
}

/// The peaks of two wells beside each other, each cut off by a wall: places and heights are those of the product.
#[test]
fn peaks_at_walls_and_in_corners_are_counted_where_they_are() {
    for (walls, tilts, count) in [
        ([-0.9, -0.7], [0.05, 0.03], 40),
        ([-0.85, -0.6], [0.05, 0.03], 60),
        ([-0.8, -0.8], [-0.02, 0.03], 50),
        ([-0.9, -0.9], [0.0, 0.1], 80),
    ] {
        let axes = walls.map(|wall| Axis::uniform(wall, 2.4, count).unwrap());
        let density = joint(&axes[0], &axes[1], |x, y| {
            wells(x, tilts[0]) * wells(y, tilts[1])
        });
        let whole: f64 = (0..2)
            .map(|k| integral(walls[k], 2.4, |x| wells(x, tilts[k])))
            .product();
        let detection = PersistenceDetector::new(DetectOptions::default(), 1).detect(&density);
        assert_eq!(detection.signature.peaks, 4, "{walls:?}");
        let tops = [0, 1].map(|k| {
            // 2 (x - x³) + 2 t = 0 in the well.
            let mut top = 1.0_f64;
            for _ in 0..40 {
                top -= (top - top.powi(3) + 0.5 * tilts[k]) / (1.0 - 3.0 * top * top);
            }
            [walls[k], top]
        });
        for peak in tops[0]
            .iter()
            .flat_map(|&x| tops[1].iter().map(move |&y| [x, y]))
        {
            let height = wells(peak[0], tilts[0]) * wells(peak[1], tilts[1]) / whole;
            let found = detection
                .features
                .iter()
                .filter(|one| one.kind == FeatureKind::Peak);
            let near = |one: &&Feature| {
                (0..2).all(|k| (one.position[k] - peak[k]).abs() < 0.5 * axes[k].width(0))
            };
            let found = found
                .clone()
                .find(near)
                .unwrap_or_else(|| panic!("{walls:?}: {peak:?}"));
            assert_eq!(found.verdict, Verdict::Present);
            // Averages over cells, by Gauss's rule, are known to a millionth.
            let off = (found.density - height).abs();
            assert!(
                off <= found.errors.density.unwrap() + 1e-6 * height,
                "{peak:?}: {} and {height}",
                found.density
            );
            assert!(
                off < 1e-3 * height,
                "{peak:?}: {} and {height}",
                found.density
            );
            for k in 0..2 {
                // At a wall it is the wall itself; elsewhere its error holds to a thousandth of a cell.
                let most = match peak[k] == walls[k] {
                    true => 0.0,
                    false => found.errors.position[k] + 1e-3 * axes[k].width(0),
                };
                let off = (found.position[k] - peak[k]).abs();
                assert!(off <= most, "{peak:?}: {:?}", found.position);
            }
        }
    }
}

#[test]
fn a_marginal_that_rises_to_a_wall_has_its_peak_there() {
    let axis = Axis::uniform(-1.0, 1.3, 40).unwrap();
    let density = marginal(&axis, |x| (0.6 * x).exp());
    let exact = (0.6_f64 * 1.3).exp() * 0.6 / ((0.78_f64).exp() - (-0.6_f64).exp());
    let detection = PersistenceDetector::new(DetectOptions::default(), 1).detect(&density);
    let peak = detection.ranked(FeatureKind::Peak, 0).unwrap();
    assert_eq!(peak.position, vec![1.3]);
    assert!((peak.density - exact).abs() <= peak.errors.density.unwrap().max(1e-9));
    assert!((peak.density - exact).abs() < 1e-7);
}

/// A normal density that is cut off before its peak: the end is where it is highest, and no more than where it was cut.
#[test]
fn a_peak_at_an_end_that_is_not_the_systems_own_may_lie_beyond_it() {
    for (middle, variance) in [(0.4, 0.5), (0.15, 0.2), (1.0, 2.0), (0.02, 1.0)] {
        let axis = Axis::uniform(-2.0, 0.0, 40).unwrap();
        let density = |x: f64| (-0.5 * (x - middle) * (x - middle) / variance).exp();
        let mut estimated = marginal(&axis, density);
        let place = |estimated: &EstimatedDensity| {
            let detector = PersistenceDetector::new(DetectOptions::default(), 1);
            let detection = detector.detect(estimated);
            let peak = detection.ranked(FeatureKind::Peak, 0).unwrap();
            (peak.position[0], peak.errors.position[0])
        };
        let (at, error) = place(&estimated);
        assert_eq!(at, 0.0);
        // The parabola of the logarithm is exact here, and the error no less than a cell.
        let expected = f64::max(middle, 0.05);
        assert!((error / expected - 1.0).abs() < 1e-2, "{error} {expected}");
        // A wall is where it is.
        estimated.structure.own_ends = vec![[true, true]];
        assert_eq!(place(&estimated), (0.0, 0.0));
    }
}
