//! The numbers of the tutorials (docs/tutorials/), from their sweep files.

use pbif::continuation::{BifurcationStatus, Label};

use crate::common::numbers::assert_holds;
use crate::common::sweeps::{measure, rows, solved, swept};

const FIRST: &str = include_str!("../../sweeps/tutorials/first.toml");
const NOISE: &str = include_str!("../../sweeps/tutorials/noise.toml");
const FRICTION: &str = include_str!("../../sweeps/tutorials/friction.toml");
const BRISTLES: &str = include_str!("../../sweeps/tutorials/bristles.toml");

/// A page, and that it says some numbers.
fn says(page: &str, numbers: &[&str]) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/tutorials");
    let text = std::fs::read_to_string(format!("{folder}/{page}.md")).unwrap();
    for number in numbers {
        assert!(text.contains(number), "`{number}` not in {page}.md");
    }
}

#[test]
fn the_first_oscillator_changes_where_the_pages_say() {
    let (_, result) = swept(FIRST, "cells.x.count=40 cells.y.count=40 levels.sd_x=0.6");
    let row = rows(&result, "x")[0];
    assert_holds([row.value, row.error], 0.540_903 * 0.002_f64.sqrt(), 4e-6);
    assert!((row.value - 0.024_190_5).abs() < 1e-7, "{}", row.value);
    says("real", &["0.0241905 ± 0.0000034", "0.0241899"]);
    // A moment of the exact density exp((2/σ²)(a H - b H²/2)) of the energy: E[x²] = E[H].
    let level = result.labels.iter().find_map(|row| match row {
        Label::Level(level) => Some([level.value, level.error]),
        _ => None,
    });
    assert_holds(level.unwrap(), 0.023_663_0, 2e-4);
    says("python", &["0.023663", "a = 0.02419"]);
    says("first", &["0.0241902 ± 0.0000022"]);
}

/// A memory moves the split of p(x) to -6 D τ, and what that leaves out falls faster than the square of τ.
#[test]
fn a_memory_of_the_noise_moves_the_split_as_the_page_says() {
    let split = |words: &str| {
        let (_, result) = swept(NOISE, words);
        let row = rows(&result, "x")[0];
        assert_eq!(row.status(), BifurcationStatus::Located, "{words}");
        (row.value, row.error)
    };
    let mut left = Vec::new();
    for (tau, said) in [(0.05, -0.029_591_2), (0.1, -0.057_151_0)] {
        let (value, error) = split(&format!("system.parameters.tau={tau}"));
        assert!(
            (value - said).abs() < 1e-7 && error < 1e-6,
            "{tau}: {value} ± {error}"
        );
        says("noise", &[&format!("{said:.7}")]);
        left.push(value + 0.6 * tau);
    }
    assert!(left[0] > 0.0 && left[1] / left[0] > 5.0, "{left:?}");
    let (value, error) = split("system.parameters.tau=0.3 cells.noise.modes=8");
    assert!(
        (value + 0.139_295).abs() < 2e-6 && error < 1e-4,
        "{value} ± {error}"
    );
    says("noise", &["-0.139295 ± 0.000030", "-0.1392991"]);
}

#[test]
fn the_peak_of_sticking_ends_where_the_page_says() {
    let (_, result) = swept(FRICTION, "");
    let row = rows(&result, "y")[0];
    assert_eq!(row.status(), BifurcationStatus::Located);
    // On finer cells it is 0.398679 ± 0.000019.
    assert_holds([row.value, row.error], 0.398_679, 6e-4);
    assert!((row.value - 0.398_40).abs() < 1e-5, "{}", row.value);
    says("friction", &["0.39840 ± 0.00032"]);
}

/// Derivative of the parabola through three places, at another place.
fn slope([a, b, c]: [(f64, f64); 3], at: f64) -> f64 {
    let pair = |one: (f64, f64), other: (f64, f64)| (other.1 - one.1) / (other.0 - one.0);
    let bend = (pair(b, c) - pair(a, b)) / (c.0 - a.0);
    pair(a, b) + bend * (2.0 * at - a.0 - b.0)
}

/// Where friction turns round the logarithm of p(y) has slopes that differ by -4 f_s/σ², since nothing flows along y.
#[test]
fn the_kink_is_as_sharp_as_the_page_says() {
    for kappa in [0.3, 0.5] {
        let (_, solution) = solved(FRICTION, "", Some(kappa));
        let density = &solution.densities[0].density;
        let centres = density.axes[0].centres();
        let above = centres.partition_point(|&centre| centre < 0.5);
        let place = |cell: usize| (centres[cell], density.values[cell].ln());
        let [low, high] =
            [above - 3, above].map(|cell| slope([0, 1, 2].map(|next| place(cell + next)), 0.5));
        assert!((high - low + 80.0).abs() < 0.8, "{kappa}: {low} {high}");
    }
}

#[test]
fn bristles_go_to_coulombs_law_as_the_page_says() {
    let deviation = |lambda: f64| {
        let (_, solution) = solved(BRISTLES, "", Some(lambda));
        measure(&solution, "sd_y")
    };
    for (lambda, said) in [(4.0, 0.4341), (64.0, 0.4232)] {
        let (value, error) = deviation(lambda);
        assert!(
            (value - said).abs() < 6e-5 && error < 3e-4,
            "{lambda}: {value} ± {error}"
        );
        says("friction", &[&format!("| {lambda} | {said} ±")]);
    }
}
