//! How what is watched fluctuates in a steady state: spectra over the frequency, correlations over the lag.

/// The spectrum of one observable, or of two, at a value of the parameter. Frequencies and lags are those that the
/// family asks for ([`Questions::spectrum`](crate::system::Questions::spectrum)).
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fluctuations {
    /// Name of the observable, or of both: `x`, `x, y`.
    pub of: String,
    /// Power at each frequency with its error, in the squared unit of the observable times that of time; the real part
    /// of a cross spectrum.
    pub power: Vec<(f64, f64)>,
    /// The imaginary part of a cross spectrum; empty of a power spectrum.
    pub imaginary: Vec<(f64, f64)>,
    /// Covariance at each lag with its error.
    pub correlation: Vec<(f64, f64)>,
}
