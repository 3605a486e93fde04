//! An eigenvalue of a grid, with its vectors.

use nalgebra::Complex;

/// An eigenvalue on one grid.
#[derive(Clone)]
pub(super) struct GridMode {
    /// By the scheme.
    pub(super) value: Complex<f64>,
    /// What half of the dissipation changes.
    pub(super) change: Complex<f64>,
    /// Whether it stands: of others it is known that they are there.
    pub(super) stands: bool,
    /// What fewer vectors change, and at most what the ends of the range do.
    pub(super) error: f64,
    /// Its vectors of either side, the left one known but for a constant, both but for a factor.
    pub(super) columns: Vec<Complex<f64>>,
    pub(super) rows: Vec<Complex<f64>>,
}

impl GridMode {
    /// Extrapolated to no dissipation.
    pub(super) fn extrapolation(&self) -> Complex<f64> {
        self.value + self.change * 2.0
    }

    /// The decay rate that it is likely to have on finer cells. Modes that oscillate and live on few cells decay too
    /// slowly there, and the extrapolation says so; of two real ones that are about to become a pair it says nothing.
    pub(super) fn likely_decay(&self) -> f64 {
        let decay = -self.value.re;
        if self.value.im == 0.0 {
            decay
        } else {
            decay.max(-self.extrapolation().re)
        }
    }

    /// The left vector; empty where the mode oscillates.
    pub(super) fn left(&self) -> Vec<f64> {
        if self.value.im == 0.0 {
            real(&self.rows)
        } else {
            Vec::new()
        }
    }
}

/// The real parts of a vector that is real but for a complex factor.
fn real(vector: &[Complex<f64>]) -> Vec<f64> {
    let largest = vector.iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let Some(turn) = largest.map(|one| one.conj() / one.norm().max(f64::MIN_POSITIVE)) else {
        return Vec::new();
    };
    vector.iter().map(|one| (one * turn).re).collect()
}
