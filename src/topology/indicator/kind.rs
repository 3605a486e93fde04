//! What an indicator is: how it is read, what it is called, and what its zero means.

use super::Indicator;
use super::words::Step;
use crate::density::EstimatedDensity;

/// How an indicator is read, and what its zero means.
pub trait Behaviour: Sync {
    /// Words that no other indicator has, for files that are read again.
    fn code(&self) -> &'static str;

    /// The words used in tables.
    fn name(&self) -> &'static str {
        self.code()
    }

    /// The title of its panel in figures.
    fn title(&self) -> &'static str {
        self.name()
    }

    /// Reads it off a density, nearest to a place, one coordinate an axis; `None` where there is none.
    fn read(&self, estimated: &EstimatedDensity, near: &[f64]) -> Option<Indicator>;

    /// What happens where it passes zero; `None` where the counts alone tell.
    fn words(&self, step: &Step) -> Option<&'static str> {
        let _ = step;
        None
    }

    /// Those that may vanish on its curve in a density with so many axes: what it leads to differs from there on.
    fn companions(&self, axes: usize) -> Vec<IndicatorKind> {
        let _ = axes;
        Vec::new()
    }

    /// Whether its zero is a bifurcation by itself. That of a test function makes a point of codimension two where
    /// another indicator is zero too.
    fn is_bifurcation(&self) -> bool {
        true
    }

    /// Whether it is read at a centre of symmetry.
    fn is_at_centre(&self) -> bool {
        false
    }

    /// Whether it follows from the equations alone: no cells take part.
    fn is_exact(&self) -> bool {
        false
    }

    /// Of one that is read on one side of a kink: whether that is the upper side.
    fn side_of_kink(&self) -> Option<bool> {
        None
    }

    /// Of the fold of a marginal: whether the density rises with the coordinate between valley and peak.
    fn rising(&self) -> Option<bool> {
        None
    }

    /// Of a pair that is born at a kink: the indicator of the same pair born beside it.
    fn away_from_kink(&self) -> Option<IndicatorKind> {
        None
    }

    /// The indicator at the mirror image of its place in a symmetric density over one axis; `None` where it has no
    /// other.
    fn mirror(&self) -> Option<IndicatorKind> {
        None
    }
}

/// Which derivative an indicator is, one of [`IndicatorKind::ALL`] or a test function.
#[derive(Clone, Copy)]
pub struct IndicatorKind(pub(super) &'static dyn Behaviour);

impl std::ops::Deref for IndicatorKind {
    type Target = dyn Behaviour;

    fn deref(&self) -> &Self::Target {
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
