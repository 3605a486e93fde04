//! How accurate the generator is for the oscillator with Coulomb friction: against the exact density where there is no
//! friction, and against finer cells and the exact jump of the slope where there is. Prints the Markdown tables of
//! docs/accuracy.md; takes about half a minute on two cores.
//!
//! Run with `cargo run --release --example generator_accuracy`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use std::sync::Arc;

use pbif::density::total_variation_of_masses;
use pbif::generator::{
    AdvectiveScheme, GeneratorOptions, assemble, automatic_grading, cell_masses,
};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::generator::{RateMethod, RateOptions, RateSolver};
use pbif::system::{System, registry};

type AnyError = Box<dyn std::error::Error>;

/// Noise intensity σ².
const SIGMA2: f64 = 0.01;

/// The nodes on [-½, ½] and the weights, Σ = 1, of the three-point Gauss-Legendre rule.
const GAUSS: [(f64, f64); 3] = [
    (-0.387_298_334_620_741_7, 5.0 / 18.0),
    (0.0, 8.0 / 18.0),
    (0.387_298_334_620_741_7, 5.0 / 18.0),
];

fn main() -> Result<(), AnyError> {
    without_friction()?;
    at_the_kink()
}

fn coulomb(f_c: f64) -> Result<Arc<dyn System>, AnyError> {
    let values = [
        ("mu", 0.01),
        ("kappa", 0.01),
        ("f_c", f_c),
        ("sigma2", SIGMA2),
    ];
    Ok(registry::find("coulomb")?.system_with(&values)?)
}

/// Equal cells on ±`half`.
fn uniform(half: f64, count: usize) -> Result<CellSpace, AnyError> {
    Ok(CellSpace::new(vec![Axis::uniform(-half, half, count)?; 2])?)
}

/// 100 cells an axis, on y graded toward the surface as the program does it, each split in `split`.
fn graded(system: &dyn System, half: f64, split: usize) -> Result<CellSpace, AnyError> {
    let mut grading = automatic_grading(system, &[(-half, half); 2], 1, 100)
        .ok_or("there is no surface to grade toward")?;
    grading.smallest /= split as f64;
    let x = Axis::uniform(-half, half, 100 * split)?;
    let y = Axis::graded(-half, half, 100 * split, &grading)?;
    Ok(CellSpace::new(vec![x, y])?)
}

/// Steady masses of the cells, Σ = 1; a guess decides which cell the solver holds.
fn masses(
    system: &dyn System,
    space: &CellSpace,
    scheme: AdvectiveScheme,
    guess: Option<&[f64]>,
) -> Result<Vec<f64>, AnyError> {
    let generator = assemble(system, space, &GeneratorOptions { scheme })?;
    let options = RateOptions {
        // Single precision, the choice for large grids, needs hundreds of iterations on cells this unequal.
        method: Some(RateMethod::Lu),
        ..RateOptions::default()
    };
    let mut solver = RateSolver::new(space.clone(), options);
    let steady = solver.solve(&generator.matrix, &generator.escape, guess)?;
    if !steady.info.converged {
        return Err("a solve did not converge".into());
    }
    Ok(cell_masses(system, space, &steady.mass))
}

/// Integrals of the exact density over the cells, Σ = 1.
fn exact_masses(system: &dyn System, space: &CellSpace) -> Result<Vec<f64>, AnyError> {
    let mut masses = vec![0.0; space.n_cells()];
    for (cell, mass) in masses.iter_mut().enumerate() {
        let centre = space.centre(cell);
        let width = |axis: usize| space.axes()[axis].width(space.position(cell, axis));
        for (x, first) in GAUSS {
            for (y, second) in GAUSS {
                let state = [centre[0] + x * width(0), centre[1] + y * width(1)];
                let density = system.exact_log_density(&state);
                let density = density.ok_or("the exact density is not known")?.exp();
                *mass += first * second * density * space.volume(cell);
            }
        }
    }
    let total: f64 = masses.iter().sum();
    masses.iter_mut().for_each(|mass| *mass /= total);
    Ok(masses)
}

