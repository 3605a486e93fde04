//! What the slope correction gains, against exact densities and laws.

#![allow(clippy::panic, reason = "a test that cannot be set up should stop")]

use super::solve_corrected;
use crate::cancellation::Cancellation;
use crate::sampling::{Integrator, SampledTransitions, SamplingOptions, sample_transitions};
use crate::space::{Axis, CellSpace};
use crate::stationary::{Options, Outcome, Solver, SteadyState};
use crate::system::test_families::OneState;
use crate::system::test_families::built_in;
use crate::system::{System, registry};

fn options(map_step: f64, samples: usize) -> SamplingOptions {
    SamplingOptions {
        map_step,
        time_step: 0.05,
        samples,
        groups: 8,
        seed: 1,
        integrator: Integrator::StochasticHeun,
        keep_starts: true,
    }
}

fn steady(
    transitions: &SampledTransitions,
    space: &CellSpace,
    guess: Option<&[f64]>,
    left_out: Option<usize>,
) -> (SteadyState, super::Corrected) {
    let solver = Options::new(Solver::MultilevelAggregation, 1e-10);
    let found = solve_corrected(transitions, space, guess, left_out, &solver, 1e-6).unwrap();
    let Outcome::Steady(steady) = found.outcome.clone() else {
        panic!("no steady state");
    };
    (steady, found)
}

/// The plain cell map's steady masses.
fn plain(transitions: &SampledTransitions, space: &CellSpace) -> Vec<f64> {
    let solver = Options::new(Solver::MultilevelAggregation, 1e-10);
    let found = crate::stationary::solve(&transitions.matrix(), space, None, &solver).unwrap();
    let Outcome::Steady(steady) = found else {
        panic!("no steady state");
    };
    steady.mass
}

fn total_variation(a: &[f64], b: &[f64]) -> f64 {
    0.5 * a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>()
}

/// Integrals of the exact density over cells of one width, by midpoints of 8×8 parts.
fn exact(system: &dyn System, space: &CellSpace) -> Vec<f64> {
    let part = |n: usize, axis: usize| ((n as f64 + 0.5) / 8.0 - 0.5) * space.axes()[axis].width(0);
    let of_cell = |cell: usize| -> f64 {
        let centre = space.centre(cell);
        let at = |n: usize| [centre[0] + part(n / 8, 0), centre[1] + part(n % 8, 1)];
        let density = |n: usize| system.exact_log_density(&at(n)).unwrap().exp();
        (0..64).map(density).sum()
    };
    let mass: Vec<f64> = (0..space.n_cells()).map(of_cell).collect();
    let total: f64 = mass.iter().sum();
    mass.iter().map(|mass| mass / total).collect()
}

/// The system without friction on [-3, 3]², 50×50 cells, 2000 samples, Δt = 1.
fn without_friction() -> (CellSpace, SampledTransitions, Vec<f64>) {
    let values = [
        ("kappa", 0.01),
        ("mu", 0.01),
        ("f_c", 0.0),
        ("sigma2", 0.01),
    ];
    let system = built_in("coulomb", &values);
    let axis = Axis::uniform(-3.0, 3.0, 50).unwrap();
    let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
    let seed = space.find(&[0.1, 0.1]).unwrap();
    let transitions = sample_transitions(
        &*system,
        &space,
        &[seed],
        &options(1.0, 2000),
        &Cancellation::new(),
    )
    .unwrap();
    let exact = exact(&*system, &space);
    (space, transitions, exact)
}

#[test]
fn the_same_samples_give_a_many_times_smaller_error() {
    let (space, transitions, exact) = without_friction();
    let flat = plain(&transitions, &space);
    let (corrected, found) = steady(&transitions, &space, None, None);
    let (before, after) = (
        total_variation(&flat, &exact),
        total_variation(&corrected.mass, &exact),
    );
    // What remains is sampling, 0.010 by the jackknife (docs/sgcm.md).
    assert!(before > 0.1 && after < before / 5.0, "{before} {after}");
    assert!(corrected.mass.iter().all(|&mass| mass >= 0.0));
    assert!(
        corrected.info.converged && found.rounds < 30,
        "{}",
        found.rounds
    );
    // Flat cells add h²/(12Δt); of that next to nothing is left.
    let local: Vec<f64> = transitions
        .cells()
        .iter()
        .map(|&cell| corrected.mass[cell])
        .collect();
    let remaining = transitions.remaining_diffusion(&space, &local, &found.slopes);
    let added = transitions.numerical_diffusion(&local);
    for (remaining, added) in remaining.iter().zip(&added) {
        assert!(remaining.abs() < 0.1 * added, "{remaining} {added}");
    }
    // A good guess leads to the same masses in fewer turns; replicates stay near, on all sides.
    let (again, warm) = steady(&transitions, &space, Some(&corrected.mass), None);
    assert!(total_variation(&again.mass, &corrected.mass) < 1e-6);
    assert!(
        warm.rounds < found.rounds,
        "{} {}",
        warm.rounds,
        found.rounds
    );
    let distance = |group: usize| {
        let (without, _) = steady(&transitions, &space, Some(&corrected.mass), Some(group));
        total_variation(&without.mass, &corrected.mass)
    };
    // A replicate differs by about the sampling error over √7.
    assert!((0..8).map(distance).all(|tv| tv > 1e-4 && tv < 0.01));
}

