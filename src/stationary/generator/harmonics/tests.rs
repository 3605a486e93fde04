//! Factors harmonic by harmonic against those of all nodes together, on forced oscillators.

use sprs::CsMat;

use crate::generator::{Generator, GeneratorOptions, assemble};
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::tests::distance;
use crate::stationary::generator::{RateMethod, RateOptions, RateSolver, RateSteadyState};
use crate::system::TypedModel;

/// Cells along x and y, and harmonics of the phase, of an oscillator with this restoring force.
fn forced(
    force: &str,
    (reach, cells): ([f64; 2], usize),
    harmonics: usize,
    values: &[(&str, f64)],
) -> (CellSpace, Generator) {
    let model = TypedModel::new("forced", "Forced", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", format!("-g y + {force} + F cos(w t)"))
        .with_noise("y", ["sqrt(2 g T)"])
        .with_parameters(["g", "T", "F", "w"])
        .build()
        .unwrap();
    let axis = |reach: f64| Axis::uniform(-reach, reach, cells).unwrap();
    let phase = Axis::fourier(0.0, 1.0, harmonics).unwrap();
    let space = CellSpace::new(vec![axis(reach[0]), axis(reach[1]), phase]).unwrap();
    let system = model.system(&model.values(values).unwrap());
    let generator = assemble(&*system, &space, &GeneratorOptions::default()).unwrap();
    (space, generator)
}

fn solver(space: &CellSpace, method: RateMethod) -> RateSolver {
    let options = RateOptions {
        method: Some(method),
        tolerance: 1e-8,
        memory_limit_bytes: 20 << 30,
        ..RateOptions::default()
    };
    RateSolver::new(space.clone(), options)
}

fn solve(space: &CellSpace, generator: &Generator, method: RateMethod) -> RateSteadyState {
    let steady = solver(space, method).solve(&generator.matrix, &generator.escape, None);
    steady.unwrap()
}

#[test]
fn explore() {
    let n = std::env::var("N").map_or(40, |n| n.parse().unwrap());
    let k = std::env::var("K").map_or(8, |n| n.parse().unwrap());
    for (name, force, reach, g, t, f, w) in [
        ("weak linear", "-x", [4.5, 4.5], 0.5, 0.5, 0.1, 0.7),
        ("std 1", "-x", [4.5, 4.5], 0.5, 0.5, 0.4, 0.7),
        ("std 2", "-x", [4.5, 4.5], 0.5, 0.5, 0.8, 0.7),
        ("well", "x - x^3", [2.2, 2.2], 0.3, 0.12, 0.2, 0.3),
        ("duffing", "-x - x^3", [3.0, 4.5], 0.2, 0.3, 0.4, 1.3),
        ("resonant", "-x - x^3", [2.2, 2.8], 0.1, 0.1, 0.25, 1.3),
    ] {
        let values = [("g", g), ("T", t), ("F", f), ("w", w)];
        let (space, generator) = forced(force, (reach, n), k, &values);
        let start = std::time::Instant::now();
        let each = solve(&space, &generator, RateMethod::Modewise);
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "{name}: {} iterations, {} factorisations, converged {}, {:.1e}, {seconds:.2} s, {} MB",
            each.info.iterations, each.info.factorisations, each.info.converged, each.info.residual,
            each.info.factor_bytes >> 20,
        );
        if n <= 20 {
            let whole = solve(&space, &generator, RateMethod::Lu);
            println!("  {:e}", distance(&whole.mass, &each.mass));
        }
    }
}
