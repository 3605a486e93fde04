//! Natural ends of an axis: the noise dies there, and the density goes like a power of the distance to it.
//!
//! Without flux (ln p)' = 2a/b² - (b²)'/b², with drift a and noise intensity b². With the distance u to the end, u
//! times that slope tends to the exponent ν of p ~ u^ν. Above 0 the density vanishes at the end, below 0 it grows there
//! beyond any bound; at -1 and below it cannot be normalised: all mass ends there, and there is no stationary density
//! (W. Feller, Annals of Mathematics 55, 1952).

use super::rule::look;
use crate::numerics::limit_at_zero;
use crate::space::Axis;
use crate::system::{LANES, System};

/// The nearest place at which drift and noise are looked at, as a share of the range.
const NEAREST: f64 = 1e-8;
/// From one place to the next one nearer to the end.
const RATIO: f64 = 4.0;
/// Share of the noise in the middle of the axis below which there is none at its end.
const NOTHING: f64 = 1e-20;
/// Growth of u · 2a/b² over all places from which on it has no limit.
const UNBOUNDED: f64 = 30.0;
/// Exponents are read at so many places.
const PLACES: usize = 8;

/// An end of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// Where the axis begins.
    Lower,
    /// Where it ends.
    Upper,
}

impl End {
    /// Both.
    pub(crate) const ALL: [Self; 2] = [Self::Lower, Self::Upper];

    /// Its coordinate.
    pub(crate) fn of(self, axis: &Axis) -> f64 {
        match self {
            Self::Lower => axis.from(),
            Self::Upper => axis.to(),
        }
    }

    /// Sign of the direction from it into the axis.
    fn inward(self) -> f64 {
        match self {
            Self::Lower => 1.0,
            Self::Upper => -1.0,
        }
    }
}

/// The exponent ν of the density p ~ u^ν at the distance u from a natural end; infinite where no power is strong
/// enough. `None` where noise acts at the end, or for a system with more axes or with a period.
pub(crate) fn exponent_at(system: &dyn System, axis: &Axis, end: End) -> Option<f64> {
    if system.dimension() != 1 || system.facts().period.is_some() {
        return None;
    }
    let (at, length) = (end.of(axis), axis.to() - axis.from());
    // Places next to the end, the nearest first, then the end and the middle.
    let distance = |place: usize| length * NEAREST * RATIO.powi(place as i32);
    let mut places = [at; LANES];
    for (place, slot) in places.iter_mut().enumerate().take(PLACES) {
        *slot = at + end.inward() * distance(place);
    }
    places[PLACES + 1] = 0.5 * (axis.from() + axis.to());
    let (drift, intensity) = look(system, &places);
    let is_natural = intensity[PLACES] <= NOTHING * intensity[PLACES + 1];
    let is_noisy = intensity[..PLACES].iter().all(|one| *one > 0.0);
    if !(is_natural && is_noisy) {
        return None;
    }
    let rate =
        |place: usize| 2.0 * end.inward() * drift[place] * distance(place) / intensity[place];
    let (nearest, farthest) = (rate(0), rate(PLACES - 1));
    if nearest.abs() > UNBOUNDED * farthest.abs().max(1.0) {
        return Some(nearest.signum() * f64::INFINITY);
    }
    // The order of the noise, from one place to the next. Both are off by multiples of the distance and of its square,
    // which fall out.
    let order = |place: usize| (intensity[place + 1] / intensity[place]).ln() / RATIO.ln();
    let found = |place: usize| rate(place) - order(place);
    let limit = limit_at_zero([0, 1, 2].map(found), RATIO);
    limit.is_finite().then_some(limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Interpretation, TypedModel, absorbs};

    fn exponents(drift: &str, noise: &str, to: f64) -> [Option<f64>; 2] {
        let model = TypedModel::new("typed", "A typed system", ["x"])
            .with_equation("x", drift)
            .with_noise("x", [noise])
            .with_interpretation(Interpretation::Ito);
        let system = model.build().unwrap().system_with(&[]).unwrap();
        let axis = Axis::uniform(0.0, to, 10).unwrap();
        End::ALL.map(|end| exponent_at(system.as_ref(), &axis, end))
    }

    #[test]
    fn exponents_are_those_of_textbooks() {
        // Verhulst: p ~ x^(2a/σ² - 2). Feller's square root: p ~ x^(2a/σ² - 1). Wright and Fisher: mutations on either
        // side.
        let near = |found: Option<f64>, exact: f64| (found.unwrap() - exact).abs() < 1e-6;
        let verhulst = exponents("0.3 x - x^2", "0.5 x", 6.0);
        assert!(
            near(verhulst[0], 0.4) && verhulst[1].is_none(),
            "{verhulst:?}"
        );
        let feller = exponents("0.3 - x", "0.5 sqrt(x)", 6.0);
        assert!(near(feller[0], 1.4) && feller[1].is_none(), "{feller:?}");
        let genes = exponents("0.1 (1 - x) - 0.2 x", "0.7 sqrt(x (1 - x))", 1.0);
        let exact = [0.1, 0.2].map(|rate| 2.0 * rate / 0.49 - 1.0);
        assert!(
            near(genes[0], exact[0]) && near(genes[1], exact[1]),
            "{genes:?}"
        );
    }

    #[test]
    fn a_power_of_minus_one_is_told_where_equations_bend_toward_the_end() {
        // Growth 1 against an uptake that saturates, read by Stratonovich: p ~ x^(2(1 - b)/σ² - 1). From b = 1 on all
        // mass ends at 0.
        let powers = [0.9, 1.0, 1.1].map(|b: f64| {
            let drift = format!("x (1 - x/8) - {b} x/(1 + x) + 0.08 x");
            exponents(&drift, "0.4 x", 31.0)[0].unwrap()
        });
        for (found, exact) in powers.into_iter().zip([0.25, -1.0, -2.25]) {
            assert!((found - exact).abs() < 1e-9, "{found} {exact}");
        }
        assert_eq!(powers.map(absorbs), [false, true, true]);
    }

    #[test]
    fn a_drift_that_noise_does_not_balance_has_no_power() {
        // At N the drift of an epidemic points inward without noise; x' = -x² with noise x² is drawn to zero faster
        // than any power.
        let [low, high] = exponents("5 x - 0.5 x^2", "0.03 x (100 - x)", 100.0);
        let exact = 10.0 / (1e4 * 0.03 * 0.03) - 2.0;
        assert!((low.unwrap() - exact).abs() < 1e-6);
        assert_eq!(high, Some(f64::INFINITY));
        assert_eq!(exponents("-x^2", "x^2", 1.0)[0], Some(f64::NEG_INFINITY));
    }
}
