//! The largest Lyapunov exponent λ of a fixed point that multiplicative noise leaves alone: small deviations from it
//! grow or die out like e^{λt}, for almost every path. Where λ passes zero is a D-bifurcation.
//!
//! On one axis λ = a' - ½ Σ b_k'². On two axes it is an average over the angle of the deviation (Khasminskii's
//! formula), whose stationary density is found by Fourier modes: see `angle`. An angle that no noise moves, or that
//! has a direction which nothing leaves, is treated exactly.
//!
//! Source: L. Arnold, *Random Dynamical Systems*, Springer 1998, sections 6.2 and 9.

mod angle;
mod banded;
mod waves;

use crate::system::{Family, FixedPointFault, Linearised};

/// A Lyapunov exponent with its error, in 1/t.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Exponent {
    /// The exponent.
    pub value: f64,
    /// What fewer modes change, and rounding.
    pub error: f64,
}

impl Exponent {
    /// Whether it is below zero beyond its error: almost every path that starts near the fixed point ends in it.
    pub(crate) fn attracts(&self) -> bool {
        self.value + self.error < 0.0
    }
}

/// Why there is no exponent.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExponentError {
    /// There is no linear equation about the state.
    #[error(transparent)]
    FixedPoint(#[from] FixedPointFault),
    /// Exponents are worked out on one axis and on two.
    #[error("the system has {axes} axes; exponents are worked out of one axis and of two")]
    Axes {
        /// Axes of the system.
        axes: usize,
    },
}

/// Exponents of the fixed point that a family asks for; `None` where it asks for none.
pub(crate) fn of_family(
    family: &Family,
    coordinate: f64,
) -> Option<Result<Exponent, ExponentError>> {
    let state = family.questions.fixed_point.as_deref()?;
    let linear = family.linearised(coordinate, state);
    Some(
        linear
            .map_err(ExponentError::from)
            .and_then(|linear| largest(&linear)),
    )
}

/// The largest Lyapunov exponent of dv = A v dt + Σ B_k v dW_k in Itô's sense.
///
/// ```
/// use pbif::exponent::largest;
/// use pbif::system::Linearised;
///
/// // dx = x dt + 2 x dW: the logarithm of x drifts by 1 - 2²/2.
/// let linear = Linearised { drift: vec![vec![1.0]], noises: vec![vec![vec![2.0]]] };
/// assert_eq!(largest(&linear)?.value, -1.0);
/// # Ok::<(), pbif::exponent::ExponentError>(())
/// ```
///
/// # Errors
/// [`ExponentError::Axes`].
pub fn largest(linear: &Linearised) -> Result<Exponent, ExponentError> {
    let noises = linear.noises.iter();
    match linear.drift.as_slice() {
        [row] if row.len() == 1 => {
            let (a, b) = (row[0], noises.map(|noise| 0.5 * noise[0][0].powi(2)));
            let halves: f64 = b.sum();
            Ok(Exponent {
                value: a - halves,
                error: 4.0 * f64::EPSILON * (a.abs() + halves),
            })
        }
        [first, second] if first.len() == 2 && second.len() == 2 => {
            let matrix = |rows: &[Vec<f64>]| [[rows[0][0], rows[0][1]], [rows[1][0], rows[1][1]]];
            let noises: Vec<_> = noises.map(|noise| matrix(noise)).collect();
            Ok(angle::largest(&matrix(&linear.drift), &noises))
        }
        rows => Err(ExponentError::Axes { axes: rows.len() }),
    }
}

#[cfg(test)]
mod tests;
