//! The linear equation of small deviations from a state that neither drift nor noise moves.

/// dv = A v dt + Σ B_k v dW_k in Itô's sense: what small deviations v from a fixed point obey.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearised {
    /// A, by rows: the derivatives of the Itô drift, in 1/t.
    pub drift: Vec<Vec<f64>>,
    /// B of each noise, by rows: the derivatives of its amplitudes, in 1/√t.
    pub noises: Vec<Vec<Vec<f64>>>,
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
