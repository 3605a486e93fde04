//! The rims of a joint density's craters: which are rings, which peaks stand on them, and what lies within.

use super::candidate::{Candidate, is_smooth};
use super::critical::{Critical, height_above};
use super::enclosure::Enclosure;
use super::field::Field;
use super::persistence::CellValues;
use super::rim::{RimPeak, Summits, summits};
use super::significance::{Judgement, Limits};
use super::{Feature, FeatureErrors, FeatureKind, Signature, Verdict};
use crate::density::EstimatedDensity;
use crate::numerics::sort_descending;

/// A crater's rim.
pub(super) struct Rim {
    pub(super) around: Enclosure,
    /// Whether it is of one height within the errors: a ring.
    pub(super) is_ring: bool,
    /// Its crest; `None` where it could not be followed.
    summits: Option<Summits>,
    /// What is said of the peaks of the crest, in their order.
    judgements: Vec<Judgement>,
}

impl Rim {
    /// Whether a peak of the cells belongs to the rim, which has its own account of its peaks.
    pub(super) fn owns(&self, cell: usize) -> bool {
        let on_crest = self
            .summits
            .as_ref()
            .is_some_and(|one| one.pass_through(cell));
        on_crest || (self.is_ring && self.around.is_rim(cell))
    }

    /// Whether it runs around the centre of symmetry.
    pub(super) fn holds_centre(&self, estimated: &EstimatedDensity) -> bool {
        let axes = &estimated.density.axes;
        let Some(&[x, y]) = estimated.structure.centre.as_deref() else {
            return false;
        };
        let cell = axes[0].find(x).zip(axes[1].find(y));
        cell.is_some_and(|(row, column)| self.around.holds(row * axes[1].count() + column))
    }

    /// Number of peaks on it that are present, where it knows.
    fn peaks(&self) -> usize {
        let present = self
            .judgements
            .iter()
            .filter(|one| one.verdict == Verdict::Present);
        if self.is_ring { 0 } else { present.count() }
    }

    /// The ring, or the peaks of the crest with the valleys between; `whole` is the peak of the cells that stands for
    /// the rim as a whole.
    pub(super) fn features(
        &self,
        estimated: &EstimatedDensity,
        whole: Option<&Candidate>,
    ) -> Vec<Feature> {
        let Some(whole) = whole else {
            return Vec::new();
        };
        let cell = whole.component.birth;
        let top = whole.feature(estimated, FeatureKind::Peak, cell);
        let mut found = Vec::new();
        // Where the rim as a whole merges with what is higher.
        if let Some(saddle) = whole.component.death {
            found.push(whole.feature(estimated, FeatureKind::Valley, saddle));
        }
        if self.is_ring {
            found.push(Feature {
                kind: FeatureKind::Ring,
                partner: Some(self.around.middle(&estimated.density.axes)),
                ..top
            });
            return found;
        }
        let peaks = self.summits.iter().flat_map(|one| &one.peaks);
        for (index, (peak, judgement)) in peaks.zip(&self.judgements).enumerate() {
            if index == 0 {
                found.push(Feature {
                    position: peak.position.clone(),
                    density: peak.density,
                    ..top.clone()
                });
                continue;
            }
            let feature = |kind, position: &Vec<f64>, density, partner| Feature {
                kind,
                position: position.clone(),
                density,
                persistence: peak.height,
                standard_error: peak.error,
                significance: judgement.significance,
                verdict: judgement.verdict,
                partner,
                errors: FeatureErrors::default(),
            };
            let saddle = Some(peak.saddle.clone());
            found.push(feature(
                FeatureKind::Peak,
                &peak.position,
                peak.density,
                saddle,
            ));
            let low = peak.density - peak.height;
            found.push(feature(FeatureKind::Valley, &peak.saddle, low, None));
        }
        found
    }
}

