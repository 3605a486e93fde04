//! What a sweep will cost: memory and work of one point, and the machine's memory.
//!
//! SGCM, memory of one point. A transition takes 8 bytes for its probability, 8 for its row, and a 2-byte count for
//! each replicate, with slope correction 4 bytes more a replicate and axis; a cell takes 8 vectors of 8 bytes in the solver and one more for each replicate. The
//! trajectories of a cell end in at most `samples` cells, and in at most all of them; the image of a box
//! generally overlaps at least 2^d boxes. The solver's coarser levels at most double the transitions.
//!
//! Monte Carlo: 32 blocks, each with a count and then a replicate's mass a cell.
//!
//! Generator: a stencil holds 2 reach + 1 rates along each axis, 16 bytes each, in up to four matrices (Q, dQ/dθ, the
//! second scheme, the one kept for sensitivities); the factors come from the elimination order itself.

use crate::MAX_DIMENSION;
use crate::method::{
    Correction, Estimator, GeneratorMethodOptions, MethodOptions, MonteCarloOptions, SgcmOptions,
    StepChoice,
};
use crate::monte_carlo::BLOCKS;
use crate::space::CellSpace;
use crate::stationary::generator::{Estimate, RateError, estimate};

/// Bytes a transition takes.
fn transition_bytes(options: &SgcmOptions, dimension: usize) -> f64 {
    let starts = match options.correction {
        Correction::Slope => 4.0 * dimension as f64,
        Correction::None => 0.0,
    };
    2.0 * 16.0 + (2.0 + starts) * options.replicates as f64
}

/// Bytes a cell takes beside its transitions.
fn cell_bytes(options: &SgcmOptions, dimension: usize) -> f64 {
    // Moments of the end points by start, 11 numbers an axis, and slopes.
    let corrected = match options.correction {
        Correction::Slope => 11.0 * dimension as f64 + 2.0 * MAX_DIMENSION as f64,
        Correction::None => 0.0,
    };
    8.0 * (8.0 + options.replicates as f64 + corrected)
}

/// Upper bound of the bytes at work at one point: every sample of a cell ends in a cell of its own.
pub fn estimated_bytes(n_cells: f64, dimension: usize, options: &SgcmOptions) -> f64 {
    let reached = n_cells.min(options.samples as f64);
    let transition = transition_bytes(options, dimension);
    n_cells * (reached * transition + cell_bytes(options, dimension))
}

/// Bytes at work at one point by SGCM with so many entries of the transition matrix, counted, in so many cells.
pub fn sgcm_bytes(
    transitions: usize,
    cells: usize,
    dimension: usize,
    options: &SgcmOptions,
) -> f64 {
    let transition = transition_bytes(options, dimension);
    transitions as f64 * transition + cells as f64 * cell_bytes(options, dimension)
}

/// Lower bound of the bytes at work at one point: by SGCM every cell reaches 2^d cells, d = `dimension`; by the
/// generator the matrices alone.
pub fn least_bytes(n_cells: f64, dimension: usize, method: &MethodOptions) -> f64 {
    match method {
        MethodOptions::Generator(options) => matrix_bytes(n_cells, dimension, options),
        MethodOptions::Sgcm(options) => {
            let image = 2_f64.powi(dimension as i32);
            let reached = n_cells.min(options.samples as f64).min(image);
            let transition = transition_bytes(options, dimension);
            n_cells * (reached * transition + cell_bytes(options, dimension))
        }
        MethodOptions::MonteCarlo(_) => monte_carlo_bytes(n_cells),
    }
}

/// Bytes at work at one point by Monte Carlo: a count and a replicate's mass for each cell and block.
pub fn monte_carlo_bytes(n_cells: f64) -> f64 {
    n_cells * 16.0 * BLOCKS as f64
}

