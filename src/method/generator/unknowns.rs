//! Numbers of a generator's unknowns, which are masses of cells or of modes.

use crate::density::{EstimatedMoments, Moments, Roughness};
use crate::generator::unknown_moments;
use crate::method::watched::differences;
use crate::space::CellSpace;

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

/// Σ |a - b|.
pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
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

/// The moments alone.
fn moments_of(space: &CellSpace, unknowns: &[f64]) -> Vec<Moments> {
    unknown_moments(space, unknowns)
        .into_iter()
        .map(|(mean, variance)| Moments {
            mean,
            standard_deviation: variance.max(0.0).sqrt(),
        })
        .collect()
}
