//! Decay of the last harmonics of an angle that no noise blurs.
//!
//! Advection passes a density on from each harmonic to the next. Where a series ends it would be reflected, so that the
//! first harmonics depend on where that is. Here harmonic k of K decays at S (k/K)^8: the last ones are absorbed, the
//! first ones are left alone, and the mean is not touched. Source: E. Tadmor, Convergence of spectral methods for
//! nonlinear conservation laws, SIAM J. Numer. Anal. 26 (1989) 30-44; C. Canuto et al., *Spectral Methods*, 2006.

use std::f64::consts::TAU;

use sprs::{CsMat, TriMat};

use super::Generator;
use crate::space::CellSpace;

/// Power of k/K.
const ORDER: i32 = 8;

/// Adds to a generator on a space whose last axis is an angle with harmonics that the last of them decays at this rate.
pub(crate) fn add_spectral_viscosity(generator: &mut Generator, space: &CellSpace, rate: f64) {
    let (cells, axes) = (space.n_cells(), space.axes());
    let Some(count) = axes.last().map(|angle| angle.count()) else {
        return;
    };
    let last = count / 2;
    // What a node gives to the one so many further on; over all of them these sum to zero.
    let given = |distance: usize| -> f64 {
        let terms = (1..=last).map(|k| {
            let wave = (TAU * (k * distance) as f64 / count as f64).cos();
            (k as f64 / last as f64).powi(ORDER) * wave
        });
        -2.0 * rate / count as f64 * terms.sum::<f64>()
    };
    let given: Vec<f64> = (0..count).map(given).collect();
    let mut decay = TriMat::with_capacity((cells, cells), count * cells);
    for from in 0..cells {
        let (node, first) = (from % count, from - from % count);
        for other in 0..count {
            decay.add_triplet(first + other, from, given[node.abs_diff(other)]);
        }
    }
    let decay: CsMat<f64> = decay.to_csc();
    generator.matrix = &generator.matrix + &decay;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;

    #[test]
    fn the_last_harmonic_decays_at_the_rate_and_the_others_by_their_power() {
        let axes = vec![
            Axis::uniform(-1.0, 1.0, 2).unwrap(),
            Axis::fourier(0.0, 1.0, 4).unwrap(),
        ];
        let space = CellSpace::new(axes).unwrap();
        let mut generator = Generator {
            matrix: TriMat::new((18, 18)).to_csc(),
            escape: vec![0.0; 18],
        };
        add_spectral_viscosity(&mut generator, &space, 3.0);
        for (k, rate) in [(0, 0.0), (1, 3.0 / 65536.0), (2, 3.0 / 256.0), (4, 3.0)] {
            let wave = |node: usize| (TAU * (k * (node % 9)) as f64 / 9.0 + 0.3).cos();
            let mut change = [0.0; 18];
            for (&entry, (to, from)) in &generator.matrix {
                change[to] += entry * wave(from);
            }
            for (to, change) in change.into_iter().enumerate() {
                assert!((change + rate * wave(to)).abs() < 1e-13, "{k} {to}");
            }
        }
    }
}
