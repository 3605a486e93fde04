//! What an indicator is: how it is read, what it is called, and what its zero means.

use super::Indicator;
use super::words::Step;
use crate::density::EstimatedDensity;

/// What an indicator is.
pub(crate) struct Traits {
    /// Words that no other indicator has, for files that are read again.
    pub(super) code: &'static str,
    /// The words used in tables.
    pub(super) name: &'static str,
    /// The title of its panel in figures.
    #[cfg_attr(not(feature = "figures"), expect(dead_code))]
    pub(crate) title: &'static str,
    /// Reads it off a density, nearest to a place, one coordinate an axis; `None` where there is none.
    pub(crate) read: fn(&EstimatedDensity, &[f64]) -> Option<Indicator>,
    /// What happens where it passes zero; `None` where the counts alone tell.
    pub(super) words: fn(&Step) -> Option<&'static str>,
    /// Those that may vanish on its curve in a density with so many axes: what it leads to differs from there on.
    pub(crate) companions: fn(usize) -> Vec<IndicatorKind>,
    /// Whether its zero is a bifurcation by itself. That of a test function makes a point of codimension two where
    /// another indicator is zero too.
    pub(crate) is_bifurcation: bool,
    /// Whether it is read at a centre of symmetry.
    pub(crate) is_at_centre: bool,
    /// Whether it follows from the equations alone: no cells take part.
    pub(crate) is_exact: bool,
    /// Of one that is read on one side of a kink: whether that is the upper side.
    pub(crate) side_of_kink: Option<bool>,
    /// Of the fold of a marginal: whether the density rises with the coordinate between valley and peak.
    pub(crate) rising: Option<bool>,
    /// Of a pair that is born at a kink: the indicator of the same pair born beside it.
    pub(crate) away_from_kink: fn() -> Option<IndicatorKind>,
    /// The indicator at the mirror image of its place in a symmetric density over one axis, if it has another there.
    pub(crate) mirror: fn() -> Option<IndicatorKind>,
}

impl Traits {
    /// Those of an indicator without further meaning that is called and read so.
    pub(super) const fn new(
        code: &'static str,
        read: fn(&EstimatedDensity, &[f64]) -> Option<Indicator>,
    ) -> Self {
        Self {
            code,
            name: code,
            title: code,
            read,
            words: |_| None,
            companions: |_| Vec::new(),
            is_bifurcation: true,
            is_at_centre: false,
            is_exact: false,
            side_of_kink: None,
            rising: None,
            away_from_kink: || None,
            mirror: || None,
        }
    }
}

/// Which derivative an indicator is, one of [`IndicatorKind::ALL`] or a test function.
#[derive(Clone, Copy)]
pub struct IndicatorKind(pub(super) &'static Traits);

impl IndicatorKind {
    /// Words that no other indicator has, for files that are read again.
    pub fn code(self) -> &'static str {
        self.0.code
    }

    /// The words used in tables.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// What it is, and what its zero means.
    pub(crate) fn traits(self) -> &'static Traits {
        self.0
    }
}

impl PartialEq for IndicatorKind {
    fn eq(&self, other: &Self) -> bool {
        self.code() == other.code()
    }
}

impl Eq for IndicatorKind {}

impl std::fmt::Debug for IndicatorKind {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.code())
    }
}
