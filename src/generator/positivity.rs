//! Negative masses filled from their own grid line.
//!
//! Along an axis without noise the density can be thinner than a cell: given (x, y), Dahl's z lies within a few
//! hundredths of a value that the last reversal set. Linear schemes of order above one answer with wiggles about
//! zero (Godunov 1959), one of order one with a spread that spoils the moments. The wiggles cancel in every
//! density that does not keep that axis. So the solution stays linear, and its wiggles are taken out afterwards, line by
//! line, with the line's mass, mean and mean square kept: nothing that does not keep the axis changes at all.

use nalgebra::{Matrix3, Vector3};

use crate::space::CellSpace;
use crate::system::System;

/// Corrections tried for a line before a moment is given up.
const ATTEMPTS: usize = 60;
/// Mismatch of the moments, relative to the line's mass, that counts as none.
const MATCHED: f64 = 1e-12;

/// What a repair did. Masses are relative to Σ = 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repair {
    /// Σ |min(mass, 0)| before.
    pub negative_before: f64,
    /// The same after: lines whose whole mass is negative stay as they are.
    pub negative_after: f64,
    /// Half the L1 norm of the change.
    pub moved: f64,
}

/// Replaces the masses of every grid line along the axes that have walls and no noise by non-negative ones with the
/// same sum, mean and mean square (of the cells' middles; fewer of them where no such masses exist). `masses` has
/// length `n_cells`; the marginals and joint densities of all other axes are unchanged to rounding.
pub fn repair_negative(system: &dyn System, space: &CellSpace, masses: &mut [f64]) -> Repair {
    let negative = |masses: &[f64]| masses.iter().map(|mass| (-mass).max(0.0)).sum::<f64>();
    let before = masses.to_vec();
    let shape = space.shape();
    for (index, axis) in space.axes().iter().enumerate() {
        if system.noise_axes().contains(&index) || system.bounds(index).is_none() {
            continue;
        }
        let stride: usize = shape[index + 1..].iter().product();
        let (middle, half) = (
            0.5 * (axis.from() + axis.to()),
            0.5 * (axis.to() - axis.from()),
        );
        let places: Vec<f64> = axis.centres().iter().map(|x| (x - middle) / half).collect();
        let mut line = vec![0.0; places.len()];
        for first in (0..masses.len()).filter(|&cell| space.position(cell, index) == 0) {
            for (position, value) in line.iter_mut().enumerate() {
                *value = masses[first + position * stride];
            }
            repair_line(&places, &mut line);
            for (position, value) in line.iter().enumerate() {
                masses[first + position * stride] = *value;
            }
        }
    }
    let change = before.iter().zip(&*masses).map(|(a, b)| (a - b).abs());
    Repair {
        negative_before: negative(&before),
        negative_after: negative(masses),
        moved: 0.5 * change.sum::<f64>(),
    }
}

/// Repairs a line in place: three moments if they can be kept, else two, else its mass.
fn repair_line(places: &[f64], line: &mut [f64]) {
    let total: f64 = line.iter().sum();
    if line.iter().all(|mass| *mass >= 0.0) || total <= 0.0 {
        return;
    }
    let wanted = moments(places, line);
    for kept in [3, 2, 1] {
        if let Some(repaired) = with_moments(places, line, &wanted, kept) {
            line.copy_from_slice(&repaired);
            return;
        }
    }
}

/// Σ m, Σ m x, Σ m x².
fn moments(places: &[f64], masses: &[f64]) -> Vector3<f64> {
    let terms = places.iter().zip(masses);
    terms.fold(Vector3::zeros(), |sum, (x, m)| {
        sum + Vector3::new(*m, m * x, m * x * x)
    })
}

