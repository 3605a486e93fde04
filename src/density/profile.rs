//! What the equations of a system with one axis say of its density between the cells: where it has extrema, and where
//! its slope has.
//!
//! Without flux through the ends, (log p)' = 2a/b² - (b²)'/b² with drift a and noise intensity b² in the sense of Itô:
//! the stationary solution in one variable, with D⁽¹⁾ = a and D⁽²⁾ = b²/2 in H. Risken, The Fokker-Planck Equation, 2nd
//! edition, Springer 1989, section 5.2.

/// The extrema of a density over one axis and of the slope of its logarithm, found from drift and noise: they depend on
/// no cells. Places are coordinates of the axis, in its unit; densities have the inverse of that unit, and their
/// integral over the range of the axis is one.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Profile {
    /// Peaks and valleys by turns, in ascending place. An end of the range may be a peak.
    pub extrema: Vec<Extremum>,
    /// Extrema of the slope of log p, in ascending place: a peak and a valley are born together where one passes zero.
    pub turns: Vec<Turn>,
    /// Places where that slope jumps, ascending.
    pub jumps: Vec<SlopeJump>,
    /// p''/p at the centre of symmetry, and its error, both over the square of the axis's unit; `None` without a
    /// centre.
    pub curvature: Option<(f64, f64)>,
    /// Exponents ν of p ~ u^ν at the distance u from the lower and the upper end of the range, where these are natural:
    /// the noise dies there. Infinite where the density vanishes faster than any power.
    pub ends: [Option<f64>; 2],
}

/// A peak or a valley of a density over one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extremum {
    /// Its coordinate, in the axis's unit: a zero of (log p)', or where that slope jumps from one sign to the other.
    pub place: f64,
    /// Whether it is a peak.
    pub is_peak: bool,
    /// The density there, over the axis's unit; ∫ p = 1 over the range. At a natural end that is a peak, where it has
    /// no bound, the density next to it: 2⁻⁴⁰ of a cell away.
    pub density: f64,
    /// Its natural logarithm, of the density in the inverse of the axis's unit: weak noise makes peaks whose density is
    /// too small for a number, and that are peaks all the same.
    pub log_density: f64,
    /// Error of log p (a number without unit) that has gathered from the lower end of the range up to here: that of the
    /// ratio of two densities is the difference of theirs.
    pub gathered_error: f64,
}

/// An extremum of the slope of the logarithm of a density.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Turn {
    /// Its coordinate, in the axis's unit.
    pub place: f64,
    /// Whether the slope is largest there, not least.
    pub is_largest: bool,
    /// (log p)' there, over the axis's unit. At a jump it is that on the side where the extremum is.
    pub slope: f64,
    /// Its error, over the axis's unit.
    pub error: f64,
}

/// A jump of the slope of the logarithm of a density, where the drift or the slope of the noise jumps.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SlopeJump {
    /// Its coordinate, in the axis's unit.
    pub place: f64,
    /// (log p)' below and above, over the axis's unit.
    pub slopes: [f64; 2],
    /// Error of either, over the axis's unit.
    pub error: f64,
}
