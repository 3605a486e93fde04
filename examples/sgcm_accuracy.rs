//! How accurate SGCM is: steady states of the oscillator without friction, whose density is known exactly, over map
//! steps, grids and integrators. Prints the Markdown tables of docs/sgcm.md; takes about a minute on two cores.
//!
//! Run with `cargo run --release --example sgcm_accuracy`; with `-- quick` after it, the first grid of each table
//! alone.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::cancellation::Cancellation;
use pbif::density::{Observable, estimate, total_variation_of_masses};
use pbif::method::{Corrected, solve_corrected};
use pbif::sampling::{Integrator, Pilot, SampledTransitions, SamplingOptions, pilot};
use pbif::sampling::{TransitionMatrix, sample_transitions};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::{Options, Outcome, Solver, SteadyState, second_eigenvalue, solve};
use pbif::system::{System, registry};

type AnyError = Box<dyn std::error::Error>;

/// The nodes on [-1, 1] and the weights, Σ = 1, of the four-point Gauss-Legendre rule.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
    (-0.339_981_043_584_856_26, 0.326_072_577_431_273_07),
    (0.339_981_043_584_856_26, 0.326_072_577_431_273_07),
    (0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
];

/// Cells an axis, and samples a cell.
const GRIDS: [(usize, usize); 4] = [(50, 500), (50, 2000), (100, 500), (100, 2000)];

/// The oscillator on one grid, with what every run on it is compared to.
struct Trial<'a> {
    system: &'a dyn System,
    space: CellSpace,
    pilot: Pilot,
    exact: Vec<f64>,
}

impl<'a> Trial<'a> {
    fn new(system: &'a dyn System, count: usize) -> Result<Self, AnyError> {
        let axis = Axis::uniform(-3.0, 3.0, count)?;
        let space = CellSpace::new(vec![axis.clone(), axis])?;
        Ok(Self {
            system,
            pilot: pilot(system, &space, 1, &Cancellation::new())?,
            exact: exact_masses(system, &space)?,
            space,
        })
    }

    /// Samples and solves; `None` where mass does not stay in Ω.
    fn run(&self, options: &SamplingOptions) -> Result<Run, AnyError> {
        let (system, seeds) = (self.system, &self.pilot.cells);
        let transitions =
            sample_transitions(system, &self.space, seeds, options, &Cancellation::new())?;
        let matrix = transitions.matrix();
        let solver = Options::new(Solver::MultilevelAggregation, 1e-10);
        let steady = match solve(&matrix, &self.space, None, &solver)? {
            Outcome::Steady(steady) => Some(steady),
            _ => None,
        };
        Ok(Run {
            transitions,
            matrix,
            steady,
        })
    }

    fn distance(&self, steady: &SteadyState) -> Result<f64, AnyError> {
        Ok(total_variation_of_masses(&steady.mass, &self.exact)?)
    }
}

/// One sampled chain with its steady state.
struct Run {
    transitions: SampledTransitions,
    matrix: TransitionMatrix,
    steady: Option<SteadyState>,
}

/// Integrals of the exact density over the cells of Ω, Σ = 1. Values at the centres would be off by O(h²).
fn exact_masses(system: &dyn System, space: &CellSpace) -> Result<Vec<f64>, AnyError> {
    let mut masses = Vec::with_capacity(space.n_cells());
    for cell in 0..space.n_cells() {
        let centre = space.centre(cell);
        let half = |axis: usize| 0.5 * space.axes()[axis].width(space.position(cell, axis));
        let mut mass = 0.0;
        for (x, x_weight) in GAUSS {
            for (y, y_weight) in GAUSS {
                let state = [centre[0] + x * half(0), centre[1] + y * half(1)];
                let logarithm = system.exact_log_density(&state);
                mass += x_weight * y_weight * logarithm.ok_or("no exact density")?.exp();
            }
        }
        masses.push(mass * space.volume(cell));
    }
    let total: f64 = masses.iter().sum();
    Ok(masses.iter().map(|mass| mass / total).collect())
}

