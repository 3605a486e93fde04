//! Factors mode by mode against those of all modes together, on Dahl's oscillator.

use sprs::CsMat;

use super::layout::Layout;
use crate::generator::{Generator, GeneratorOptions, assemble};
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::dissection::Grid;
use crate::stationary::generator::tests::{
    assert_adjoint, assert_same_bits, difference_of_answers, distance, solve, solver,
};
use crate::stationary::generator::{RateMethod, estimate};
use crate::system::registry;

/// Cells along x and y, and modes of z.
fn space(cells: [usize; 2], modes: usize) -> CellSpace {
    let x = Axis::uniform(-2.4, 2.4, cells[0]).unwrap();
    let y = Axis::uniform(-3.2, 3.2, cells[1]).unwrap();
    CellSpace::new(vec![x, y, Axis::modes(-0.5, 0.5, modes).unwrap()]).unwrap()
}

/// With friction of a level, its state always between ±1/2.
fn dahl(space: &CellSpace, level: f64, alpha: f64) -> Generator {
    let values = [
        ("alpha", alpha),
        ("kappa", 0.1),
        ("mu", 1.0),
        ("lambda", 2.0 * level),
        ("f_c", level),
        ("sigma2", 0.2),
    ];
    let system = registry::find("dahl").unwrap().system_with(&values);
    assemble(&*system.unwrap(), space, &GeneratorOptions::default()).unwrap()
}

#[test]
fn masses_come_back_from_their_moments_wherever_the_modes_stand() {
    let cells = || Axis::uniform(0.0, 1.0, 3).unwrap();
    let modes = |count| Axis::modes(-0.3, 0.7, count).unwrap();
    for axes in [
        vec![cells(), modes(5)],
        vec![modes(128), cells()],
        vec![modes(4), cells(), modes(3)],
    ] {
        let space = CellSpace::new(axes).unwrap();
        let layout = Layout::new(&space, Grid::new(&[3], &[1], 5)).unwrap();
        let mass = |cell: usize| (1.3 * cell as f64).sin();
        let masses: Vec<f64> = (0..space.n_cells()).map(mass).collect();
        let moments = layout.moments(&masses, (0, masses[0]));
        assert!(distance(&layout.masses(&moments), &masses) < 1e-11 * masses.len() as f64);
        // The lowest moment of a place is what it holds.
        let held: f64 = moments.iter().step_by(layout.modes()).sum();
        assert!((held - masses.iter().sum::<f64>()).abs() < 1e-11);
    }
}

#[test]
fn all_modes_together_and_each_by_itself_have_the_same_steady_state() {
    for (cells, modes) in [([14, 12], 6), ([14, 12], 17)] {
        let space = space(cells, modes);
        let generator = dahl(&space, 0.1, 0.5);
        let whole = solve(&space, &generator, RateMethod::Lu);
        let each = solve(&space, &generator, RateMethod::Modewise);
        let error = distance(&whole.mass, &each.mass);
        assert!(error < 1e-9, "{modes}: {error:e}");
        // Friction is no small force here, half of the largest restoring one; still few iterations.
        assert!(each.info.iterations <= 40, "{:?}", each.info);
    }
}

#[test]
fn without_a_force_of_the_state_the_triangle_is_the_whole_generator() {
    let space = space([14, 12], 12);
    let iterations = [1e-9, 0.1].map(|level| {
        let generator = dahl(&space, level, 0.5);
        solve(&space, &generator, RateMethod::Modewise)
            .info
            .iterations
    });
    // Left is what single precision does to the lowest mode, whose deviations die out slowly.
    assert!(3 * iterations[0] < 2 * iterations[1], "{iterations:?}");
}

#[test]
fn half_of_the_cells_are_solved_mode_by_mode_too() {
    let space = space([24, 20], 16);
    let generator = dahl(&space, 0.1, -0.5);
    let matrix = &generator.matrix;
    let whole = solve(&space, &generator, RateMethod::LuSingle);
    let each = solve(&space, &generator, RateMethod::Modewise);
    let error = distance(&whole.mass, &each.mass);
    assert!(error < 1e-9, "{error:e}");
    let mut reversed = each.mass.clone();
    reversed.reverse();
    assert!(distance(&reversed, &each.mass) < 1e-12);
    // One rate that is not mirrored, and all cells are solved.
    let mut tilted = matrix.clone();
    let places = {
        let column = tilted.outer_view(5).unwrap();
        let mut entries = column.indices().iter();
        entries.position(|&row| row == 5).unwrap()
    };
    let start = tilted.indptr().raw_storage()[5];
    let other = if places == 0 { 1 } else { 0 };
    tilted.data_mut()[start + places] -= 1e-3;
    tilted.data_mut()[start + other] += 1e-3;
    let mut solver = solver(&space, RateMethod::Modewise, 1e-11);
    let steady = solver.solve(&tilted, &generator.escape, None).unwrap();
    let factors = [&each, &steady].map(|steady| steady.info.factor_bytes);
    assert!(
        steady.info.converged && 3 * factors[0] < 2 * factors[1],
        "{factors:?}"
    );
    assert!(distance(&steady.mass, &each.mass) < 1e-2);
}

#[test]
fn answers_to_changes_are_the_same_and_the_transposed_factors_their_adjoint() {
    let space = space([14, 12], 10);
    let generator = dahl(&space, 0.1, 0.5);
    let other = dahl(&space, 0.1, 0.5001);
    let change: CsMat<f64> = (&other.matrix - &generator.matrix).map(|rate| 1e4 * rate);
    let error = difference_of_answers(&space, &generator, &change);
    assert!(error < 1e-8, "{error:e}");
    for method in [RateMethod::Lu, RateMethod::LuSingle, RateMethod::Modewise] {
        assert_adjoint(&space, &generator, method);
    }
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let space = space([24, 20], 12);
    assert_same_bits(&space, &dahl(&space, 0.1, 0.5));
}

#[test]
fn many_modes_are_taken_one_by_one_and_few_together() {
    let method = |modes: usize| {
        let space = space([60, 48], modes);
        let limit = 8 << 30;
        estimate(&space, &[3, 3, modes - 1], limit, None)
            .unwrap()
            .method
    };
    assert_eq!(method(96), RateMethod::Modewise);
    assert_eq!(method(2), RateMethod::LuSingle);
}
