//! What a run of free trajectories estimates: cell masses, replicates for their errors, and what left Ω.

use super::advances::{Rotation, rotation};
use super::batch::Histogram;
use super::phases::{Periodic, Phases};

use crate::space::CellSpace;

/// Blocks that standard errors rest on. Blocks are groups of independent trajectories, or, when there are fewer than
/// this many batches, stretches of their time.
pub(crate) const BLOCKS: usize = 32;

/// Counts of one task.
#[derive(Debug, Clone)]
pub(super) struct Tally {
    pub(super) blocks: Vec<Histogram>,
    pub(super) trajectories: u64,
    pub(super) runaways: u64,
    /// Steps made.
    pub(super) steps: u64,
    /// Time that trajectories lived before they ran away, all together.
    pub(super) lived: f64,
}

impl Tally {
    pub(super) fn new(blocks: Vec<Histogram>) -> Self {
        Self {
            blocks,
            trajectories: 0,
            runaways: 0,
            steps: 0,
            lived: 0.0,
        }
    }
}

/// A density estimated by free trajectories, conditioned on Ω.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Mass of every cell of the space, Σ = 1; all zero when no look found a trajectory in Ω.
    pub mass: Vec<f64>,
    /// The masses without one block of the run each (delete-a-block jackknife), for
    /// [`crate::density::estimate`]; blocks without a visit to Ω are left out.
    pub replicates: Vec<Vec<f64>>,
    /// Mean of every axis over the looks in Ω, of the states themselves and not of cell centres.
    pub mean: Vec<f64>,
    /// Variance of every axis, likewise.
    pub variance: Vec<f64>,
    /// Share of the looks at trajectories that had not run away that found them outside Ω.
    pub share_outside: f64,
    /// Share of the trajectories that ran away.
    pub runaways: f64,
    /// Trajectories that ran away, per trajectory and unit of time.
    pub runaway_rate: f64,
    /// Integrator steps of all trajectories together, burn-in included.
    pub steps: u64,
    /// Looks at trajectories that found them in Ω.
    pub looks: u64,
    /// How each angle turns, where it was watched for long enough.
    pub rotations: Vec<Rotation>,
    /// Of a forced system, what was seen at each part of its period.
    pub periodic: Option<Periodic>,
}

impl Estimate {
    /// Merges the tasks in the order of their numbers; `turns` are the axes whose advances over windows of one length
    /// they have summed up.
    pub(super) fn new(
        space: &CellSpace,
        parts: Vec<Tally>,
        phases: Option<&Phases>,
        (turns, window): (&[usize], f64),
    ) -> Self {
        let sum = |value: fn(&Tally) -> u64| parts.iter().map(value).sum::<u64>();
        let (trajectories, runaways) = (sum(|part| part.trajectories), sum(|part| part.runaways));
        let steps = sum(|part| part.steps);
        let lived: f64 = parts.iter().map(|part| part.lived).sum();
        let blocks: Vec<Histogram> = parts.into_iter().flat_map(|part| part.blocks).collect();
        let dimension = space.dimension();
        let mut total = Histogram {
            counts: vec![0; space.n_cells() + 1],
            sums: vec![[0.0; 2]; blocks.first().map_or(dimension, |block| block.sums.len())],
            gone: 0,
            advances: Vec::new(),
        };
        blocks.iter().for_each(|block| total.join(block));
        let (inside, outside) = (total.inside(), total.outside());
        let counts = &total.counts[..space.n_cells()];
        let of_all = 1.0 / inside.max(1) as f64;
        let without = |block: &Histogram| -> Option<Vec<f64>> {
            let left = inside - block.inside();
            let pairs = counts.iter().zip(&block.counts);
            (block.inside() > 0 && left > 0)
                .then(|| pairs.map(|(a, b)| (a - b) as f64 / left as f64).collect())
        };
        let mut sums = vec![[0.0; 2]; dimension];
        for (index, part) in total.sums.iter().enumerate() {
            let sums = &mut sums[index % dimension];
            (sums[0], sums[1]) = (sums[0] + part[0], sums[1] + part[1]);
        }
        let mean: Vec<f64> = sums.iter().map(|sums| sums[0] * of_all).collect();
        let variances = sums.iter().zip(&mean);
        Self {
            variance: variances
                .map(|(sums, mean)| (sums[1] * of_all - mean * mean).max(0.0))
                .collect(),
            mean,
            mass: counts.iter().map(|&count| count as f64 * of_all).collect(),
            replicates: blocks.iter().filter_map(without).collect(),
            share_outside: outside as f64 / (inside + outside).max(1) as f64,
            runaways: runaways as f64 / trajectories.max(1) as f64,
            runaway_rate: runaways as f64 / lived.max(f64::MIN_POSITIVE),
            steps,
            looks: inside,
            periodic: phases.map(|phases| Periodic::new(phases, space, &blocks)),
            rotations: turns
                .iter()
                .enumerate()
                .filter_map(|(index, &axis)| {
                    let advances = blocks.iter().map(|block| block.advances[index]);
                    rotation(&advances.collect::<Vec<_>>(), axis, window)
                })
                .collect(),
        }
    }
}
