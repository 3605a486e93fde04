//! How fast a generator forgets its start: the slowest decay rate beside the steady state, by inverse iteration with
//! the factorisation of the steady state.

use sprs::CsMat;

use crate::stationary::rates::RateSolver;

/// Inverse iterations; the last half of them counts.
const ITERATIONS: usize = 16;

/// Relative error of each of them.
const ROUGH: f64 = 1e-2;

/// Time in which deviations from the steady state shrink by e, from x ← Q⁻¹ x on vectors of sum zero: the mean growth
/// over the last iterations is 1/|λ₂|. Rough (a few per cent, more for oscillating modes), which is enough to compare
/// with the time in which mass escapes. `None` when a solve fails.
pub(super) fn relaxation_time(solver: &mut RateSolver, mass: &[f64]) -> Option<f64> {
    let cells = mass.len();
    let heaviest = (0..cells).max_by(|&a, &b| mass[a].total_cmp(&mass[b]))?;
    // A start that excites every mode: mass times an uneven, deterministic weight, made to sum to zero.
    let uneven =
        |cell: usize| ((cell as f64 * 0.754_877_666).fract() - 0.5) + cell as f64 / cells as f64;
    let mut vector: Vec<f64> = (0..cells).map(|cell| mass[cell] * uneven(cell)).collect();
    let excess: f64 = vector.iter().sum();
    vector
        .iter_mut()
        .zip(mass)
        .for_each(|(value, mass)| *value -= excess * mass);
    let mut growth = 0.0;
    for iteration in 0..ITERATIONS {
        let size: f64 = vector.iter().map(|value| value.abs()).sum();
        if size == 0.0 || !size.is_finite() {
            return None;
        }
        vector.iter_mut().for_each(|value| *value /= size);
        let next = solver
            .sensitivity_within(
                &as_derivative(&vector, heaviest, mass[heaviest])?,
                mass,
                ROUGH,
            )
            .ok()?;
        let grown: f64 = next.iter().map(|value| value.abs()).sum();
        if 2 * iteration >= ITERATIONS {
            growth += grown.ln();
        }
        vector = next;
    }
    let time = (growth / (ITERATIONS / 2) as f64).exp();
    (time > 0.0 && time.is_finite()).then_some(time)
}

/// A matrix whose product with the mass is the vector: all of it in the column of the heaviest cell.
fn as_derivative(vector: &[f64], column: usize, mass: f64) -> Option<CsMat<f64>> {
    let cells = vector.len();
    let mut starts = vec![0; cells + 1];
    starts[column + 1..].fill(cells);
    let rows: Vec<usize> = (0..cells).collect();
    let values: Vec<f64> = vector.iter().map(|value| value / mass).collect();
    CsMat::try_new_csc((cells, cells), starts, rows, values).ok()
}
