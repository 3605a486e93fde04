//! How far angles turn: whole turns of every trajectory, and what its advances over windows of one length say of mean
//! velocity and effective diffusion.
//!
//! With d and d' the advances over two neighbouring windows of length w, the mean velocity is V = ⟨d⟩/w. The variance
//! of the advance over two windows less that over one is 2 D w, up to what is left of a correlation after a whole
//! window between: D = (var d + 2 cov(d, d'))/(2 w).

use crate::numerics::jackknife;

/// How an angle turns in the steady state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Axis of the angle.
    pub axis: usize,
    /// Mean velocity, in units of the axis per unit of time, with its standard error.
    pub velocity: (f64, f64),
    /// Effective diffusion: half the rate at which the variance of the angle grows whose turns are counted; with its
    /// standard error.
    pub diffusion: (f64, f64),
}

/// Sums over advances of one angle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Advances {
    count: f64,
    sum: f64,
    squares: f64,
    /// Over pairs of neighbouring windows: their number, Σ (d + d')/2, Σ d d'.
    pairs: f64,
    halves: f64,
    products: f64,
}

impl Advances {
    pub(super) fn add(&mut self, advance: f64, before: Option<f64>) {
        self.count += 1.0;
        self.sum += advance;
        self.squares += advance * advance;
        if let Some(before) = before {
            self.pairs += 1.0;
            self.halves += 0.5 * (advance + before);
            self.products += advance * before;
        }
    }

    /// These and others, or these without others.
    fn joined(&self, other: &Self, sign: f64) -> Self {
        Self {
            count: self.count + sign * other.count,
            sum: self.sum + sign * other.sum,
            squares: self.squares + sign * other.squares,
            pairs: self.pairs + sign * other.pairs,
            halves: self.halves + sign * other.halves,
            products: self.products + sign * other.products,
        }
    }

    /// Velocity and diffusion by windows of this length; `None` without a pair.
    fn judge(&self, window: f64) -> Option<[f64; 2]> {
        if self.pairs < 1.0 {
            return None;
        }
        let mean = self.sum / self.count;
        let variance = self.squares / self.count - mean * mean;
        let covariance =
            self.products / self.pairs - 2.0 * mean * self.halves / self.pairs + mean * mean;
        let diffusion = (variance + 2.0 * covariance) / (2.0 * window);
        Some([mean / window, diffusion])
    }
}

/// How an angle turns, by what each block of a run saw of it; `None` where fewer than two of them saw enough.
pub(super) fn rotation(blocks: &[Advances], axis: usize, window: f64) -> Option<Rotation> {
    let nothing = Advances::default();
    let all = blocks.iter().fold(nothing, |all, one| all.joined(one, 1.0));
    let [velocity, diffusion] = all.judge(window)?;
    let seen = blocks.iter().filter(|one| one.count > 0.0);
    let without = seen.filter_map(|one| all.joined(one, -1.0).judge(window));
    let without: Vec<[f64; 2]> = without.collect();
    if without.len() < 2 {
        return None;
    }
    // Delete-a-block jackknife.
    let error = |which: usize| jackknife(without.iter().map(|both| both[which]));
    Some(Rotation {
        axis,
        velocity: (velocity, error(0)),
        diffusion: (diffusion, error(1)),
    })
}
