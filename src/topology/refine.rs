//! Position and height of a feature below the size of a cell.
//!
//! A quadratic is fitted by least squares to the values of a window of cells, each value being the *average* of
//! the density over its cell: ⟨x²⟩ = c² + h²/12 for centre c and width h, on any widths. The window is three
//! cells along an axis (in one dimension the quadratic then has the three averages exactly), and wider where the
//! density does not change by more than its standard errors. The result stays inside the window; along directions in
//! which the quadratic is not curved the right way it stays at the cell's centre.
//!
//! On a smooth density the position is off by O(h²), the height by O(h³) (in practice h⁴); at a kink
//! by O(h). Marginals without noise are known better: from here `extremum` goes on to a high order.

use std::ops::Range;

use super::FeatureKind;
use super::critical::Critical;
use super::extremum::{Vertex, extremum};
use super::field::Field;
use super::quadratic::{Scale, basis, fit, principal_directions};
use crate::density::EstimatedDensity;
use crate::space::Axis;

/// Changes below this many standard errors are noise, and the window grows across them.
const NOISE_LIMIT: f64 = 4.0;

/// The window reaches at most this share of an axis to either side.
const LARGEST_REACH: usize = 8;

/// Longest step along a principal direction, in half lengths of the window.
const FARTHEST: f64 = 1.5;

/// Refines the feature whose cell is given. One or two axes; one value and one error a cell.
pub(super) fn refine(estimated: &EstimatedDensity, cell: usize, kind: FeatureKind) -> Vertex {
    let axes = &estimated.density.axes;
    let columns = axes.last().map_or(1, Axis::count);
    let at: Vec<usize> = match axes.len() {
        1 => vec![cell],
        _ => vec![cell / columns, cell % columns],
    };
    let windows: Vec<Range<usize>> = (0..axes.len())
        .map(|axis| window(estimated, &at, axis))
        .collect();
    if let Some(at_end) = at_end(estimated, cell, kind) {
        return at_end;
    }
    let place = stationary_point(estimated, &at, &windows, kind).unwrap_or_else(|| Vertex {
        position: axes
            .iter()
            .zip(&at)
            .map(|(axis, &i)| axis.centre(i))
            .collect(),
        density: estimated.density.values[cell],
    });
    extremum(estimated, cell, place.position[0], kind).unwrap_or(place)
}

/// The feature of an outermost cell at the end of the range, where a density without noise rises toward it.
fn at_end(estimated: &EstimatedDensity, cell: usize, kind: FeatureKind) -> Option<Vertex> {
    if estimated.is_noisy() {
        return None;
    }
    let field = Field::new(estimated)?;
    let centre = field.centre(cell);
    (0..centre.len()).find_map(|k| field.end_near(k, centre[k]))?;
    let critical = Critical::near(&field, &centre, kind, field.values())?;
    critical.is_at_end.then_some(Vertex {
        density: critical.jet.value,
        position: critical.position,
    })
}

/// Cells of one axis that the fit around the cell `at` takes in.
fn window(estimated: &EstimatedDensity, at: &[usize], axis: usize) -> Range<usize> {
    let count = estimated.density.axes[axis].count();
    let stride = if axis + 1 == at.len() {
        1
    } else {
        estimated.density.axes[1].count()
    };
    let cell: usize = if at.len() == 1 {
        at[0]
    } else {
        at[0] * estimated.density.axes[1].count() + at[1]
    };
    let (values, errors) = (&estimated.density.values, &estimated.standard_error);
    let is_noise = |other: usize| {
        let change = (values[other] - values[cell]).abs();
        change < NOISE_LIMIT * errors[cell].hypot(errors[other])
    };
    let mut reach = 1;
    while reach < count / LARGEST_REACH
        && at[axis] >= reach
        && at[axis] + reach < count
        && is_noise(cell - reach * stride)
        && is_noise(cell + reach * stride)
    {
        reach += 1;
    }
    // At an end of the range the three cells nearest to it.
    let low = at[axis].saturating_sub(reach).min(count.saturating_sub(3));
    let high = (at[axis] + reach + 1).max(3).min(count);
    low..high
}

