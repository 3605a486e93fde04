//! The transition matrix of a cell map, and the counts it is estimated from.

use sprs::CsMat;

use super::column::{Column, SINK};

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
}

/// Where the samples of every reachable cell ended, by group.
///
/// Groups partition the samples of each cell into independent stratified samples: with a matrix from each
/// delete-a-group jackknife, the sampling error of anything computed from the matrix can be estimated.
#[derive(Debug, Clone)]
pub struct SampledTransitions {
    cells: Vec<usize>,
    columns: Vec<Column>,
    groups: usize,
    dimension: usize,
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
        dimension: usize,
    ) -> Self {
        let (cells, mut columns): (Vec<usize>, Vec<Column>) = columns.into_iter().unzip();
        let mut position = vec![SINK; n_cells];
        for (index, &cell) in cells.iter().enumerate() {
            position[cell] = index as u32;
        }
        for column in &mut columns {
            for (cell, _) in &mut column.destinations {
                *cell = position.get(*cell as usize).copied().unwrap_or(SINK);
            }
        }
        Self {
            cells,
            columns,
            groups: options.groups,
            dimension,
            map_step: options.map_step,
            time_step: options.map_step / options.steps() as f64,
        }
    }

    /// Number in the cell space of each sampled cell, ascending.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// Number of groups.
    pub fn groups(&self) -> usize {
        self.groups
    }

    /// Step the integrator took: the largest divisor of the map step that is not above the one asked for.
    pub fn time_step(&self) -> f64 {
        self.time_step
    }

    /// Integrator steps of all trajectories together: the work that was done.
    pub fn n_steps(&self) -> u64 {
        let samples: usize = self.columns.iter().map(|column| column.groups.len()).sum();
        samples as u64 * (self.map_step / self.time_step).round() as u64
    }

    /// The transition matrix of all samples.
    pub fn matrix(&self) -> TransitionMatrix {
        self.assemble(None)
    }

    /// The transition matrix of all samples but those of one group (of none, if there is no such group).
    pub fn matrix_without_group(&self, group: usize) -> TransitionMatrix {
        self.assemble(Some(group).filter(|&group| group < self.groups && self.groups > 1))
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

    /// Counts of one column, `left_out` not counted: destination and number of samples.
    fn counts(column: &Column, left_out: Option<usize>) -> impl Iterator<Item = (u32, usize)> {
        let entries = column.entries().map(move |(cell, groups)| {
            let counts = |group: &&u8| left_out != Some(usize::from(**group));
            (cell, groups.iter().filter(counts).count())
        });
        entries.filter(|&(_, count)| count > 0)
    }

    /// Counts into rows in two passes: the size of each row, then its entries in order of their columns.
    fn assemble(&self, left_out: Option<usize>) -> TransitionMatrix {
        let n = self.cells.len();
        let mut row_ends = vec![0_usize; n + 1];
        for column in &self.columns {
            for (cell, _) in Self::counts(column, left_out) {
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
            let total: usize = Self::counts(column, left_out).map(|entry| entry.1).sum();
            for (cell, count) in Self::counts(column, left_out) {
                let probability = count as f64 / total as f64;
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
        }
    }
}
