//! The registry of indicators: the list of those that are stored. Each has its name in its own file.

use super::IndicatorKind;

impl IndicatorKind {
    /// All but test functions, which are not stored.
    pub const ALL: [Self; 24] = [
        Self::CURVATURE,
        Self::OPPOSITE_CURVATURE,
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
        Self::merger(false),
        Self::merger(true),
        Self::natural_end(false),
        Self::natural_end(true),
    ];

    /// The one that has this code.
    pub(crate) fn of_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }
}
