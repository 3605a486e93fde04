//! Which cell is held at a fixed mass.

use sprs::CsMat;

use super::DirectSolver;

/// If the held cell carries less than this share of the largest mass, another one is held in new factors, and new ones
/// are made if a solve fails.
pub(super) const WEAK_HELD_SHARE: f64 = 1e-2;
/// The held cell must carry at least this share of the largest mass, or another one is held.
const LEAST_HELD_SHARE: f64 = 1e-8;

impl DirectSolver {
    /// The cell to hold: the one that is held, if it carries mass; the most probable one of the guess; without
    /// a guess the one that is left most slowly, which is near a point of rest.
    pub(super) fn choose_held(&self, matrix: &CsMat<f64>, mass: &[f64]) -> usize {
        if mass.is_empty() {
            let rate = |cell: usize| matrix.get(cell, cell).map_or(0.0, |rate| rate.abs());
            let cells = 0..matrix.cols();
            let slowest = cells.min_by(|&a, &b| rate(a).total_cmp(&rate(b)));
            return slowest.unwrap_or(0);
        }
        let (best, largest) = largest(mass);
        let kept = self.preconditioner.as_ref().map(|kept| kept.held);
        // Between wiggles, and at the nodes of a series, a cell's mass may be below zero: its size is what holds.
        kept.filter(|&held| mass[held].abs() >= LEAST_HELD_SHARE * largest)
            .unwrap_or(best)
    }

    /// The cell to hold in new factors: the old one unless it carries little mass, which would be lost in the next
    /// points.
    pub(super) fn cell_to_hold(&self, held: usize, mass: &[f64]) -> usize {
        if mass.is_empty() {
            return held;
        }
        let (best, largest) = largest(mass);
        if mass[held].abs() < WEAK_HELD_SHARE * largest {
            best
        } else {
            held
        }
    }
}

/// The cell with the largest mass, and that mass.
pub(in crate::stationary::generator) fn largest(mass: &[f64]) -> (usize, f64) {
    let cells = mass.iter().copied().enumerate();
    cells.fold((0, f64::NEG_INFINITY), |best, cell| {
        if cell.1 > best.1 { cell } else { best }
    })
}
