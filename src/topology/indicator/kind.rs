//! What an indicator is: how it is read, what it is called, and what its zero means.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use super::Indicator;
use crate::density::EstimatedDensity;
use crate::topology::Signature;

/// Reads an indicator off a density, nearest to a place, one coordinate an axis; `None` where there is none.
pub(super) type Read = fn(&EstimatedDensity, &[f64]) -> Option<Indicator>;

/// What an indicator is.
pub(crate) struct Traits {
    /// Words that no other indicator has, for files that are read again.
    pub(super) code: &'static str,
    /// The words used in tables.
    pub(super) name: &'static str,
    /// The title of its panel in figures.
    pub(crate) title: &'static str,
    /// How it is read.
    pub(crate) read: Read,
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
    /// Whether its error is of what it is read for, and not of the cells alone: finer ones leave what they say of it.
    pub(crate) keeps_error: bool,
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
    pub(super) const fn new(code: &'static str, read: Read) -> Self {
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
            keeps_error: false,
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
    pub(crate) fn code(self) -> &'static str {
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

/// A change of signature as the parameter rises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step {
    /// Whether the indicator that is zero there rises.
    pub(crate) rises: bool,
    /// The signature below.
    pub(crate) before: Signature,
    /// The signature above.
    pub(crate) after: Signature,
}

impl Step {
    /// What happens: in the words of the indicator that is zero there, in those of what is counted where several
    /// changes cannot be told apart, and where no indicator tells.
    pub(crate) fn words(&self, kind: Option<IndicatorKind>, is_several: bool) -> &'static str {
        if self.before == self.after {
            return "comes and goes";
        }
        let own = kind.filter(|_| !is_several);
        let own = own.and_then(|kind| (kind.traits().words)(self));
        own.or_else(|| self.of_rings())
            .unwrap_or_else(|| match (self.craters(), self.peaks()) {
                (Greater, _) => "crater opens",
                (Less, _) => "crater closes",
                _ if kind.is_some() || is_several => self.of_centre(),
                (Equal, Greater) => "peak appears",
                (Equal, _) => "peak vanishes",
            })
    }

    /// How the number of craters changes.
    pub(super) fn craters(&self) -> Ordering {
        self.after.craters.cmp(&self.before.craters)
    }

    /// How the number of peaks changes.
    pub(super) fn peaks(&self) -> Ordering {
        self.after.peaks.cmp(&self.before.peaks)
    }

    /// Beside other peaks that stand, the centre becomes a peak between two new valleys, or is one no more.
    pub(super) fn of_centre(&self) -> &'static str {
        match (self.rises, self.peaks()) {
            (true, Less) => "peak at the centre vanishes",
            (true, _) => "symmetric split",
            (false, Greater) => "peak at the centre is born",
            (false, _) => "symmetric merger",
        }
    }

    fn of_rings(&self) -> Option<&'static str> {
        let (before, after) = (self.before, self.after);
        let same_peaks = before.peaks == after.peaks;
        Some(match (after.rings.cmp(&before.rings), self.craters()) {
            (Equal, _) => return None,
            (Greater, Greater) if same_peaks => "ring is born",
            (Greater, Greater) => "ring opens",
            (Less, Less) if same_peaks => "ring vanishes",
            (Less, Less) => "ring closes",
            (Less, _) if after.rings > 0 => "rings merge",
            (Greater, _) if before.rings > 0 => "ring parts",
            (Greater, _) => "rim becomes level",
            (Less, _) => "rim breaks into peaks",
        })
    }
}
