//! Borders of basins and rings of densities that are known exactly.

use super::*;
use crate::density::{Density, Observable};
use crate::space::Axis;
use crate::topology::{DetectOptions, Detector, PersistenceDetector};

/// A density with these values at the centres of cells, and what is detected in it.
fn detected(log: impl Fn(f64, f64) -> f64, count: usize) -> (EstimatedDensity, Detection) {
    let axes = vec![
        Axis::uniform(-3.0, 3.0, count).unwrap(),
        Axis::uniform(-2.5, 2.5, count).unwrap(),
    ];
    let [first, second] = &axes[..] else {
        unreachable!()
    };
    let rows = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
    let values = rows.map(|(i, j)| log(first.centre(i), second.centre(j)).exp());
    let values: Vec<f64> = values.collect();
    let mass: f64 = values.iter().sum::<f64>() * first.width(0) * second.width(0);
    let values = values.into_iter().map(|one| one / mass).collect();
    let density = EstimatedDensity::new(Observable::Joint(0, 1), Density { axes, values });
    let detection = PersistenceDetector::new(DetectOptions::default(), 1).detect(&density);
    (density, detection)
}

/// Two wells whose valley is curved: ln p = -2 (x² - 1)² + 0.2 x - y² + 0.8 x y².
fn curved(x: f64, y: f64) -> f64 {
    -2.0 * (x * x - 1.0).powi(2) + 0.2 * x - y * y * (1.0 - 0.8 * (x + 0.3).tanh())
}

/// The place along x of the valley at a height y, downhill from its saddle, by steps of 1e-4.
fn valley_at(y: f64, units: [f64; 2]) -> f64 {
    let slope = |x: f64, y: f64| {
        let h = 1e-5;
        [
            (curved(x + h, y) - curved(x - h, y)) / (2.0 * h) * units[0],
            (curved(x, y + h) - curved(x, y - h)) / (2.0 * h) * units[1],
        ]
    };
    let mut saddle = -0.02;
    for _ in 0..30 {
        let h = 1e-4;
        let [up, own, down] = [saddle + h, saddle, saddle - h].map(|x| slope(x, 0.0)[0]);
        saddle -= own * 2.0 * h / (up - down);
    }
    let mut at = [saddle, y.signum() * 1e-4];
    while at[1].abs() < y.abs() {
        let [a, b] = slope(at[0], at[1]);
        let length = a.hypot(b);
        at = [
            at[0] - 1e-4 * a / length * units[0],
            at[1] - 1e-4 * b / length * units[1],
        ];
    }
    at[0]
}

#[test]
fn basins_end_along_the_valley_within_the_stated_error() {
    for count in [40, 64, 100] {
        let (density, detection) = detected(curved, count);
        let right = basin(&density, &detection, 2).unwrap();
        let left = basin(&density, &detection, 1).unwrap();
        let [border] = &right[..] else {
            panic!("{} borders", right.len())
        };
        for y in [-1.2, -0.6, 0.5, 1.1] {
            let exact = valley_at(y, border.units);
            let error = border
                .nodes
                .iter()
                .map(|node| node.error)
                .fold(0.0, f64::max);
            let off = error * border.units[0];
            assert!(
                border.holds([exact + off, y]),
                "{count} cells, y = {y}: {exact} + {off}"
            );
            assert!(
                !border.holds([exact - off, y]),
                "{count} cells, y = {y}: {exact} - {off}"
            );
            assert!(left[0].holds([exact - off, y]) && !left[0].holds([exact + off, y]));
            assert!(off < 0.1 * 6.0 / count as f64, "{count} cells: {off}");
        }
        assert!(basin(&density, &detection, 3).is_none());
        assert!(crest(&density, &detection).is_none());
    }
}

#[test]
fn a_valley_along_an_axis_ends_a_basin_at_one_coordinate() {
    // x'' = -g x' + x - x³ + 0.15 + √(2 g T) ξ, T = 0.15: the valley is x = -0.153395, a root of x - x³ + 0.15.
    let potential = |x: f64| -0.5 * x * x + 0.25 * x.powi(4) - 0.15 * x;
    let log = |x: f64, y: f64| -(0.5 * y * y + potential(x)) / 0.15;
    let (density, detection) = detected(log, 80);
    let left = basin(&density, &detection, 1).unwrap();
    let [border] = &left[..] else {
        panic!("{} borders", left.len())
    };
    let text = border.inequality(["x", "y"], 0.0);
    assert!(!text.contains('y'), "{text}");
    assert!(border.holds([-0.15341, 2.0]) && !border.holds([-0.15338, -2.0]));
    assert!(border.nodes.iter().all(|node| node.error < 1e-4));
}

