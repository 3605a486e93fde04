//! What lies beyond the ends of the ranges: its mass, and how it goes on, from how the density falls near them.

use crate::space::{Axis, CellSpace};

/// Distance from an open end, in lengths over which the density falls by e, from which on it falls as it would were
/// there no end, but for a share of exp(-2): nearer to it what leaves is missing.
const FROM_END: f64 = 2.0;

/// Cells between an end and the one whose density is hardly thinned out by what leaves.
const CELLS_FROM_END: usize = 2;

/// Share of the density that is there at that distance.
pub(super) fn share_told() -> f64 {
    1.0 - (-FROM_END).exp()
}

/// Least power of the distance from the mean with which a density must fall at an end for its fall to be gone on with:
/// a slower fall says nothing of what is beyond the end.
const LEAST_POWER: f64 = 2.0;

/// How a density ends along one axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Tail {
    /// Mass in the outermost cells.
    pub(super) outer: f64,
    /// The density beside the end, before what leaves thins it out, over the largest along the axis.
    pub(super) level: f64,
    /// What lies beyond the end, were the density to go on falling as it does near it.
    pub(super) beyond: Beyond,
}

/// What lies beyond an end.
///
/// There p = p(D) exp(-ν (t^g - 1)/g) is assumed, with t the distance from the mean in units of the end's distance D:
/// an exponential is g = 1, a power law t^-ν is g → 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Beyond {
    pub(super) mass: f64,
    /// Power ν = -d ln p/d ln t at the end.
    power: f64,
    /// How the power grows outward, g, from 0 to 1. What falls faster than an exponential counts as one.
    growth: f64,
}

impl Default for Beyond {
    fn default() -> Self {
        Self {
            mass: 0.0,
            power: f64::INFINITY,
            growth: 1.0,
        }
    }
}

impl Beyond {
    /// Mean of t^order over what lies beyond the end; infinite where the power is too small for it to exist.
    ///
    /// It is exact for a power law, and of first order in 1/ν for an exponential.
    pub(super) fn stretch(&self, order: i32) -> f64 {
        let order = f64::from(order);
        let rest = self.power - (1.0 - self.growth) * (order + 1.0);
        if rest > 0.0 {
            1.0 + order / rest
        } else {
            f64::INFINITY
        }
    }

    /// The power with which the density falls, if too slowly for a standard deviation to exist or to be known.
    pub(super) fn heavy(&self) -> Option<f64> {
        (self.mass > 0.0 && self.stretch(2).is_infinite()).then_some(self.power)
    }
}

/// The density along an axis, seen from one of its ends: mass and width of each cell from the end inward, and the
/// distance from the end to the mean.
struct Inward {
    cells: Vec<(f64, f64)>,
    depth: f64,
}

impl Inward {
    fn new(cells: Vec<(f64, f64)>) -> Self {
        let (mut edge, mut whole, mut first) = (0.0, 0.0, 0.0);
        for &(mass, width) in &cells {
            whole += mass;
            first += mass * (edge + 0.5 * width);
            edge += width;
        }
        Self {
            cells,
            depth: first / whole,
        }
    }

    /// For every face from the end inward its distance to the end and the rate with which the density falls outward
    /// there; none beside cells with no mass, where there is nothing but wiggles of the scheme.
    fn falls(&self) -> impl Iterator<Item = (f64, Option<f64>)> {
        self.cells.windows(2).scan(0.0, |edge, pair| {
            let ((mass, width), (next, next_width)) = (pair[0], pair[1]);
            *edge += width;
            let is_known = mass > 0.0 && next > 0.0;
            let rate = (next / next_width / (mass / width)).ln() / (0.5 * (width + next_width));
            Some((*edge, is_known.then_some(rate)))
        })
    }

    /// How the power of the fall grows from half way between the mean and a face outward to that face, where it is
    /// `power`: 2^g times. What looks slower than an exponential is believed to be it by half.
    fn growth(&self, face: f64, power: f64) -> f64 {
        let half = 0.5 * (self.depth + face);
        let there = self.falls().find(|(distance, _)| *distance >= half);
        let inner = there.and_then(|(distance, rate)| Some(rate? * (self.depth - distance)));
        match inner {
            Some(inner) if inner > 0.0 => (2.0 * (power / inner).log2() - 1.0).clamp(0.0, 1.0),
            // Between peaks nothing is told of how their sides fall.
            _ => 1.0,
        }
    }

    /// The density of the third cell from the end over the largest one.
    fn level(&self) -> f64 {
        let density = |&(mass, width): &(f64, f64)| (mass / width).max(0.0);
        let largest = self.cells.iter().map(density).fold(0.0, f64::max);
        let beside = self.cells.get(CELLS_FROM_END).or(self.cells.last());
        let beside = beside.map_or(0.0, density);
        if largest > 0.0 { beside / largest } else { 0.0 }
    }