fn without_friction() -> Result<(), AnyError> {
    println!("| cells an axis | half range | upwind5 (default) | central4 | central6 |");
    println!("| ---: | ---: | ---: | ---: | ---: |");
    let system = coulomb(0.0)?;
    for (count, half) in [
        (50, 3.6),
        (100, 3.8),
        (100, 4.0),
        (50, 4.2),
        (100, 4.2),
        (150, 4.2),
    ] {
        let space = uniform(half, count)?;
        let exact = exact_masses(&*system, &space)?;
        print!("| {count} | {half} |");
        for scheme in AdvectiveScheme::ALL {
            let found = masses(&*system, &space, scheme, None)?;
            print!(" {:.1e} |", total_variation_of_masses(&found, &exact)?);
        }
        println!();
    }
    Ok(())
}

fn at_the_kink() -> Result<(), AnyError> {
    println!("\n| f_c | half range | cells | scheme | slope | TV | negative mass |");
    println!("| ---: | ---: | --- | --- | ---: | ---: | ---: |");
    for (f_c, half) in [(0.01, 3.0), (0.001, 3.6), (-0.001, 3.8), (-0.01, 4.2)] {
        let system = coulomb(f_c)?;
        let spaces = [
            ("uniform", uniform(half, 100)?, uniform(half, 200)?),
            (
                "graded",
                graded(&*system, half, 1)?,
                graded(&*system, half, 2)?,
            ),
        ];
        for (name, space, fine) in &spaces {
            let reference = reference(&*system, space, fine)?;
            for scheme in AdvectiveScheme::ALL {
                let found = masses(&*system, space, scheme, None)?;
                let negative: f64 = found.iter().map(|mass| (-mass).max(0.0)).sum();
                println!(
                    "| {f_c} | {half} | {name} | {} | {:.4} | {:.1e} | {negative:.1e} |",
                    scheme.name(),
                    slope_over_law(space, &found, f_c),
                    total_variation_of_masses(&found, &reference)?
                );
            }
        }
    }
    Ok(())
}

/// Masses by the scheme of highest order on cells split in two, summed over each cell of `space`.
fn reference(
    system: &dyn System,
    space: &CellSpace,
    fine: &CellSpace,
) -> Result<Vec<f64>, AnyError> {
    let parent =
        |cell: usize| space.number(&[fine.position(cell, 0) / 2, fine.position(cell, 1) / 2]);
    let coarse = masses(system, space, AdvectiveScheme::Central6, None)?;
    let guess: Vec<f64> = (0..fine.n_cells())
        .map(|cell| coarse[parent(cell)])
        .collect();
    let found = masses(system, fine, AdvectiveScheme::Central6, Some(&guess))?;
    let mut sums = vec![0.0; space.n_cells()];
    for (cell, mass) in found.iter().enumerate() {
        sums[parent(cell)] += mass;
    }
    Ok(sums)
}

/// p'(0+)/p(0) of the marginal of y over the exact -2 f_c/σ²: the slope at the surface of the cubic that has the
/// masses of the four cells above it.
fn slope_over_law(space: &CellSpace, masses: &[f64], f_c: f64) -> f64 {
    let axis = &space.axes()[1];
    let mut marginal = vec![0.0; axis.count()];
    for (cell, mass) in masses.iter().enumerate() {
        marginal[space.position(cell, 1)] += mass;
    }
    let first = axis.count() / 2;
    // Newton's divided differences of the integral of the density, which vanishes at the surface.
    let edges: Vec<f64> = (0..5).map(|edge| axis.edges()[first + edge]).collect();
    let mut differences = [0.0; 5];
    for edge in 1..5 {
        differences[edge] = differences[edge - 1] + marginal[first + edge - 1];
    }
    for order in 1..5 {
        for edge in (order..5).rev() {
            differences[edge] =
                (differences[edge] - differences[edge - 1]) / (edges[edge] - edges[edge - order]);
        }
    }
    // First and second derivative at the surface, edges[0] = 0: p(0) and p'(0+).
    let [e1, e2, e3] = [edges[1], edges[2], edges[3]];
    let [d1, d2, d3, d4] = [1, 2, 3, 4].map(|order| differences[order]);
    let density = d1 - e1 * d2 + e1 * e2 * d3 - e1 * e2 * e3 * d4;
    let slope = 2.0 * (d2 - (e1 + e2) * d3 + (e1 * e2 + e1 * e3 + e2 * e3) * d4);
    slope / density / (-2.0 * f_c / SIGMA2)
}
