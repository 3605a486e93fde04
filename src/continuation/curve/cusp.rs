//! Cusps: where the fold of a marginal ends because two folds meet and turn on the spot.
//!
//! On a fold a peak and a valley are one, at a place x where p' = p'' = 0. Along the fold both parameters are smooth functions of x, beyond the cusp
//! as well, where x goes on and the other fold begins; at the cusp p''' = 0 too, and with it dθ/dx = 0. The indicator itself is no help there, since
//! it is defined by the inflection between two extrema; the parameters as polynomials in x are.

use super::found::{CurvePoint, EndReason};
use super::plane::Plane;
use crate::continuation::{BifurcationStatus, ErrorParts};
use crate::topology::IndicatorKind;

/// Degree of the polynomials.
const DEGREE: usize = 4;
/// Fewest points that they are fitted to.
const FEWEST: usize = 8;
/// Length of the end of a curve that they are taken from, in sides of the box.
const LONGEST: f64 = 0.2;
/// Farthest that a cusp may be from where the curve was met last, in sides of the box.
const FAR: f64 = 0.05;

/// A cusp beyond the end of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cusp {
    /// In the box with sides of length one.
    at: [f64; 2],
    place: f64,
    error: f64,
    /// Direction in which the curve leaves it, of length one.
    leaves: [f64; 2],
}

/// Adds the cusps in which a curve ends, as points of their own: `reasons` are those of its ends, `start` the place of its start.
pub(super) fn add_cusps(
    points: &mut Vec<CurvePoint>,
    reasons: &mut [EndReason],
    start: &mut usize,
    (kind, plane, tolerance): (IndicatorKind, &Plane, f64),
) {
    if !matches!(kind, IndicatorKind::Shoulder { .. }) {
        return;
    }
    let count = reasons.len();
    for (index, reason) in reasons.iter_mut().enumerate() {
        let ends_here = matches!(
            reason,
            EndReason::NotConverged | EndReason::FeatureLost | EndReason::Singular
        );
        let is_first = index == 0 && count > 1;
        let inward: Vec<&CurvePoint> = match is_first {
            true => points.iter().collect(),
            false => points.iter().rev().collect(),
        };
        let Some((cusp, last)) = ends_here
            .then(|| cusp(&inward, plane))
            .flatten()
            .zip(inward.first())
        else {
            continue;
        };
        let point = point(&cusp, last, is_first, plane, tolerance);
        *reason = EndReason::Cusp;
        if is_first {
            points.insert(0, point);
            *start += 1;
        } else {
            points.push(point);
        }
    }
}

fn point(
    cusp: &Cusp,
    last: &CurvePoint,
    is_first: bool,
    plane: &Plane,
    tolerance: f64,
) -> CurvePoint {
    let sides = plane.sides();
    let beyond = plane.place(last.values);
    let apart = (cusp.at[0] - beyond[0]).hypot(cusp.at[1] - beyond[1]);
    let (before, onward) = if is_first {
        (-apart, 1.0)
    } else {
        (apart, -1.0)
    };
    let across = [-cusp.leaves[1], cusp.leaves[0]];
    CurvePoint {
        values: plane.values(cusp.at),
        error: cusp.error,
        parts: ErrorParts {
            solver: cusp.error,
            ..ErrorParts::default()
        },
        to_edge: [0, 1].map(|k| cusp.error * across[k] * sides[k].length()),
        indicator: 0.0,
        gradient: last.gradient,
        place: vec![cusp.place],
        arclength: last.arclength + before,
        tangent: [0, 1].map(|k| onward * cusp.leaves[k] * sides[k].length()),
        checked: false,
        status: match cusp.error <= tolerance {
            true => BifurcationStatus::Located,
            false => BifurcationStatus::Unresolved,
        },
    }
}

/// The cusp near the first of some points that follow each other inward.
fn cusp(inward: &[&CurvePoint], plane: &Plane) -> Option<Cusp> {
    let first = inward.first()?;
    let near = inward
        .iter()
        .take_while(|point| (point.arclength - first.arclength).abs() <= LONGEST);
    let near: Vec<&CurvePoint> = near.copied().collect();
    let places: Vec<f64> = near
        .iter()
        .filter_map(|point| point.place.first().copied())
        .collect();
    let rises = places.windows(2).all(|pair| pair[1] > pair[0]);
    let falls = places.windows(2).all(|pair| pair[1] < pair[0]);
    if near.len() < FEWEST || !(rises || falls) {
        return None;
    }
    let values: Vec<[f64; 2]> = near.iter().map(|point| plane.place(point.values)).collect();
    let found = turning(&places, &values, DEGREE)?;
    let lower = turning(&places, &values, DEGREE - 1)?;
    // Within a cell of the cusp peak and valley are hardly told apart, and the place between them is the least certain.
    let nearest = near.len() / 4;
    let farther = turning(&places[nearest..], &values[nearest..], DEGREE)?;
    let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let known = near.iter().map(|point| point.error).fold(0.0, f64::max);
    let span = (places[places.len() - 1] - places[0]).abs();
    let beyond = (places[0] - found.place) * (places[places.len() - 1] - places[0]) / span;
    let is_near = apart(found.at, values[0]) <= FAR && (-0.05 * span..=span).contains(&beyond);
    is_near.then_some(Cusp {
        at: found.at,
        place: found.place,
        error: known
            + 2.0 * (apart(found.at, lower.at) + apart(found.at, farther.at))
            + 3.0 * found.scatter,
        leaves: found.leaves,
    })
}

