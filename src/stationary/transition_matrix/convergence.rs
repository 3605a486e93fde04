//! How far an iterate is from the solution. A residual does not tell: with a second eigenvalue of 0.998 the
//! error is hundreds of times larger. The contraction of successive changes does.

/// Changes below this are rounding to a noticeable part, and say nothing of the contraction.
const ROUNDING: f64 = 1e-11;

/// Contraction assumed while none could be observed, and the fastest that is believed: the first cycles remove
/// fast modes and say little of the slow ones.
const ASSUMED: f64 = 0.5;

/// L1 distance between two probability vectors at most.
const LARGEST_ERROR: f64 = 2.0;

/// Estimates the error from the L1 changes of successive iterates.
pub(super) struct Contraction {
    /// Iterations over which one factor is observed.
    window: usize,
    /// Changes of the latest iterations, oldest first, at most `window + 1`.
    changes: std::collections::VecDeque<f64>,
    /// The latest factors an iteration; the largest counts.
    factors: [f64; 3],
    /// A factor known otherwise, such as |λ₂|/λ₁.
    known: f64,
}

impl Contraction {
    /// Observes the contraction over `window` iterations.
    pub(super) fn new(window: usize) -> Self {
        Self {
            window,
            changes: std::collections::VecDeque::with_capacity(window + 2),
            factors: [0.0; 3],
            known: 0.0,
        }
    }

    /// The contraction an iteration cannot be faster than.
    pub(super) fn set_known(&mut self, factor: f64) {
        self.known = factor;
    }

    /// Takes the change of an iteration; returns the estimated L1 error of the new iterate.
    pub(super) fn observe(&mut self, change: f64) -> f64 {
        self.changes.push_back(change);
        if self.changes.len() > self.window + 1 {
            self.changes.pop_front();
        }
        if self.changes.len() > self.window && change > ROUNDING {
            let factor = (change / self.changes[0]).powf(1.0 / self.window as f64);
            self.factors = [self.factors[1], self.factors[2], factor];
        }
        self.estimate(change)
    }

    /// The remaining changes as a geometric series.
    pub(super) fn estimate(&self, change: f64) -> f64 {
        let observed = self.factors.iter().copied().fold(ASSUMED, f64::max);
        let factor = observed.max(self.known);
        if change == 0.0 {
            0.0
        } else if factor < 1.0 {
            (change * factor / (1.0 - factor)).min(LARGEST_ERROR)
        } else {
            LARGEST_ERROR
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_geometric_error_is_estimated_exactly() {
        let mut contraction = Contraction::new(4);
        for iteration in 0..12 {
            // Errors 0.9^k: the change from k to k + 1 is 0.1 · 0.9^k, the error after it 0.9^(k+1).
            let estimate = contraction.observe(0.1 * 0.9_f64.powi(iteration));
            if iteration >= 4 {
                assert!((estimate / 0.9_f64.powi(iteration + 1) - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn oscillation_is_never_taken_for_convergence() {
        let mut contraction = Contraction::new(2);
        let last = (0..100).map(|_| contraction.observe(1e-6)).last();
        assert_eq!(last, Some(LARGEST_ERROR));
    }
}
