//! Densities by free trajectories against exact ones, cell by cell in units of their standard errors.

use super::*;
use crate::cancellation::{Cancellation, Cancelled};
use crate::density::{EstimatedDensity, Observable, Projection, estimate};
use crate::sampling::Integrator;
use crate::space::Axis;
use crate::system::{LANES, registry};
use std::sync::Arc;

struct Case {
    system: Arc<dyn System>,
    space: CellSpace,
    relaxation: Relaxation,
}

impl Case {
    fn new(model: &str, values: &[(&str, f64)], half: f64, count: usize) -> Self {
        let system = registry::find(model).unwrap().system_with(values).unwrap();
        let axis = Axis::uniform(-half, half, count).unwrap();
        let space = CellSpace::new(vec![axis; system.dimension()]).unwrap();
        let relaxation = relaxation(&*system, &space, 5, &Cancellation::new()).unwrap();
        Self {
            system,
            space,
            relaxation,
        }
    }

    fn run(&self, trajectories: usize, times: f64) -> ErgodicRun {
        let time_step = self
            .relaxation
            .time_step(Integrator::StochasticHeun, 1e-3)
            .min(0.02 / self.relaxation.frequency);
        ErgodicRun {
            time_step,
            integrator: Integrator::StochasticHeun,
            seed: 3,
            trajectories,
            burn_in: 12.0 * self.relaxation.time,
            length: times * self.relaxation.time,
            stride: ErgodicRun::stride(&self.relaxation, time_step),
        }
    }

    fn estimate(&self, run: &ErgodicRun) -> Estimate {
        let starts = &self.relaxation.settled;
        ergodic(
            &*self.system,
            &self.space,
            starts,
            run,
            &Cancellation::new(),
        )
        .unwrap()
    }

    /// Integrals of the exact density over the cells, by midpoints of 8 parts an axis: error h²/(24·64) of the second
    /// derivative.
    fn exact(&self) -> Vec<f64> {
        const PARTS: usize = 8;
        let dimension = self.space.dimension();
        let of_cell = |cell: usize| {
            let centre = self.space.centre(cell);
            let points = PARTS.pow(dimension as u32);
            let at = |point: usize| {
                let state: Vec<f64> = (0..dimension)
                    .map(|axis| {
                        let part = point / PARTS.pow(axis as u32) % PARTS;
                        let width = self.space.axes()[axis].width(0);
                        centre[axis] + width * ((part as f64 + 0.5) / PARTS as f64 - 0.5)
                    })
                    .collect();
                self.system.exact_log_density(&state).unwrap().exp()
            };
            (0..points).map(at).sum::<f64>()
        };
        let mass: Vec<f64> = (0..self.space.n_cells()).map(of_cell).collect();
        let total: f64 = mass.iter().sum();
        mass.iter().map(|mass| mass / total).collect()
    }
}

/// (estimate - exact)/error of the cells with at least `least` of the mass.
fn deviations(found: &EstimatedDensity, exact: &[f64], space: &CellSpace, least: f64) -> Vec<f64> {
    let projection = Projection::new(space, found.observable).unwrap();
    let exact = projection.density(exact).unwrap();
    let volumes = exact.volumes();
    (0..exact.values.len())
        .filter(|&cell| exact.values[cell] * volumes[cell] > least)
        .map(|cell| (found.density.values[cell] - exact.values[cell]) / found.standard_error[cell])
        .collect()
}

/// Errors must be those that are stated: mean square 1, and 95.4 % within two of them. `independent` is the number of
/// cells that vary for themselves: beside sampling the mean square scatters by √(2/independent), and the errors' own
/// scatter adds to it.
fn assert_honest(case: &Case, found: &Estimate, observable: Observable, independent: f64) {
    let exact = case.exact();
    let found = estimate(&case.space, observable, &found.mass, &found.replicates).unwrap();
    let z = deviations(&found, &exact, &case.space, 1e-4);
    let square = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
    let covered = z.iter().filter(|z| z.abs() < 2.0).count() as f64 / z.len() as f64;
    let scatter = 4.0 * (2.0 / independent).sqrt();
    assert!(
        (square - 1.0).abs() < scatter,
        "{observable:?}: {square} of {} cells, {scatter}",
        z.len()
    );
    let share = 4.0 * (0.954 * 0.046 / independent).sqrt();
    assert!(
        (covered - 0.954).abs() < share + 0.01,
        "{observable:?}: {covered}"
    );
}

#[test]
fn stated_errors_are_the_true_ones_for_an_oscillator_without_friction() {
    let values = [("kappa", 0.05), ("mu", 0.5), ("f_c", 0.0), ("sigma2", 0.02)];
    let case = Case::new("coulomb", &values, 2.2, 40);
    let found = case.estimate(&case.run(2048, 40.0));
    assert!(found.share_outside < 1e-4 && found.runaways == 0.0);
    assert_honest(&case, &found, Observable::Joint(0, 1), 300.0);
    // Bins of a marginal share the fluctuations of the energy: few vary for themselves.
    assert_honest(&case, &found, Observable::Marginal(0), 15.0);
    assert_honest(&case, &found, Observable::Marginal(1), 15.0);
}