/// The positive part of a line times a polynomial that restores its first moments, clipped until it needs no clipping.
fn with_moments(
    places: &[f64],
    line: &[f64],
    wanted: &Vector3<f64>,
    kept: usize,
) -> Option<Vec<f64>> {
    let mut masses: Vec<f64> = line.iter().map(|mass| mass.max(0.0)).collect();
    for _ in 0..ATTEMPTS {
        let missing = wanted - moments(places, &masses);
        if missing.rows(0, kept).amax() <= MATCHED * wanted[0] {
            return Some(masses);
        }
        let mut products = Matrix3::identity();
        let mut right = Vector3::zeros();
        for row in 0..kept {
            right[row] = missing[row];
            for column in 0..kept {
                let power = i32::try_from(row + column).ok()?;
                let terms = places.iter().zip(&masses);
                products[(row, column)] = terms.map(|(x, m)| m * x.powi(power)).sum();
            }
        }
        let change = products.lu().solve(&right)?;
        for (mass, x) in masses.iter_mut().zip(places) {
            let factor = 1.0 + change[0] + x * (change[1] + x * change[2]);
            *mass *= factor.max(0.0);
        }
        if !masses.iter().all(|mass| mass.is_finite()) {
            return None;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::registry;

    #[test]
    fn a_line_with_wiggles_keeps_its_moments_and_loses_its_negatives() {
        let places: Vec<f64> = (0..10).map(|cell| -0.9 + 0.2 * f64::from(cell)).collect();
        let mut line = [0.0, 0.001, -0.004, 0.01, -0.05, 0.3, 0.6, 0.2, -0.03, 0.01];
        let wanted = moments(&places, &line);
        repair_line(&places, &mut line);
        assert!(line.iter().all(|mass| *mass >= 0.0), "{line:?}");
        assert!(
            (moments(&places, &line) - wanted).amax() < 1e-12,
            "{line:?}"
        );
    }

    #[test]
    fn what_cannot_be_kept_is_given_up_in_order() {
        // A mean square below what any masses on these cells have: mass and mean are kept.
        let places = [-0.5, 0.0, 0.5];
        let mut line = [-0.1, 1.2, -0.1];
        repair_line(&places, &mut line);
        assert!(
            (line[1] - 1.0).abs() < 1e-12 && line[0] == 0.0 && line[2] == 0.0,
            "{line:?}"
        );
        // A mean outside the line: only the mass.
        let mut line = [-1.0, 0.5, 1.0];
        repair_line(&places, &mut line);
        assert!((line.iter().sum::<f64>() - 0.5).abs() < 1e-12, "{line:?}");
        assert!(line.iter().all(|mass| *mass >= 0.0));
        let mut lost = [-1.0, 0.5, 0.1];
        repair_line(&places, &mut lost);
        assert_eq!(lost, [-1.0, 0.5, 0.1]);
    }

    #[test]
    fn only_lines_between_walls_are_touched() {
        let values = [
            ("kappa", 0.1),
            ("lambda", 0.2),
            ("f_c", 0.1),
            ("sigma2", 0.2),
        ];
        let dahl = registry::find("dahl")
            .unwrap()
            .system_with(&values)
            .unwrap();
        let axes = [(2.0, 3), (2.0, 4), (0.5, 5)];
        let axes = axes.map(|(half, count)| Axis::uniform(-half, half, count).unwrap());
        let space = CellSpace::new(axes.to_vec()).unwrap();
        let mut masses: Vec<f64> = (0..60).map(|cell| f64::from(cell * 7 % 11) - 1.5).collect();
        let before = masses.clone();
        let repair = repair_negative(&*dahl, &space, &mut masses);
        assert!(
            repair.negative_before > 0.0 && repair.negative_after == 0.0,
            "{repair:?}"
        );
        assert!(repair.moved >= repair.negative_before);
        for (old, new) in before.chunks(5).zip(masses.chunks(5)) {
            let sums = [old, new].map(|line| line.iter().sum::<f64>());
            assert!((sums[0] - sums[1]).abs() < 1e-10);
        }
        let values = [("kappa", 0.01), ("f_c", 0.01), ("sigma2", 0.01)];
        let coulomb = registry::find("coulomb")
            .unwrap()
            .system_with(&values)
            .unwrap();
        let axis = Axis::uniform(-1.0, 1.0, 2).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
        let mut masses = [0.5, -0.5, 0.5, 0.5];
        assert_eq!(repair_negative(&*coulomb, &space, &mut masses).moved, 0.0);
    }
}
