//! Friction against a solve on four times the cells an axis, and what solves cost: tables of docs/accuracy.md.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot be set up should stop; the tables are printed"
)]

use std::sync::Arc;
use std::time::Instant;

use pbif::generator::{
    AdvectiveScheme, GeneratorOptions, assemble, automatic_grading, cell_masses,
};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::generator::{RateMethod, RateOptions, RateSolver, RateSteadyState};
use pbif::system::{System, registry};

fn coulomb(f_c: f64) -> Arc<dyn System> {
    let values = [
        ("kappa", 0.01),
        ("mu", 0.01),
        ("sigma2", 0.01),
        ("f_c", f_c),
    ];
    registry::find("coulomb")
        .unwrap()
        .system_with(&values)
        .unwrap()
}

fn dahl(alpha: f64) -> Arc<dyn System> {
    let values = [
        ("alpha", alpha),
        ("kappa", 0.02),
        ("mu", 1.0),
        ("lambda", 0.06),
        ("f_c", 0.05),
        ("sigma2", 0.02),
    ];
    registry::find("dahl")
        .unwrap()
        .system_with(&values)
        .unwrap()
}

/// 100 cells on x, 100 on y graded toward the surface, every one split in `split`.
fn graded(system: &dyn System, half: f64, split: usize) -> CellSpace {
    let mut grading = automatic_grading(system, &[(-half, half); 2], 1, 100).unwrap();
    grading.smallest /= split as f64;
    let x = Axis::uniform(-half, half, 100 * split).unwrap();
    let y = Axis::graded(-half, half, 100 * split, &grading).unwrap();
    CellSpace::new(vec![x, y]).unwrap()
}

fn masses(
    system: &dyn System,
    space: &CellSpace,
    scheme: AdvectiveScheme,
    guess: Option<&[f64]>,
) -> Vec<f64> {
    let generator = assemble(system, space, &GeneratorOptions { scheme }).unwrap();
    let options = RateOptions {
        // Single precision, the choice for large grids, needs hundreds of iterations on cells this unequal.
        method: Some(RateMethod::Lu),
        ..RateOptions::default()
    };
    let state =
        RateSolver::new(space.clone(), options).solve(&generator.matrix, &generator.escape, guess);
    let state = state.unwrap();
    assert!(state.info.converged);
    cell_masses(system, space, &state.mass)
}

#[test]
fn friction_agrees_with_four_times_the_cells_an_axis() {
    for (f_c, half) in [(0.01, 3.0), (-0.01, 4.2)] {
        let system = coulomb(f_c);
        let (space, fine) = (graded(&*system, half, 1), graded(&*system, half, 4));
        for (cell, edge) in space.axes()[1].edges().iter().enumerate() {
            assert!((edge - fine.axes()[1].edges()[4 * cell]).abs() < 1e-9);
        }
        // A guess, so that a cell is held that carries mass.
        let coarse = masses(&*system, &space, AdvectiveScheme::Central6, None);
        let parent =
            |cell: usize| space.number(&[fine.position(cell, 0) / 4, fine.position(cell, 1) / 4]);
        let guess: Vec<f64> = (0..fine.n_cells())
            .map(|cell| coarse[parent(cell)])
            .collect();
        let reference = masses(&*system, &fine, AdvectiveScheme::Central6, Some(&guess));
        let mut restricted = vec![0.0; space.n_cells()];
        for (cell, mass) in reference.iter().enumerate() {
            restricted[parent(cell)] += mass;
        }
        let errors = AdvectiveScheme::ALL.map(|scheme| {
            let found = masses(&*system, &space, scheme, None);
            0.5 * found
                .iter()
                .zip(&restricted)
                .map(|(a, b)| (a - b).abs())
                .sum::<f64>()
        });
        println!("f_c = {f_c}: {errors:?}");
        let best = errors.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(best < 3e-4, "f_c = {f_c}: {errors:?}");
    }
}

/// Processor seconds of this process so far, where the system tells.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = text
        .rsplit(')')
        .next()
        .unwrap_or("")
        .split_whitespace()
        .collect();
    let ticks = |index: usize| {
        fields
            .get(index)
            .and_then(|field| field.parse::<f64>().ok())
    };
    0.01 * ticks(11).unwrap_or(0.0)
}

