//! One density, step by step: a model, cells, a sampled transition matrix, its steady state, a marginal and its peaks.
//!
//! Run with `cargo run --release --example one_density`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::cancellation::Cancellation;
use pbif::density::{Observable, estimate, moments, total_variation_of_masses};
use pbif::sampling::{Integrator, SamplingOptions, pilot, sample_transitions};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::{Options, Outcome, Solver, solve};
use pbif::system::registry;
use pbif::topology::{DetectOptions, Detector, PersistenceDetector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A Duffing oscillator with dry friction. Without friction (f_c = 0) the density is known exactly.
    let model = registry::find("coulomb")?;
    let parameters = [
        ("kappa", 0.01),
        ("mu", 0.01),
        ("f_c", 0.0),
        ("sigma2", 0.01),
    ];
    let system = model.system_with(&parameters)?;

    // 50 x 50 cells over x and y = x'. An even count puts a face on y = 0, where friction switches.
    let axis = Axis::uniform(-3.0, 3.0, 50)?;
    let space = CellSpace::new(vec![axis.clone(), axis])?;

    // A few free trajectories show which cells to start from and which steps suit the system.
    let pilot = pilot(system.as_ref(), &space, 1, &Cancellation::new())?;
    let time_step = pilot.automatic_time_step(Integrator::StochasticHeun);
    let options = SamplingOptions {
        map_step: pilot.automatic_map_step(time_step, 500),
        time_step,
        samples: 500,
        groups: 8,
        seed: 1,
        integrator: Integrator::StochasticHeun,
        keep_starts: false,
    };
    let transitions = sample_transitions(
        system.as_ref(),
        &space,
        &pilot.cells,
        &options,
        &Cancellation::new(),
    )?;

    // The steady state p = P p, and the same without each group of samples for the sampling error.
    let solver = Options::new(Solver::MultilevelAggregation, 1e-10);
    let Outcome::Steady(steady) = solve(&transitions.matrix(), &space, None, &solver)? else {
        return Err("no single steady state in these cells".into());
    };
    let mut replicates = Vec::new();
    for group in 0..transitions.groups() {
        let matrix = transitions.matrix_without_group(group);
        if let Outcome::Steady(without) = solve(&matrix, &space, Some(&steady.mass), &solver)? {
            replicates.push(without.mass);
        }
    }
    let cycles = steady.info.iterations;
    println!("map step {:.2}, {cycles} cycles", options.map_step);
    for (axis, moment) in moments(&space, &steady.mass)?.iter().enumerate() {
        let name = &model.axes[axis].name;
        println!("sd of {name}: {:.4}", moment.standard_deviation);
    }

    // What the marginal of x looks like.
    let marginal = estimate(&space, Observable::Marginal(0), &steady.mass, &replicates)?;
    let detection = PersistenceDetector::new(DetectOptions::default(), 1).detect(&marginal);
    println!("p(x): {}", detection.signature);

    // The exact density, for comparison: total variation between the cell masses.
    let weight = |cell| {
        let log_density = system.exact_log_density(&space.centre(cell));
        log_density.map_or(0.0, f64::exp)
    };
    let weights: Vec<f64> = (0..space.n_cells()).map(weight).collect();
    let total: f64 = weights.iter().sum();
    let exact: Vec<f64> = weights.iter().map(|weight| weight / total).collect();
    let distance = total_variation_of_masses(&steady.mass, &exact)?;
    println!("total variation to the exact density: {distance:.4}");
    Ok(())
}
