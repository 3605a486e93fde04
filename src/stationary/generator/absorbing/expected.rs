//! What is expected of the way from each cell to the end of a process.

use super::super::balance::dot;

/// What a process is expected to gather on its way from each cell to its end.
pub(crate) struct Expected {
    /// From the held cell; zero where none is.
    pub(super) at_held: f64,
    /// From each cell, less than from the held one: known to more digits than the difference.
    pub(super) beside: Vec<f64>,
}

impl Expected {
    /// From each cell.
    pub(crate) fn values(&self) -> Vec<f64> {
        let values = self.beside.iter().map(|value| value + self.at_held);
        values.collect()
    }

    /// From each cell, less than from the held one.
    pub(crate) fn beside(&self) -> &[f64] {
        &self.beside
    }

    /// w·Q z of pairs w and z, for a generator that is given by its rates (row, column, rate), any number of them for a
    /// place, and the rates of its ends.
    pub(crate) fn through<const N: usize>(
        pairs: [(&Self, &[f64]); N],
        rates: &[(usize, usize, f64)],
        ends: &[f64],
    ) -> [f64; N] {
        // Columns sum to minus the ends, so that the held cell's value meets what ends alone.
        let mut within = [0.0; N];
        for &(row, column, rate) in rates {
            for (sum, (expected, times)) in within.iter_mut().zip(&pairs) {
                *sum += expected.beside[row] * rate * times[column];
            }
        }
        for (sum, (expected, times)) in within.iter_mut().zip(&pairs) {
            *sum -= expected.at_held * dot(ends, times);
        }
        within
    }

    /// g + Qᵀ f for another generator and its gain: what its own equation for what is expected is short of.
    pub(crate) fn left_by(
        &self,
        rates: &[(usize, usize, f64)],
        ends: &[f64],
        gain: &[f64],
    ) -> Vec<f64> {
        let pairs = gain.iter().zip(ends);
        let mut left: Vec<f64> = pairs.map(|(gain, end)| gain - self.at_held * end).collect();
        for &(row, column, rate) in rates {
            left[column] += rate * self.beside[row];
        }
        left
    }

    /// The sum of what is expected over a start.
    pub(crate) fn over(&self, start: &[f64]) -> f64 {
        dot(&self.beside, start) + self.at_held * start.iter().sum::<f64>()
    }

    /// What two starts, each with Σ = 1, differ by.
    pub(crate) fn difference(&self, one: &[f64], other: &[f64]) -> f64 {
        dot(&self.beside, one) - dot(&self.beside, other)
    }
}
