//! How far the angles of a batch turn: whole turns are counted, and at the end of every window the advances are added.

use super::advances::Advances;
use super::batch::Batch;
use crate::sampling::WholeTurn;
use crate::system::{LANES, Lanes};

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