#[test]
fn four_basins_end_at_two_valleys_each() {
    let log = |x: f64, y: f64| -(x * x - 1.0).powi(2) - 1.3 * (y * y - 1.0).powi(2);
    let (density, detection) = detected(log, 60);
    for (number, place) in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]]
        .iter()
        .enumerate()
    {
        let borders = basin(&density, &detection, number + 1).unwrap();
        let holds = |at: [f64; 2]| borders.iter().all(|one| one.holds(at));
        let [x, y] = *place;
        for [a, b] in [[0.05, 0.05], [0.1, 1.5], [1.9, 0.1], [1.5, 1.6]] {
            assert!(holds([a * x, b * y]), "{number}: {a}, {b}");
            assert!(
                !holds([-a * x, b * y]) && !holds([a * x, -b * y]),
                "{number}: {a}, {b}"
            );
        }
    }
}

#[test]
fn the_number_of_a_basin_does_not_hang_on_the_cells() {
    // Peaks at (-0.02, 1) and (0.02, -1): less than a tenth of the standard deviation 0.5 of x apart, so that y tells.
    let log = |x: f64, y: f64| -2.0 * (y * y - 1.0).powi(2) - 2.0 * (x + 0.02 * y) * (x + 0.02 * y);
    for count in [30, 47, 80, 120] {
        let (density, detection) = detected(log, count);
        let borders = basin(&density, &detection, 1).unwrap();
        let holds = |at: [f64; 2]| borders.iter().all(|one| one.holds(at));
        assert!(holds([0.02, -1.0]) && !holds([-0.02, 1.0]), "{count}");
    }
}

#[test]
fn a_ring_ends_at_its_crest() {
    // r = 1 about (0.2, -0.1), in a frame that is oblique and not square, with peaks on the crest.
    let radius = |x: f64, y: f64| {
        let (x, y) = (x - 0.2, y + 0.1);
        (0.7 * x + 0.2 * y).hypot(0.9 * y - 0.1 * x)
    };
    let log = |x: f64, y: f64| -6.0 * (radius(x, y) - 1.0).powi(2);
    let (density, detection) = detected(log, 80);
    let ring = crest(&density, &detection).unwrap();
    for degrees in (0..360).step_by(7) {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let one = radius(0.2 + cos, -0.1 + sin);
        let at = |r: f64| [0.2 + cos * r / one, -0.1 + sin * r / one];
        assert!(ring.holds(at(0.985)) && !ring.holds(at(1.015)), "{degrees}");
        assert!(!ring.clone().other_side().holds(at(0.985)));
    }
    assert!(basin(&density, &detection, 1).is_none());
}

#[test]
fn a_broken_line_passes_its_nodes() {
    let nodes = [(-1.0, 0.5), (0.25, 1.0), (1.0, -2.0), (2.0, -1.0)];
    let text = broken_line("u", &nodes);
    let terms = |u: f64| -> f64 {
        let text = text.replace('u', &format!("({u:?})"));
        // A sum of products of numbers in parentheses and of abs(a - (b)).
        let parts = text.split(" + ").map(|part| {
            let number = |text: &str| text.trim_matches(['(', ')']).parse::<f64>().unwrap();
            match part.split_once('*') {
                None => number(part),
                Some((factor, rest)) => match rest.strip_prefix("abs(") {
                    Some(rest) => {
                        let (a, b) = rest.split_once(" - ").unwrap();
                        number(factor) * (number(a) - number(b)).abs()
                    }
                    None => number(factor) * number(rest),
                },
            }
        });
        parts.sum()
    };
    for (along, across) in nodes {
        assert!((terms(along) - across).abs() < 1e-12, "{text}");
    }
    assert!((terms(3.0) - 0.0).abs() < 1e-12 && (terms(-3.5) + 0.5).abs() < 1e-12);
}