/// Where both parameters stand still.
#[derive(Debug, Clone, Copy)]
struct Turning {
    place: f64,
    at: [f64; 2],
    /// The direction in which they move away from there.
    leaves: [f64; 2],
    /// Root of the mean square of what the polynomials leave of the points.
    scatter: f64,
}

/// Where both parameters, as polynomials of the place near to these points, stand still; `None` where they do not do so together.
fn turning(places: &[f64], values: &[[f64; 2]], degree: usize) -> Option<Turning> {
    let (origin, last) = (*places.first()?, *places.last()?);
    let scaled: Vec<f64> = places
        .iter()
        .map(|x| (x - origin) / (last - origin))
        .collect();
    let fits = [0, 1].map(|k| {
        let values: Vec<f64> = values.iter().map(|value| value[k]).collect();
        fitted(&scaled, &values, degree)
    });
    let at = |u: f64| fits.each_ref().map(|fit| evaluated(fit, u));
    let mut u = 0.0;
    for _ in 0..20 {
        let both = at(u);
        let (first, second) = (both.map(|one| one[1]), both.map(|one| one[2]));
        // Along the second derivative, which does not vanish at a cusp.
        u -= (first[0] * second[0] + first[1] * second[1]) / square(second);
        if !u.is_finite() {
            return None;
        }
    }
    let both = at(u);
    let (first, second) = (both.map(|one| one[1]), both.map(|one| one[2]));
    let bend = square(second).sqrt();
    let left = scaled.iter().zip(values).map(|(&u, value)| {
        let both = at(u);
        square([0, 1].map(|k| both[k][0] - value[k]))
    });
    let scatter = (left.sum::<f64>() / places.len() as f64).sqrt();
    let stands = square(first).sqrt() <= 0.02 * bend;
    stands.then(|| Turning {
        place: origin + u * (last - origin),
        at: both.map(|one| one[0]),
        leaves: second.map(|part| part / bend),
        scatter,
    })
}

fn square(vector: [f64; 2]) -> f64 {
    vector[0] * vector[0] + vector[1] * vector[1]
}

/// Coefficients, lowest power first, of the polynomial that is nearest to some points: by columns made orthogonal one after the other.
fn fitted(places: &[f64], values: &[f64], degree: usize) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut rest = values.to_vec();
    // Each column with its coefficients in powers.
    let mut columns: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let mut result = vec![0.0; degree + 1];
    for power in 0..=degree {
        let mut column: Vec<f64> = places.iter().map(|x| x.powi(power as i32)).collect();
        let mut powers = vec![0.0; degree + 1];
        powers[power] = 1.0;
        // Twice: rounding leaves something of the first time.
        for _ in 0..2 {
            for (other, other_powers) in &columns {
                let share = dot(&column, other);
                column
                    .iter_mut()
                    .zip(other)
                    .for_each(|(a, b)| *a -= share * b);
                powers
                    .iter_mut()
                    .zip(other_powers)
                    .for_each(|(a, b)| *a -= share * b);
            }
        }
        let length = dot(&column, &column).sqrt();
        column.iter_mut().for_each(|value| *value /= length);
        powers.iter_mut().for_each(|value| *value /= length);
        let share = dot(&rest, &column);
        rest.iter_mut()
            .zip(&column)
            .for_each(|(a, b)| *a -= share * b);
        result
            .iter_mut()
            .zip(&powers)
            .for_each(|(a, b)| *a += share * b);
        columns.push((column, powers));
    }
    result
}

/// Value, first and second derivative of a polynomial.
fn evaluated(coefficients: &[f64], x: f64) -> [f64; 3] {
    let mut result = [0.0; 3];
    for coefficient in coefficients.iter().rev() {
        result[2] = result[2] * x + 2.0 * result[1];
        result[1] = result[1] * x + result[0];
        result[0] = result[0] * x + coefficient;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_fitted_to_the_digit_and_has_its_derivatives() {
        let of = |x: f64| 2.0 - x + 3.0 * x * x - x.powi(4);
        let places = [-1.0, -0.3, 0.2, 0.7, 0.9, 1.5, 1.6];
        let [value, first, second] = evaluated(&fitted(&places, &places.map(of), 4), 0.4);
        assert!((value - of(0.4)).abs() < 1e-12);
        assert!((first - (-1.0 + 2.4 - 4.0 * 0.064)).abs() < 1e-12);
        assert!((second - (6.0 - 12.0 * 0.16)).abs() < 1e-11);
    }

    #[test]
    fn the_place_at_which_both_parameters_turn_is_found_from_one_side() {
        // A cusp at (0.3, 0.4), bent: θ = (0.3 + t³ (1 + t), 0.4 + t² + t⁴) with t = x - 0.1.
        let of = |x: f64| {
            let t = x - 0.1;
            [0.3 + t.powi(3) * (1.0 + t), 0.4 + t * t + t.powi(4)]
        };
        let places: Vec<f64> = (0..12).map(|k| 0.12 + 0.02 * f64::from(k)).collect();
        let values: Vec<[f64; 2]> = places.iter().map(|&x| of(x)).collect();
        let found = turning(&places, &values, 4).unwrap();
        assert!((found.place - 0.1).abs() < 1e-9, "{found:?}");
        assert!((found.at[0] - 0.3).hypot(found.at[1] - 0.4) < 1e-12);
        assert!(found.leaves[0].abs() < 1e-6 && (found.leaves[1] - 1.0).abs() < 1e-9);
        assert!(found.scatter < 1e-13);
        // A smooth curve turns nowhere.
        let smooth: Vec<[f64; 2]> = places.iter().map(|&x| [x, x * x]).collect();
        assert!(turning(&places, &smooth, 4).is_none());
    }
}
