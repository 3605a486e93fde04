//! Samples the transitions of all cells that can be reached from given ones.

use super::column::{Column, ColumnSampler, SINK};
use super::phase::PhaseStep;
use super::{SampledTransitions, SamplingError, SamplingOptions};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::in_parallel;
use crate::space::CellSpace;
use crate::system::System;

/// Samples trajectories from every cell that can be reached from `seeds` (numbers in the cell space): the
/// seeds first, then the cells their trajectories end in, until no new cell appears.
///
/// Results depend on neither the number of threads nor, but for which cells are sampled, on the seeds: a cell's
/// trajectories are keyed by the options' seed and the cell's number.
///
/// # Errors
/// [`SamplingError`].
pub fn sample_transitions(
    system: &dyn System,
    space: &CellSpace,
    seeds: &[usize],
    options: &SamplingOptions,
    cancellation: &Cancellation,
) -> Result<SampledTransitions, SamplingError> {
    options.check()?;
    if system.dimension() != space.dimension() {
        return Err(SamplingError::Dimension {
            system: system.dimension(),
            space: space.dimension(),
        });
    }
    system.facts().autonomous()?;
    let n_cells = space.n_cells();
    if let Some(&cell) = seeds.iter().find(|&&cell| cell >= n_cells) {
        return Err(SamplingError::Seed { cell, n_cells });
    }
    let phase = PhaseStep::of(system, space, options.map_step)?;
    let sampler = ColumnSampler::new(system, space, options, phase, cancellation);
    let sample = |&cell: &usize| -> Result<_, Cancelled> { Ok((cell, sampler.column(cell)?)) };
    let mut known = vec![false; n_cells];
    let mut columns: Vec<(usize, Column)> = Vec::new();
    let mut frontier = unknown_of(seeds.iter().copied(), &mut known);
    while !frontier.is_empty() {
        let sampled = in_parallel(frontier.len(), |number| sample(&frontier[number]))?;
        let ends = sampled.iter().flat_map(|(_, column)| &column.destinations);
        let ends = ends.copied().filter(|&cell| cell != SINK);
        frontier = unknown_of(ends.map(|cell| cell as usize), &mut known);
        columns.extend(sampled);
    }
    columns.sort_unstable_by_key(|entry| entry.0);
    Ok(SampledTransitions::new(
        columns,
        n_cells,
        options,
        (space.dimension(), phase.map(|phase| phase.axis)),
    ))
}

/// The cells not marked yet, ascending; marks them.
fn unknown_of(cells: impl Iterator<Item = usize>, known: &mut [bool]) -> Vec<usize> {
    let mut unknown: Vec<usize> = cells
        .filter(|&cell| !std::mem::replace(&mut known[cell], true))
        .collect();
    unknown.sort_unstable();
    unknown
}

#[cfg(test)]
mod tests;