/// Total variation that sampling alone is expected to cause: ½ Σ E|error|, with normal errors of the jackknife's
/// standard deviation in every cell.
fn sampling_error(trial: &Trial<'_>, run: &Run, steady: &SteadyState) -> Result<f64, AnyError> {
    let options = Options::new(Solver::MultilevelAggregation, 1e-7);
    let mut replicates = Vec::new();
    for group in 0..run.transitions.groups() {
        let matrix = run.transitions.matrix_without_group(group);
        let outcome = solve(&matrix, &trial.space, Some(&steady.mass), &options)?;
        if let Outcome::Steady(without) = outcome {
            replicates.push(without.mass);
        }
    }
    expected_distance(trial, steady, &replicates)
}

/// ½ Σ E|error| from the replicates of a jackknife.
fn expected_distance(
    trial: &Trial<'_>,
    steady: &SteadyState,
    replicates: &[Vec<f64>],
) -> Result<f64, AnyError> {
    let joint = Observable::Joint(0, 1);
    let estimated = estimate(&trial.space, joint, &steady.mass, replicates)?;
    let errors = estimated.standard_error.iter();
    let cells = errors.zip(estimated.density.volumes());
    let sum: f64 = cells.map(|(error, volume)| error * volume).sum();
    Ok(0.5 * sum * (2.0 / std::f64::consts::PI).sqrt())
}

/// The same samples with densities that are flat and linear inside the cells: distance, share of sampling in it,
/// diffusion that the cells add, turns of the solve.
fn corrections(system: &dyn System, grids: usize) -> Result<(), AnyError> {
    println!(
        "| cells | samples | Δt | TV, flat | TV, linear | TV from sampling, linear | D_num, flat | D_num of x, linear | D_num of y, linear | turns |"
    );
    println!("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for &(count, samples) in GRIDS.iter().take(grids.min(3)) {
        let trial = Trial::new(system, count)?;
        let integrator = Integrator::StochasticHeun;
        let time_step = trial.pilot.automatic_time_step(integrator);
        for map_step in [0.2, 1.0, 3.0, 6.2] {
            let run = trial.run(&SamplingOptions {
                map_step,
                time_step,
                samples,
                groups: 8,
                seed: 1,
                integrator,
                keep_starts: true,
            })?;
            let flat = run.steady.as_ref().ok_or("no steady state in Ω")?;
            let (corrected, found) = linear(&trial, &run, None, None)?;
            let replicates: Result<Vec<_>, AnyError> = (0..run.transitions.groups())
                .map(|group| linear_masses(&trial, &run, &corrected, group))
                .collect();
            let cells = run.transitions.cells();
            let local: Vec<f64> = cells.iter().map(|&cell| corrected.mass[cell]).collect();
            let added = run.transitions.numerical_diffusion(&local);
            let left = run
                .transitions
                .remaining_diffusion(&trial.space, &local, &found.slopes);
            println!(
                "| {count}² | {samples} | {map_step} | {:.4} | {:.4} | {:.4} | {:.6} | {:.6} | {:.6} | {} |",
                trial.distance(flat)?,
                trial.distance(&corrected)?,
                expected_distance(&trial, &corrected, &replicates?)?,
                added[0],
                left[0],
                left[1],
                found.rounds,
            );
        }
    }
    Ok(())
}

/// Steady state with densities linear inside the cells.
fn linear(
    trial: &Trial<'_>,
    run: &Run,
    guess: Option<&[f64]>,
    left_out: Option<usize>,
) -> Result<(SteadyState, Corrected), AnyError> {
    let solver = Options::new(Solver::MultilevelAggregation, 1e-10);
    let found = solve_corrected(
        &run.transitions,
        &trial.space,
        guess,
        left_out,
        &solver,
        1e-6,
    )?;
    match found.outcome.clone() {
        Outcome::Steady(steady) => Ok((steady, found)),
        _ => Err("no steady state in Ω".into()),
    }
}

fn linear_masses(
    trial: &Trial<'_>,
    run: &Run,
    full: &SteadyState,
    group: usize,
) -> Result<Vec<f64>, AnyError> {
    Ok(linear(trial, run, Some(&full.mass), Some(group))?.0.mass)
}

