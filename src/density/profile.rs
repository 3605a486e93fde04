//! What the equations of a system with one axis say of its density between the cells: where it has extrema, and where its slope has.

/// The extrema of a density over one axis and of the slope of its logarithm, found from drift and noise: they depend on no cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    /// Peaks and valleys by turns, in ascending place. An end of the range may be a peak.
    pub extrema: Vec<Extremum>,
    /// Extrema of the slope of log p, in ascending place: a peak and a valley are born together where one passes zero.
    pub turns: Vec<Turn>,
    /// Places where that slope jumps.
    pub jumps: Vec<SlopeJump>,
    /// p''/p at the centre of symmetry, and its error; `None` without one.
    pub curvature: Option<(f64, f64)>,
}

/// A peak or a valley of a density over one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// Where.
    pub place: f64,
    /// Whether it is a peak.
    pub is_peak: bool,
    /// The density there.
    pub density: f64,
    /// Error of the density's logarithm that has gathered from the lower end of the range up to here: differences count.
    pub gathered_error: f64,
}

/// An extremum of the slope of the logarithm of a density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Where.
    pub place: f64,
    /// Whether the slope is largest there, not least.
    pub is_largest: bool,
    /// (log p)' there, per unit of the coordinate.
    pub slope: f64,
    /// Its error.
    pub error: f64,
}

/// A jump of the slope of the logarithm of a density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlopeJump {
    /// Where.
    pub place: f64,
    /// (log p)' below and above.
    pub slopes: [f64; 2],
    /// Their error.
    pub error: f64,
}
