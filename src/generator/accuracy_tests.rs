//! Accuracy of the generator's steady states against exact densities.

use std::sync::Arc;

use super::banded_tests::null_vector;
use super::{AdvectiveScheme, GeneratorOptions, assemble, automatic_grading, cell_masses};
use crate::space::{Axis, CellSpace, Grading};
use crate::system::{Lanes, Noise, System, TypedModel, registry};

fn bound(model: &str, given: &[(&str, f64)]) -> Arc<dyn System> {
    registry::find(model).unwrap().system_with(given).unwrap()
}

fn coulomb(f_c: f64) -> Arc<dyn System> {
    let values = [
        ("mu", 0.01),
        ("kappa", 0.01),
        ("f_c", f_c),
        ("sigma2", 0.01),
    ];
    bound("coulomb", &values)
}

fn square(half: f64, count: usize) -> CellSpace {
    CellSpace::new(vec![Axis::uniform(-half, half, count).unwrap(); 2]).unwrap()
}

/// 50 cells on x, 100 on y graded toward the surface as the automatic grading says.
fn graded(system: &dyn System, half: f64) -> CellSpace {
    let grading = automatic_grading(system, &[(-half, half); 2], 1, 100).unwrap();
    let x = Axis::uniform(-half, half, 50).unwrap();
    let y = Axis::graded(-half, half, 100, &grading).unwrap();
    CellSpace::new(vec![x, y]).unwrap()
}

fn steady_masses(system: &dyn System, space: &CellSpace, scheme: AdvectiveScheme) -> Vec<f64> {
    let generator = assemble(system, space, &GeneratorOptions { scheme }).unwrap();
    let centre = space.find(&vec![1e-9; space.dimension()]).unwrap();
    cell_masses(system, space, &null_vector(&generator.matrix, centre))
}

/// Integrals of the exact density over the cells, three Gauss points an axis, Σ = 1.
fn exact_masses(system: &dyn System, space: &CellSpace) -> Vec<f64> {
    let offset = 0.5 * 0.6_f64.sqrt();
    let gauss = [
        (-offset, 5.0 / 18.0),
        (0.0, 8.0 / 18.0),
        (offset, 5.0 / 18.0),
    ];
    let points = 3_usize.pow(u32::try_from(space.dimension()).unwrap());
    let mass = |cell: usize| -> f64 {
        let value = |point: usize| {
            let (mut state, mut weight, mut rest) = (space.centre(cell), space.volume(cell), point);
            for (index, coordinate) in state.iter_mut().enumerate() {
                let (place, share) = gauss[rest % 3];
                rest /= 3;
                *coordinate += place * space.axes()[index].width(space.position(cell, index));
                weight *= share;
            }
            weight * system.exact_log_density(&state).unwrap().exp()
        };
        (0..points).map(value).sum()
    };
    let masses: Vec<f64> = (0..space.n_cells()).map(mass).collect();
    let total: f64 = masses.iter().sum();
    masses.iter().map(|mass| mass / total).collect()
}

fn total_variation(a: &[f64], b: &[f64]) -> f64 {
    0.5 * a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>()
}

fn error(system: &dyn System, space: &CellSpace, scheme: AdvectiveScheme) -> f64 {
    total_variation(
        &steady_masses(system, space, scheme),
        &exact_masses(system, space),
    )
}

fn negative_mass(masses: &[f64]) -> f64 {
    masses.iter().map(|mass| (-mass).max(0.0)).sum()
}

/// p'(0+)/p(0) of the y marginal over -2 f_c/σ²: from the cubic whose integrals are the masses of the four cells above
/// 0.
fn slope_law_ratio(space: &CellSpace, masses: &[f64], f_c: f64) -> f64 {
    let axis = &space.axes()[1];
    let mut marginal = vec![0.0; axis.count()];
    for (cell, mass) in masses.iter().enumerate() {
        marginal[space.position(cell, 1)] += mass;
    }
    let first = axis.count() / 2;
    let matrix = nalgebra::Matrix4::from_fn(|row, power| {
        let edge = |offset: usize| axis.edges()[first + offset] / axis.width(first);
        let power = i32::try_from(power + 1).unwrap();
        edge(row + 1).powi(power) - edge(row).powi(power)
    });
    let right = nalgebra::Vector4::from_fn(|row, _| marginal[first + row]);
    let integral = matrix.lu().solve(&right).unwrap();
    2.0 * integral[1] / integral[0] / axis.width(first) / (-2.0 * f_c / 0.01)
}

