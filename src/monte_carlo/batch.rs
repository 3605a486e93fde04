//! A batch of free trajectories: advanced together, taken out when they run away, counted into cells.

use multiversion::multiversion;

use super::advances::Advances;

use crate::MAX_DIMENSION;
use crate::cancellation::Cancelled;
use crate::sampling::{CellLookup, NormalStream, Stepper, StreamKey, mix, unit};
use crate::space::CellSpace;
use crate::system::{LANES, Lanes};

/// A trajectory has run away when a coordinate is this many times half the range from its middle, or not finite.
const FAR: f64 = 100.0;

/// Number among the cells that keys the streams apart from those of the cells and of the pilot.
const CELL: u64 = u64::MAX - 1;

/// What the streams of a run are for: different purposes never share random numbers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    Settle = 1,
    Halving = 2,
    Ergodic = 3,
    Ensemble = 4,
    Starts = 5,
    Path = 6,
    Passage = 7,
    PassageStart = 8,
    Chance = 9,
    Tangent = 10,
    Transition = 11,
    Meeting = 12,
    Map = 13,
    MapStart = 14,
    MapChance = 15,
}

/// Key of one batch's stream.
pub(super) fn key(seed: u64, purpose: Purpose, batch: u64) -> StreamKey {
    StreamKey {
        seed,
        cell: CELL,
        block: ((purpose as u64) << 48) | batch,
    }
}

/// Coordinates in [0, 1) of a random point.
pub(super) fn random_point(seed: u64, number: u64, dimension: usize) -> [f64; MAX_DIMENSION] {
    let word = key(seed, Purpose::Starts, number).word();
    let mut point = [0.0; MAX_DIMENSION];
    for (axis, value) in point.iter_mut().enumerate().take(dimension) {
        *value = unit(mix(word.wrapping_add(axis as u64)));
    }
    point
}

/// How far trajectories may go: middle of the range and greatest distance from it, one pair an axis.
#[derive(Debug, Clone)]
pub(super) struct Limits(Vec<(f64, f64)>);

impl Limits {
    /// Number of axes.
    pub(super) fn dimension(&self) -> usize {
        self.0.len()
    }

    pub(super) fn new(space: &CellSpace) -> Self {
        let axes = space.axes().iter();
        let limit = |from: f64, to: f64| (0.5 * (from + to), FAR * 0.5 * (to - from));
        // However far an angle turns, it does not run away.
        let limit = |axis: &crate::space::Axis| match limit(axis.from(), axis.to()) {
            (middle, _) if axis.is_closed() => (middle, f64::INFINITY),
            limit => limit,
        };
        Self(axes.map(limit).collect())
    }

    /// Whether a state has not run away.
    pub(super) fn hold(&self, state: &[f64]) -> bool {
        let near = |(&value, &(middle, far)): (&f64, &(f64, f64))| (value - middle).abs() <= far;
        state.iter().zip(&self.0).all(near)
    }
}

/// Trajectories that advance together.
pub(super) struct Batch {
    /// `states[axis][lane]`; not numbers for a trajectory that has run away.
    pub(super) states: Vec<Lanes>,
    stream: NormalStream,
    steps: usize,
    /// Which trajectories have not run away.
    pub(super) alive: [bool; LANES],
}

impl Batch {
    pub(super) fn new(states: Vec<Lanes>, key: StreamKey) -> Self {
        Self {
            states,
            stream: NormalStream::new(key),
            steps: 0,
            alive: [true; LANES],
        }
    }

    pub(super) fn advance(&mut self, stepper: &Stepper<'_>, steps: usize) -> Result<(), Cancelled> {
        stepper.advance(&mut self.states, self.steps, steps, &mut self.stream)?;
        self.steps += steps;
        Ok(())
    }

    /// Number of trajectories that have not run away.
    pub(super) fn n_alive(&self) -> usize {
        self.alive.iter().filter(|&&alive| alive).count()
    }

    /// Takes out trajectories that have run away: they are never restarted.
    pub(super) fn retire(&mut self, limits: &Limits) {
        for lane in 0..LANES {
            let near = |(lanes, &(middle, far)): (&Lanes, &(f64, f64))| {
                (lanes[lane] - middle).abs() <= far
            };
            if self.alive[lane] && !self.states.iter().zip(&limits.0).all(near) {
                self.alive[lane] = false;
                for lanes in &mut self.states {
                    lanes[lane] = f64::NAN;
                }
            }
        }
    }
}

/// Counts of looks at trajectories.
#[derive(Debug, Clone)]
pub(super) struct Histogram {
    /// Looks that found each cell, and last those that found none.
    pub(super) counts: Vec<u64>,
    /// Σ x and Σ x² over looks inside Ω, one pair an axis; of a forced system so for each part of the period, the axes
    /// fastest.
    pub(super) sums: Vec<[f64; 2]>,
    /// Looks at trajectories that had run away.
    pub(super) gone: u64,
    /// How far angles advance, one an axis that closes on itself.
    pub(super) advances: Vec<Advances>,
}

impl Histogram {
    pub(super) fn new(lookup: &CellLookup, dimension: usize, parts: usize, turns: usize) -> Self {
        Self {
            counts: vec![0; lookup.n_cells() + 1],
            sums: vec![[0.0; 2]; dimension * parts],
            gone: 0,
            advances: vec![Advances::default(); turns],
        }
    }

    /// Adds another one's counts.
    pub(super) fn join(&mut self, other: &Self) {
        let counts = self.counts.iter_mut().zip(&other.counts);
        counts.for_each(|(count, more)| *count += more);
        for (sums, more) in self.sums.iter_mut().zip(&other.sums) {
            sums[0] += more[0];
            sums[1] += more[1];
        }
        self.gone += other.gone;
    }

    /// Looks inside Ω.
    pub(super) fn inside(&self) -> u64 {
        self.counts[..self.counts.len() - 1].iter().sum()
    }

    /// Looks outside Ω at trajectories that had not run away.
    pub(super) fn outside(&self) -> u64 {
        let sink = self.counts.last().copied().unwrap_or(0);
        sink.saturating_sub(self.gone)
    }

    /// Counts one look at the states of a batch, at this part of the period.
    pub(super) fn look(&mut self, lookup: &CellLookup, states: &[Lanes], part: usize) {
        let first = part * states.len();
        let sums = &mut self.sums[first..first + states.len()];
        count(lookup, states, &mut self.counts, sums);
    }

    /// Tells that looks since the last call were also at this many trajectories that had run away before.
    pub(super) fn exclude(&mut self, gone: usize, looks: usize) {
        self.gone += (gone * looks) as u64;
    }
}

#[multiversion(targets = "simd")]
fn count(lookup: &CellLookup, states: &[Lanes], counts: &mut [u64], sums: &mut [[f64; 2]]) {
    let mut cells = [0; LANES];
    lookup.find(states, &mut cells);
    for &cell in &cells {
        counts[cell] += 1;
    }
    // Eight partial sums, so that the order of additions does not depend on the width of the registers.
    for (lanes, sums) in states.iter().zip(sums) {
        let mut parts = [[0.0; 8]; 2];
        for (lanes, cells) in lanes.chunks_exact(8).zip(cells.chunks_exact(8)) {
            for place in 0..8 {
                let inside = cells[place] < lookup.n_cells();
                let x = if inside { lanes[place] } else { 0.0 };
                parts[0][place] += x;
                parts[1][place] += x * x;
            }
        }
        sums[0] += parts[0].iter().sum::<f64>();
        sums[1] += parts[1].iter().sum::<f64>();
    }
}
