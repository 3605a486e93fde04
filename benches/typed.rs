//! A built-in model against its twin as formulas, through the library: steps of sampled trajectories, and the assembly
//! of a generator. Run with `cargo bench --bench typed`; figures are the fastest of several runs on one thread.
#![allow(missing_docs, clippy::print_stdout, clippy::unwrap_used)]

use std::hint::black_box;
use std::time::Instant;

use pbif::cancellation::Cancellation;
use pbif::generator::{GeneratorOptions, assemble};
use pbif::sampling::{Integrator, SamplingOptions, sample_transitions};
use pbif::space::{Axis, CellSpace};
use pbif::system::{System, TypedModel, registry};

/// What is measured of a system, in seconds.
type Measure = fn(&dyn System) -> f64;

/// Seconds of the fastest run.
fn fastest(runs: usize, mut work: impl FnMut()) -> f64 {
    let times = (0..runs).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}

fn sampling(system: &dyn System) -> f64 {
    let space = CellSpace::new(vec![Axis::uniform(-3.0, 3.0, 50).unwrap(); 2]).unwrap();
    let seeds: Vec<usize> = (0..space.n_cells()).collect();
    let options = SamplingOptions {
        map_step: 0.5,
        time_step: 0.01,
        samples: 128,
        groups: 2,
        seed: 1,
        integrator: Integrator::StochasticHeun,
        keep_starts: false,
    };
    let never = Cancellation::new();
    fastest(5, || {
        let sampled = sample_transitions(system, &space, &seeds, &options, &never);
        black_box(sampled.unwrap());
    })
}

fn assembly(system: &dyn System) -> f64 {
    let space = CellSpace::new(vec![Axis::uniform(-3.0, 3.0, 100).unwrap(); 2]).unwrap();
    fastest(20, || {
        black_box(assemble(system, &space, &GeneratorOptions::default()).unwrap());
    })
}

fn main() {
    let values = [
        ("kappa", 0.01),
        ("mu", 0.01),
        ("f_c", 0.02),
        ("sigma2", 0.01),
    ];
    let model = registry::find("coulomb").unwrap();
    let typed = TypedModel::new("typed", "twin of coulomb", model.axes.clone())
        .with_parameters(model.parameters.clone())
        .with_equation("x", "y")
        .with_equation("y", "-kappa y - x (alpha + mu x^2) - f_c sign(y)")
        .with_noise("y", ["sqrt(sigma2)"])
        .build()
        .unwrap();
    let (built_in, typed) = (
        model.system_with(&values).unwrap(),
        typed.system_with(&values).unwrap(),
    );
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let measures: [(&str, Measure); 2] = [
        ("sampling, 50 × 50 cells × 128 samples × 50 steps", sampling),
        ("assembly of a generator, 100 × 100 cells", assembly),
    ];
    for (name, measure) in measures {
        let [one, other] =
            threads.install(|| [measure(built_in.as_ref()), measure(typed.as_ref())]);
        println!(
            "{name}: built-in {:.2} ms, formulas {:.2} ms, {:.0} % of its speed",
            1e3 * one,
            1e3 * other,
            100.0 * one / other
        );
    }
}
