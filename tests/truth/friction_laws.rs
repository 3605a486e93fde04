//! Every friction law by the generator against its exact balance of power and against free trajectories, which share
//! only the drift.

use std::sync::Arc;

use crate::common::steady::{by_trajectories, means, solve};
use pbif::generator::{GeneratorOptions, automatic_grading};
use pbif::space::{Axis, CellSpace, Grading};
use pbif::system::{System, VELOCITY, registry};

const COMMON: [(&str, f64); 4] = [
    ("alpha", -0.3),
    ("kappa", 0.1),
    ("mu", 1.0),
    ("sigma2", 0.08),
];

fn system(model: &str, own: &[(&str, f64)]) -> Arc<dyn System> {
    let values = [&COMMON[..], own].concat();
    registry::find(model).unwrap().system_with(&values).unwrap()
}

/// Axes of a grid: `cells` on ±2.4 of x and y, y graded where friction switches, `modes` on every internal state.
fn axes(system: &dyn System, cells: usize, modes: usize) -> Vec<Axis> {
    let bounds = |index| system.facts().bounds(index).unwrap_or((-2.4, 2.4));
    let ranges: Vec<(f64, f64)> = (0..system.dimension()).map(bounds).collect();
    let axis = |index: usize| {
        let (from, to) = ranges[index];
        if system.facts().bounds(index).is_some() {
            return Axis::modes(from, to, modes).unwrap();
        }
        match automatic_grading(system, &ranges, index, cells) {
            Some(grading) => Axis::graded(from, to, cells, &grading).unwrap(),
            None => Axis::uniform(from, to, cells).unwrap(),
        }
    };
    (0..ranges.len()).map(axis).collect()
}

/// Means of functions of the state in the steady state on a grid.
fn by_generator<const Q: usize>(
    system: &dyn System,
    axes: Vec<Axis>,
    look: impl Fn(&[f64]) -> [f64; Q],
) -> [f64; Q] {
    let space = CellSpace::new(axes).unwrap();
    let scheme = GeneratorOptions::default().scheme;
    means(&space, &solve(system, &space, scheme), look)
}

/// Noise feeds σ²/2 into the kinetic energy, force and friction take it out: E[y a_y] = -σ²/2 to the share `of_grid`.
/// Mean squares of x, y and the internal state agree with trajectories to four standard errors and that share.
fn assert_agrees(system: &dyn System, cells: usize, modes: usize, of_grid: f64) {
    let axes = system.dimension();
    let look = |state: &[f64]| {
        let power = state[VELOCITY] * system.drift_at(0.0, state)[VELOCITY];
        let last = state[axes - 1];
        [
            power,
            state[0] * state[0],
            state[VELOCITY] * state[VELOCITY],
            last * last,
            state[0] * last,
        ]
    };
    let found = by_generator(system, self::axes(system, cells, modes), look);
    let fed = 0.5 * system.noises()[0].additive().unwrap().powi(2);
    let missed = (found[0] / fed + 1.0).abs();
    assert!(missed < of_grid, "power: {missed:e} of what noise feeds in");
    let sampled = by_trajectories(system, 25_000, 0..16, look);
    for (index, (found, (mean, error))) in found.iter().zip(sampled).enumerate().skip(1) {
        let allowed = 4.0 * error + of_grid * mean.abs();
        let gap = (found - mean).abs();
        assert!(gap < allowed, "{index}: {found} against {mean} ± {error}");
    }
}

#[test]
fn lugre_agrees() {
    let own = [
        ("lambda", 0.8),
        ("eta", 0.1),
        ("f_c", 0.08),
        ("f_s", 0.14),
        ("v_s", 0.3),
    ];
    assert_agrees(&*system("lugre", &own), 44, 6, 3e-3);
}

#[test]
fn stribeck_agrees_on_a_base_that_stands_or_moves() {
    let own = |base| [("f_c", 0.05), ("f_s", 0.12), ("v_s", 0.4), ("v_b", base)];
    assert_agrees(&*system("stribeck", &own(0.0)), 60, 1, 3e-3);
    assert_agrees(&*system("stribeck", &own(0.4)), 60, 1, 3e-3);
}

#[test]
fn the_cubic_law_agrees() {
    let own = [("f_s", 0.12), ("f_m", 0.05), ("v_m", 0.8)];
    assert_agrees(&*system("stribeck_cubic", &own), 60, 1, 3e-3);
}

#[test]
fn elasto_plastic_agrees() {
    let own = [("lambda", 0.8), ("eta", 0.1), ("f_b", 0.05), ("f_t", 0.06)];
    assert_agrees(&*system("elasto_plastic", &own), 40, 8, 5e-3);
}

#[test]
fn bouc_wen_agrees_for_both_exponents() {
    for n in [1.0, 2.0] {
        let own = [("lambda", 0.2), ("beta", 0.8), ("gamma", 0.3), ("n", n)];
        assert_agrees(&*system("bouc_wen", &own), 36, 8, 5e-3);
    }
}

#[test]
fn bliman_sorine_agrees_on_four_axes() {
    let own = [("f_1", 0.12), ("f_2", 0.05), ("epsilon", 0.5), ("rho", 0.4)];
    assert_agrees(&*system("bliman_sorine", &own), 30, 4, 1e-2);
}

/// A stiff contact is Coulomb's. Where the body turns round, its friction turns only after a distance f_c/λ. Noise
/// takes a time (f_c/(λσ))^(2/3) for that, in which the velocity moves by (σ² f_c/λ)^(1/3): the force is wrong in a
/// layer that thin, and what that shifts of the mass is of the order of its square. So E[y²] goes to Coulomb's with the
/// power 2/3 of 1/λ.
#[test]
fn a_stiff_dahl_contact_goes_to_coulombs_law_with_the_power_two_thirds() {
    let shared = [("kappa", 0.1), ("f_c", 0.1), ("sigma2", 0.1)];
    let y_squared = |system: Arc<dyn System>| {
        let layer = Grading {
            at: vec![0.0],
            smallest: 6e-3,
        };
        let mut axes = vec![
            Axis::uniform(-3.2, 3.2, 32).unwrap(),
            Axis::graded(-3.2, 3.2, 72, &layer).unwrap(),
        ];
        if let Some((from, to)) = system.facts().bounds(2) {
            axes.push(Axis::modes(from, to, 6).unwrap());
        }
        by_generator(&*system, axes, |state| [state[1] * state[1]])[0]
    };
    let bound = |model, values: &[(&str, f64)]| {
        let model = registry::find(model).unwrap();
        model.system_with(values).unwrap()
    };
    let coulomb = y_squared(bound("coulomb", &shared));
    let [stiff, stiffer] = [128.0, 512.0].map(|lambda| {
        let values = [&shared[..], &[("lambda", lambda)]].concat();
        y_squared(bound("dahl", &values)) - coulomb
    });
    let order = (stiff / stiffer).log(4.0);
    assert!((order - 2.0 / 3.0).abs() < 0.04, "{order}");
    assert!(stiffer > 0.0 && stiffer < 2.5e-3 * coulomb, "{stiffer:e}");
}
