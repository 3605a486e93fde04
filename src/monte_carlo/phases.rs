//! Looks at a forced system: at even parts of its period, so that the phase of each is known and nothing is binned.
//!
//! A cell along the phase stands for the phase at its beginning: cell j of n holds what is seen at the phase j/n.

use super::MonteCarloError;
use super::batch::Histogram;
use crate::numerics::jackknife;
use crate::sampling::part_of_period;
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Relative difference of times that is rounding.
const ROUNDING: f64 = 1e-9;

/// The phase of a forcing, and how many parts of the period are looked at.
#[derive(Debug, Clone)]
pub(super) struct Phases {
    axis: usize,
    /// Looks of a period.
    pub(super) parts: usize,
}

impl Phases {
    /// Those of a run with this time between looks; `None` of a system without forcing.
    ///
    /// # Errors
    /// [`MonteCarloError::Phases`] unless looks are one part of the period apart.
    pub(super) fn of(
        system: &dyn System,
        space: &CellSpace,
        spacing: f64,
    ) -> Result<Option<Self>, MonteCarloError> {
        let (Some(axis), Some(wanted)) = (system.facts().phase, part_of_period(system, space))
        else {
            return Ok(None);
        };
        let parts = space.axes()[axis].count();
        // Also for what is not a number.
        if (spacing / wanted - 1.0).abs() <= ROUNDING {
            return Ok(Some(Self { axis, parts }));
        }
        Err(MonteCarloError::Phases {
            spacing,
            wanted,
            parts,
        })
    }

    fn put(&self, states: &mut [Lanes], number: usize, beyond: f64) {
        let part = (number % self.parts) as f64;
        let phase = (part + beyond) / self.parts as f64;
        states[self.axis] = [phase; LANES];
    }

    /// The phase of the look of a number, which rounding has moved a little.
    pub(super) fn set(&self, states: &mut [Lanes], number: usize) {
        self.put(states, number, 0.0);
    }

    /// The middle of the cell that stands for the phase of the look of a number.
    pub(super) fn set_to_cell(&self, states: &mut [Lanes], number: usize) {
        self.put(states, number, 0.5);
    }
}

/// What was seen of the states at each part of the period.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    parts: usize,
    dimension: usize,
    /// Looks inside Ω, Σ x and Σ x² of all and without one block each: an entry a part and axis, the axes fastest.
    all: Vec<[f64; 3]>,
    without: Vec<Vec<[f64; 3]>>,
}

impl Periodic {
    pub(super) fn new(phases: &Phases, space: &CellSpace, blocks: &[Histogram]) -> Self {
        let (parts, dimension) = (phases.parts, space.dimension());
        let place: Vec<usize> = space.positions(phases.axis).collect();
        let of_block = |block: &Histogram| {
            let mut looks = vec![0.0; parts];
            for (&part, &count) in place.iter().zip(&block.counts) {
                looks[part] += count as f64;
            }
            let sums = block.sums.iter().enumerate();
            let sums = sums.map(|(index, sums)| [looks[index / dimension], sums[0], sums[1]]);
            sums.collect::<Vec<_>>()
        };
        let blocks: Vec<Vec<[f64; 3]>> = blocks.iter().map(of_block).collect();
        let mut all = vec![[0.0; 3]; parts * dimension];
        for block in &blocks {
            for (all, one) in all.iter_mut().zip(block) {
                *all = std::array::from_fn(|which| all[which] + one[which]);
            }
        }
        let seen = blocks
            .iter()
            .filter(|block| block.iter().any(|sums| sums[0] > 0.0));
        let without = seen.map(|block| {
            let pairs = all.iter().zip(block);
            pairs
                .map(|(all, one)| std::array::from_fn(|which| all[which] - one[which]))
                .collect()
        });
        Self {
            parts,
            dimension,
            without: without.collect(),
            all,
        }
    }

    /// Parts of the period that were looked at.
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// Mean and standard deviation of an axis at the beginning of a part of the period, each with its standard error.
    pub fn moments(&self, axis: usize, part: usize) -> [(f64, f64); 2] {
        let of = |sums: &[[f64; 3]]| {
            let [looks, first, second] = sums[part * self.dimension + axis];
            let mean = first / looks;
            [mean, (second / looks - mean * mean).max(0.0).sqrt()]
        };
        let own = of(&self.all);
        [0, 1].map(|which| (own[which], self.error(&|sums| of(sums)[which])))
    }

    /// Amplitude with which the mean of an axis moves at the frequency of the forcing, with its standard error: twice
    /// the magnitude of the average of mean times e^{-2πis} over the phase s.
    pub fn amplitude(&self, axis: usize) -> (f64, f64) {
        let of = |sums: &[[f64; 3]]| {
            let (mut cosine, mut sine) = (0.0, 0.0);
            for part in 0..self.parts {
                let [looks, first, _] = sums[part * self.dimension + axis];
                let angle = std::f64::consts::TAU * part as f64 / self.parts as f64;
                cosine += first / looks * angle.cos();
                sine += first / looks * angle.sin();
            }
            2.0 / self.parts as f64 * f64::hypot(cosine, sine)
        };
        (of(&self.all), self.error(&of))
    }

    /// Delete-a-block jackknife.
    fn error(&self, of: &dyn Fn(&[[f64; 3]]) -> f64) -> f64 {
        let values: Vec<f64> = self.without.iter().map(|sums| of(sums)).collect();
        jackknife(values.iter().copied())
    }
}
