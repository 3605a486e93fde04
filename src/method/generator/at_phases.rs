//! Means and standard deviations of the axes at phases of a forcing.

use super::unknowns::by_schemes;
use crate::density::{EstimatedMoments, Moments, phase_factors, times};
use crate::method::MethodError;
use crate::method::ends::{self, AtEnds};
use crate::method::tails;
use crate::space::CellSpace;
use crate::system::Family;

/// A steady state over a whole period.
pub(super) struct OverPeriod<'a> {
    pub(super) space: &'a CellSpace,
    /// The generator's unknowns, Σ = 1; those of the second scheme.
    pub(super) unknowns: &'a [f64],
    pub(super) second: Option<&'a [f64]>,
    /// Sums of the unknowns that end at walls, and those of the second scheme.
    pub(super) weights: &'a [f64],
    pub(super) others: Option<&'a [f64]>,
    pub(super) masses: &'a [f64],
    /// Axes with coordinates of planes on which the derivative of the density jumps.
    pub(super) planes: &'a [(usize, f64)],
    /// Ends that nothing passes.
    pub(super) closed: &'a [[bool; 2]],
}

/// Harmonics that are left out to see what more of them would change: where a force has a symmetry, one of two
/// neighbours moves means alone, and the other deviations.
const LAST: usize = 2;

/// The moments in the order of the phases that are watched. Their errors are what the second scheme, the last harmonics
/// and cells at walls change, and what lies beyond the ends at that phase.
pub(super) fn moments_at_phases(
    family: &Family,
    over: &OverPeriod<'_>,
) -> Result<Vec<EstimatedMoments>, MethodError> {
    let Some(along) = family.model().phase_axis() else {
        return Ok(Vec::new());
    };
    let slice = Slice::new(over.space, along)?;
    let planes = over.planes.iter().filter(|plane| plane.0 != along);
    let planes = planes.map(|&(axis, at)| (slice.axis(axis), at));
    let planes: Vec<(usize, f64)> = planes.collect();
    let closed = over.closed.iter().enumerate();
    let closed = closed.filter(|(axis, _)| *axis != along);
    let closed: Vec<[bool; 2]> = closed.map(|(_, ends)| *ends).collect();
    let mut found = Vec::new();
    for (at, _) in family.at_phases() {
        let axis = slice.axis(at.axis);
        let factors =
            [0, LAST].map(|left_out| phase_factors(over.space, along, at.phase, left_out));
        let of = |weights: &[f64], second: Option<&[f64]>, factors: &[f64]| {
            let here = slice.of(&times(weights, factors));
            let second = second.map(|second| slice.of(&times(second, factors)));
            by_schemes(&slice.space, &here, second.as_deref(), &planes)
        };
        let all = of(over.weights, over.others, &factors[0]);
        let own = all[axis];
        let change = |other: EstimatedMoments| Moments {
            mean: (other.moments.mean - own.moments.mean).abs(),
            standard_deviation: (other.moments.standard_deviation - own.moments.standard_deviation)
                .abs(),
        };
        let fewer = change(of(over.weights, None, &factors[1])[axis]);
        let plain = change(of(over.unknowns, over.second, &factors[0])[axis]);
        let masses = slice.of(&times(over.masses, &factors[0]));
        let ends = tails::tails(&slice.space, &masses, &closed);
        let ends = AtEnds::new(&slice.space, &masses, &ends);
        let ends = ends::beyond(&slice.space, (&ends, 0.0), &all).of(axis, &own.moments);
        found.push(own.with(fewer).with(plain).with(ends));
    }
    Ok(found)
}

/// The cells of all axes but one, over which masses are summed.
struct Slice {
    space: CellSpace,
    along: usize,
    /// Cells along that axis, and those of all later axes.
    count: usize,
    stride: usize,
}

impl Slice {
    fn new(space: &CellSpace, along: usize) -> Result<Self, MethodError> {
        let axes = space.axes().iter().enumerate();
        let axes = axes.filter(|(axis, _)| *axis != along);
        let shape = space.shape();
        Ok(Self {
            space: CellSpace::new(axes.map(|(_, axis)| axis.clone()).collect())?,
            along,
            count: shape[along],
            stride: shape[along + 1..].iter().product(),
        })
    }

    /// The number of an axis among those that are left.
    fn axis(&self, axis: usize) -> usize {
        axis - usize::from(axis > self.along)
    }

    fn of(&self, masses: &[f64]) -> Vec<f64> {
        let blocks = masses.chunks_exact(self.count * self.stride);
        let sums = blocks.flat_map(|block| {
            (0..self.stride)
                .map(move |inner| block.iter().skip(inner).step_by(self.stride).sum::<f64>())
        });
        sums.collect()
    }
}
