//! Generators on the cells outside of a region: what leaves a cell, and sums up to the border.

use super::*;
use crate::space::{Axis, CellSpace};
use crate::system::{regions, registry};

#[test]
fn what_leaves_a_cell_is_elsewhere_or_has_ended_and_cells_inside_are_on_their_own() {
    let model = registry::find("coulomb").unwrap();
    let values = [("kappa", 0.1), ("sigma2", 0.2), ("f_c", 0.1)];
    let system = model.system_with(&values).unwrap();
    let values = model.values(&values).unwrap();
    let axis = |count| Axis::uniform(-2.0, 2.0, count).unwrap();
    let space = CellSpace::new(vec![axis(20), axis(14)]).unwrap();
    for until in [
        "x > 1.13",
        "x^2 + y^2 > 2",
        "abs(x) < 0.33",
        "x + y > 0.713 or y < -1.21",
    ] {
        let region = regions(&model, &[("until", until)]).unwrap().remove(0);
        let level = region.level().bind(&values).unwrap();
        let options = GeneratorOptions::default();
        for dissipation in [Dissipation::Full, Dissipation::Half] {
            let found = assemble_absorbing(
                &*system,
                &space,
                &level,
                &options,
                (dissipation, Closure::Fourth),
            );
            let found = found.unwrap();
            for (cell, column) in found.matrix().outer_iterator().enumerate() {
                let state = space.centre(cell);
                assert_eq!(found.kept[cell], level.at(&state) >= 0.0);
                if !found.kept[cell] {
                    assert_eq!(column.indices(), [cell]);
                    assert_eq!((found.ends[cell], found.weights[0][cell]), (0.0, 0.0));
                    continue;
                }
                let sum: f64 = column.data().iter().sum();
                let size: f64 = column.data().iter().map(|rate| rate.abs()).sum();
                assert!((sum + found.ends[cell]).abs() < 1e-13 * size, "{until}");
                assert!(column.indices().iter().all(|&row| found.kept[row]));
            }
            let mut parts = vec![0.0; found.ends.len()];
            for ending in &found.endings {
                assert_eq!(found.kept[ending.cell], ending.end.is_some());
                assert!(found.kept[ending.source]);
                parts[ending.source] += ending.rate;
            }
            for (sum, whole) in parts.iter().zip(&found.ends) {
                assert!((sum - whole).abs() < 1e-12 * whole.abs().max(1.0));
            }
            assert!(found.ends.iter().sum::<f64>() > 0.0);
        }
    }
}

#[test]
fn sums_end_at_a_border_that_lies_between_nodes() {
    // ∫ (1.03² - x² - y²) over a disc is π R⁴/2; the density is zero at its border.
    let model = registry::find("coulomb").unwrap();
    let values = [("kappa", 0.1), ("sigma2", 0.2), ("f_c", 0.1)];
    let system = model.system_with(&values).unwrap();
    let values = model.values(&values).unwrap();
    let region = regions(&model, &[("until", "x^2 + y^2 > 1.03^2")])
        .unwrap()
        .remove(0);
    let level = region.level().bind(&values).unwrap();
    let exact = 0.5 * std::f64::consts::PI * 1.03_f64.powi(4);
    for (count, largest) in [(20, 2e-3), (40, 4e-4), (80, 1e-4)] {
        let axis = Axis::uniform(-1.5, 1.5, count).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
        let options = GeneratorOptions::default();
        let found = assemble_absorbing(
            &*system,
            &space,
            &level,
            &options,
            (Dissipation::Full, Closure::Fourth),
        );
        for weights in found.unwrap().weights {
            let cells = weights
                .iter()
                .enumerate()
                .filter(|(_, weight)| **weight != 0.0);
            let terms = cells.map(|(cell, weight)| weight * level.at(&space.centre(cell)));
            let sum: f64 = terms.sum::<f64>() * space.volume(0);
            assert!(
                (sum / exact - 1.0).abs() < largest,
                "{count}: {}",
                sum / exact - 1.0
            );
        }
    }
}
