//! What lies beyond the ends of the ranges: its mass from how the density falls near them, and what it would do to
//! means and deviations. What leaves within one relaxation time is missing inside as well, and counts as beyond.

use crate::density::{EstimatedMoments, Moments};
use crate::space::{Axis, CellSpace};

/// Distance from an open end, in lengths over which the density falls by e, from which on it falls as it would were
/// there no end: nearer to it what leaves is missing.
const FROM_END: f64 = 2.0;

/// Least number of times by which a density must fall by e over its axis for its fall to be gone on with: else it says
/// nothing of what is beyond the end.
const LEAST_FALL: f64 = 4.0;

/// How a density ends along one axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Tail {
    /// Mass in the outermost cells.
    pub(super) outer: f64,
    /// Mass beyond the end, were the density to go on falling as it does near it.
    pub(super) beyond: f64,
}

/// The tail at the first edge of cells of these widths.
fn tail(cells: &[(f64, f64)]) -> Tail {
    let outer = cells.first().map_or(0.0, |(mass, _)| *mass);
    let length: f64 = cells.iter().map(|(_, width)| width).sum();
    let mut edge = 0.0;
    let mut best = Tail {
        outer,
        beyond: outer.max(0.0),
    };
    for pair in cells.windows(2) {
        let ((mass, width), (next, next_width)) = (pair[0], pair[1]);
        let (outside, distance) = (edge, edge + 0.5 * width);
        edge += width;
        // Below zero there is nothing but wiggles of the scheme.
        if outer <= 0.0 || mass <= 0.0 || next <= 0.0 {
            continue;
        }
        let rate = (next / next_width / (mass / width)).ln() / (0.5 * (width + next_width));
        if rate * length < LEAST_FALL {
            break;
        }
        // The mass of a cell of an exponential density, and what follows of it beyond the end.
        best.beyond = mass / (rate * width).exp_m1() * (-rate * outside).exp();
        if rate * distance >= FROM_END {
            break;
        }
    }
    best
}

/// The tails at the ends of every axis from the masses of all cells; nothing at ends that are `closed`.
pub(super) fn tails(space: &CellSpace, mass: &[f64], closed: &[[bool; 2]]) -> Vec<[Tail; 2]> {
    let empty = |axis: &Axis| {
        (0..axis.count())
            .map(|cell| (0.0, axis.width(cell)))
            .collect()
    };
    let mut along: Vec<Vec<(f64, f64)>> = space.axes().iter().map(empty).collect();
    for (cell, &mass) in mass.iter().enumerate() {
        for (axis, cells) in along.iter_mut().enumerate() {
            cells[space.position(cell, axis)].0 += mass;
        }
    }
    let ends = along.into_iter().zip(closed).map(|(mut cells, closed)| {
        let lower = tail(&cells);
        cells.reverse();
        let mut ends = [lower, tail(&cells)];
        for (end, closed) in ends.iter_mut().zip(closed) {
            if *closed {
                *end = Tail::default();
            }
        }
        ends
    });
    ends.collect()
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
        let ends = tails(&space, &masses, &[[true, false]])[0];
        assert_eq!(ends[0], Tail::default(), "nothing is beyond a wall");
        let found = ends.map(|end| end.beyond);
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
    fn what_leaves_through_an_end_does_not_hide_what_is_beyond_it() {
        // A normal density to 4.2 deviations, and the same next to an end that takes what reaches it.
        let axis = Axis::uniform(-4.2, 4.2, 84).unwrap();
        let space = CellSpace::new(vec![axis.clone()]).unwrap();
        let whole = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
        let absorbed = |x: f64| whole(x) * (1.0 - (-4.2 * (4.2 - x)).exp());
        let beyond = |of: &dyn Fn(f64) -> f64| {
            let masses: Vec<f64> = axis.centres().into_iter().map(|x| 0.1 * of(x)).collect();
            tails(&space, &masses, &[[true, false]])[0][1].beyond
        };
        // The mass beyond 4.2 deviations.
        let exact = 1.334_6e-5;
        // An exponential from 0.65 deviations inside, where the normal density falls by 3.5 a deviation, is too high by
        // exp(0.65²/2) and by 4.4/3.5. Of what the end takes exp(-2) is missing there, and the fall is steeper for it.
        let found = beyond(&whole) / exact;
        assert!(found > 1.3 && found < 1.7, "{found}");
        let found = beyond(&absorbed) / exact;
        assert!(found > 0.5 && found < 1.3, "{found}");
    }

    #[test]
    fn a_density_that_rises_toward_its_end_may_go_on() {
        assert_eq!(tail(&[(0.2, 1.0), (0.1, 1.0)]).beyond, 0.2);
        assert_eq!(tail(&[(0.0, 1.0), (0.1, 1.0)]).beyond, 0.0);
        assert_eq!(tail(&[(-0.1, 1.0), (0.1, 1.0)]).beyond, 0.0);
        assert_eq!(tail(&[(0.1, 1.0), (-0.1, 1.0)]).beyond, 0.1);
    }
}
