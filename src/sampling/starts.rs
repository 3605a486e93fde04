//! Where the trajectories of a cell start: stratified in every axis and antithetic.
//!
//! Each group of samples is a randomly shifted rank-1 lattice and its mirror image about the cell's centre. Every
//! start alone is uniform in the cell; together the points of a lattice fall one in each of as many equal strata
//! of every axis, so a group is well spread by itself and groups are independent.

use multiversion::multiversion;

use crate::MAX_DIMENSION;
use crate::sampling::random::{mix, unit};

/// 1/φ_k, 1/φ_k², … of the generalised golden ratio φ_k (φ^(k+1) = φ + 1) for k = 1, 2, 3: the multipliers of
/// axes after the first in 2, 3 and 4 dimensions, which keep the lattice far from planes.
const MULTIPLIERS: [&[f64]; MAX_DIMENSION] = [
    &[],
    &[0.618_033_988_749_895],
    &[0.754_877_666_246_693, 0.569_840_290_998_053],
    &[
        0.819_172_513_396_165,
        0.671_043_606_703_789,
        0.549_700_477_901_970,
    ],
];

/// Starts for any group size of one run: the stratum of each sample on each axis, the same of both of a pair.
#[derive(Debug, Clone)]
pub(crate) struct StartLattice {
    /// Points of the lattice, and strata of an axis.
    points: f64,
    strata: Vec<Vec<f64>>,
}

/// By how much the lattice of a group is shifted, an axis.
pub(crate) type Shift = [f64; MAX_DIMENSION];

/// The shift of the lattice of a cell's group, to which `key` belongs.
pub(crate) fn shift(key: u64) -> Shift {
    std::array::from_fn(|axis| unit(mix(key.wrapping_add(axis as u64))))
}

impl StartLattice {
    /// A lattice for `samples` starts, mirror images included, in `dimension` axes.
    pub(crate) fn new(samples: usize, dimension: usize) -> Self {
        let points = samples.div_ceil(2).max(1);
        let mut generators = [1; MAX_DIMENSION];
        let multipliers = MULTIPLIERS[dimension.clamp(1, MAX_DIMENSION) - 1];
        for (generator, multiplier) in generators[1..].iter_mut().zip(multipliers) {
            *generator = coprime_near((multiplier * points as f64).round() as usize, points);
        }
        // Generators are coprime to the number of points: every stratum has one.
        let of_axis = |generator: &usize| -> Vec<f64> {
            let strata = (0..points).map(|point| point * generator % points);
            strata.flat_map(|stratum| [stratum as f64; 2]).collect()
        };
        Self {
            points: points as f64,
            strata: generators.iter().map(of_axis).collect(),
        }
    }

    /// Coordinate in [0, 1) of a group's sample on one axis.
    pub(crate) fn coordinate(&self, shift: &Shift, sample: usize, axis: usize) -> f64 {
        let mut coordinate = [0.0];
        self.place(shift, sample, axis, &mut coordinate);
        coordinate[0]
    }

    /// Coordinates in [0, 1) on one axis of a group's samples from number `first` on. Samples 2i and 2i + 1 are mirror
    /// images of each other.
    pub(super) fn place(&self, shift: &Shift, first: usize, axis: usize, coordinates: &mut [f64]) {
        let strata = &self.strata[axis][first..first + coordinates.len()];
        place(strata, shift[axis], self.points, first, coordinates);
    }
}

#[multiversion(targets = "simd")]
fn place(strata: &[f64], shift: f64, points: f64, first: usize, coordinates: &mut [f64]) {
    for (index, (stratum, coordinate)) in strata.iter().zip(coordinates).enumerate() {
        let place = (stratum + shift) / points;
        let is_image = (first + index) & 1 == 1;
        *coordinate = if is_image { 1.0 - place } else { place };
    }
}

/// The number nearest to `wanted` in [1, points] that has no factor in common with `points`.
fn coprime_near(wanted: usize, points: usize) -> usize {
    let near = (0..=points).flat_map(|off| [wanted.saturating_sub(off), wanted + off]);
    near.filter(|&number| (1..=points).contains(&number))
        .find(|&number| num_integer::gcd(number, points) == 1)
        .unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coordinate of one sample.
    fn coordinate(lattice: &StartLattice, key: u64, sample: usize, axis: usize) -> f64 {
        lattice.coordinate(&shift(key), sample, axis)
    }

    #[test]
    fn every_axis_is_stratified_and_pairs_mirror() {
        for (samples, dimension) in [(250, 2), (63, 3), (16, 4), (2, 2), (1, 1)] {
            let lattice = StartLattice::new(samples, dimension);
            let points = samples.div_ceil(2);
            for axis in 0..dimension {
                let start = |sample| coordinate(&lattice, 99, sample, axis);
                let strata = (0..points).map(|i| (start(2 * i) * points as f64) as usize);
                let mut strata: Vec<usize> = strata.collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..points).collect::<Vec<_>>());
                for pair in 0..samples / 2 {
                    assert!((start(2 * pair) + start(2 * pair + 1) - 1.0).abs() < 1e-15);
                }
            }
        }
    }

    #[test]
    fn the_plane_is_covered_evenly() {
        // Each of 5×5 boxes should hold 250/25 = 10 of a group's starts; independent ones scatter by ±3.2,
        // so that some box of 25 would be off by 6 or more.
        let lattice = StartLattice::new(250, 2);
        for key in 0..20 {
            let mut counts = [0_i32; 25];
            for sample in 0..250 {
                let at = |axis| (coordinate(&lattice, mix(key), sample, axis) * 5.0) as usize;
                counts[(at(0) * 5 + at(1)).min(24)] += 1;
            }
            assert!(
                counts.iter().all(|count| (count - 10).abs() <= 4),
                "{counts:?}"
            );
        }
    }

    #[test]
    fn one_start_is_uniform_over_keys() {
        let lattice = StartLattice::new(100, 2);
        let starts = (0..4000).map(|key| coordinate(&lattice, mix(key), 7, 1));
        // The shift alone is random: a start is uniform in its stratum of width 1/50.
        let place: Vec<f64> = starts.map(|start| (start * 50.0).fract()).collect();
        let mean = place.iter().sum::<f64>() / 4000.0;
        assert!(
            (mean - 0.5).abs() < 5.0 / f64::sqrt(12.0 * 4000.0),
            "{mean}"
        );
    }
}
