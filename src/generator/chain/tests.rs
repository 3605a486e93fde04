//! Chains against closed forms.

use super::*;
use crate::generator::one_axis;
use crate::space::Axis;
use crate::system::{Interpretation, System, TypedModel};
use std::sync::Arc;

fn system(drift: &str, noises: &[&str]) -> Arc<dyn System> {
    let typed = TypedModel::new("typed", "A typed system", ["x"])
        .with_equation("x", drift)
        .with_noise("x", noises.iter().copied())
        .with_interpretation(Interpretation::Ito);
    typed.build().unwrap().system_with(&[]).unwrap()
}

/// The line of a system on a range of which some ends are walls.
fn line(
    (drift, noises): (&str, &[&str]),
    (from, to): (f64, f64),
    walls: [bool; 2],
    breaks: &[f64],
) -> (Arc<dyn System>, Mesh) {
    let system = system(drift, noises);
    let axis = Axis::uniform(from, to, 40).unwrap();
    let found = one_axis(system.as_ref(), &axis).unwrap();
    let end = |end: usize| match (found.ends[end], walls[end]) {
        (Some(exponent), _) => AxisEnd::Natural(exponent),
        (None, true) => AxisEnd::Wall,
        (None, false) => AxisEnd::Open,
    };
    let reach = Reach {
        system: system.as_ref(),
        axis: &axis,
        ends: [end(0), end(1)],
        mean: found.moments.0,
    };
    let line = reach.mesh(MESH_PLACES, MESH_DEPTH, breaks).unwrap();
    (system, line)
}

/// Decay rates with their errors.
fn rates(line: &Mesh, count: usize) -> Vec<(f64, f64)> {
    let all = line.grids().map(|grid| {
        let chain = &grid.chain;
        let places = 0..chain.masses.len();
        let mut start: Vec<f64> = places.map(|place| (place as f64 * 0.61).sin()).collect();
        let mean = Chain::over(&chain.masses, &start) / chain.masses.iter().sum::<f64>();
        start.iter_mut().for_each(|value| *value -= mean);
        chain.krylov(&[start], 40).reduced(1.0, false).rates
    });
    let known = |mode: usize| line.extrapolated([0, 1, 2].map(|grid: usize| all[grid][mode]));
    (0..count).map(known).collect()
}

fn holds((value, error): (f64, f64), exact: f64, largest: f64) {
    assert!(
        (value - exact).abs() <= error,
        "{value} ± {error:e}, exactly {exact}"
    );
    assert!(
        error < largest,
        "{value} ± {error:e} instead of {largest:e}"
    );
}

#[test]
fn rates_are_those_of_textbooks() {
    // Ornstein and Uhlenbeck; Feller's square root; Wright and Fisher; growing noise, whose third mode is no more.
    let (_, linear) = line(("-x", &["0.7"]), (-3.0, 3.0), [false; 2], &[]);
    let (_, feller) = line(
        ("2*(1 - x)", &["2.4*sqrt(x)"]),
        (0.0, 12.0),
        [false; 2],
        &[],
    );
    let (_, genes) = line(
        ("0.3 - x", &["1.2*sqrt(x*(1 - x))"]),
        (0.0, 1.0),
        [false; 2],
        &[],
    );
    let (_, growing) = line(("-x", &["1", "0.7*x"]), (-9.0, 9.0), [false; 2], &[]);
    for (line, exact, largest) in [
        (linear, vec![1.0, 2.0, 3.0], 3e-3),
        (feller, vec![2.0, 4.0, 6.0], 3e-3),
        (genes, vec![1.0, 2.0 + 1.44, 3.0 + 3.0 * 1.44], 3e-3),
        (growing, vec![1.0, 2.0 - 0.49], 1e-2),
    ] {
        for (known, exact) in rates(&line, exact.len()).into_iter().zip(exact) {
            holds(known, exact, largest);
        }
    }
}

#[test]
fn a_continuous_spectrum_has_an_error_that_holds_where_it_begins() {
    // Reflected motion with a drift: all rates from g²/2 on.
    let (_, line) = line(("-1.2", &["1"]), (0.0, 6.0), [true, false], &[]);
    let (value, error) = rates(&line, 1)[0];
    assert!(
        (value - 0.72).abs() <= error && error < 0.1,
        "{value} {error}"
    );
}