/// Stationary point of the fitted quadratic, if it is of the kind that is looked for.
fn stationary_point(
    estimated: &EstimatedDensity,
    at: &[usize],
    windows: &[Range<usize>],
    kind: FeatureKind,
) -> Option<Vertex> {
    let axes = &estimated.density.axes;
    let scales: Vec<Scale> = (0..axes.len())
        .map(|k| Scale::new(&axes[k], at[k], &windows[k]))
        .collect();
    let coefficients = fit(estimated, windows, &scales)?;
    let mut place = match coefficients.as_slice() {
        [_, slope, curvature] => vec![vertex(*slope, *curvature, kind)?],
        [_, sx, sy, xx, xy, yy] => critical_point([*sx, *sy, *xx, *xy, *yy], kind),
        _ => return None,
    };
    for (k, coordinate) in place.iter_mut().enumerate() {
        *coordinate = scales[k].clamp(&axes[k], &windows[k], *coordinate);
    }
    let terms: Vec<(f64, f64)> = place.iter().map(|&u| (u, u * u)).collect();
    let products = basis(&terms).into_iter().zip(&coefficients);
    let density = products.map(|(term, coefficient)| term * coefficient).sum();
    let position = place
        .iter()
        .zip(&scales)
        .map(|(u, scale)| scale.origin + u * scale.unit);
    Some(Vertex {
        position: position.collect(),
        density,
    })
}

/// Vertex of a parabola that opens the right way.
fn vertex(slope: f64, curvature: f64, kind: FeatureKind) -> Option<f64> {
    let opens = match kind {
        FeatureKind::Peak | FeatureKind::Ring => curvature < 0.0,
        FeatureKind::Valley | FeatureKind::Crater => curvature > 0.0,
    };
    opens.then(|| -0.5 * slope / curvature)
}

