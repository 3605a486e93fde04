//! Cusps: where the fold of a marginal ends because two folds meet and turn on the spot.
//!
//! On a fold a peak and a valley are one, at a place x where p' = p'' = 0. Along the fold both parameters are smooth
//! functions of x, beyond the cusp as well, where x goes on and the other fold begins; at the cusp p''' = 0 too, and
//! with it dθ/dx = 0. The indicator itself is no help there, since it is defined by the inflection between two extrema;
//! the parameters as polynomials in x are.

use super::found::EndReason;
use super::polynomial::{evaluate, fit};
use super::tail::{Beyond, FAR, Tail};
use super::walked::apart;
use crate::topology::IndicatorKind;

/// Degree of the polynomials.
const DEGREE: usize = 4;

/// The cusp near the end of a fold; `rising` is its indicator's.
pub(super) fn cusp(tail: &Tail<'_>, rising: bool) -> Option<Beyond> {
    let (places, values) = (&tail.places, &tail.values);
    let rises = places.windows(2).all(|pair| pair[1] > pair[0]);
    let falls = places.windows(2).all(|pair| pair[1] < pair[0]);
    if !(rises || falls) {
        return None;
    }
    let found = turning(places, values, DEGREE)?;
    let lower = turning(places, values, DEGREE - 1)?;
    // Within a cell of the cusp peak and valley are hardly told apart, and the place between them is the least certain.
    let nearest = places.len() / 4;
    let farther = turning(&places[nearest..], &values[nearest..], DEGREE)?;
    let span = (places[places.len() - 1] - places[0]).abs();
    let beyond = (places[0] - found.place) * (places[places.len() - 1] - places[0]) / span;
    let is_near = apart(found.at, values[0]) <= FAR && (-0.05 * span..=span).contains(&beyond);
    // The other fold is where the place goes on; there peak and valley have changed sides.
    let opposite = 2.0 * found.place - places[places.len() / 2];
    is_near.then(|| Beyond {
        reason: EndReason::Cusp,
        at: found.at,
        place: found.place,
        error: tail.largest_error()
            + 2.0 * (apart(found.at, lower.at) + apart(found.at, farther.at))
            + 3.0 * found.scatter,
        scatter: 0.0,
        leaves: found.leaves,
        branch: (
            found.at(opposite),
            IndicatorKind::shoulder(!rising),
            opposite,
        ),
    })
}

/// Where both parameters stand still.
#[derive(Debug, Clone)]
struct Turning {
    place: f64,
    at: [f64; 2],
    /// The direction in which they move away from there.
    leaves: [f64; 2],
    /// Root of the mean square of what the polynomials leave of the points.
    scatter: f64,
    fits: [Vec<f64>; 2],
    /// First and last place.
    ends: [f64; 2],
}

impl Turning {
    /// Both parameters where the fold is at a place.
    fn at(&self, place: f64) -> [f64; 2] {
        let [origin, last] = self.ends;
        let u = (place - origin) / (last - origin);
        self.fits.each_ref().map(|fit| evaluate(fit, u)[0])
    }
}

/// Where both parameters, as polynomials of the place near to these points, stand still; `None` where they do not do so
/// together.
fn turning(places: &[f64], values: &[[f64; 2]], degree: usize) -> Option<Turning> {
    let (origin, last) = (*places.first()?, *places.last()?);
    let scaled: Vec<f64> = places
        .iter()
        .map(|x| (x - origin) / (last - origin))
        .collect();
    let fits = [0, 1].map(|k| {
        let values: Vec<f64> = values.iter().map(|value| value[k]).collect();
        fit(&scaled, &values, degree)
    });
    let at = |u: f64| fits.each_ref().map(|fit| evaluate(fit, u));
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
        ends: [origin, last],
        fits,
    })
}

fn square(vector: [f64; 2]) -> f64 {
    vector[0] * vector[0] + vector[1] * vector[1]
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let beyond = found.at(0.0);
        assert!((beyond[0] - of(0.0)[0]).hypot(beyond[1] - of(0.0)[1]) < 1e-9);
        // A smooth curve turns nowhere.
        let smooth: Vec<[f64; 2]> = places.iter().map(|&x| [x, x * x]).collect();
        assert!(turning(&places, &smooth, 4).is_none());
    }
}