#[test]
fn mean_times_have_all_their_digits_on_every_grid() {
    // Between walls without a force T'' = -2/σ², T'(0) = 0: from 0.2 to 0.6 it takes (0.36 - 0.04)/σ².
    let (_, flat) = line(("0", &["0.5"]), (0.0, 1.0), [true; 2], &[0.2, 0.6]);
    for grid in flat.grids() {
        let at = |place: f64| {
            flat.places
                .iter()
                .map(|one| *one == place)
                .collect::<Vec<_>>()
        };
        let inside: Vec<bool> = flat.places.iter().map(|one| *one >= 0.6).collect();
        let times = grid
            .chain
            .until(&grid.sampled(&inside))
            .solve(&grid.chain.masses, |_| 0.0);
        let start = grid
            .sampled(&at(0.2))
            .iter()
            .position(|is_start| *is_start)
            .unwrap();
        let exact = (0.36 - 0.04) / 0.25;
        assert!(
            (times[start] / exact - 1.0).abs() < 1e-12,
            "{}",
            times[start]
        );
    }
}

#[test]
fn times_over_barriers_that_no_solver_of_cells_resolves_are_those_of_the_quadrature() {
    // Symmetric wells: from one to the other it takes twice as long as to the top between, where either is next.
    let (_, line) = line(
        ("x - x^3", &["sqrt(0.01)"]),
        (-2.0, 2.0),
        [false; 2],
        &[-1.0, 0.0, 1.0],
    );
    let grid = &line.grids()[0];
    let time_to = |to: f64| {
        let inside: Vec<bool> = line.places.iter().map(|one| *one >= to).collect();
        let times = grid.chain.until(&inside).solve(&grid.chain.masses, |_| 0.0);
        times[line.places.iter().position(|one| *one == -1.0).unwrap()]
    };
    let (top, other) = (time_to(0.0), time_to(1.0));
    // exp(2 ΔU/σ²) with ΔU = 1/4: Kramers' formula is off by a share of σ².
    let kramers = std::f64::consts::PI / 2.0_f64.sqrt() * 50.0_f64.exp();
    assert!((top / kramers - 1.0).abs() < 0.02, "{top:e} {kramers:e}");
    assert!((other / top - 2.0).abs() < 1e-9, "{other:e} {top:e}");
}

#[test]
fn means_reach_beyond_the_range_and_into_ends_where_noise_dies() {
    let of = |function: fn(f64) -> f64| move |places: &[f64; 8]| places.map(function);
    // E exp(3x) of a normal density of variance v is exp(9v/2): most of it is beyond the range.
    let (normal, on_normal) = {
        let system = system("-x", &["2"]);
        let axis = Axis::uniform(-6.0, 6.0, 40).unwrap();
        let reach = Reach {
            system: system.as_ref(),
            axis: &axis,
            ends: [AxisEnd::Open; 2],
            mean: 0.0,
        };
        let line = reach.mesh(128, 600.0, &[]).unwrap();
        (system, line)
    };
    let found = on_normal.mean(normal.as_ref(), &of(|x| (3.0 * x).exp()));
    holds(
        (found.value / 9.0_f64.exp(), found.error / 9.0_f64.exp()),
        1.0,
        1e-9,
    );
    // A step is found between places.
    let found = on_normal.mean(normal.as_ref(), &of(|x| f64::from(u8::from(x > 0.1234))));
    let exact = 0.5 * statrs::function::erf::erfc(0.1234 / 2.0);
    holds((found.value, found.error), exact, 1e-6);
    // E ln x of a gamma density of shape 2k/s² = 0.64 about a mean of one.
    let (feller, on_feller) = line(
        ("2*(1 - x)", &["2.5*sqrt(x)"]),
        (0.0, 12.0),
        [false; 2],
        &[],
    );
    let shape: f64 = 0.64;
    let exact = statrs::function::gamma::digamma(shape) - shape.ln();
    let found = on_feller.mean(feller.as_ref(), &of(f64::ln));
    holds((found.value, found.error), exact, 1e-6);
    // 1/x has a mean from a shape of one on.
    let found = on_feller.mean(feller.as_ref(), &of(f64::recip));
    assert!(found.endless[0] && found.error.is_infinite());
}

#[test]
fn a_line_without_an_end_is_none() {
    // Beyond x = 1 states run away.
    let system = system("x^2 - x", &["0.2"]);
    let axis = Axis::uniform(-0.8, 0.7, 40).unwrap();
    let reach = Reach {
        system: system.as_ref(),
        axis: &axis,
        ends: [AxisEnd::Open; 2],
        mean: 0.0,
    };
    assert!(reach.mesh(MESH_PLACES, MESH_DEPTH, &[]).is_none());
}