#[test]
fn stated_errors_are_the_true_ones_in_two_wells_and_in_a_crater() {
    let wells = Case::new("bistable", &[("a", 0.6), ("sigma2", 0.3)], 2.0, 60);
    let found = wells.estimate(&wells.run(2048, 60.0));
    assert_honest(&wells, &found, Observable::Marginal(0), 15.0);
    let values = [("a", 0.2), ("b", 0.5), ("sigma2", 0.1)];
    let crater = Case::new("rayleigh", &values, 2.6, 40);
    let found = crater.estimate(&crater.run(2048, 40.0));
    assert_honest(&crater, &found, Observable::Joint(0, 1), 300.0);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let values = [("kappa", 0.1), ("f_c", 0.02), ("sigma2", 0.02)];
    let case = Case::new("coulomb", &values, 0.8, 30);
    let run = case.run(40 * LANES, 1.0);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let relaxed = relaxation(&*case.system, &case.space, 5, &Cancellation::new()).unwrap();
            (relaxed.settled, relaxed.time.to_bits(), case.estimate(&run))
        })
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(3));
    assert!(one.2.share_outside > 0.0, "trajectories that come back");
}

#[test]
fn trajectories_that_run_away_are_counted_and_the_rest_is_kept() {
    let values = [("kappa", -0.5), ("mu", 0.0), ("f_c", 0.0), ("sigma2", 0.01)];
    let case = Case::new("coulomb", &values, 1.5, 30);
    let run = ErgodicRun {
        time_step: 0.05,
        integrator: Integrator::StochasticHeun,
        seed: 1,
        trajectories: 100,
        burn_in: 1.0,
        length: 100.0,
        stride: 2,
    };
    let found = ergodic(&*case.system, &case.space, &[], &run, &Cancellation::new()).unwrap();
    assert_eq!(found.runaways, 1.0);
    assert!(
        found.looks > 0 && found.runaway_rate > 0.01,
        "{}",
        found.runaway_rate
    );
    assert!(found.share_outside > 0.5 && found.share_outside < 1.0);
}

#[test]
fn an_ensemble_agrees_with_the_exact_density_and_with_the_time_average() {
    let values = [("kappa", 0.1), ("mu", 0.5), ("f_c", 0.0), ("sigma2", 0.03)];
    let case = Case::new("coulomb", &values, 2.0, 24);
    let run = EnsembleRun {
        time_step: 0.05,
        integrator: Integrator::StochasticHeun,
        seed: 3,
        trajectories: 200_000,
        time: 12.0 * case.relaxation.time,
        start: vec![(0.5, 0.5), (0.0, 0.2)],
    };
    let found = ensemble(&*case.system, &case.space, &run, &Cancellation::new()).unwrap();
    assert_eq!(
        found.looks + (found.share_outside * 200_000.0) as u64,
        200_000
    );
    assert_honest(&case, &found, Observable::Joint(0, 1), 200.0);
    let ergodic = case.estimate(&case.run(2048, 40.0));
    for axis in 0..2 {
        // Relative error of a variance of 2e5 normal values: √(2/2e5) = 0.3 %; the time average holds about as many.
        let ratio = ergodic.variance[axis] / found.variance[axis];
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    }
    let early = EnsembleRun { time: 0.2, ..run };
    let early = ensemble(&*case.system, &case.space, &early, &Cancellation::new()).unwrap();
    assert!((early.mean[0] - 0.5).abs() < 0.1, "still at its start");
}

#[test]
fn variances_of_a_linear_oscillator_are_exact_with_long_steps_that_are_split() {
    let values = [("kappa", 0.1), ("mu", 0.0), ("f_c", 0.0), ("sigma2", 0.03)];
    let case = Case::new("coulomb", &values, 2.0, 24);
    let run = ErgodicRun {
        time_step: 0.4,
        integrator: Integrator::Splitting,
        stride: 4,
        ..case.run(2048, 40.0)
    };
    let found = case.estimate(&run);
    for axis in 0..2 {
        // σ²/(2κ), of 2048 · 40 relaxation times: a standard error of 0.5 %. Velocities of the steps have 4 % more.
        let ratio = found.variance[axis] / 0.15;
        assert!((ratio - 1.0).abs() < 0.015, "{axis}: {ratio}");
    }
}

#[test]
fn refusals_name_what_is_wrong() {
    let case = Case::new("bistable", &[("a", -0.5), ("sigma2", 0.3)], 2.0, 10);
    let run = case.run(64, 1.0);
    let refused = |run: &ErgodicRun, starts: &[Vec<f64>]| {
        ergodic(
            &*case.system,
            &case.space,
            starts,
            run,
            &Cancellation::new(),
        )
        .unwrap_err()
    };
    let still = ErgodicRun {
        time_step: 0.0,
        ..run.clone()
    };
    assert!(refused(&still, &[]).to_string().contains("time step is 0"));
    assert_eq!(refused(&run, &[vec![0.0, 0.0]]), MonteCarloError::Start);
    let blind = ErgodicRun {
        stride: 0,
        ..run.clone()
    };
    assert_eq!(refused(&blind, &[]), MonteCarloError::Stride);
    let cancellation = Cancellation::new();
    cancellation.cancel();
    let stopped = ergodic(&*case.system, &case.space, &[], &run, &cancellation);
    assert_eq!(stopped.unwrap_err(), MonteCarloError::Cancelled(Cancelled));
}