/// Integrator steps at one point by Monte Carlo, where all that they depend on is given.
pub fn monte_carlo_steps(options: &MonteCarloOptions) -> Option<f64> {
    let given = |choice: StepChoice| match choice {
        StepChoice::Fixed(value) => Some(value),
        StepChoice::Auto => None,
    };
    let length = match options.estimator {
        Estimator::Ergodic => given(options.length)?,
        Estimator::Ensemble => 0.0,
    };
    let time = given(options.burn_in)? + length;
    Some(given(options.trajectories)? * time / given(options.time_step)?)
}

/// Bytes of the sparse matrices of the generator.
fn matrix_bytes(n_cells: f64, dimension: usize, options: &GeneratorMethodOptions) -> f64 {
    let rates = dimension * 2 * options.scheme.reach() + 1;
    4.0 * 16.0 * n_cells * rates as f64
}

/// Which factorisation the generator will use, its memory and work.
///
/// # Errors
/// [`RateError::Memory`] when not even the smallest fits the limit.
pub fn factorisation(
    space: &CellSpace,
    options: &GeneratorMethodOptions,
) -> Result<Estimate, RateError> {
    let reach = vec![options.scheme.reach(); space.dimension()];
    estimate(space, &reach, (options.memory_limit * 1e9) as u64, None)
}

/// Bytes at work at one point by the generator: the matrices, and factors and fronts at their peak.
pub fn generator_bytes(
    space: &CellSpace,
    options: &GeneratorMethodOptions,
    factors: &Estimate,
) -> f64 {
    matrix_bytes(space.n_cells() as f64, space.dimension(), options) + factors.peak_bytes as f64
}

/// Memory of the machine, or of the group of processes where that is limited; `None` if unknown.
pub fn machine_memory() -> Option<f64> {
    let mut system = sysinfo::System::new().ok()?;
    system.refresh_memory();
    let limit = system.cgroup_limits().map(|limits| limits.total_memory);
    let total = system.total_memory();
    let memory = limit
        .filter(|&limit| limit > 0)
        .map_or(total, |limit| limit.min(total));
    (memory > 0).then_some(memory as f64)
}

/// A number of bytes as people write it.
pub fn bytes_in_words(bytes: f64) -> String {
    let units = ["kB", "MB", "GB", "TB", "PB"];
    let mut value = bytes / 1e3;
    let mut unit = 0;
    while value >= 1e3 && unit + 1 < units.len() {
        value /= 1e3;
        unit += 1;
    }
    format!("{value:.1} {}", units[unit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_enclose_and_grow_with_cells_and_samples() {
        let options = SgcmOptions::default();
        let more = SgcmOptions {
            samples: 2 * options.samples,
            ..options.clone()
        };
        for n_cells in [4.0, 2500.0, 1e6] {
            let (least, most) = (
                least_bytes(n_cells, 2, &MethodOptions::Sgcm(options.clone())),
                estimated_bytes(n_cells, 2, &options),
            );
            assert!(least <= most);
            assert!(estimated_bytes(2.0 * n_cells, 2, &options) >= 2.0 * most);
            assert!(estimated_bytes(n_cells, 2, &more) >= most);
        }
        // 10 cells, 10 transitions each at most: 10·(10·48 + 128) bytes with 8 replicates.
        let options = SgcmOptions {
            correction: Correction::None,
            ..options
        };
        assert_eq!(estimated_bytes(10.0, 2, &options), 6080.0);
        // Slopes: 2·4 bytes more a replicate and transition, 8·(2·11 + 8) a cell.
        let corrected = SgcmOptions {
            correction: Correction::Slope,
            ..options.clone()
        };
        assert_eq!(
            estimated_bytes(10.0, 2, &corrected),
            6080.0 + 10.0 * (10.0 * 64.0 + 240.0)
        );
        let method = MethodOptions::Sgcm(options);
        assert_eq!(least_bytes(10.0, 2, &method), 10.0 * (4.0 * 48.0 + 128.0));
    }

    #[test]
    fn bytes_are_written_with_a_unit() {
        assert_eq!(bytes_in_words(1.5e9), "1.5 GB");
        assert_eq!(bytes_in_words(2.0e21), "2000000.0 PB");
        assert_eq!(bytes_in_words(12.0), "0.0 kB");
    }
}
