//! Numbers of a generator's unknowns, which are masses of cells or of modes.

use crate::density::{EstimatedMoments, Moments, Roughness};
use crate::generator::unknown_moments;
use crate::method::watched::differences;
use crate::space::CellSpace;
use crate::system::System;

/// Masses of the cells of the other axes. The values at the nodes of a series, which may be negative where the density
/// is nothing, are the masses of no cells.
pub(super) fn summed_over_modes(space: &CellSpace, masses: &[f64]) -> Vec<f64> {
    let mut summed = masses.to_vec();
    let mut stride = 1;
    for axis in space.axes().iter().rev() {
        if axis.is_modes() {
            let blocks = summed.chunks_exact(stride * axis.count());
            let sum = |block: &[f64], inner| block.iter().skip(inner).step_by(stride).sum::<f64>();
            summed = blocks
                .flat_map(|block| (0..stride).map(move |inner| sum(block, inner)))
                .collect();
        } else {
            stride *= axis.count();
        }
    }
    summed
}

/// Σ |min(mass, 0)|.
pub(super) fn negative_mass(masses: &[f64]) -> f64 {
    masses.iter().map(|mass| (-mass).max(0.0)).sum()
}

/// Moments of the axes from the unknowns, which are free of the h²/6 that moments of cell masses have. Their errors are
/// what the unknowns of a second scheme change; unknown without them.
pub(super) fn by_schemes(
    space: &CellSpace,
    unknowns: &[f64],
    second: Option<&[f64]>,
    planes: &[(usize, f64)],
) -> Vec<EstimatedMoments> {
    let own = moments_of(space, unknowns);
    let Some(second) = second else {
        return own.into_iter().map(EstimatedMoments::unjudged).collect();
    };
    let others = moments_of(space, second);
    let differences = differences(unknowns, second);
    let estimated = own.into_iter().zip(&others).zip(space.axes()).enumerate();
    let estimated = estimated.map(|(index, ((own, other), axis))| {
        let positions = space.positions(index);
        let values: Vec<f64> = positions.map(|position| axis.nodes()[position]).collect();
        let roughness = Roughness {
            space,
            weights: unknowns,
            differences: &differences,
            planes,
        };
        let more = roughness.of_moments(&values, &own);
        EstimatedMoments::by_difference(own, std::slice::from_ref(other)).with(more)
    });
    estimated.collect()
}

/// Moments of sums that end at walls, with the error of the cells there: fluxes beside a wall are of second order.
///
/// So is what the sums change that do not end at walls, which is taken for the error of both moments. Along an axis
/// without walls the equations say more: d⟨y⟩/dt and d⟨y²⟩/dt are zero, and what is left of them over a relaxation
/// time is an error too.
pub(super) fn with_walls(
    all: Vec<EstimatedMoments>,
    (system, space): (&dyn System, &CellSpace),
    (unknowns, weights): (&[f64], &[f64]),
    relaxation: Option<f64>,
) -> Vec<EstimatedMoments> {
    let left = imbalances(&all, (system, space), weights);
    let pairs = all.into_iter().zip(moments_of(space, unknowns)).zip(left);
    let wider = pairs.enumerate().map(|(axis, ((own, plain), left))| {
        let is_walled = system.facts().reflecting.contains_key(&axis);
        let [mean, square] = match is_walled {
            true => [0.0; 2],
            false => left.over(relaxation),
        };
        let deviation = own.moments.standard_deviation;
        own.with(Moments {
            mean: (own.moments.mean - plain.mean).abs() + mean,
            standard_deviation: (deviation - plain.standard_deviation).abs()
                + 0.5 * square / deviation.max(f64::MIN_POSITIVE),
        })
    });
    wider.collect()
}

/// What is left of the balance of an axis, and how fast its coordinate moves over the range that it takes.
#[derive(Default, Clone, Copy)]
struct Imbalance {
    mean: f64,
    square: f64,
    rate: f64,
}

impl Imbalance {
    /// Errors of mean and variance, for a relaxation time that is known or else for the axis's own.
    fn over(self, relaxation: Option<f64>) -> [f64; 2] {
        let time = relaxation.unwrap_or(1.0 / self.rate);
        [self.mean.abs() * time, 0.5 * self.square.abs() * time]
    }
}

/// ⟨f⟩ and ⟨2 (y - m) f + b²⟩ of every axis y of drift f and noise b, with the rate √(⟨f²⟩/⟨(y - m)²⟩).
fn imbalances(
    all: &[EstimatedMoments],
    (system, space): (&dyn System, &CellSpace),
    weights: &[f64],
) -> Vec<Imbalance> {
    let total: f64 = weights.iter().sum();
    let mut left = vec![Imbalance::default(); space.dimension()];
    for (cell, weight) in weights.iter().enumerate() {
        let (state, share) = (space.node(cell), weight / total);
        let drift = system.drift_at(0.0, &state);
        for (axis, one) in left.iter_mut().enumerate() {
            let aside = state[axis] - all[axis].moments.mean;
            let noise = system.intensity_at(axis, 0.0, &state);
            one.mean += share * drift[axis];
            one.square += share * (2.0 * aside * drift[axis] + noise);
            one.rate += share * drift[axis] * drift[axis];
        }
    }
    for (one, known) in left.iter_mut().zip(all) {
        one.rate = one.rate.max(0.0).sqrt() / known.moments.standard_deviation;
    }
    left
}

/// The moments alone.
pub(super) fn moments_of(space: &CellSpace, unknowns: &[f64]) -> Vec<Moments> {
    unknown_moments(space, unknowns)
        .into_iter()
        .map(|(mean, variance)| Moments {
            mean,
            standard_deviation: variance.max(0.0).sqrt(),
        })
        .collect()
}