/// The rims of the craters that are present. Basins that spill over into each other before they spill over a common rim
/// share it.
pub(super) fn rims(
    grid: CellValues<'_>,
    estimated: &EstimatedDensity,
    craters: &[Candidate],
    limits: &Limits,
) -> Vec<Rim> {
    let present = craters
        .iter()
        .filter(|one| one.judgement.verdict == Verdict::Present);
    let mut saddles: Vec<usize> = present
        .filter_map(|crater| crater.component.death)
        .collect();
    sort_descending(&mut saddles, |&place| grid.values[place]);
    let mut found: Vec<Rim> = Vec::new();
    for saddle in saddles {
        let around = Enclosure::at(grid, saddle);
        if !found.iter().any(|rim| rim.around.is_rim(around.top)) {
            found.push(judge(estimated, around, saddle, limits));
        }
    }
    found
}

/// A rim with its peaks.
fn judge(estimated: &EstimatedDensity, around: Enclosure, saddle: usize, limits: &Limits) -> Rim {
    let field = Field::new(estimated).filter(|_| is_smooth(estimated));
    let inside = around.middle(&estimated.density.axes);
    let summits = field.and_then(|field| summits(&field, estimated, &around, &inside));
    let Some(summits) = summits else {
        let is_ring = is_level(estimated, around.top, saddle, limits);
        return Rim {
            around,
            is_ring,
            summits: None,
            judgements: Vec::new(),
        };
    };
    let judge = |peak: &RimPeak| {
        let of_ends = limits.error_of_ends(peak.height, peak.density);
        limits.judge_exact(peak.height, peak.error + of_ends)
    };
    let judgements: Vec<Judgement> = summits.peaks.iter().map(judge).collect();
    let has_peaks = judgements
        .first()
        .is_some_and(|one| one.verdict == Verdict::Present);
    Rim {
        around,
        is_ring: !has_peaks,
        summits: Some(summits),
        judgements,
    }
}

/// Whether the highest and the lowest point of a rim are of one height within their errors.
fn is_level(estimated: &EstimatedDensity, top: usize, saddle: usize, limits: &Limits) -> bool {
    let values = &estimated.density.values;
    let rise = values[top] - values[saddle];
    let field = Field::new(estimated).filter(|_| is_smooth(estimated));
    let Some(field) = field else {
        let noise = estimated.standard_error[top].hypot(estimated.standard_error[saddle]);
        return limits.judge(rise, noise).verdict != Verdict::Present;
    };
    let near = |cell, kind| Critical::near(&field, &field.centre(cell), kind, values);
    let (Some(top), Some(low)) = (
        near(top, FeatureKind::Peak),
        near(saddle, FeatureKind::Valley),
    ) else {
        return false;
    };
    let (height, error) = height_above(&top, &low, estimated);
    let of_ends = limits.error_of_ends(height, top.value(values));
    limits.judge_exact(height, error + of_ends).verdict != Verdict::Present
}

/// What there is, and what lies within what.
pub(super) fn contents(peaks: &[Candidate], craters: &[Candidate], rims: &[Rim]) -> Signature {
    let is_present = |one: &&Candidate| one.judgement.verdict == Verdict::Present;
    let within = |rim: &&Rim| rims.iter().any(|other| other.around.holds(rim.around.top));
    let rings = || rims.iter().filter(|rim| rim.is_ring);
    let mut signature = Signature {
        craters: craters.iter().filter(is_present).count(),
        rings: rings().count(),
        enclosed_rings: rings().filter(within).count(),
        ..Signature::default()
    };
    for rim in rims {
        signature.peaks += rim.peaks();
        signature.enclosed_peaks += if within(&rim) { rim.peaks() } else { 0 };
    }
    for peak in peaks.iter().filter(is_present) {
        let cell = peak.component.birth;
        if !rims.iter().any(|rim| rim.owns(cell)) {
            signature.peaks += 1;
            let enclosed = rims.iter().any(|rim| rim.around.holds(cell));
            signature.enclosed_peaks += usize::from(enclosed);
        }
    }
    signature
}