/// Map steps, grids and samples with Heun's integrator: distance, its share from sampling, numerical diffusion.
fn map_steps(system: &dyn System, grids: usize) -> Result<(), AnyError> {
    println!(
        "| cells | samples | Δt | TV | TV from sampling | D_num of x | D_num of y | h²/(12Δt) |"
    );
    println!("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for &(count, samples) in GRIDS.iter().take(grids) {
        let trial = Trial::new(system, count)?;
        let integrator = Integrator::StochasticHeun;
        let time_step = trial.pilot.automatic_time_step(integrator);
        let automatic = trial.pilot.automatic_map_step(time_step, samples);
        for map_step in [0.2, 1.0, 3.0, 6.2, automatic] {
            let run = trial.run(&SamplingOptions {
                map_step,
                time_step,
                samples,
                groups: 8,
                seed: 1,
                integrator,
                keep_starts: false,
            })?;
            let steady = run.steady.as_ref().ok_or("no steady state in Ω")?;
            let local: Vec<f64> = run
                .transitions
                .cells()
                .iter()
                .map(|&cell| steady.mass[cell])
                .collect();
            let diffusion = run.transitions.numerical_diffusion(&local);
            let width = trial.space.axes()[0].width(0);
            let name = if map_step == automatic { "auto: " } else { "" };
            println!(
                "| {count}² | {samples} | {name}{map_step:.1} | {:.4} | {:.4} | {:.6} | {:.6} | {:.6} |",
                trial.distance(steady)?,
                sampling_error(&trial, &run, steady)?,
                diffusion[0],
                diffusion[1],
                width * width / (12.0 * map_step),
            );
        }
    }
    Ok(())
}

/// Time steps of three integrators at one map step: what each takes away from the damping, and what comes of it.
fn integrators(system: &dyn System) -> Result<(), AnyError> {
    let trial = Trial::new(system, 50)?;
    let (euler, heun) = (Integrator::EulerMaruyama, Integrator::StochasticHeun);
    let automatic = trial.pilot.automatic_time_step(heun);
    println!(
        "| integrator | dt | taken from κ = 0.01 | TV | standard deviation of y | escape in one relaxation time |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: |");
    let steps = [0.02, 0.01, 0.005, 0.0025].map(|step| (euler, step));
    let split = [0.4, 0.2, 0.1].map(|step| (Integrator::Splitting, step));
    let others = [(heun, 0.2), (heun, automatic), (heun, 0.01)];
    let all = steps.into_iter().chain(others).chain(split);
    for (integrator, time_step) in all {
        let run = trial.run(&SamplingOptions {
            map_step: 6.2,
            time_step,
            samples: 500,
            groups: 8,
            seed: 1,
            integrator,
            keep_starts: false,
        })?;
        let taken = match integrator {
            Integrator::EulerMaruyama => run.transitions.time_step(),
            Integrator::StochasticHeun | Integrator::WeakHeun => {
                run.transitions.time_step().powi(3) / 4.0
            }
            Integrator::Splitting | Integrator::WeakSplitting => 0.0,
        };
        print!("| {} | {time_step:.4} | {taken:.1e} | ", integrator.name());
        match &run.steady {
            Some(steady) => {
                let moments = pbif::density::moments(&trial.space, &steady.mass)?;
                let spread = moments[1].standard_deviation;
                let rate = -(-steady.info.escape_per_step).ln_1p() / run.matrix.map_step;
                let relaxation =
                    second_eigenvalue(&run.matrix, &trial.space, steady, &Cancellation::new())?;
                let relaxation = relaxation.relaxation_time;
                let share = 100.0 * rate * relaxation.unwrap_or(f64::INFINITY);
                println!(
                    "{:.3} | {spread:.3} | {share:.2} % |",
                    trial.distance(steady)?
                );
            }
            None => println!("no steady state | | |"),
        }
    }
    Ok(())
}

fn main() -> Result<(), AnyError> {
    let given = [
        ("kappa", 0.01),
        ("mu", 0.01),
        ("f_c", 0.0),
        ("sigma2", 0.01),
    ];
    let system = registry::find("coulomb")?.system_with(&given)?;
    let is_quick = std::env::args().any(|argument| argument == "quick");
    let grids = if is_quick { 1 } else { GRIDS.len() };
    map_steps(system.as_ref(), grids)?;
    println!();
    corrections(system.as_ref(), grids)?;
    if !is_quick {
        println!();
        integrators(system.as_ref())?;
    }
    Ok(())
}
