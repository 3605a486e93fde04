//! Questions of fluctuations in a steady state: whose spectra, at which frequencies. What they ask is worked out in
//! [`crate::spectrum`].

use std::sync::Arc;

use super::Quantity;

/// A function of the state whose fluctuations are looked at.
#[derive(Debug, Clone)]
pub enum Fluctuating {
    /// An axis of the state, by its number, and its name.
    Axis(usize, String),
    /// A quantity.
    Quantity(Arc<Quantity>),
}

impl Fluctuating {
    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            Self::Axis(_, name) => name,
            Self::Quantity(quantity) => quantity.name(),
        }
    }
}

/// Whether the power of negative frequencies counts with that of positive ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sides {
    /// It does not: the variance is the integral over all frequencies of either sign, over 2π.
    #[default]
    Two,
    /// It does: the variance is the integral over the positive frequencies, over 2π.
    One,
}

words! {
    Sides, pub name:
    Two: "two",
    One: "one",
}

impl Sides {
    /// By what the two-sided spectrum is multiplied.
    pub(crate) fn factor(self) -> f64 {
        match self {
            Self::Two => 1.0,
            Self::One => 2.0,
        }
    }
}

/// Angular frequencies, per unit time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The lowest, where they stand evenly in their logarithms; they begin at zero otherwise.
    pub from: Option<f64>,
    /// The highest; `None` where it is left to the program.
    pub to: Option<f64>,
    /// How many there are.
    pub points: usize,
}

impl Band {
    /// All frequencies, ascending; none where the highest is not known.
    pub fn frequencies(&self) -> Vec<f64> {
        let Some(to) = self.to else {
            return Vec::new();
        };
        let last = self.points.saturating_sub(1).max(1) as f64;
        let share = |number: usize| number as f64 / last;
        let at = |number: usize| match self.from {
            Some(from) => from * (to / from).powf(share(number)),
            None => to * share(number),
        };
        (0..self.points).map(at).collect()
    }
}

/// Whose spectra are wanted, and where.
#[derive(Debug, Clone)]
pub struct SpectrumQuestion {
    /// What fluctuates.
    pub observables: Vec<Fluctuating>,
    /// Pairs of their numbers; a power spectrum where both are the same.
    pub pairs: Vec<(usize, usize)>,
    /// The frequencies.
    pub band: Band,
    /// What a spectrum's integral is.
    pub sides: Sides,
    /// Longest lag at which correlations are wanted, as many as there are frequencies; none without.
    pub lag: Option<f64>,
}

impl SpectrumQuestion {
    /// Name of a pair in tables: `x`, or `x, y` of a cross spectrum.
    pub(crate) fn name(&self, (one, other): (usize, usize)) -> String {
        let name = |number: usize| self.observables[number].name();
        match one == other {
            true => name(one).to_owned(),
            false => format!("{}, {}", name(one), name(other)),
        }
    }

    /// Distance between lags, and how many there are.
    pub(crate) fn lags(&self) -> (f64, usize) {
        let count = self.band.points;
        match self.lag {
            Some(lag) => (lag / count.saturating_sub(1).max(1) as f64, count),
            None => (0.0, 0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_stand_evenly() {
        let even = Band {
            from: None,
            to: Some(2.0),
            points: 5,
        };
        assert_eq!(even.frequencies(), [0.0, 0.5, 1.0, 1.5, 2.0]);
        let logarithmic = Band {
            from: Some(0.01),
            to: Some(100.0),
            points: 5,
        };
        for (found, wanted) in logarithmic
            .frequencies()
            .iter()
            .zip([0.01, 0.1, 1.0, 10.0, 100.0])
        {
            assert!((found / wanted - 1.0).abs() < 1e-12);
        }
        let open = Band { to: None, ..even };
        assert!(open.frequencies().is_empty());
    }
}
