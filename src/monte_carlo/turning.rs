//! How far angles turn: whole turns of every trajectory, and what its advances over windows of one length say of mean
//! velocity and effective diffusion.
//!
//! With d and d' the advances over two neighbouring windows of length w, the mean velocity is V = ⟨d⟩/w. The variance
//! of the advance over two windows less that over one is 2 D w, up to what is left of a correlation after a whole
//! window between: D = (var d + 2 cov(d, d'))/(2 w).

use super::batch::Batch;
use crate::sampling::WholeTurn;
use crate::system::{LANES, Lanes};

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
    fn add(&mut self, advance: f64, before: Option<f64>) {
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
    let count = without.len() as f64;
    let error = |which: usize| {
        let mean = without.iter().map(|both| both[which]).sum::<f64>() / count;
        let squares = without.iter().map(|both| (both[which] - mean).powi(2));
        ((count - 1.0) / count * squares.sum::<f64>()).sqrt()
    };
    Some(Rotation {
        axis,
        velocity: (velocity, error(0)),
        diffusion: (diffusion, error(1)),
    })
}

/// The turns of a batch of trajectories.
pub(super) struct Turning<'a> {
    all: &'a [WholeTurn],
    /// Whole turns so far, one row an axis that closes on itself.
    turns: Vec<Lanes>,
    /// Where the window began, and the advance over the one before, which there is none of at first.
    from: Vec<Lanes>,
    before: Vec<Option<Lanes>>,
    looks: usize,
    /// Looks of a window.
    window: usize,
}

impl<'a> Turning<'a> {
    pub(super) fn new(all: &'a [WholeTurn], window: usize) -> Self {
        Self {
            all,
            turns: vec![[0.0; LANES]; all.len()],
            from: vec![[0.0; LANES]; all.len()],
            before: vec![None; all.len()],
            looks: 0,
            window,
        }
    }

    /// Brings the coordinates of a batch back to one turn, and counts those that were whole.
    pub(super) fn count(&mut self, batch: &mut Batch) {
        for (turn, counted) in self.all.iter().zip(&mut self.turns) {
            let lanes = batch.states[turn.axis].iter_mut().zip(counted);
            for (x, counted) in lanes {
                let number = turn.number(*x);
                *x -= turn.length * number;
                *counted += number;
            }
        }
    }

    /// Windows begin here.
    pub(super) fn begin(&mut self, batch: &Batch) {
        self.turns
            .iter_mut()
            .for_each(|turns| *turns = [0.0; LANES]);
        for (turn, from) in self.all.iter().zip(&mut self.from) {
            *from = batch.states[turn.axis];
        }
    }

    /// Counts a look at a batch within one turn. At the end of a window the advances of trajectories that have not run
    /// away are added.
    pub(super) fn look(&mut self, batch: &Batch, sums: &mut [Advances]) {
        self.looks += 1;
        if self.looks < self.window {
            return;
        }
        self.looks = 0;
        for (index, turn) in self.all.iter().enumerate() {
            let mut advances = [0.0; LANES];
            for (lane, advance) in advances.iter_mut().enumerate() {
                let x = batch.states[turn.axis][lane];
                *advance = x - self.from[index][lane] + turn.length * self.turns[index][lane];
                if advance.is_finite() {
                    let before = self.before[index].map(|before| before[lane]);
                    sums[index].add(*advance, before);
                }
            }
            self.before[index] = Some(advances);
        }
        self.begin(batch);
    }
}
