//! The transition matrix of a cell map.

use sprs::CsMat;

/// Transition probabilities between `n` cells of a cell space over one map step.
///
/// Columns sum to one with the sink: Σ_i P[i][j] + escape[j] = 1, so p(m+1) = P p(m), the paper's Eq. (4).
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