    fn tail(&self) -> Tail {
        let level = self.level();
        let outer = self.cells.first().map_or(0.0, |(mass, _)| *mass);
        let mut beyond = Beyond {
            mass: outer.max(0.0),
            ..Beyond::default()
        };
        for (&(mass, width), (face, rate)) in self.cells.iter().zip(self.falls()) {
            let Some(rate) = rate.filter(|_| outer > 0.0) else {
                continue;
            };
            let power = rate * (self.depth - face);
            if power < LEAST_POWER {
                break;
            }
            let outside = face - width;
            let growth = self.growth(face, power);
            // The mass of a cell of an exponential density, and of one that is a power of the distance from the mean,
            // and what follows of it beyond the end.
            let exponential = mass / (rate * width).exp_m1() * (-rate * outside).exp();
            let of = |distance: f64| (1.0 - distance / self.depth).powf(1.0 - power);
            let algebraic = mass / (of(face) - of(outside));
            beyond = Beyond {
                mass: exponential.powf(growth) * algebraic.powf(1.0 - growth) / share_told(),
                // At the end itself the power has grown on.
                power: power * (self.depth / (self.depth - face)).powf(growth),
                growth,
            };
            if rate * face - 0.5 * rate * width >= FROM_END {
                return Tail {
                    outer,
                    level,
                    beyond,
                };
            }
        }
        // Nearer to the end the fall tells about how much is beyond, and not how it goes on.
        let mass = beyond.mass;
        Tail {
            outer,
            level,
            beyond: Beyond {
                mass,
                ..Beyond::default()
            },
        }
    }
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
    let ends = along.into_iter().zip(closed).map(|(cells, closed)| {
        let reversed = cells.iter().rev().copied().collect();
        let mut ends = [cells, reversed].map(|cells| Inward::new(cells).tail());
        for (end, closed) in ends.iter_mut().zip(closed) {
            if *closed {
                *end = Tail::default();
            }
        }
        ends
    });
    ends.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;

    #[test]
    fn what_leaves_through_an_end_does_not_hide_what_is_beyond_it() {
        // A normal density to 4.2 deviations, and the same next to an end that takes what reaches it.
        let axis = Axis::uniform(-4.2, 4.2, 84).unwrap();
        let space = CellSpace::new(vec![axis.clone()]).unwrap();
        let whole = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
        let absorbed = |x: f64| whole(x) * (1.0 - (-4.2 * (4.2 - x)).exp());
        let beyond = |of: &dyn Fn(f64) -> f64| {
            let masses: Vec<f64> = axis.centres().into_iter().map(|x| 0.1 * of(x)).collect();
            share_told() * tails(&space, &masses, &[[true, false]])[0][1].beyond.mass
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
        let tail = |cells: &[(f64, f64)]| Inward::new(cells.to_vec()).tail().beyond.mass;
        assert_eq!(tail(&[(0.2, 1.0), (0.1, 1.0)]), 0.2);
        assert_eq!(tail(&[(0.0, 1.0), (0.1, 1.0)]), 0.0);
        assert_eq!(tail(&[(-0.1, 1.0), (0.1, 1.0)]), 0.0);
        assert_eq!(tail(&[(0.1, 1.0), (-0.1, 1.0)]), 0.1);
    }

    #[test]
    fn a_fall_that_ends_near_the_end_is_no_power_law() {
        // It falls by 1.3 in the outermost cell alone, two and a half cells from the mean.
        let cells = [0.05, 0.1, 0.1, 0.1, 0.1].map(|mass| (mass, 1.0));
        let end = Inward::new(cells.to_vec()).tail().beyond;
        assert!(end.mass > 0.0 && end.heavy().is_none(), "{end:?}");
        assert_eq!(end.stretch(2), 1.0);
    }

    #[test]
    fn a_power_law_is_told_from_an_exponential() {
        // p of (1 + x²)^-(ν/2) on cells of 0.1, cut off at 20.
        let axis = Axis::uniform(-20.0, 20.0, 400).unwrap();
        let space = CellSpace::new(vec![axis.clone()]).unwrap();
        for power in [3.5_f64, 4.5, 6.0, 9.0] {
            let density = |x: f64| (1.0 + x * x).powf(-0.5 * power);
            let masses: Vec<f64> = axis
                .centres()
                .into_iter()
                .map(|x| 0.1 * density(x))
                .collect();
            let end = tails(&space, &masses, &[[true, false]])[0][1].beyond;
            // ∫ x^-ν from 20 on; 1 + x² for x² makes it less by about ν/2 of 1/400.
            let exact = 20.0_f64.powf(1.0 - power) / (power - 1.0);
            assert!(
                (share_told() * end.mass / exact - 1.0).abs() < 0.05,
                "{end:?}"
            );
            assert!(
                (end.stretch(2) / ((power - 1.0) / (power - 3.0)) - 1.0).abs() < 0.05,
                "{end:?}"
            );
            assert!(end.heavy().is_none(), "{end:?}");
        }
        let masses: Vec<f64> = axis
            .centres()
            .into_iter()
            .map(|x| 1.0 / (1.0 + x * x).powf(1.3))
            .collect();
        let end = tails(&space, &masses, &[[true, false]])[0][1].beyond;
        assert!((end.heavy().unwrap() - 2.6).abs() < 0.05, "{end:?}");
    }
}
