//! Properties of sampled transitions, and the exact density of the damped oscillator.

use super::*;
use crate::cancellation::{Cancellation, Cancelled};
use crate::sampling::{Integrator, TransitionMatrix, pilot};
use crate::space::Axis;
use crate::system::test_families::OneState;
use crate::system::test_families::built_in;
use std::sync::Arc;

fn square(half: f64, count: usize) -> CellSpace {
    let axis = Axis::uniform(-half, half, count).unwrap();
    CellSpace::new(vec![axis.clone(), axis]).unwrap()
}

fn options() -> SamplingOptions {
    SamplingOptions {
        map_step: 1.0,
        time_step: 0.05,
        samples: 240,
        groups: 8,
        seed: 1,
        integrator: Integrator::StochasticHeun,
        keep_starts: false,
    }
}

fn coulomb(f_c: f64) -> Arc<dyn System> {
    let values = [
        ("kappa", 0.01),
        ("mu", 0.01),
        ("f_c", f_c),
        ("sigma2", 0.01),
    ];
    built_in("coulomb", &values)
}

fn sample(
    system: &dyn System,
    space: &CellSpace,
    seeds: &[usize],
    options: &SamplingOptions,
) -> SampledTransitions {
    sample_transitions(system, space, seeds, options, &Cancellation::new()).unwrap()
}

fn column_sums(transitions: &TransitionMatrix) -> Vec<f64> {
    let mut sums = transitions.escape.clone();
    for row in transitions.matrix.outer_iterator() {
        for (column, value) in row.iter() {
            sums[column] += value;
        }
    }
    sums
}

/// p with p ∝ P p by power iteration, Σ = 1.
fn stationary(transitions: &TransitionMatrix) -> Vec<f64> {
    let n = transitions.cells.len();
    let mut mass = vec![1.0 / n as f64; n];
    for _ in 0..400 {
        let row = |row: sprs::CsVecView<'_, f64>| row.iter().map(|(j, p)| p * mass[j]).sum::<f64>();
        let next: Vec<f64> = transitions.matrix.outer_iterator().map(row).collect();
        let total: f64 = next.iter().sum();
        mass = next.into_iter().map(|value| value / total).collect();
    }
    mass
}

/// Total variation between masses and the exact ones, by 4×4 points a cell.
fn total_variation(system: &dyn System, space: &CellSpace, cells: &[usize], mass: &[f64]) -> f64 {
    let mut exact = vec![0.0; space.n_cells()];
    for (cell, value) in exact.iter_mut().enumerate() {
        let centre = space.centre(cell);
        let offset = |i: usize, axis: usize| {
            centre[axis] + (i as f64 / 4.0 - 0.375) * space.axes()[axis].width(0)
        };
        for point in 0..16 {
            let state = [offset(point / 4, 0), offset(point % 4, 1)];
            *value += system.exact_log_density(&state).unwrap().exp();
        }
    }
    let total: f64 = exact.iter().sum();
    let mut found = vec![0.0; space.n_cells()];
    for (&cell, &mass) in cells.iter().zip(mass) {
        found[cell] = mass;
    }
    let difference = exact
        .iter()
        .zip(&found)
        .map(|(exact, found)| (exact / total - found).abs());
    0.5 * difference.sum::<f64>()
}

#[test]
fn the_exact_density_of_the_oscillator_comes_out_within_three_per_cent() {
    let (system, space) = (coulomb(0.0), square(3.0, 50));
    let pilot = pilot(&*system, &space, 1, &Cancellation::new()).unwrap();
    let time_step = pilot.automatic_time_step(Integrator::StochasticHeun);
    let map_step = pilot.automatic_map_step(time_step, 2000);
    let options = SamplingOptions {
        map_step,
        time_step,
        samples: 2000,
        ..options()
    };
    let sampled = sample(&*system, &space, &pilot.cells, &options);
    let mass = stationary(&sampled.matrix());
    let distance = total_variation(&*system, &space, sampled.cells(), &mass);
    assert!(
        distance <= 0.03,
        "{distance} at map step {map_step}, time step {time_step}"
    );
    // The cells' diffusion is h²/(12Δt) on both axes, and below 5 % of σ²/2 in sum.
    for diffusion in sampled.numerical_diffusion(&mass) {
        let law = 0.12 * 0.12 / (12.0 * map_step);
        assert!((diffusion / law - 1.0).abs() < 0.03, "{diffusion} {law}");
    }
}

