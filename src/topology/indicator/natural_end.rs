//! The indicator of a maximum that leaves a natural end of the range, where the noise dies: the exponent ν of the
//! density p ~ u^ν at the distance u from it, with its sign turned.
//!
//! Where ν < 0 the density grows beyond any bound at the end, which is its peak; where ν > 0 it vanishes there. The
//! exponent follows from drift and noise ([`crate::density::Profile::ends`]): no cells take part.

use std::cmp::Ordering;

use super::kind::Traits;
use super::{Indicator, IndicatorKind};
use crate::density::EstimatedDensity;
use crate::topology::Step;

/// Error of an exponent, which is extrapolated from drift and noise next to the end.
const ERROR: f64 = 1e-8;

impl IndicatorKind {
    /// The exponent of a density over one axis at an end of the range where the noise dies, with its sign turned:
    /// positive when the end is a peak, where the density grows beyond any bound.
    pub(crate) const fn natural_end(is_upper: bool) -> Self {
        Self(&BOTH[is_upper as usize])
    }
}

/// At the lower end, and at the upper one.
static BOTH: [Traits; 2] = [
    Traits {
        words,
        ..Traits::new("exponent at the lower end", |density, _| {
            exponent(density, false)
        })
    },
    Traits {
        words,
        ..Traits::new("exponent at the upper end", |density, _| {
            exponent(density, true)
        })
    },
];

fn words(step: &Step) -> Option<&'static str> {
    let at_ends = step.after.at_ends.cmp(&step.before.at_ends);
    Some(match (at_ends, step.peaks()) {
        (Ordering::Greater, Ordering::Greater) => "peak at the end is born",
        (Ordering::Greater, _) => "peak reaches the end",
        (Ordering::Less, Ordering::Less) => "peak at the end vanishes",
        (Ordering::Less, _) => "peak leaves the end",
        (Ordering::Equal, _) => return None,
    })
}

/// -ν, positive where the end is a peak; `None` where noise acts at the end, or no power is strong enough.
fn exponent(estimated: &EstimatedDensity, is_upper: bool) -> Option<Indicator> {
    let [axis] = estimated.density.axes.as_slice() else {
        return None;
    };
    let profile = estimated.structure.profile.as_ref()?;
    let exponent = profile.ends[usize::from(is_upper)]?;
    let place = if is_upper { axis.to() } else { axis.from() };
    let kind = IndicatorKind::natural_end(is_upper);
    Indicator::known(kind, place, -exponent, ERROR)
}

/// The natural ends of a density over one axis that are its peaks, by their indicators.
pub(crate) fn peaks_at_ends(estimated: &EstimatedDensity) -> impl Iterator<Item = Indicator> {
    let found = [false, true].map(|is_upper| exponent(estimated, is_upper));
    found.into_iter().flatten().filter(|one| one.value > 0.0)
}
