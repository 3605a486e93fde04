//! The other indicators that may pass zero where an event is.

use super::Point;
use super::events::{Event, present};
use crate::density::EstimatedDensity;
use crate::topology::{FeatureKind, IndicatorKind};

impl Event {
    /// The same born at an inflection beside the kink that it was seen at; `None` where no other place is known.
    pub(super) fn at_inflection(&self) -> Option<Self> {
        let (kind, place) = self.indicator.as_ref()?;
        Some(Self {
            indicator: Some(((kind.traits().away_from_kink)()?, place.clone())),
            ..self.clone()
        })
    }

    /// The same where a peak of one axis meets the valley on its other side: which of its two valleys it was born with,
    /// or vanishes with, does not follow from their heights at a value some way off. `None` where there is none.
    pub(super) fn on_other_flank(&self, point: &Point, observable: usize) -> Option<Self> {
        let (rising, peak) = self.flank()?;
        let between = peak + 0.5 * to_valley(point, observable, peak, rising)?;
        Some(self.by(IndicatorKind::shoulder(!rising), between))
    }

    /// The same of a marginal as the end of a valley between two peaks, or of a peak between two valleys: its valley
    /// and the peak itself.
    pub(super) fn at_merger(&self, point: &Point, observable: usize) -> Vec<Self> {
        let Some((rising, peak)) = self.flank() else {
            return Vec::new();
        };
        let valley = to_valley(point, observable, peak, !rising);
        let valley = valley.map(|apart| self.by(IndicatorKind::merger(false), peak + apart));
        let own = self.by(IndicatorKind::merger(true), peak);
        valley.into_iter().chain([own]).collect()
    }

    /// Of a peak of one axis that is born on a flank, or vanishes on it: whether the density rises from the valley to
    /// it, and where it is.
    fn flank(&self) -> Option<(bool, f64)> {
        let (kind, _) = self.indicator.as_ref()?;
        match self.place[..] {
            [peak] => Some((kind.traits().rising?, peak)),
            _ => None,
        }
    }

    /// The same with another indicator, looked for at a place.
    fn by(&self, kind: IndicatorKind, place: f64) -> Self {
        Self {
            indicator: Some((kind, vec![place])),
            ..self.clone()
        }
    }

    /// Whether the density bends at a plane between the critical point of a joint density and the one that it is born
    /// with.
    pub(super) fn is_across_bend(&self, density: &EstimatedDensity) -> bool {
        let kinks = density.structure.kinks.iter();
        let Some((_, between)) =
            (self.indicator.as_ref()).filter(|one| one.0 == IndicatorKind::FOLD)
        else {
            return false;
        };
        let mut bends = kinks.filter(|kink| kink.is_bend() && kink.axis < between.len());
        bends.any(|kink| {
            let (own, middle) = (self.place[kink.axis], between[kink.axis]);
            (kink.at - middle).abs() <= (own - middle).abs()
        })
    }

    /// The same as a critical point that stays and changes its type, where the density is symmetric about it: the peak
    /// or crater itself, or the saddle that it grows from.
    pub(super) fn at_symmetry(&self) -> Vec<Self> {
        let is_peak = match self.feature {
            FeatureKind::Peak => true,
            FeatureKind::Crater => false,
            FeatureKind::Ring | FeatureKind::Valley => return Vec::new(),
        };
        let Some((_, between)) =
            (self.indicator.as_ref()).filter(|one| one.0 == IndicatorKind::FOLD)
        else {
            return Vec::new();
        };
        let pairs = self.place.iter().zip(between);
        let saddle: Vec<f64> = pairs.map(|(own, between)| 2.0 * between - own).collect();
        [(true, self.place.clone()), (false, saddle)]
            .map(|(is_it, place)| Self {
                indicator: Some((IndicatorKind::split(is_peak, is_it), place)),
                ..self.clone()
            })
            .into()
    }
}

/// How far the nearest valley above a peak, or below it, lies from it along an axis, with its sign.
fn to_valley(point: &Point, observable: usize, peak: f64, is_above: bool) -> Option<f64> {
    let axis = &point.densities[observable].density.axes[0];
    let valleys = present(point, observable, FeatureKind::Valley).into_iter();
    let apart = valleys.map(|valley| axis.apart(valley.position[0], peak));
    let on_side = apart.filter(|apart| (*apart > 0.0) == is_above);
    on_side.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}