#[test]
fn without_friction_the_density_is_exact_to_the_targets_at_50_cells() {
    let (system, space) = (coulomb(0.0), square(3.6, 50));
    let default = error(&*system, &space, AdvectiveScheme::default());
    let central = error(&*system, &space, AdvectiveScheme::Central6);
    assert!(default < 1e-3, "{default:e}");
    assert!(central < 1e-4, "{central:e}");
}

#[test]
fn without_friction_the_density_is_exact_to_the_targets_at_100_cells() {
    let system = coulomb(0.0);
    let default = error(&*system, &square(3.8, 100), AdvectiveScheme::default());
    let central = error(&*system, &square(4.0, 100), AdvectiveScheme::Central6);
    assert!(default < 5e-5, "{default:e}");
    assert!(central < 1e-5, "{central:e}");
}

#[test]
fn every_scheme_is_of_fourth_order_or_better() {
    let system = coulomb(0.0);
    for scheme in AdvectiveScheme::ALL {
        let coarse = error(&*system, &square(4.6, 40), scheme);
        let fine = error(&*system, &square(4.6, 80), scheme);
        let order = (coarse / fine).log2();
        assert!(
            order > 3.9,
            "{}: {coarse:e} {fine:e}, order {order}",
            scheme.name()
        );
    }
}

#[test]
fn graded_cells_are_of_fourth_order_too() {
    // Energy-dependent damping bends along y, on which cells beside y = 0.3 are a third of those of even width.
    let system = bound("rayleigh", &[("a", -0.2), ("b", 0.2), ("sigma2", 0.2)]);
    let on = |count: usize| {
        let (half, grading) = (
            4.2,
            Grading {
                at: vec![0.3],
                smallest: 2.8 / count as f64,
            },
        );
        let x = Axis::uniform(-half, half, count).unwrap();
        let y = Axis::graded(-half, half, count, &grading).unwrap();
        let space = CellSpace::new(vec![x, y]).unwrap();
        error(&*system, &space, AdvectiveScheme::default())
    };
    let (coarse, fine) = (on(60), on(120));
    let order = (coarse / fine).log2();
    assert!(order > 3.5, "{coarse:e} {fine:e}, order {order}");
}

#[test]
fn the_slope_law_holds_at_the_switching_surface() {
    for (f_c, half) in [(0.01, 3.0), (0.001, 3.6), (-0.01, 4.2), (-0.001, 3.8)] {
        let system = coulomb(f_c);
        let space = graded(&*system, half);
        let masses = steady_masses(&*system, &space, AdvectiveScheme::default());
        let ratio = slope_law_ratio(&space, &masses, f_c);
        assert!((ratio - 1.0).abs() < 0.02, "f_c = {f_c}: {ratio}");
        assert!(
            negative_mass(&masses) < 1e-5,
            "{:e}",
            negative_mass(&masses)
        );
    }
}

#[test]
fn energy_dependent_damping_is_exact_on_both_sides_of_its_bifurcation() {
    for a in [-0.2, 0.2] {
        let system = bound("rayleigh", &[("a", a), ("b", 0.2), ("sigma2", 0.2)]);
        let space = square(3.4, 100);
        let error = error(&*system, &space, AdvectiveScheme::default());
        assert!(error < 1e-4, "a = {a}: {error:e}");
    }
}

#[test]
fn one_dimension_is_exact_on_both_sides_of_the_bifurcation() {
    for a in [-0.5, 0.0, 1.0] {
        let system = bound("bistable", &[("a", a), ("sigma2", 0.1)]);
        let axis = Axis::uniform(-2.0, 2.0, 100).unwrap();
        let space = CellSpace::new(vec![axis]).unwrap();
        let error = error(&*system, &space, AdvectiveScheme::default());
        assert!(error < 1e-4, "a = {a}: {error:e}");
    }
}

/// dx = -x dt + 0.5 √(1 + x²) dW: p ∝ (1 + x²)^(-1 - 4).
struct Multiplicative([Noise; 1]);

impl System for Multiplicative {
    fn dimension(&self) -> usize {
        1
    }
    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        drift[0] = states[0].map(|x| -x);
    }
    fn noises(&self) -> &[Noise] {
        &self.0
    }
    fn exact_log_density(&self, state: &[f64]) -> Option<f64> {
        Some(-5.0 * (1.0 + state[0] * state[0]).ln())
    }
}

