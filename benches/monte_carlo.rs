//! Steps a second of long trajectories of the Coulomb oscillator, counted into 50×50 cells.
//!
//! Read `thrpt`: an element is one step of one trajectory, its share of looks included. Build with
//! `cargo bench --bench monte_carlo`.
#![allow(missing_docs)] // criterion's macros make undocumented items

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use pbif::cancellation::Cancellation;
use pbif::monte_carlo::{ErgodicRun, ergodic};
use pbif::sampling::Integrator;
use pbif::space::{Axis, CellSpace, Grading};
use pbif::system::registry;

const TRAJECTORIES: usize = 2048;
const STEPS: usize = 10_000;
const STEP: f64 = 0.02;

fn grids() -> Result<Vec<(&'static str, CellSpace)>, pbif::space::SpaceError> {
    let axis = Axis::uniform(-5.5, 5.5, 50)?;
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.002,
    };
    let graded = Axis::graded(-5.5, 5.5, 100, &grading)?;
    Ok(vec![
        ("uniform", CellSpace::new(vec![axis.clone(), axis.clone()])?),
        ("graded", CellSpace::new(vec![axis, graded])?),
    ])
}

fn long_trajectories(criterion: &mut Criterion) {
    let values = [
        ("kappa", 0.01),
        ("mu", 0.01),
        ("f_c", 0.02),
        ("sigma2", 0.01),
    ];
    let system = registry::find("coulomb").and_then(|model| model.system_with(&values));
    let (Ok(system), Ok(grids)) = (system, grids()) else {
        return;
    };
    let mut group = criterion.benchmark_group("2048 trajectories × 10,000 steps");
    group
        .sample_size(10)
        .throughput(Throughput::Elements((TRAJECTORIES * STEPS) as u64));
    // The spacing that is chosen on 50×50 cells, and practically no looks.
    for (name, stride) in [("uniform", 8), ("graded", 8), ("uniform", 1000)] {
        let Some((_, space)) = grids.iter().find(|grid| grid.0 == name) else {
            continue;
        };
        for (integrator, threads) in [
            (Integrator::StochasticHeun, 1),
            (Integrator::StochasticHeun, 2),
            (Integrator::EulerMaruyama, 2),
        ] {
            let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
                continue;
            };
            let run = ErgodicRun {
                time_step: STEP,
                integrator,
                seed: 1,
                trajectories: TRAJECTORIES,
                burn_in: STEP,
                length: STEPS as f64 * STEP,
                stride,
            };
            let run = || ergodic(&*system, space, &[], &run, &Cancellation::new());
            let name = format!(
                "{name}, every {stride} steps, {}, {threads} threads",
                integrator.name()
            );
            group.bench_function(name, |bencher| {
                bencher.iter(|| pool.install(|| black_box(run())))
            });
        }
    }
    group.finish();
}

criterion_group!(benches, long_trajectories);
criterion_main!(benches);
