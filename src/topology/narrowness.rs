//! How well a density can be read between its cells: what features narrower than cells leave uncertain.
//!
//! At the faces of the cells the polynomials through the averages over eight cells and over six are compared. They
//! agree where the density changes little from cell to cell. Beside a peak narrower than a cell they do not, however
//! well the averages are known.

use super::field::{Field, REACH};
use super::reconstruction::{Weights, interpolating};
use crate::density::EstimatedDensity;

/// The largest difference between two reconstructions of a density at faces of its cells, in units of the density;
/// zero where the cells are too few for them, or the density has neither one axis nor two. Faces are those in the
/// middle of both polynomials: beside an end or a kink one-sided ones differ by up to a hundred times as much.
pub(crate) fn reading_error(estimated: &EstimatedDensity) -> f64 {
    let Some(field) = Field::new(estimated) else {
        return 0.0;
    };
    let axes = (0..field.axes().len()).map(|k| along(&field, k));
    axes.fold(0.0, f64::max)
}

/// The largest difference along one axis.
fn along(field: &Field<'_>, k: usize) -> f64 {
    let axes = field.axes();
    let (values, count) = (field.values(), axes[k].count());
    let inner: usize = axes[k + 1..].iter().map(|axis| axis.count()).product();
    let outer = values.len() / (count * inner).max(1);
    let faces = (1..count).filter_map(|face| both(field, k, face));
    let largest = |[fine, rough]: [Weights; 2]| {
        let lines = (0..outer).flat_map(|row| (0..inner).map(move |column| (row, column)));
        let difference = |(row, column): (usize, usize)| {
            let read = |line: &Weights| -> f64 {
                let start = (row * count + line.first) * inner + column;
                let cells = values[start..].iter().step_by(inner);
                line.weights.iter().zip(cells).map(|(w, v)| w * v).sum()
            };
            (read(&fine) - read(&rough)).abs()
        };
        lines.map(difference).fold(0.0, f64::max)
    };
    faces.map(largest).fold(0.0, f64::max)
}

/// Weights of the values at a face by both reconstructions; `None` where an end or a kink is too near.
fn both(field: &Field<'_>, k: usize, face: usize) -> Option<[Weights; 2]> {
    let axis = &field.axes()[k];
    let at = *axis.edges().get(face)?;
    let line = |reach: usize| {
        let cells = field.window(k, at, reach)?;
        let is_central = cells == (face.checked_sub(reach)?..face + reach);
        interpolating(axis, cells, at, 1)
            .filter(|_| is_central)?
            .pop()
    };
    Some([line(REACH[0])?, line(REACH[1])?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::{Density, Observable};
    use crate::space::Axis;

    /// Of x⁶ eight cells know all. The primitive x⁷/7 over six cells of width h, by the seven edges, is off by the
    /// product of the distances from these over 7; at the middle edge its slope by (3!)² h⁶/7.
    #[test]
    fn a_power_of_six_differs_by_what_its_own_remainder_is() {
        let axis = Axis::uniform(0.0, 1.0, 20).unwrap();
        let edges = axis.edges().windows(2);
        let average =
            |edge: &[f64]| (edge[1].powi(7) - edge[0].powi(7)) / (7.0 * (edge[1] - edge[0]));
        let values: Vec<f64> = edges.map(average).collect();
        let expected = 36.0 / 7.0 * 0.05_f64.powi(6);
        let other = Axis::uniform(0.0, 1.0, 9).unwrap();
        // Along either of two axes alike.
        let by_row: Vec<f64> = values.iter().flat_map(|&value| vec![value; 9]).collect();
        let by_column = values.repeat(9);
        let of = |axes: Vec<Axis>, values: Vec<f64>| {
            let observable = Observable::Joint(0, 1);
            reading_error(&EstimatedDensity::new(observable, Density { axes, values }))
        };
        for found in [
            of(vec![axis.clone()], values),
            of(vec![axis.clone(), other.clone()], by_row),
            of(vec![other, axis], by_column),
        ] {
            assert!(
                (found / expected - 1.0).abs() < 1e-4,
                "{found:e} {expected:e}"
            );
        }
    }
}