#[test]
fn noise_that_depends_on_the_state_is_exact() {
    // The linear drift is advected, with the order of the scheme; quadrature, which such systems get, is not asked
    // here.
    let axis = Axis::uniform(-8.0, 8.0, 400).unwrap();
    let space = CellSpace::new(vec![axis]).unwrap();
    let amplitude = |_, states: &[Lanes], amplitude: &mut Lanes| {
        *amplitude = states[0].map(|x| 0.5 * (1.0 + x * x).sqrt());
    };
    let system = Multiplicative([Noise::of_state(0, amplitude)]);
    for scheme in AdvectiveScheme::ALL {
        let error = error(&system, &space, scheme);
        assert!(error < 1e-5, "{}: {error:e}", scheme.name());
    }
}

/// Along z the density piles up at the walls faster than any grid resolves, so a scheme that is not of first
/// order dips below zero there; the dips shrink with the cells.
#[test]
fn a_hysteretic_oscillator_keeps_its_mass_within_the_walls() {
    let values = [
        ("alpha", 0.5),
        ("kappa", 0.1),
        ("mu", 1.0),
        ("lambda", 0.2),
        ("f_c", 0.1),
        ("sigma2", 0.2),
    ];
    let system = bound("dahl", &values);
    let axis = |half: f64, count: usize| Axis::uniform(-half, half, count).unwrap();
    let negative = [8, 16].map(|cells| {
        let space = CellSpace::new(vec![axis(2.4, 20), axis(2.8, 20), axis(0.5, cells)]).unwrap();
        let generator = assemble(&*system, &space, &GeneratorOptions::default()).unwrap();
        for (cell, &escape) in generator.escape.iter().enumerate() {
            let at_edge =
                |axis: usize, count: usize| [0, count - 1].contains(&space.position(cell, axis));
            let open = at_edge(0, 20) || at_edge(1, 20);
            assert!(open || escape == 0.0, "cell {cell} loses {escape}");
        }
        negative_mass(&steady_masses(&*system, &space, AdvectiveScheme::default()))
    });
    assert!(
        negative[0] < 0.02 && negative[1] < 0.8 * negative[0],
        "{negative:?}"
    );
}

/// y' = -κ y + f(x) + √s ξ with a force that bends at c: the density is exp(-2κ/s (y²/2 + V(x))).
const BENT: (f64, f64, f64) = (0.8, 0.6, 0.177);

/// By how much the slope of log p at the bend is off, on the line of cells above y = 0: the larger one of the slopes
/// there of the parabolas through the errors of three cells on either side.
fn slope_error_at_bend(count: usize) -> f64 {
    let (kappa, s, c) = BENT;
    let model = TypedModel::new("bent", "A force that bends", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", format!("-{kappa} y - x^3 + 1.5 abs(x - {c})"))
        .with_noise("y", [format!("sqrt({s})")])
        .build()
        .unwrap();
    let system = model.system_with(&[]).unwrap();
    let x = Axis::uniform(-2.7, 2.9, count).unwrap().with_faces_on(&[c]);
    let space = CellSpace::new(vec![x, Axis::uniform(-4.0, 4.0, count).unwrap()]).unwrap();
    let masses = steady_masses(&*system, &space, AdvectiveScheme::default());
    let potential = |x: f64| 0.25 * x.powi(4) - 0.75 * (x - c) * (x - c).abs();
    let axis = &space.axes()[0];
    let above = axis.face_at(c).unwrap();
    let off = |cell: usize| {
        let (from, width) = (axis.edges()[cell], axis.width(cell));
        let value = |x: f64| (-2.0 * kappa / s * potential(x)).exp();
        let places = (0..64).map(|place| from + width * (f64::from(place) + 0.5) / 64.0);
        let exact = places.map(value).sum::<f64>() * width / 64.0;
        (masses[cell * count + count / 2] / exact).ln()
    };
    let slope = |cells: [usize; 3]| {
        let [near, middle, far] = cells.map(off);
        (2.0 * near - 3.0 * middle + far) / axis.width(cells[0])
    };
    let below = slope([above - 1, above - 2, above - 3]);
    below.abs().max(slope([above, above + 1, above + 2]).abs())
}

/// Stencils across the bend make it an error of order one, of at least 2e-2 on 90 cells.
#[test]
fn the_slope_where_a_force_bends_is_of_order_two() {
    let [coarse, fine] = [60, 90].map(slope_error_at_bend);
    let order = (coarse / fine).ln() / 1.5_f64.ln();
    assert!(order > 1.8 && fine < 7e-3, "{coarse:e} {fine:e}: {order}");
}