#[test]
fn without_kept_starts_the_plain_cell_map_is_solved() {
    let (space, mut transitions, _) = without_friction();
    transitions.forget_starts();
    let (found, corrected) = steady(&transitions, &space, None, None);
    assert!(total_variation(&found.mass, &plain(&transitions, &space)) < 1e-9);
    assert_eq!(corrected.rounds, 1);
}

/// Flat cells widen the density to σ²/2 + (h²/6)/(1 - e^{-2Δt}) (`sampling::accuracy`). Linear ones leave the variance
/// of the masses at that of exact cell masses, σ²/2 up to terms of the fourth order in h.
#[test]
fn cells_no_longer_widen_a_density() {
    let width = 0.125;
    let space = CellSpace::new(vec![Axis::uniform(-5.0, 5.0, 80).unwrap()]).unwrap();
    for map_step in [0.2, 1.0] {
        let options = SamplingOptions {
            time_step: 0.02,
            ..options(map_step, 100_000)
        };
        let transitions = sample_transitions(
            // Of variance 1/4.
            &OneState::new(0.5_f64.sqrt(), |x: f64| -x),
            &space,
            &[40],
            &options,
            &Cancellation::new(),
        )
        .unwrap();
        let variance = |mass: &[f64], slopes: &dyn Fn(usize) -> f64| -> f64 {
            let cells = || mass.iter().enumerate();
            let centre = |cell: usize| space.centre(cell)[0];
            // ∫x² of a density linear in the cell: c² + 2c·(h s/12) + h²/12.
            let square =
                |cell: usize| centre(cell).powi(2) + centre(cell) * width * slopes(cell) / 6.0;
            let mean: f64 = cells().map(|(cell, mass)| mass * centre(cell)).sum();
            cells().map(|(cell, mass)| mass * square(cell)).sum::<f64>() - mean * mean
                + width * width / 12.0
        };
        let law = width * width / 6.0 / (1.0 - (-2.0 * map_step).exp());
        let flat = variance(&plain(&transitions, &space), &|_| 0.0) - 0.25;
        let (corrected, found) = steady(&transitions, &space, None, None);
        let position = |cell: usize| transitions.cells().iter().position(|&c| c == cell);
        let slope = |cell: usize| position(cell).map_or(0.0, |at| found.slopes[at][0]);
        let linear = variance(&corrected.mass, &slope) - 0.25;
        // Sampling: 0.2 % of the variance at most, against a widening of 3.2 % and 1.2 %.
        assert!((flat / law - 1.0).abs() < 0.15, "{map_step}: {flat} {law}");
        assert!(linear.abs() < 0.2 * law, "{map_step}: {linear} {law}");
    }
}

/// Two wells that no sample crosses between: correction must not hide that there are two steady states, nor fill cells.
#[test]
fn several_closed_classes_stay_several() {
    let system = registry::find("bistable")
        .unwrap()
        .system_with(&[("a", 1.0), ("sigma2", 0.005)])
        .unwrap();
    let space = CellSpace::new(vec![Axis::uniform(-2.0, 2.0, 40).unwrap()]).unwrap();
    let seeds = [space.find(&[-1.0]).unwrap(), space.find(&[1.0]).unwrap()];
    let transitions = sample_transitions(
        &*system,
        &space,
        &seeds,
        &options(1.0, 200),
        &Cancellation::new(),
    )
    .unwrap();
    let solver = Options::new(Solver::MultilevelAggregation, 1e-10);
    let found = solve_corrected(&transitions, &space, None, None, &solver, 1e-6).unwrap();
    let Outcome::SeveralClasses { classes, .. } = found.outcome else {
        panic!("one class");
    };
    assert_eq!(classes.len(), 2);
}
