//! Friction by the generator against a solve on four times the cells an axis.

use std::sync::Arc;

use pbif::generator::{
    AdvectiveScheme, GeneratorOptions, assemble, automatic_grading, cell_masses,
};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::generator::{RateMethod, RateOptions, RateSolver};
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
        let best = errors.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(best < 3e-4, "f_c = {f_c}: {errors:?}");
    }
}
