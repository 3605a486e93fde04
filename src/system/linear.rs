//! The linear equation of small deviations from a state that neither drift nor noise moves.

/// dv = A v dt + Σ B_k v dW_k in Itô's sense: what small deviations v from a fixed point obey.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearised {
    /// A, by rows: the derivatives of the Itô drift, in 1/t.
    pub drift: Vec<Vec<f64>>,
    /// B of each noise, by rows: the derivatives of its amplitudes, in 1/√t.
    pub noises: Vec<Vec<Vec<f64>>>,
}

impl Linearised {
    /// The rate, in 1/t, at which a density that is the same everywhere about the fixed point thins out:
    /// tr A - ½ Σ ((tr B_k)² + tr B_k²).
    ///
    /// The stationary density beside a fixed point that repels goes like r^(γ - d) at the distance r in d dimensions,
    /// with g(-γ) = 0, where g(p) = lim ln E|v|^p / t is convex and g(0) = 0. A constant density is a solution of the
    /// Fokker-Planck equation of the linear one but for its growth, so that g(-d) is minus this rate: where it is
    /// positive, γ > d and the density vanishes at the fixed point, where it is negative it is infinite there. In one
    /// dimension γ - 1 = 2 (a - b²)/b². (Moments: L. Arnold, *Random Dynamical Systems*, Springer 1998, section 6.2.)
    pub(crate) fn thinning(&self) -> f64 {
        let trace = |m: &[Vec<f64>]| (0..m.len()).map(|i| m[i][i]).sum::<f64>();
        let of_square = |m: &[Vec<f64>]| {
            let pairs = (0..m.len()).flat_map(|i| (0..m.len()).map(move |j| (i, j)));
            pairs.map(|(i, j)| m[i][j] * m[j][i]).sum::<f64>()
        };
        let noises = self.noises.iter();
        let spread = noises.map(|b| trace(b).powi(2) + of_square(b)).sum::<f64>();
        trace(&self.drift) - 0.5 * spread
    }
}

/// Why there is no linear equation about a state.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FixedPointFault {
    /// The drift or a noise moves the state.
    #[error("the state moves along axis {axis}: drift {drift}, amplitude of the noise {noise}")]
    Moves {
        /// The axis along which it moves most.
        axis: usize,
        /// Drift there.
        drift: f64,
        /// The largest amplitude of a noise there.
        noise: f64,
    },
    /// Drift or noise has no derivative there.
    #[error("drift or noise along axis {axis} has no derivative at the state")]
    Rough {
        /// The axis.
        axis: usize,
    },
    /// The equations are not known as formulas.
    #[error("the equations are not known as formulas")]
    NoFormulas,
    /// The parameter's value is not allowed.
    #[error("a parameter has a value there that is not allowed")]
    NotAllowed,
}

#[cfg(test)]
mod tests {
    use super::Linearised;

    #[test]
    fn a_density_turns_from_infinite_to_zero_where_it_neither_thins_out_nor_piles_up() {
        // On one axis the power is 2a/b² - 2.
        for (a, b) in [(0.3f64, 0.5f64), (0.2, 0.5), (1.0, 1.0)] {
            let linear = Linearised {
                drift: vec![vec![a]],
                noises: vec![vec![vec![b]]],
            };
            let power = 2.0 * a / (b * b) - 2.0;
            assert!((linear.thinning() - 0.5 * b * b * power).abs() < 1e-15);
        }
        // Noise in the stiffness of an oscillator: the damping alone.
        let linear = Linearised {
            drift: vec![vec![0.0, 1.0], vec![-1.0, 0.07]],
            noises: vec![vec![vec![0.0, 0.0], vec![0.5, 0.0]]],
        };
        assert!((linear.thinning() - 0.07).abs() < 1e-15);
        // Two equal axes under one noise, dx_i = a x_i dt + b x_i dW: r goes like the one of one axis, and
        // p ~ r^(γ - 2) with γ = 2 (a - b²/2)/b², which is 2 at a = 3 b²/2.
        let of = |a: f64| Linearised {
            drift: vec![vec![a, 0.0], vec![0.0, a]],
            noises: vec![vec![vec![0.4, 0.0], vec![0.0, 0.4]]],
        };
        assert!(of(1.5 * 0.16).thinning().abs() < 1e-15 && of(0.25).thinning() > 0.0);
    }
}
