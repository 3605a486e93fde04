//! The transition matrix of a cell map, and the counts it is estimated from.

use sprs::CsMat;

use super::column::{Column, SINK};
use super::end_moments::Means;
use super::slopes::cell_slopes;
use crate::MAX_DIMENSION;
use crate::space::CellSpace;

/// Transition probabilities between `n` cells of a cell space over one map step.
///
/// Columns sum to one with the sink: `Σ_i P[i][j] + escape[j] = 1`, so p(m+1) = P p(m), the paper's Eq. (4).
#[derive(Debug, Clone)]
pub struct TransitionMatrix {
    /// P, `n × n`, compressed by rows (CSR): row `i` lists the cells `j` from which `i` is reached.
    pub matrix: CsMat<f64>,
    /// Probability to be in the sink one map step after a uniform start in each cell; length `n`.
    pub escape: Vec<f64>,
    /// Number in the cell space of each row and column, ascending; length `n`.
    pub cells: Vec<usize>,
    /// Time that one application spans.
    pub map_step: f64,
    /// Axis of the cell space along which every transition passes the same number of cells, the phase of a forcing: the
    /// chain is periodic.
    pub phase: Option<usize>,
}

/// Where the samples of every reachable cell ended, by group.
///
/// Groups partition the samples of each cell into independent stratified samples: with a matrix from each
/// delete-a-group jackknife, the sampling error of anything computed from the matrix can be estimated.
#[derive(Debug, Clone)]
pub struct SampledTransitions {
    pub(super) cells: Vec<usize>,
    pub(super) columns: Vec<Column>,
    pub(super) groups: usize,
    pub(super) dimension: usize,
    pub(super) phase: Option<usize>,
    map_step: f64,
    time_step: f64,
}

impl SampledTransitions {
    /// Sampled columns in ascending order of their cells; destinations hold numbers in the cell space, and
    /// become positions in the list of cells.
    pub(super) fn new(
        columns: Vec<(usize, Column)>,
        n_cells: usize,
        options: &super::SamplingOptions,
        (dimension, phase): (usize, Option<usize>),
    ) -> Self {
        let (cells, mut columns): (Vec<usize>, Vec<Column>) = columns.into_iter().unzip();
        let mut position = vec![SINK; n_cells];
        for (index, &cell) in cells.iter().enumerate() {
            position[cell] = index as u32;
        }
        for column in &mut columns {
            for cell in &mut column.destinations {
                *cell = position.get(*cell as usize).copied().unwrap_or(SINK);
            }
        }
        Self {
            cells,
            columns,
            groups: options.groups,
            dimension,
            phase,
            map_step: options.map_step,
            time_step: options.map_step / options.steps() as f64,
        }
    }

    /// Number in the cell space of each sampled cell, ascending.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// Slopes of the density in every sampled cell, from the masses of all cells of the space; see [`cell_slopes`].
    pub(crate) fn slopes(&self, space: &CellSpace, mass: &[f64]) -> Vec<[f64; MAX_DIMENSION]> {
        cell_slopes(space, &self.cells, mass, self.phase)
    }

    /// Number of groups.
    pub fn groups(&self) -> usize {
        self.groups
    }

    /// Time that a transition spans.
    pub(crate) fn map_step(&self) -> f64 {
        self.map_step
    }

    /// Step the integrator took: the largest divisor of the map step that is not above the one asked for.
    pub fn time_step(&self) -> f64 {
        self.time_step
    }

    /// Integrator steps of all trajectories together: the work that was done.
    pub(crate) fn n_steps(&self) -> u64 {
        let samples: usize = self.columns.iter().map(|column| column.samples).sum();
        samples as u64 * (self.map_step / self.time_step).round() as u64
    }

    /// The transition matrix of all samples.
    pub fn matrix(&self) -> TransitionMatrix {
        self.assemble(None, None)
    }

    /// The transition matrix of all samples but those of one group (of none, if there is no such group).
    pub fn matrix_without_group(&self, group: usize) -> TransitionMatrix {
        self.assemble(self.existing(Some(group)), None)
    }

    /// The transition matrix for a density that is linear in each cell, p_j/V (1 + Σ_a s_a u_a) with u_a from -½ to ½
    /// across the cell: every sample counts by the density at its start. `slopes` holds the s_a of every sampled cell,
    /// as [`cell_slopes`] makes them (Σ |s_a| < 2, so that no weight is negative). `left_out` names
    /// a group that is not counted. Without kept starts this is the plain matrix.
    pub(crate) fn corrected_matrix(
        &self,
        slopes: &[[f64; MAX_DIMENSION]],
        left_out: Option<usize>,
    ) -> TransitionMatrix {
        self.assemble(self.existing(left_out), Some(slopes))
    }

    fn existing(&self, group: Option<usize>) -> Option<usize> {
        group.filter(|&group| group < self.groups && self.groups > 1)
    }

    /// Forgets where samples started, as if they had not been kept.
    #[cfg(test)]
    pub(crate) fn forget_starts(&mut self) {
        self.columns.iter_mut().for_each(Column::forget_starts);
    }

    /// Whether it is known where in their cells the samples started.
    pub(crate) fn keeps_starts(&self) -> bool {
        self.columns.iter().any(Column::keeps_starts)
    }