struct Cost {
    cells: f64,
    cold: f64,
    bytes: f64,
}

/// A cold solve and a warm one a small step of the parameter on; prints a line.
fn cost(name: &str, space: &CellSpace, systems: [Arc<dyn System>; 2]) -> Cost {
    let options = RateOptions {
        memory_limit_bytes: 12 << 30,
        ..RateOptions::default()
    };
    let mut solver = RateSolver::new(space.clone(), options);
    let mut guess: Option<Vec<f64>> = None;
    let mut cost = Cost {
        cells: space.n_cells() as f64,
        cold: 0.0,
        bytes: 0.0,
    };
    print!("{name}");
    for system in systems {
        let (clock, processor) = (Instant::now(), processor_seconds());
        let generator = assemble(&*system, space, &GeneratorOptions::default()).unwrap();
        let RateSteadyState { mass, info } = solver
            .solve(&generator.matrix, &generator.escape, guess.as_deref())
            .unwrap();
        let (wall, processor) = (
            clock.elapsed().as_secs_f64(),
            processor_seconds() - processor,
        );
        print!(
            " | {wall:.3} s ({processor:.2}), {}+{}{}",
            info.factorisations,
            info.iterations,
            if info.converged { "" } else { " NOT CONVERGED" }
        );
        if guess.is_none() {
            (cost.cold, cost.bytes) = (processor, info.factor_bytes as f64);
        }
        if guess.is_some() {
            println!(
                " | {:.0} MB, {}",
                info.factor_bytes as f64 / 1e6,
                info.method.name()
            );
        }
        guess = Some(mass);
    }
    cost
}

/// Least-squares slope of the logarithms.
fn exponent(costs: &[Cost], value: fn(&Cost) -> f64) -> f64 {
    let points = costs
        .iter()
        .map(|cost| (cost.cells.ln(), value(cost).max(1e-3).ln()));
    let n = costs.len() as f64;
    let (x, y) = points.clone().fold((0.0, 0.0), |sum, point| {
        (sum.0 + point.0 / n, sum.1 + point.1 / n)
    });
    let (xy, xx) = points.fold((0.0, 0.0), |sum, point| {
        (
            sum.0 + (point.0 - x) * (point.1 - y),
            sum.1 + (point.0 - x).powi(2),
        )
    });
    xy / xx
}

#[test]
#[ignore = "minutes: prints the tables of cost in docs/accuracy.md"]
fn table_of_costs() {
    println!("grid | cold, wall (processor), factorisations+iterations | warm | factors");
    let largest: usize = std::env::var("LARGEST").map_or(1000, |count| count.parse().unwrap());
    let mut costs = Vec::new();
    for count in [50, 100, 200, 500, 1000]
        .into_iter()
        .filter(|count| *count <= largest)
    {
        let axis = Axis::uniform(-3.6, 3.6, count).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
        costs.push(cost(
            &format!("{count}²"),
            &space,
            [coulomb(0.005), coulomb(0.0051)],
        ));
    }
    let large = &costs[2.min(costs.len() - 1)..];
    println!(
        "2D from 200²: time ∝ cells^{:.2}",
        exponent(large, |cost| cost.cold)
    );
    println!(
        "2D: memory ∝ cells^{:.2}",
        exponent(&costs, |cost| cost.bytes)
    );
    let mut costs = Vec::new();
    for count in [20, 30, 40] {
        let wall = 0.05 / 0.06;
        let axes = [(-2.5, 2.5), (-2.5, 2.5), (-wall, wall)];
        let axes = axes.map(|(from, to)| Axis::uniform(from, to, count).unwrap());
        let space = CellSpace::new(axes.to_vec()).unwrap();
        costs.push(cost(&format!("{count}³"), &space, [dahl(0.5), dahl(0.475)]));
    }
    println!("3D: time ∝ cells^{:.2}", exponent(&costs, |cost| cost.cold));
    println!(
        "3D: memory ∝ cells^{:.2}",
        exponent(&costs, |cost| cost.bytes)
    );
}
