//! Time and memory of the steady state of generators: `cargo bench --bench rates -- 2d 50 100`.

#[path = "../src/stationary/rates/tests/generators.rs"]
mod generators;

use std::time::Instant;

use pbif::space::{Axis, CellSpace};
use pbif::stationary::rates::{RateMethod, RateOptions, RateSolver, estimate};

fn space(shape: &[usize]) -> CellSpace {
    let axes = shape
        .iter()
        .map(|&count| Axis::uniform(-1.0, 1.0, count).unwrap());
    CellSpace::new(axes.collect()).unwrap()
}

/// Cold, warm (parameter moved a little, neighbour's mass as guess), and sensitivity-free timing of one grid.
fn run(shape: &[usize], method: Option<RateMethod>) {
    let make = |step: f64| match *shape {
        [count, _] => generators::oscillator(count, 0.01 + step * 1e-4),
        _ => generators::dahl([shape[0], shape[1], shape[2]], 0.5 - step * 0.025),
    };
    let space = space(shape);
    let options = RateOptions {
        method,
        memory_limit_bytes: 20 << 30,
        ..RateOptions::default()
    };
    let plan = estimate(
        &space,
        &vec![3; shape.len()],
        options.memory_limit_bytes,
        method,
    )
    .unwrap();
    let mut solver = RateSolver::new(space, options);
    let mut guess: Option<Vec<f64>> = None;
    for step in 0..5 {
        let (matrix, escape) = make(f64::from(step));
        let clock = Instant::now();
        let state = solver.solve(&matrix, &escape, guess.as_deref()).unwrap();
        let seconds = clock.elapsed().as_secs_f64();
        let info = &state.info;
        println!(
            "{shape:?} {:10} {:9.4} s  fact {} iter {:3} res {:.1e} err {:.1e} esc {:.1e} neg {:.1e} {} | {:.1} MB (peak {:.1}) {:.2} GF",
            info.method.name(),
            seconds,
            info.factorisations,
            info.iterations,
            info.residual,
            info.error_estimate,
            info.escape_rate,
            info.negative_mass,
            info.converged,
            info.factor_bytes as f64 / 1e6,
            plan.peak_bytes as f64 / 1e6,
            plan.operations / 1e9,
        );
        guess = Some(state.mass);
    }
}

fn main() {
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with("--"))
        .collect();
    let method = RateMethod::ALL
        .into_iter()
        .find(|method| words.iter().any(|word| word == method.name()));
    let mut ran = false;
    for word in &words {
        let shape: Vec<usize> = word
            .split('x')
            .filter_map(|count| count.parse().ok())
            .collect();
        if shape.len() >= 2 {
            run(&shape, method);
            ran = true;
        }
    }
    if !ran {
        run(&[50, 50], None);
        run(&[100, 100], None);
    }
}