/// Where the slope of a quadratic in two variables vanishes along those principal directions whose curvature
/// suits the kind. On a ridge of constant height that is the ridge.
fn critical_point(coefficients: [f64; 5], kind: FeatureKind) -> Vec<f64> {
    let mut point = vec![0.0, 0.0];
    for principal in principal_directions(coefficients) {
        if principal.suits(kind) {
            let step = -principal.slope / principal.curvature;
            // Far outside the window the fit says nothing of this direction.
            if step.abs() <= FARTHEST {
                point[0] += step * principal.direction[0];
                point[1] += step * principal.direction[1];
            }
        }
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::{Density, Observable};
    use crate::space::Grading;
    use crate::topology::analytic_tests::averages;

    fn exact(axes: Vec<Axis>, values: Vec<f64>) -> EstimatedDensity {
        EstimatedDensity::new(Observable::Marginal(0), Density { axes, values })
    }

    fn graded(count: usize) -> Axis {
        let grading = Grading {
            at: vec![0.13],
            smallest: 0.3 / count as f64,
        };
        Axis::graded(-1.0, 1.0, count, &grading).unwrap()
    }

    #[test]
    fn a_parabola_is_found_exactly_on_graded_cells() {
        let axis = graded(12);
        let parabola = |x: f64| 3.0 * x - 2.0 * (x - 0.2).powi(3) / 3.0;
        let estimated = averages(&axis, parabola);
        let place = refine(&estimated, axis.find(0.2).unwrap(), FeatureKind::Peak);
        assert!((place.position[0] - 0.2).abs() < 1e-10, "{place:?}");
        assert!((place.density - 3.0).abs() < 1e-10, "{place:?}");
    }

    #[test]
    fn position_converges_with_order_two_and_height_with_order_three() {
        // p = cos(2(x - 0.21)) + 0.3 (x - 0.21)³ has its peak at 0.21, height 1, and no symmetry there.
        let primitive = |x: f64| {
            let u = x - 0.21;
            0.5 * (2.0 * u).sin() + 0.075 * u.powi(4)
        };
        for count in [20, 40, 80, 160] {
            let axis = Axis::uniform(-1.0, 1.0, count).unwrap();
            let h = 2.0 / count as f64;
            let estimated = averages(&axis, primitive);
            let place = refine(&estimated, axis.find(0.21).unwrap(), FeatureKind::Peak);
            // Taylor: the position is off by |p'''| h²/(8|p''|) or so (0.06 h²) plus |p''''| h² × offset.
            assert!(
                (place.position[0] - 0.21).abs() < 0.3 * h * h,
                "{count}: {place:?}"
            );
            assert!(
                (place.density - 1.0).abs() < 0.5 * h.powi(3),
                "{count}: {place:?}"
            );
        }
    }

    #[test]
    fn a_quadratic_saddle_peak_and_crater_are_found_exactly_in_two_dimensions() {
        let axes = vec![graded(14), Axis::uniform(-2.0, 2.0, 11).unwrap()];
        // Averages of c + s₁ (x - 0.2)² + s₂ (y - 0.3)² + m (x - 0.2)(y - 0.3).
        let values = |signs: (f64, f64), mixed: f64| -> Vec<f64> {
            let square = |axis: &Axis, i: usize, at: f64| {
                (axis.centre(i) - at).powi(2) + axis.width(i).powi(2) / 12.0
            };
            let value = |cell: usize| {
                let (i, j) = (cell / 11, cell % 11);
                let product = (axes[0].centre(i) - 0.2) * (axes[1].centre(j) - 0.3);
                5.0 + signs.0 * square(&axes[0], i, 0.2)
                    + signs.1 * square(&axes[1], j, 0.3)
                    + mixed * product
            };
            (0..14 * 11).map(value).collect()
        };
        let cell = axes[0].find(0.2).unwrap() * 11 + axes[1].find(0.3).unwrap();
        for (signs, kind) in [
            ((-1.0, -0.5), FeatureKind::Peak),
            ((1.0, 0.5), FeatureKind::Crater),
            ((-1.0, 0.5), FeatureKind::Valley),
        ] {
            let place = refine(&exact(axes.clone(), values(signs, 0.4)), cell, kind);
            assert!((place.position[0] - 0.2).abs() < 1e-9, "{kind:?} {place:?}");
            assert!((place.position[1] - 0.3).abs() < 1e-9, "{kind:?} {place:?}");
            assert!((place.density - 5.0).abs() < 1e-9, "{kind:?} {place:?}");
        }
    }

    #[test]
    fn ends_plateaus_and_wrong_curvature_stay_in_the_neighbourhood() {
        let axis = Axis::uniform(0.0, 1.0, 10).unwrap();
        // Falls from the end: the parabola's vertex lies outside, the end itself is the place.
        let falling = averages(&axis, |x| x - (x + 0.5).powi(3) / 6.0);
        let place = refine(&falling, 0, FeatureKind::Peak);
        assert_eq!(place.position, vec![0.0]);
        assert!((place.density - (1.0 - 0.125)).abs() < 1e-12);
        // Convex from the end, 3 e^{-3x}: the end itself is the place.
        let convex = averages(&axis, |x| -(-3.0 * x).exp());
        let place = refine(&convex, 0, FeatureKind::Peak);
        assert_eq!(place.position, vec![0.0]);
        assert!((place.density - 3.0).abs() < 1e-5, "{}", place.density);
        // Two equal highest cells: the face between them.
        let mut values = vec![0.0; 10];
        values[4..6].fill(1.0);
        let pair = exact(vec![axis], values);
        for cell in [4, 5] {
            let place = refine(&pair, cell, FeatureKind::Peak);
            assert!((place.position[0] - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_widens_the_window_and_steadies_the_position() {
        let axis = Axis::uniform(-2.0, 2.0, 100).unwrap();
        let noise = |cell: usize| 0.01 * ((cell * 7919 % 101) as f64 / 50.0 - 1.0);
        let mut estimated = averages(&axis, |x| x - x.powi(3) / 6.0);
        for cell in 0..100 {
            estimated.density.values[cell] += noise(cell);
        }
        let values = &estimated.density.values;
        let highest = (0..100)
            .max_by(|&a, &b| values[a].total_cmp(&values[b]))
            .unwrap();
        estimated.standard_error = vec![0.006; 100];
        let place = refine(&estimated, highest, FeatureKind::Peak);
        let cell_wise = axis.centre(highest).abs();
        assert!(
            place.position[0].abs() < 0.03 && place.position[0].abs() < cell_wise,
            "{place:?}"
        );
    }
}
