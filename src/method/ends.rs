//! Errors of means and deviations by what lies beyond the ends of the ranges: of the axis that ends, of the others, and
//! of quantities. What leaves within one relaxation time is missing inside as well, and counts as beyond.

use super::beside_ends::{BesideEnd, beside_ends};
use super::tails::{Beyond, Tail};
use crate::density::{EstimatedMoments, Moments};
use crate::space::CellSpace;

/// What lies beyond the ends of the axes, for moments.
pub(super) struct Ends {
    /// Of each axis what lies beyond each end and the end's distance from the mean in standard deviations.
    axes: Vec<[(Beyond, f64); 2]>,
    /// Errors of the moments of each axis by what lies beyond the ends of the others.
    across: Vec<Moments>,
}

/// What is found at the ends of the axes.
#[derive(Debug, Clone, Default)]
pub(super) struct AtEnds {
    /// What may lie beyond them.
    pub(super) beyond: Vec<[Beyond; 2]>,
    /// The states next to them.
    pub(super) beside: Vec<[BesideEnd; 2]>,
}

impl AtEnds {
    /// From the tails there and the masses of all cells.
    pub(super) fn new(space: &CellSpace, mass: &[f64], tails: &[[Tail; 2]]) -> Self {
        Self {
            beyond: tails
                .iter()
                .map(|ends| ends.map(|end| end.beyond))
                .collect(),
            beside: beside_ends(space, mass),
        }
    }

    /// Errors of the moments of an axis by what lies beyond the ends of the others. What leaves is shared among the
    /// ends as what lies beyond them is. Where that falls as too small a power for a deviation, what an axis has of it
    /// shows in its own tail.
    fn across(
        &self,
        (space, leak): (&CellSpace, f64),
        estimated: &[EstimatedMoments],
        axis: usize,
    ) -> Moments {
        let own = &estimated[axis].moments;
        let whole: f64 = self.beyond.iter().flatten().map(|end| end.mass).sum();
        let mut errors = Moments {
            mean: 0.0,
            standard_deviation: 0.0,
        };
        let all = space.axes().iter().zip(&self.beyond).zip(&self.beside);
        let others = all.zip(estimated).enumerate();
        let others =
            others.filter(|(other, ((cells, _), _))| *other != axis && !cells.0.is_modes());
        for (other, (((cells, beyond), beside), estimated)) in others {
            let ends = beyond.iter().zip(beside).zip([cells.from(), cells.to()]);
            for ((beyond, beside), end) in ends.filter(|((beyond, _), _)| beyond.mass > 0.0) {
                let mass = beyond.mass + leak * beyond.mass / whole;
                let from = (other, estimated.moments.mean, end);
                let [mean, variance] = beside.differences((axis, own), from);
                let stretch = |order: i32| match beyond.stretch(order) {
                    stretch if stretch.is_finite() => stretch,
                    _ => 1.0,
                };
                errors.mean += mass * mean * stretch(1);
                errors.standard_deviation += 0.5 * mass * variance * stretch(2)
                    / own.standard_deviation.max(f64::MIN_POSITIVE);
            }
        }
        errors
    }
}

/// What lies beyond the ends, from what is found there, the share that leaves within one relaxation time, and the
/// moments of the axes, which come first among all.
pub(super) fn beyond(
    space: &CellSpace,
    (found, leak): (&AtEnds, f64),
    estimated: &[EstimatedMoments],
) -> Ends {
    let count = space.dimension().min(estimated.len());
    let across = (0..count).map(|axis| found.across((space, leak), estimated, axis));
    let across = across.collect();
    let found = &found.beyond;
    let axes = space.axes().iter().zip(found).zip(estimated);
    let axes = axes.map(|((axis, found), one)| {
        let distance = |end: f64| {
            let deviation = one.moments.standard_deviation.max(f64::MIN_POSITIVE);
            (end - one.moments.mean).abs() / deviation
        };
        // A series reaches beyond its outermost nodes.
        if axis.is_modes() {
            return [(Beyond::default(), 0.0); 2];
        }
        [(found[0], axis.from()), (found[1], axis.to())].map(|(mut beyond, end)| {
            beyond.mass += leak;
            (beyond, distance(end))
        })
    });
    Ends {
        axes: axes.collect(),
        across,
    }
}

impl Ends {
    /// Errors that it makes of the moments of an axis, or of a quantity, which is taken to grow as squares of the axes
    /// do. They are infinite where a density falls as too small a power.
    pub(super) fn of(&self, index: usize, moments: &Moments) -> Moments {
        let (ends, power): (Vec<(Beyond, f64)>, i32) = match self.axes.get(index) {
            Some(own) => (own.to_vec(), 1),
            None => (self.axes.iter().flatten().copied().collect(), 2),
        };
        let sum = |power: i32| -> f64 {
            let terms = ends
                .iter()
                .filter(|(beyond, distance)| beyond.mass > 0.0 && distance.is_finite())
                .map(|(beyond, distance)| {
                    beyond.mass * distance.powi(power) * beyond.stretch(power)
                });
            terms.sum()
        };
        let across = self.across.get(index);
        Moments {
            mean: moments.standard_deviation * sum(power) + across.map_or(0.0, |one| one.mean),
            standard_deviation: 0.5 * moments.standard_deviation * sum(2 * power)
                + across.map_or(0.0, |one| one.standard_deviation),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::tails::{share_told, tails};
    use crate::space::Axis;

    #[test]
    fn the_tail_of_an_exponential_density_is_found_and_its_moments_bounded() {
        // p = exp(-x) from the wall at 0 on, cut off at 6.
        let space = CellSpace::new(vec![Axis::uniform(0.0, 6.0, 24).unwrap()]).unwrap();
        let edges = space.axes()[0].edges().windows(2);
        let masses: Vec<f64> = edges
            .map(|edge| (-edge[0]).exp() - (-edge[1]).exp())
            .collect();
        let ends = tails(&space, &masses, &[[true, false]])[0];
        assert_eq!(ends[0], Tail::default(), "nothing is beyond a wall");
        let found = ends.map(|end| end.beyond);
        assert!((share_told() * found[1].mass / (-6.0_f64).exp() - 1.0).abs() < 1e-12);
        let total: f64 = masses.iter().sum();
        let inside: Vec<f64> = masses.iter().map(|mass| mass / total).collect();
        let own = crate::density::moments(&space, &inside).unwrap()[0];
        let found = AtEnds {
            beyond: vec![found],
            ..AtEnds::default()
        };
        let ends = beyond(&space, (&found, 0.0), &[EstimatedMoments::unjudged(own)]);
        let error = ends.of(0, &own);
        // Mean and deviation of the whole are 1. What is beyond lies farther out than the end.
        for (off, error) in [
            (1.0 - own.mean, error.mean),
            (1.0 - own.standard_deviation, error.standard_deviation),
        ] {
            assert!(off > 0.5 * error && off < 2.0 * error, "{off:e} {error:e}");
        }
    }
}