    /// Diffusion that the cells add, one value an axis, in units of the axis squared per unit time:
    /// Σ_j mass_j m_j/(2Δt), where m_j is the mean square displacement of spreading the samples from cell j
    /// evenly over the cells they end in. On uniform cells it is about h²/(12Δt).
    ///
    /// `mass` has one entry a sampled cell, Σ = 1 (an average over fewer cells if it is shorter).
    pub fn numerical_diffusion(&self, mass: &[f64]) -> Vec<f64> {
        let diffusion = |axis: usize| {
            let columns = self.columns.iter().zip(mass);
            let mean: f64 = columns
                .map(|(column, mass)| mass * column.spreading[axis])
                .sum();
            mean / (2.0 * self.map_step)
        };
        (0..self.dimension).map(diffusion).collect()
    }

    /// Diffusion that remains with densities linear in the cells, an axis, as [`Self::numerical_diffusion`]: by how
    /// much the variance of the reconstructed density exceeds that of the end points which it is made of, over 2Δt, and
    /// by how much its harmonics fall short of theirs along an angle. May be slightly negative. `mass` and `slopes` are
    /// of the sampled cells; without kept starts the diffusion of flat cells.
    pub fn remaining_diffusion(
        &self,
        space: &CellSpace,
        mass: &[f64],
        slopes: &[[f64; MAX_DIMENSION]],
    ) -> Vec<f64> {
        if !self.keeps_starts() {
            return self.numerical_diffusion(mass);
        }
        let diffusion = |axis: usize| {
            if self.phase == Some(axis) {
                return 0.0;
            }
            let edges = &space.axes()[axis];
            let (mut ends, mut cells) = (Means::default(), Means::default());
            for (j, column) in self.columns.iter().enumerate() {
                let weight = mass[j] / column.samples as f64;
                column.ends[axis].add_to(&mut ends, weight, &slopes[j]);
                let position = space.position(self.cells[j], axis);
                cells.add_cell(edges, position, mass[j], slopes[j][axis]);
            }
            ends.diffusion_to(&cells, edges) / self.map_step
        };
        (0..self.dimension).map(diffusion).collect()
    }

    /// Weights of one column, `left_out` not counted: destination and Σ over its samples of the density at their
    /// starts, relative to the cell's mean.
    fn weights(
        &self,
        column: &Column,
        left_out: Option<usize>,
        slope: Option<&[f64; MAX_DIMENSION]>,
        weights: &mut Vec<(u32, f64)>,
    ) {
        weights.clear();
        let dimension = self.dimension;
        let slope = slope.filter(|_| column.keeps_starts());
        let tilt = |starts: &[f32], slope: &[f64; MAX_DIMENSION]| -> f64 {
            let terms = starts.iter().zip(slope);
            terms.map(|(&start, s)| f64::from(start) * s).sum()
        };
        let starts = |of: &[f32], number: usize| {
            let of_axes = number * dimension..(number + 1) * dimension;
            slope.map_or(0.0, |slope| tilt(&of[of_axes], slope))
        };
        let group = left_out.map(|group| &column.groups[group]);
        let shares = group
            .into_iter()
            .flat_map(|group| group.counts.iter().enumerate());
        let mut shares = shares.peekable();
        let ends = column.destinations.iter().zip(&column.counts);
        for (place, (&cell, &all)) in ends.enumerate() {
            let (mut count, mut tilted) = (all, starts(&column.starts, place));
            if let Some((number, share)) = shares.next_if(|(_, share)| share.0 as usize == place) {
                count -= share.1;
                tilted -= group.map_or(0.0, |group| starts(&group.starts, number));
            }
            if count > 0 {
                weights.push((cell, f64::from(count) + tilted));
            }
        }
    }

    /// Counts into rows in two passes: the size of each row, then its entries in order of their columns.
    fn assemble(
        &self,
        left_out: Option<usize>,
        slopes: Option<&[[f64; MAX_DIMENSION]]>,
    ) -> TransitionMatrix {
        let n = self.cells.len();
        let mut row_ends = vec![0_usize; n + 1];
        let mut weights = Vec::new();
        for column in &self.columns {
            self.weights(column, left_out, None, &mut weights);
            for &(cell, _) in &weights {
                if cell != SINK {
                    row_ends[cell as usize + 1] += 1;
                }
            }
        }
        for row in 0..n {
            row_ends[row + 1] += row_ends[row];
        }
        let mut next = row_ends.clone();
        let (mut indices, mut values) = (vec![0_usize; row_ends[n]], vec![0.0; row_ends[n]]);
        let mut escape = vec![0.0; n];
        for (j, column) in self.columns.iter().enumerate() {
            let slope = slopes.and_then(|slopes| slopes.get(j));
            self.weights(column, left_out, slope, &mut weights);
            let total: f64 = weights.iter().map(|entry| entry.1).sum();
            for &(cell, weight) in &weights {
                let probability = weight / total;
                if cell == SINK {
                    escape[j] = probability;
                } else {
                    let place = next[cell as usize];
                    (indices[place], values[place]) = (j, probability);
                    next[cell as usize] += 1;
                }
            }
        }
        TransitionMatrix {
            matrix: CsMat::new((n, n), row_ends, indices, values),
            escape,
            cells: self.cells.clone(),
            map_step: self.map_step,
            phase: self.phase,
        }
    }
}
