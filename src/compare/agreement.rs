//! Generator and Monte Carlo bin by bin.

use super::{Method, Solved};
use crate::density::{EstimatedDensity, Observable};

/// Standard errors within which two estimates are said to agree.
const ERRORS: f64 = 3.0;

/// A bin counts when Monte Carlo knows its density to a fifth: in the far tail it rests on a few excursions, whose
/// visits come in clusters and of which blocks say too little.
const KNOWN: f64 = 5.0;

/// Bins that the generator gives more than this share of the largest density count in any case.
const OCCUPIED: f64 = 1e-2;

/// How far a marginal by the generator and by Monte Carlo agree, bin by bin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// The marginal.
    pub observable: Observable,
    /// Bins whose density Monte Carlo knows to a fifth, or to which the generator gives more than 1 % of the largest
    /// density.
    pub bins: usize,
    /// Those in which both agree within three standard errors of Monte Carlo.
    pub within: usize,
    /// Those in which they differ by more than that and the generator's own grid error together.
    pub beyond: usize,
    /// Largest difference in standard errors of Monte Carlo.
    pub worst: f64,
}

impl Agreement {
    /// Share of the bins that agree.
    pub(crate) fn share(&self) -> f64 {
        self.within as f64 / self.bins.max(1) as f64
    }
}

/// Compares a density with a grid error (`computed`) to one with a sampling error (`sampled`), on the same cells.
pub(crate) fn agreement(computed: &EstimatedDensity, sampled: &EstimatedDensity) -> Agreement {
    let mut found = Agreement {
        observable: computed.observable,
        bins: 0,
        within: 0,
        beyond: 0,
        worst: 0.0,
    };
    let occupied = OCCUPIED * computed.density.maximum();
    let values = computed.density.values.iter().zip(&sampled.density.values);
    let grid = computed.stated_errors();
    let errors = grid.iter().zip(&sampled.standard_error);
    for ((a, b), (grid, error)) in values.zip(errors) {
        let gap = (a - b).abs();
        let within = gap <= ERRORS * error;
        if *b < KNOWN * error && *a < occupied {
            continue;
        }
        found.bins += 1;
        found.within += usize::from(within);
        found.beyond += usize::from(gap > ERRORS * error + grid);
        found.worst = found.worst.max(gap / error.max(f64::MIN_POSITIVE));
    }
    found
}

/// The agreement of generator and Monte Carlo on every marginal.
pub(super) fn of_marginals(solved: &[Solved]) -> Vec<Agreement> {
    let by = |method| solved.iter().find(|solved| solved.method == method);
    let (Some(computed), Some(sampled)) = (by(Method::Generator), by(Method::MonteCarlo)) else {
        return Vec::new();
    };
    let pairs = computed.densities.iter().zip(&sampled.densities);
    pairs
        .filter(|(density, _)| matches!(density.observable, Observable::Marginal(_)))
        .map(|(computed, sampled)| agreement(computed, sampled))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::Density;
    use crate::space::Axis;

    fn density(values: [f64; 4], errors: [f64; 4]) -> EstimatedDensity {
        EstimatedDensity {
            standard_error: errors.to_vec(),
            ..EstimatedDensity::new(
                Observable::Marginal(0),
                Density {
                    axes: vec![Axis::uniform(0.0, 4.0, 4).unwrap()],
                    values: values.to_vec(),
                },
            )
        }
    }

    #[test]
    fn bins_are_counted_by_three_standard_errors_and_the_grid_error() {
        let computed = density([0.3, 0.5, 0.2, 0.0], [0.0, 0.02, 0.0, 0.0]);
        let sampled = density([0.31, 0.45, 0.24, 0.04], [0.01; 4]);
        let found = agreement(&computed, &sampled);
        // One, five and four errors off; the grid error of 0.02 covers the second; the fourth is not known to a fifth.
        assert_eq!((found.bins, found.within, found.beyond), (3, 1, 1));
        // But what the generator is sure of must be there.
        let missed = agreement(&density([0.3, 0.4, 0.2, 0.1], [0.0; 4]), &sampled);
        assert_eq!(missed.bins, 4);
        assert!((found.worst - 5.0).abs() < 1e-12);
    }
}