#[test]
fn columns_sum_to_one_with_the_sink_in_every_matrix() {
    // Ω cuts through the density, so that mass does leave.
    let (system, space) = (coulomb(-0.02), square(1.0, 12));
    let sampled = sample(&*system, &space, &[70], &options());
    let mut matrices = vec![sampled.matrix()];
    matrices.extend((0..8).map(|group| sampled.matrix_without_group(group)));
    for transitions in &matrices {
        assert!(transitions.escape.iter().any(|&share| share > 0.1));
        assert!(
            column_sums(transitions)
                .iter()
                .all(|sum| (sum - 1.0).abs() < 1e-12)
        );
        assert_eq!(transitions.matrix.rows(), transitions.cells.len());
    }
    // The mean of the matrices that leave each of eight equal groups out is the matrix of all.
    let at =
        |transitions: &TransitionMatrix, i, j| transitions.matrix.get(i, j).copied().unwrap_or(0.0);
    for (i, row) in matrices[0].matrix.outer_iterator().enumerate() {
        for (j, value) in row.iter() {
            let mean = matrices[1..].iter().map(|m| at(m, i, j)).sum::<f64>() / 8.0;
            assert!((mean - value).abs() < 1e-12);
        }
    }
    assert!(matrices[1].matrix != matrices[0].matrix);
}

#[test]
fn neither_threads_nor_seeds_change_the_matrix() {
    let (system, space) = (coulomb(0.01), square(3.0, 20));
    let run = |threads, seeds: &[usize]| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| sample(&*system, &space, seeds, &options()).matrix())
    };
    let centre = space.find(&[0.0, 0.0]).unwrap();
    let one = run(1, &[centre]);
    let two = run(2, &[centre]);
    let other = run(2, &one.cells);
    for matrix in [two, other] {
        assert_eq!(one.cells, matrix.cells);
        assert_eq!(one.matrix, matrix.matrix);
        assert_eq!(one.escape, matrix.escape);
    }
}

#[test]
fn only_cells_that_can_be_reached_are_sampled() {
    // Without noise to speak of, a strongly damped oscillator stays in the cells about the origin.
    let values = [("kappa", 1.0), ("f_c", 0.0), ("sigma2", 1e-4)];
    let system = built_in("coulomb", &values);
    let space = square(3.0, 60);
    let sampled = sample(
        &*system,
        &space,
        &[space.find(&[0.0, 0.0]).unwrap()],
        &options(),
    );
    assert!(sampled.cells().len() < 40, "{}", sampled.cells().len());
    // Every sampled cell but the first was reached; no row may lie outside.
    assert!(
        column_sums(&sampled.matrix())
            .iter()
            .all(|sum| (sum - 1.0).abs() < 1e-12)
    );
    // Cells, samples, steps: the work is counted.
    assert_eq!(sampled.n_steps(), (sampled.cells().len() * 240 * 20) as u64);
}

#[test]
fn states_that_overflow_are_counted_in_the_sink() {
    let space = CellSpace::new(vec![Axis::uniform(1.0, 2.0, 4).unwrap()]).unwrap();
    // It leaves any range, and overflows, within the map step.
    let explosion = OneState::new(0.1, |x: f64| 40.0 * x.powi(3));
    let sampled = sample(&explosion, &space, &[1], &options());
    assert_eq!(sampled.matrix().escape, vec![1.0]);
    assert_eq!(sampled.matrix().matrix.nnz(), 0);
    assert_eq!(sampled.numerical_diffusion(&[1.0]), vec![0.0]);
}

#[test]
fn bad_settings_are_refused_and_a_stop_is_heeded() {
    let (system, space) = (coulomb(0.0), square(3.0, 10));
    let run = |options: &SamplingOptions, seeds: &[usize], stop: bool| {
        let cancellation = Cancellation::new();
        if stop {
            cancellation.cancel();
        }
        sample_transitions(&*system, &space, seeds, options, &cancellation).unwrap_err()
    };
    let with = |change: &dyn Fn(&mut SamplingOptions)| {
        let mut changed = options();
        change(&mut changed);
        run(&changed, &[0], false)
    };
    assert!(matches!(
        with(&|o| o.map_step = 0.0),
        SamplingError::Step { .. }
    ));
    assert!(matches!(
        with(&|o| o.time_step = f64::NAN),
        SamplingError::Step { .. }
    ));
    assert!(matches!(
        with(&|o| o.groups = 0),
        SamplingError::Groups { .. }
    ));
    assert!(matches!(
        with(&|o| o.groups = 257),
        SamplingError::Groups { .. }
    ));
    assert!(matches!(
        with(&|o| o.samples = 7),
        SamplingError::Groups { .. }
    ));
    assert!(matches!(
        run(&options(), &[100], false),
        SamplingError::Seed { cell: 100, .. }
    ));
    assert_eq!(
        run(&options(), &[0], true),
        SamplingError::Cancelled(Cancelled)
    );
    let line = CellSpace::new(vec![Axis::uniform(0.0, 1.0, 4).unwrap()]).unwrap();
    let error =
        sample_transitions(&*system, &line, &[0], &options(), &Cancellation::new()).unwrap_err();
    assert_eq!(
        error,
        SamplingError::Dimension {
            system: 2,
            space: 1
        }
    );
}

#[test]
fn the_time_step_divides_the_map_step() {
    let steps = |map_step, time_step| {
        SamplingOptions {
            map_step,
            time_step,
            ..options()
        }
        .steps()
    };
    assert_eq!(steps(1.0, 0.01), 100);
    assert_eq!(steps(0.3, 0.1), 3);
    assert_eq!(steps(1.0, 0.3), 4);
    assert_eq!(steps(0.1, 1.0), 1);
}
