//! How an axis ends, and how its line does.

/// How an axis ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum AxisEnd {
    /// At a wall.
    Wall,
    /// Where the noise dies; the density goes like this power of the distance.
    Natural(f64),
    /// Nowhere: the range ends, and the equations go on.
    Open,
}

/// From a place beyond the range to the next, as a factor of the distance from the mean: four steps double it.
pub(super) const STEP: f64 = 1.189_207_115_002_721;
/// Where a line ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reached {
    /// Where the noise dies, and the exponent of the density there, if it is a power.
    pub(super) natural: Option<(f64, f64)>,
    /// From where distances are, whose logarithms are even, if the line goes on beyond the range there.
    pub(super) open_from: Option<f64>,
    /// Whether ∫ dx/b has no bound toward the end of the axis, so that more of the line is always possible.
    pub(super) infinitely_far: bool,
}
