//! Ends at which the noise along an axis dies, of systems with several axes: how much mass lies in the cells beside
//! them, and whether all of it ends there.

use crate::continuation::Finding;
use crate::space::CellSpace;
use crate::system::{System, absorbs, largest_power, may_stay};

/// Mass in the cells beside an end that is worth a finding.
const LIMIT: f64 = 1e-3;

/// Mass in those cells beyond which it is all that there is: a density with a power above -0.92 has less there where
/// cells narrow to a ten-thousandth of its width.
const MOST: f64 = 0.5;

/// Cells from whose densities the power is read, by their number from the end: in the outermost ones it is what the end
/// of the grid makes of it.
const READ: [usize; 2] = [2, 6];

/// What is said of the ends at which noise dies; `masses` are those of all cells. Where drift leads away from an end
/// nothing is absorbed there, however steep the density is that the cells show beside it.
pub(super) fn findings(
    system: &dyn System,
    space: &CellSpace,
    masses: &[f64],
    natural: &[[bool; 2]],
) -> Vec<Finding> {
    let mut found = Vec::new();
    for (axis, ends) in natural.iter().enumerate() {
        let cells = &space.axes()[axis];
        if *ends == [false; 2] || cells.count() <= READ[1] {
            continue;
        }
        let mut along: Vec<f64> = vec![0.0; cells.count()];
        for (&mass, position) in masses.iter().zip(space.positions(axis)) {
            along[position] += mass;
        }
        for (end, at) in [cells.from(), cells.to()].into_iter().enumerate() {
            let from_end = |number: usize| match end {
                0 => number,
                _ => cells.count() - 1 - number,
            };
            if let (true, Some(exponent)) = (ends[end], absorbing_power(system, space, (axis, end)))
            {
                found.push(Finding::Absorbed { axis, at, exponent });
                continue;
            }
            let mass = along[from_end(0)];
            if !ends[end] || mass <= LIMIT {
                continue;
            }
            let place = |number: usize| {
                let cell = from_end(number);
                let distance = (cells.centre(cell) - at).abs();
                (distance.ln(), (along[cell] / cells.width(cell)).ln())
            };
            let power = |[near, far]: [usize; 2]| {
                let [near, far] = [near, far].map(place);
                (far.1 - near.1) / (far.0 - near.0)
            };
            let mut exponent = power(READ);
            if mass > MOST {
                // The others may hold less than the solver leaves, even less than nothing: no power is as steep.
                exponent = exponent.min(power([0, READ[0]]));
                if exponent.is_nan() {
                    exponent = f64::NEG_INFINITY;
                }
            }
            let is_absorbed =
                absorbs(exponent) && may_stay(system, &space.ranges(), natural, (axis, end));
            found.push(if is_absorbed {
                Finding::Absorbed { axis, at, exponent }
            } else {
                Finding::NaturalEnd { axis, mass, at }
            });
        }
    }
    found
}

