//! Steady state of sampled chains, to an L1 error of 1e-12: multilevel aggregation against power iteration, and
//! the second eigenvalue.

// A bench may stop where it cannot go on, and speaks to who runs it.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

use criterion::{Criterion, criterion_group, criterion_main};
use pbif::cancellation::Cancellation;
use pbif::sampling::TransitionMatrix;
use pbif::space::{Axis, CellSpace};
use pbif::stationary::{Options, Outcome, Solver, second_eigenvalue, solve};

#[path = "../src/stationary/transition_matrix/sampled_chain.rs"]
mod sampled_chain;

use sampled_chain::{Settings, sampled_chain};

/// A weakly damped chain on `count`² cells with about 45 destinations a cell.
fn chain(count: usize) -> (TransitionMatrix, CellSpace) {
    let (matrix, escape) = sampled_chain(&Settings {
        count,
        samples: 100,
        damping: 0.998,
        spread: 0.25,
        leaks: true,
        seed: 1,
    });
    let axis = Axis::uniform(-1.0, 1.0, count).unwrap();
    let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
    let matrix = TransitionMatrix {
        cells: (0..escape.len()).collect(),
        matrix,
        escape,
        map_step: 1.0,
        phase: None,
    };
    (matrix, space)
}

fn benchmark(criterion: &mut Criterion) {
    for (count, solvers) in [
        (50, &Solver::ALL[..]),
        (200, &Solver::ALL[..]),
        (500, &[Solver::MultilevelAggregation][..]),
    ] {
        let (matrix, space) = chain(count);
        let mut group = criterion.benchmark_group(format!("{count}x{count}"));
        group.sample_size(10);
        let mut steady = None;
        for &solver in solvers {
            let options = Options::new(solver, 1e-12);
            let run = || solve(&matrix, &space, None, &options);
            if let Ok(Outcome::Steady(found)) = run() {
                eprintln!("{} entries; {:?}", matrix.matrix.nnz(), found.info);
                steady = Some(found);
            }
            group.bench_function(solver.name(), |bencher| bencher.iter(run));
        }
        if let Some(steady) = steady {
            eprintln!(
                "{:?}",
                second_eigenvalue(&matrix, &space, &steady, &Cancellation::new())
            );
            let options = Options::new(Solver::MultilevelAggregation, 1e-12);
            let warm = || solve(&matrix, &space, Some(&steady.mass), &options);
            group.bench_function("warm", |bencher| bencher.iter(warm));
            let second = || second_eigenvalue(&matrix, &space, &steady, &Cancellation::new());
            group.bench_function("second eigenvalue", |bencher| bencher.iter(second));
        }
        group.finish();
    }
}

criterion_group!(benches, benchmark);
criterion_main!(benches);
