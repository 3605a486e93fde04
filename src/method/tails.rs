//! What lies beyond the ends of the ranges: its mass from how that of the outermost cells falls, and what it would do
//! to means and deviations. What leaves within one relaxation time is missing inside as well, and counts as beyond.

use crate::density::{EstimatedMoments, Moments};
use crate::space::CellSpace;

/// Largest ratio of the masses of neighbouring layers that is gone on with: a density that does not fall toward the
/// end says nothing of what is beyond it.
const SLOWEST: f64 = 0.9;

/// Masses of the two outermost layers of cells at an end of an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Layers {
    pub(super) outer: f64,
    inner: f64,
}

impl Layers {
    /// Mass beyond the end, were the density to fall as it does over the last cells: a geometric series.
    pub(super) fn beyond(self) -> f64 {
        if self.outer <= 0.0 {
            return 0.0;
        }
        let ratio = self.outer / self.inner.max(self.outer);
        let ratio = ratio.min(SLOWEST);
        self.outer * ratio / (1.0 - ratio)
    }
}

/// The layers at the ends of every axis from the masses of all cells; nothing at ends that are `closed`.
pub(super) fn layers(space: &CellSpace, mass: &[f64], closed: &[[bool; 2]]) -> Vec<[Layers; 2]> {
    let mut found = vec![[Layers::default(); 2]; space.dimension()];
    for (cell, &mass) in mass.iter().enumerate() {
        for (axis, ends) in found.iter_mut().enumerate() {
            let position = space.position(cell, axis);
            let from_end = [position, space.axes()[axis].count() - 1 - position];
            for (end, place) in from_end.into_iter().enumerate() {
                match place {
                    _ if closed[axis][end] => {}
                    0 => ends[end].outer += mass,
                    1 => ends[end].inner += mass,
                    _ => {}
                }
            }
        }
    }
    found
}

/// What lies beyond the ends of the axes, for moments.
pub(super) struct Ends {
    /// Of each axis the mass beyond each end and the end's distance from the mean in standard deviations.
    axes: Vec<[(f64, f64); 2]>,
}

/// What lies beyond the ends, from its mass, the share that leaves within one relaxation time, and the moments of the
/// axes, which come first among all.
pub(super) fn beyond(
    space: &CellSpace,
    (masses, leak): (&[[f64; 2]], f64),
    estimated: &[EstimatedMoments],
) -> Ends {
    let axes = space.axes().iter().zip(masses).zip(estimated);
    let axes = axes.map(|((axis, masses), one)| {
        let distance = |end: f64| {
            let deviation = one.moments.standard_deviation.max(f64::MIN_POSITIVE);
            (end - one.moments.mean).abs() / deviation
        };
        // A series reaches beyond its outermost nodes.
        match axis.is_modes() {
            true => [(0.0, 0.0); 2],
            false => [
                (masses[0] + leak, distance(axis.from())),
                (masses[1] + leak, distance(axis.to())),
            ],
        }
    });
    Ends {
        axes: axes.collect(),
    }
}

impl Ends {
    /// Errors that it makes of the moments of an axis, or of a quantity, which is taken to grow as squares of the axes
    /// do.
    pub(super) fn of(&self, index: usize, moments: &Moments) -> Moments {
        let (ends, power): (Vec<(f64, f64)>, i32) = match self.axes.get(index) {
            Some(own) => (own.to_vec(), 1),
            None => (self.axes.iter().flatten().copied().collect(), 2),
        };
        let sum = |power: i32| -> f64 {
            let terms = ends
                .iter()
                .map(|(mass, distance)| mass * distance.powi(power));
            terms.filter(|term| term.is_finite()).sum()
        };
        Moments {
            mean: moments.standard_deviation * sum(power),
            standard_deviation: 0.5 * moments.standard_deviation * sum(2 * power),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;

    #[test]
    fn the_tail_of_an_exponential_density_is_found_and_its_moments_bounded() {
        // p = exp(-x) from the wall at 0 on, cut off at 6.
        let space = CellSpace::new(vec![Axis::uniform(0.0, 6.0, 24).unwrap()]).unwrap();
        let edges = space.axes()[0].edges().windows(2);
        let masses: Vec<f64> = edges
            .map(|edge| (-edge[0]).exp() - (-edge[1]).exp())
            .collect();
        let layers = layers(&space, &masses, &[[true, false]]);
        let found = layers[0].map(Layers::beyond);
        assert_eq!(found[0], 0.0, "nothing is beyond a wall");
        assert!((found[1] / (-6.0_f64).exp() - 1.0).abs() < 1e-12);
        let total: f64 = masses.iter().sum();
        let inside: Vec<f64> = masses.iter().map(|mass| mass / total).collect();
        let own = crate::density::moments(&space, &inside).unwrap()[0];
        let ends = beyond(&space, (&[found], 0.0), &[EstimatedMoments::unjudged(own)]);
        let error = ends.of(0, &own);
        // Mean and deviation of the whole are 1. What is beyond lies farther out than the end.
        for (off, error) in [
            (1.0 - own.mean, error.mean),
            (1.0 - own.standard_deviation, error.standard_deviation),
        ] {
            assert!(off > 0.5 * error && off < 2.0 * error, "{off:e} {error:e}");
        }
    }

    #[test]
    fn a_density_that_rises_toward_its_end_may_go_on_for_long() {
        let rising = Layers {
            outer: 0.2,
            inner: 0.1,
        };
        assert!((rising.beyond() - 1.8).abs() < 1e-12);
        assert_eq!(Layers::default().beyond(), 0.0);
    }
}
