//! The states next to the ends of the ranges: where the coordinates are that lie beyond them, the others are not spread
//! as elsewhere, and what is cut off of one axis is missing in the means and deviations of the others.

use crate::density::Moments;
use crate::space::CellSpace;

/// Cells at an end in which its states are looked at.
const CELLS: usize = 3;

/// Means and mean squares of all coordinates among the states next to an end; without states there, of no length.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct BesideEnd {
    means: Vec<f64>,
    mean_squares: Vec<f64>,
}

/// Sums over the states next to an end.
#[derive(Clone)]
struct Sums {
    mass: f64,
    coordinates: Vec<f64>,
    squares: Vec<f64>,
}

impl Sums {
    fn add(&mut self, mass: f64, coordinates: &[f64]) {
        self.mass += mass;
        let sums = self.coordinates.iter_mut().zip(&mut self.squares);
        for ((first, second), at) in sums.zip(coordinates) {
            *first += mass * at;
            *second += mass * at * at;
        }
    }

    fn means(self) -> BesideEnd {
        if self.mass <= 0.0 {
            return BesideEnd::default();
        }
        let over = |sums: Vec<f64>| sums.into_iter().map(|sum| sum / self.mass).collect();
        BesideEnd {
            means: over(self.coordinates),
            mean_squares: over(self.squares),
        }
    }
}

/// The states next to both ends of every axis, from the masses of all cells.
pub(super) fn beside_ends(space: &CellSpace, mass: &[f64]) -> Vec<[BesideEnd; 2]> {
    let axes = space.axes();
    let none = Sums {
        mass: 0.0,
        coordinates: vec![0.0; axes.len()],
        squares: vec![0.0; axes.len()],
    };
    let mut sums = vec![[none.clone(), none]; axes.len()];
    let mut at = vec![0.0; axes.len()];
    let mut beside = vec![[false; 2]; axes.len()];
    for (cell, &mass) in mass.iter().enumerate().filter(|(_, mass)| **mass > 0.0) {
        for (k, axis) in axes.iter().enumerate() {
            let place = space.position(cell, k);
            at[k] = axis.nodes()[place];
            beside[k] = [place < CELLS, place + CELLS >= axis.count()];
        }
        let ends = sums.iter_mut().flatten().zip(beside.iter().flatten());
        for (sums, _) in ends.filter(|(_, is_beside)| **is_beside) {
            sums.add(mass, &at);
        }
    }
    sums.into_iter().map(|ends| ends.map(Sums::means)).collect()
}

impl BesideEnd {
    /// By how much the mean and the variance of one axis are others beyond an end of another axis, from the moments of
    /// both and where that end is. What the states next to it differ by grows outward, the mean as the distance from
    /// the mean of that other axis does, and the variance as its square.
    pub(super) fn differences(
        &self,
        (axis, moments): (usize, &Moments),
        (across, mean, end): (usize, f64, f64),
    ) -> [f64; 2] {
        let of = |axis: usize| Some((*self.means.get(axis)?, *self.mean_squares.get(axis)?));
        let Some(((own, square), (there, _))) = of(axis).zip(of(across)) else {
            return [0.0; 2];
        };
        let outward = (end - mean) / (there - mean);
        let outward = if outward.is_finite() { outward } else { 1.0 };
        let variance = square - moments.mean * (2.0 * own - moments.mean);
        [
            ((own - moments.mean) * outward).abs(),
            ((variance - moments.standard_deviation.powi(2)) * outward * outward).abs(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;

    #[test]
    fn beyond_an_end_of_a_normal_density_the_other_axis_is_off_by_its_correlation() {
        // A normal density of two axes with correlation r, cut off at four deviations of the first.
        let (r, count) = (0.6, 80);
        let axis = |reach: f64| Axis::uniform(-reach, reach, count).unwrap();
        let space = CellSpace::new(vec![axis(4.0), axis(7.0)]).unwrap();
        let mass: Vec<f64> = (0..space.n_cells())
            .map(|cell| {
                let at = space.centre(cell);
                let other = (at[1] - r * at[0]).powi(2) / (1.0 - r * r);
                (-0.5 * (at[0] * at[0] + other)).exp()
            })
            .collect();
        let moments = Moments {
            mean: 0.0,
            standard_deviation: 1.0,
        };
        for (beside, end) in beside_ends(&space, &mass)[0].iter().zip([-4.0, 4.0]) {
            let [mean, variance] = beside.differences((1, &moments), (0, 0.0, end));
            assert!((mean - 4.0 * r).abs() < 0.01, "{mean}");
            // The square of the mean there, and what the first axis no longer says of the second.
            let exact = r * r * (end * end - 1.0);
            assert!((variance / exact - 1.0).abs() < 0.03, "{variance} {exact}");
        }
        let empty = beside_ends(&space, &vec![0.0; space.n_cells()]);
        assert_eq!(
            empty[1][0].differences((0, &moments), (1, 0.0, -7.0)),
            [0.0; 2]
        );
    }
}