/// The exponent of the density beside an end of an axis where it is -1 or less wherever the other coordinates are.
fn absorbing_power(
    system: &dyn System,
    space: &CellSpace,
    (axis, end): (usize, usize),
) -> Option<f64> {
    let largest = largest_power(system, axis, &space.ranges(), end == 1);
    largest.filter(|exponent| absorbs(*exponent))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Axis, Grading};
    use crate::system::{Interpretation, TypedModel};

    /// What is said of p ~ x^ν on (0, 1), over cells that narrow toward zero, beside a uniform axis, under this drift.
    fn told(drift: &str, power: f64, is_mirrored: bool) -> Vec<Finding> {
        let grading = Grading {
            at: vec![f64::from(is_mirrored)],
            smallest: 1e-4,
        };
        let axis = Axis::graded(0.0, 1.0, 60, &grading).unwrap();
        let other = Axis::uniform(0.0, 1.0, 2).unwrap();
        let space = CellSpace::new(vec![axis.clone(), other]).unwrap();
        let distance = |x: f64| if is_mirrored { 1.0 - x } else { x };
        let along = (0..60).map(|cell| axis.width(cell) * distance(axis.centre(cell)).powf(power));
        let along: Vec<f64> = along.collect();
        let total: f64 = along.iter().sum();
        let masses: Vec<f64> = along
            .iter()
            .flat_map(|mass| [0.5 * mass / total; 2])
            .collect();
        let end = usize::from(is_mirrored);
        let natural = [[end == 0, end == 1], [false; 2]];
        let typed = TypedModel::new("typed", "A typed system", ["x", "y"])
            .with_equation("x", drift)
            .with_equation("y", "-y")
            .with_noise("x", ["x (1 - x)"])
            .with_noise("y", ["0.2"])
            .with_interpretation(Interpretation::Ito);
        let system = typed.build().unwrap().system_with(&[]).unwrap();
        findings(system.as_ref(), &space, &masses, &natural)
    }

    /// What is left beside a point mass at the end is noise of the solver, negative in places; beside less mass such
    /// noise says nothing.
    #[test]
    fn mass_that_is_all_at_an_end_is_absorbed_there() {
        let typed = TypedModel::new("typed", "A typed system", ["x", "y"])
            .with_equation("x", "x (1 - x) y")
            .with_equation("y", "-y")
            .with_noise("x", ["0.1 x"])
            .with_noise("y", ["0.2"])
            .with_interpretation(Interpretation::Ito);
        let system = typed.build().unwrap().system_with(&[]).unwrap();
        let axis = Axis::uniform(0.0, 1.0, 20).unwrap();
        let space = CellSpace::new(vec![axis, Axis::uniform(-1.0, 1.0, 2).unwrap()]).unwrap();
        let natural = [[true, false], [false; 2]];
        for (mass, is_absorbed) in [(1.0, true), (0.6, true), (0.4, false)] {
            let mut masses = [1e-4, -1e-4].repeat(20);
            (masses[0], masses[1], masses[20]) = (0.5 * mass, 0.5 * mass, 1.0 - mass);
            let found = findings(system.as_ref(), &space, &masses, &natural);
            let [told] = &found[..] else {
                panic!("{mass}: {found:?}");
            };
            assert_eq!(
                matches!(told, Finding::Absorbed { axis: 0, .. }),
                is_absorbed,
                "{told:?}"
            );
        }
    }

    #[test]
    fn the_power_of_the_distance_tells_whether_all_mass_ends_there() {
        // Between y = 0 and 1 the power beside either end is 2y - 2: the density tells what comes of it.
        const BY_PLACE: &str = "x (1 - x) (1 - 2 x) y";
        assert_eq!(told(BY_PLACE, 1.0, false), []);
        for is_mirrored in [false, true] {
            let end = f64::from(is_mirrored);
            let found = told(BY_PLACE, -0.9, is_mirrored);
            assert!(
                matches!(found[..], [Finding::NaturalEnd { axis: 0, at, .. }] if at == end),
                "{found:?}"
            );
            let [
                Finding::Absorbed {
                    axis: 0,
                    at,
                    exponent,
                },
            ] = told(BY_PLACE, -1.2, is_mirrored)[..]
            else {
                panic!("not absorbed");
            };
            assert!(at == end && (exponent + 1.2).abs() < 1e-9, "{exponent}");
            // Without drift it is -2 everywhere, whatever cells show.
            let found = told("0", -0.9, is_mirrored);
            let [Finding::Absorbed { exponent, .. }] = found[..] else {
                panic!("{found:?}");
            };
            assert!((exponent + 2.0).abs() < 1e-5, "{exponent}");
            // Immigration leads away from either end.
            let found = told("0.01 (1 - 2 x)", -1.2, is_mirrored);
            let is_natural = matches!(found[..], [Finding::NaturalEnd { .. }]);
            assert!(is_natural, "{found:?}");
        }
    }
}
