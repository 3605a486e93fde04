//! Sums over the states that a pilot's trajectories visit.

use super::{
    LocalRates, Pilot, Position, SLOWER_THAN_SPREAD, local_rates, positions, quantile, summary,
};
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Sums over visits to Ω.
pub(super) struct Record {
    /// Visited cells; sorted and unique at the end only.
    pub(super) cells: Vec<usize>,
    /// Visits to Ω.
    pub(super) inside: usize,
    /// Local rates at some of the visits.
    pub(super) rates: Vec<LocalRates>,
    positions: Vec<Position>,
    phase: Option<usize>,
    visits: usize,
    axes: Vec<AxisSums>,
    /// States beyond the range of each axis, or no numbers.
    pub(super) outside: Vec<usize>,
}

#[derive(Clone, Copy, Default)]
struct AxisSums {
    /// Σ (x - c) and Σ (x - c)² about the middle c of the range.
    first: f64,
    second: f64,
    square_width: f64,
    noise: f64,
    middle: f64,
}

impl Record {
    pub(super) fn new(system: &dyn System, space: &CellSpace) -> Self {
        let middle = |axis: &crate::space::Axis| AxisSums {
            middle: 0.5 * (axis.from() + axis.to()),
            ..AxisSums::default()
        };
        Self {
            cells: Vec::new(),
            inside: 0,
            rates: Vec::new(),
            positions: positions(system),
            phase: system.facts().phase,
            visits: 0,
            axes: space.axes().iter().map(middle).collect(),
            outside: vec![0; space.dimension()],
        }
    }

    /// Records every lane, and local rates at one lane in four if asked.
    pub(super) fn batch(
        &mut self,
        system: &dyn System,
        space: &CellSpace,
        states: &[Lanes],
        rates: bool,
    ) {
        for lane in 0..LANES {
            let mut state: Vec<f64> = states.iter().map(|lanes| lanes[lane]).collect();
            for (&axis, &(from, to)) in &system.facts().turns {
                state[axis] = from + (state[axis] - from).rem_euclid(to - from);
            }
            self.visit(system, space, &state);
            if rates && lane % 4 == 0 {
                let rates = local_rates(system, space, &state, &self.positions);
                self.rates.extend(rates);
            }
        }
        self.visits += LANES;
    }

    /// Records a state if it is in Ω, and along which axes it is not.
    pub(super) fn visit(&mut self, system: &dyn System, space: &CellSpace, state: &[f64]) {
        let Some(cell) = space.find(state) else {
            for ((outside, axis), &place) in self.outside.iter_mut().zip(space.axes()).zip(state) {
                *outside += usize::from(!(axis.from()..=axis.to()).contains(&place));
            }
            return;
        };
        self.cells.push(cell);
        self.inside += 1;
        for (axis, sums) in self.axes.iter_mut().enumerate() {
            let off = state[axis] - sums.middle;
            sums.first += off;
            sums.second += off * off;
            sums.square_width += space.axes()[axis].width(space.position(cell, axis)).powi(2);
        }
        for noise in system.noises() {
            let amplitude = noise.at(0.0, state);
            self.axes[noise.axis].noise += 0.5 * amplitude * amplitude;
        }
    }

    pub(super) fn join(&mut self, other: &Self) {
        self.cells.extend(&other.cells);
        self.rates.extend(&other.rates);
        self.inside += other.inside;
        self.visits += other.visits;
        for (outside, more) in self.outside.iter_mut().zip(&other.outside) {
            *outside += more;
        }
        for (sums, more) in self.axes.iter_mut().zip(&other.axes) {
            sums.first += more.first;
            sums.second += more.second;
            sums.square_width += more.square_width;
            sums.noise += more.noise;
        }
    }

    /// Means of the sums.
    pub(super) fn finish(mut self, steps: usize) -> Pilot {
        self.cells.sort_unstable();
        self.cells.dedup();
        let count = self.inside.max(1) as f64;
        let axis = |value: &dyn Fn(&AxisSums) -> f64| self.axes.iter().map(value).collect();
        let (frequency, damping) = summary(&self.rates, 0.99);
        let split = quantile(self.rates.iter().map(|rate| rate.split).collect(), 0.99);
        let standard_deviation: Vec<f64> = axis(&|sums| {
            let mean = sums.first / count;
            (sums.second / count - mean * mean).max(0.0).sqrt()
        });
        let noise_intensity: Vec<f64> = axis(&|sums| sums.noise / count);
        let pairs = noise_intensity.iter().zip(&standard_deviation);
        let crossing = pairs.map(|(noise, deviation)| noise / (deviation * deviation));
        let crossing = crossing.filter(|rate| rate.is_finite()).fold(0.0, f64::max);
        Pilot {
            steps,
            may_settle: true,
            outside: self.outside,
            share_inside: self.inside as f64 / self.visits.max(1) as f64,
            standard_deviation,
            mean_square_width: axis(&|sums| sums.square_width / count),
            noise_intensity,
            frequency: frequency.max(SLOWER_THAN_SPREAD * crossing),
            split_frequency: (!self.positions.is_empty())
                .then_some(split.max(SLOWER_THAN_SPREAD * crossing)),
            damping,
            cells: self.cells,
            phase: self.phase,
        }
    }
}
