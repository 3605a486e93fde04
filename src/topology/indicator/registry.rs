//! The registry of indicators: a name each, and the list of those that are stored.

use super::IndicatorKind;
use super::{beside, centre, fold, level, quartic, ring, shoulder, split};

impl IndicatorKind {
    /// p''/p of a marginal at its centre of symmetry.
    pub const CURVATURE: Self = Self(&centre::CURVATURE);
    /// Slope of log p on the upper side of a kink at the centre of symmetry; in a symmetric density half its jump.
    pub const KINK_SLOPE: Self = Self(&centre::KINK_SLOPE);
    /// Curvature of a joint density along a kink through the centre of symmetry.
    pub const CURVATURE_ALONG_KINK: Self = Self(&centre::ALONG_KINK);
    /// The lower of the two principal curvatures of a joint density at its centre, axes scaled to their ranges.
    pub const LOWER_CURVATURE: Self = Self(&centre::LOWER);
    /// The upper one.
    pub const UPPER_CURVATURE: Self = Self(&centre::UPPER);
    /// Slope along a ridge or trench of a joint density where it is nearest to level, positive when a peak and a saddle
    /// (a saddle and a crater) are there.
    pub const FOLD: Self = Self(&fold::FOLD);
    /// Outward slope of a joint density between a moat and the ring around it, positive when both are there.
    pub const RING: Self = Self(&ring::RING);
    /// A test function: p''''/p at the centre, along the flattest direction of a joint density; negative where peaks
    /// are born at the centre as it splits, positive where they are born away from it.
    pub(crate) const QUARTIC: Self = Self(&quartic::QUARTIC);

    /// All but test functions, which are not stored.
    pub const ALL: [Self; 19] = [
        Self::CURVATURE,
        Self::KINK_SLOPE,
        Self::CURVATURE_ALONG_KINK,
        Self::LOWER_CURVATURE,
        Self::UPPER_CURVATURE,
        Self::shoulder(true),
        Self::shoulder(false),
        Self::beside_kink(false, false),
        Self::beside_kink(false, true),
        Self::beside_kink(true, false),
        Self::beside_kink(true, true),
        Self::FOLD,
        Self::RING,
        Self::level(false),
        Self::level(true),
        Self::split(false, false),
        Self::split(false, true),
        Self::split(true, false),
        Self::split(true, true),
    ];

    /// Slope at the inflection between a valley and a peak of a marginal, positive when both are there; `rising` where
    /// the density rises with the coordinate between the two.
    pub const fn shoulder(rising: bool) -> Self {
        Self(&shoulder::BOTH[rising as usize])
    }

    /// Slope of a marginal on one side of a kink, away from it, `above` where that is the side of larger coordinates;
    /// positive when the kink is an extremum, of the two the valley if `is_valley`, and another one lies on that side.
    pub(crate) const fn beside_kink(above: bool, is_valley: bool) -> Self {
        Self(&beside::SLOPES[above as usize][is_valley as usize])
    }

    /// Curvature of a joint density along one axis at a place that turns from a peak to the bottom within a ring, or at
    /// the saddle between two rings: positive when the ring is there. Both principal curvatures pass zero there
    /// together.
    pub const fn level(along_second: bool) -> Self {
        Self(&level::BOTH[along_second as usize])
    }

    /// Curvature of a joint density across a line on which it is its own mirror image, at a critical point on that
    /// line: positive when an extremum is there, a peak if `is_peak`, else a crater, and `is_it`; otherwise when a
    /// saddle is there, which becomes that extremum.
    pub const fn split(is_peak: bool, is_it: bool) -> Self {
        Self(&split::ALL[is_peak as usize][is_it as usize])
    }

    /// A test function: curvature of the logarithm of a marginal on one side of a kink.
    pub(super) const fn curvature_beside_kink(above: bool) -> Self {
        Self(&beside::CURVATURES[above as usize])
    }

    /// The one that has this code.
    pub(crate) fn of_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }
}
