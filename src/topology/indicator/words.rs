//! What happens at a P-bifurcation, in words.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use super::IndicatorKind;
use crate::topology::Signature;

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
