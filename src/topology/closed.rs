//! Densities along axes that close on themselves: a circle, or a cylinder.
//!
//! Such a density is laid out over three turns, on a line, and looked at like any other; what lies in the middle
//! turn is what there is. Peaks and craters, their saddles and the places of indicators may lie across the seam
//! then. A peak of the middle turn has copies in the turns beside it: the highest one meets those at the lowest
//! saddle on the way round, which is a valley of its own.
//!
//! On a circle the highest peak counts, as on a line, however level the density is. Of a joint density whose highest
//! ridge runs around the cylinder without a peak that stands out it is a ring.
//!
//! A reflection of a circle holds two places fixed, half a turn from each other. Where a marginal is symmetric both are
//! centres with an indicator each, and peaks off both come in pairs.

use super::candidate::{Candidate, judge};
use super::exact::{by_kind_and_height, present_places};
use super::indicator::{at_centre, shoulders};
use super::persistence::{CellValues, Component, components, grid};
use super::place_error;
use super::significance::Limits;
use super::surroundings::{contents, rims};
use super::{Detection, Feature, FeatureKind, Flank, Indicator, IndicatorKind, Signature, Verdict};
use crate::density::{Density, EstimatedDensity, Kink, Structure, Truncation, Variants};
use crate::space::Axis;

/// Turns over which a density is laid out.
const TURNS: usize = 3;

/// Distance from a centre, in cells, within which a peak is the one at the centre.
const NEAR: f64 = 3.0;

/// A density with closed axes over three turns of each.
pub(super) struct Cover<'a> {
    own: &'a EstimatedDensity,
    laid: EstimatedDensity,
}

impl<'a> Cover<'a> {
    /// `None` where no axis closes on itself, or the density has not one value a cell.
    pub(super) fn of(own: &'a EstimatedDensity) -> Option<Self> {
        let axes = &own.density.axes;
        let cells: usize = axes.iter().map(Axis::count).product();
        let is_whole = own.density.values.len() == cells && own.standard_error.len() == cells;
        if !axes.iter().any(Axis::is_closed) || !is_whole {
            return None;
        }
        let laid: Option<Vec<Axis>> = axes.iter().map(unrolled).collect();
        let source = sources(axes);
        let pick = |values: &Vec<f64>| -> Vec<f64> {
            let picked = source.iter().filter_map(|&cell| values.get(cell));
            picked.copied().collect()
        };
        let variants = match &own.variants {
            Variants::None => Variants::None,
            Variants::Scheme(second) => Variants::Scheme(pick(second)),
            Variants::Jackknife(all) => Variants::Jackknife(all.iter().map(pick).collect()),
        };
        let laid = EstimatedDensity {
            observable: own.observable,
            density: Density {
                axes: laid?,
                values: pick(&own.density.values),
            },
            standard_error: pick(&own.standard_error),
            variants,
            structure: Structure {
                centre: own.structure.centre.clone().filter(|one| one.len() == 1),
                kinks: kinks(own),
                profile: None,
                ..own.structure.clone()
            },
            negligible: own.negligible,
            truncation: Truncation {
                share: own.truncation.share,
                change: pick(&own.truncation.change),
                level: own.truncation.level,
            },
        };
        Some(Self { own, laid })
    }

    fn is_marginal(&self) -> bool {
        self.own.density.axes.len() == 1
    }

    /// Whether a cell of the laid-out density lies in the middle turn of every closed axis.
    fn is_own(&self, cell: usize) -> bool {
        let axes = self.own.density.axes.iter().rev();
        let mut rest = cell;
        axes.into_iter().all(|axis| {
            let turns = if axis.is_closed() { TURNS } else { 1 };
            let position = rest % (turns * axis.count());
            rest /= turns * axis.count();
            position / axis.count() == turns / 2
        })
    }

    /// The copy of a cell of the laid-out density in the middle turn.
    fn own_copy(&self, cell: usize) -> usize {
        let (mut rest, mut stride, mut copy) = (cell, 1, 0);
        for axis in self.own.density.axes.iter().rev() {
            let (count, turns) = (axis.count(), if axis.is_closed() { TURNS } else { 1 });
            let position = rest % (turns * count);
            rest /= turns * count;
            copy += stride * (position % count + turns / 2 * count);
            stride *= turns * count;
        }
        copy
    }

    fn wrapped(&self, place: &[f64]) -> Vec<f64> {
        let axes = self.own.density.axes.iter();
        axes.zip(place).map(|(axis, &x)| axis.wrapped(x)).collect()
    }

    /// The same density with another centre of symmetry.
    fn about(&self, centre: Vec<f64>) -> EstimatedDensity {
        let mut laid = self.laid.clone();
        laid.structure.centre = Some(centre);
        laid
    }

    /// The place half a turn from the centre of a symmetric marginal.
    fn opposite(&self) -> Option<Vec<f64>> {
        let ([axis], [centre]) = (
            self.own.density.axes.as_slice(),
            self.laid.structure.centre.as_deref()?,
        ) else {
            return None;
        };
        let half = 0.5 * (axis.to() - axis.from());
        Some(vec![axis.wrapped(centre + half)])
    }

    /// The indicators at both centres of a symmetric marginal.
    fn indicators(&self) -> Vec<Indicator> {
        let mut found = at_centre(&self.laid);
        found.extend(self.opposite_curvature());
        for one in &mut found {
            one.place = self.wrapped(&one.place);
        }
        found
    }

    fn opposite_curvature(&self) -> Option<Indicator> {
        let laid = self.about(self.opposite()?);
        let found = at_centre(&laid).into_iter().next()?;
        Some(Indicator {
            kind: IndicatorKind::OPPOSITE_CURVATURE,
            ..found
        })
    }

    /// An indicator nearest to a place.
    pub(super) fn indicator(&self, kind: IndicatorKind, near: &[f64]) -> Option<Indicator> {
        let found = if kind == IndicatorKind::OPPOSITE_CURVATURE {
            self.opposite_curvature()
        } else {
            (kind.traits().read)(&self.laid, &self.wrapped(near))
        };
        found.map(|one| Indicator {
            place: self.wrapped(&one.place),
            ..one
        })
    }

    /// Places of a marginal where a pair of peak and valley may be about to come or go.
    pub(super) fn flanks(&self) -> Vec<Flank> {
        let [axis] = self.own.density.axes.as_slice() else {
            return Vec::new();
        };
        let mut found = shoulders(&self.laid);
        found.retain(|one| (axis.from()..axis.to()).contains(&one.place));
        found
    }

    /// The features in one turn; `None` for a density without.
    pub(super) fn detection(
        &self,
        limits: impl Fn(&EstimatedDensity, usize) -> Limits,
        doubt: f64,
    ) -> Option<Detection> {
        let grid = grid(&self.laid)?;
        let limits = limits(&self.laid, grid.values.len());
        let found = MiddleTurn::new(self, grid, &limits);
        let mut features = found.features(self);
        for feature in &mut features {
            feature.errors = place_error::errors(&self.laid, feature);
            self.bring_home(feature);
        }
        features.sort_by(by_kind_and_height);
        let indicators = self.indicators();
        let mut signature = found.signature;
        if self.is_marginal() {
            let peaks = present_places(&features, FeatureKind::Peak);
            signature = self.corrected(signature, &indicators, &peaks, doubt);
        }
        Some(Detection {
            signature,
            is_seen: true,
            indicators,
            features,
        })
    }

    /// Gives a feature its place in the turn; what it merges with stays beside it.
    fn bring_home(&self, feature: &mut Feature) {
        let home = self.wrapped(&feature.position);
        if let Some(partner) = &mut feature.partner {
            let moved = home.iter().zip(&feature.position);
            for (slot, (home, away)) in partner.iter_mut().zip(moved) {
                *slot += home - away;
            }
        }
        feature.position = home;
    }

    /// The number of peaks by the signs at both centres, where these are beyond doubt: next to its birth a peak at a
    /// centre, or the valley between a pair, is lower than what cells show.
    fn corrected(
        &self,
        mut signature: Signature,
        indicators: &[Indicator],
        peaks: &[Vec<f64>],
        doubt: f64,
    ) -> Signature {
        let [axis] = self.own.density.axes.as_slice() else {
            return signature;
        };
        let width = (axis.to() - axis.from()) / axis.count() as f64;
        for one in indicators {
            let centre = one.place[0];
            let is_near = |place: &&Vec<f64>| axis.apart(place[0], centre).abs() <= NEAR * width;
            let near = peaks.iter().filter(is_near).count();
            match (one.sign(doubt), near) {
                (Some(false), 0) | (Some(true), 1) => signature.peaks += 1,
                (Some(false), 2) => signature.peaks -= 1,
                _ => {}
            }
        }
        signature
    }
}

/// An axis over all its turns, as a line.
fn unrolled(axis: &Axis) -> Option<Axis> {
    if !axis.is_closed() {
        return Some(axis.clone());
    }
    let length = axis.to() - axis.from();
    let ends = (axis.from() - length, axis.to() + length);
    Axis::uniform(ends.0, ends.1, TURNS * axis.count()).ok()
}

/// The own cell of every cell that is laid out.
fn sources(axes: &[Axis]) -> Vec<usize> {
    let mut sources = vec![0];
    for axis in axes {
        let count = axis.count();
        let turns = if axis.is_closed() { TURNS } else { 1 };
        let cells = |before: usize| (0..turns * count).map(move |k| before * count + k % count);
        sources = sources.into_iter().flat_map(cells).collect();
    }
    sources
}

/// The kinks of all turns, with a jump for every cell along them.
fn kinks(own: &EstimatedDensity) -> Vec<Kink> {
    let axes = &own.density.axes;
    let copies = own.structure.kinks.iter().flat_map(|kink| {
        let across = &axes[kink.axis.min(axes.len() - 1)];
        let length = across.to() - across.from();
        let shifts: &[f64] = if across.is_closed() {
            &[-1.0, 0.0, 1.0]
        } else {
            &[0.0]
        };
        let along = axes.iter().enumerate().find(|(k, _)| *k != kink.axis);
        let is_long =
            along.is_some_and(|(_, axis)| axis.is_closed() && kink.jump.len() == axis.count());
        let jump = kink.jump.repeat(if is_long { TURNS } else { 1 });
        shifts.iter().map(move |shift| Kink {
            axis: kink.axis,
            at: kink.at + shift * length,
            jump: jump.clone(),
        })
    });
    copies.collect()
}

/// What there is in the middle turn.
struct MiddleTurn {
    /// The highest peak: as high as its density, and as high as it stands above the lowest saddle on the way round.
    highest: [Option<Candidate>; 2],
    /// Whether the highest ridge of a joint density runs around without a peak that stands out.
    is_ring: bool,
    features: Vec<Feature>,
    signature: Signature,
}

impl MiddleTurn {
    fn new(cover: &Cover<'_>, grid: CellValues<'_>, limits: &Limits) -> Self {
        let laid = &cover.laid;
        let (peaks, craters) = components(grid);
        let eldest = peaks.iter().find(|one| one.death.is_none());
        let top = eldest.map(|one| cover.own_copy(one.birth));
        let own = |all: Vec<Component>| -> Vec<Component> {
            all.into_iter()
                .filter(|one| cover.is_own(one.birth))
                .collect()
        };
        let (mut peaks, craters) = (own(peaks), own(craters));
        // As it meets its copies; a level density has none that does.
        let met = peaks.iter().position(|one| Some(one.birth) == top);
        let met = met.map(|index| peaks.remove(index));
        peaks.retain(|one| one.death.is_some());
        let one = |component: Option<Component>| {
            let judged = component.map(|one| judge(vec![one], false, laid, limits));
            judged.and_then(|judged| judged.into_iter().next())
        };
        let met = one(met.filter(|one| one.death.is_some()));
        let whole = one(top.map(|birth| Component {
            birth,
            death: None,
            persistence: grid.values[birth],
        }));
        let stands = met
            .as_ref()
            .is_some_and(|one| one.judgement.verdict == Verdict::Present);
        let is_ring = !cover.is_marginal() && !stands;
        let mut peaks = judge(peaks, false, laid, limits);
        let craters = judge(craters, true, laid, limits);
        let rims = rims(grid, laid, &craters, limits);
        let mut features = Vec::new();
        for peak in &peaks {
            if !rims.iter().any(|rim| rim.owns(peak.component.birth)) {
                features.push(peak.feature(laid, FeatureKind::Peak, peak.component.birth));
                let saddle = peak.component.death.into_iter();
                features.extend(saddle.map(|at| peak.feature(laid, FeatureKind::Valley, at)));
            }
        }
        for rim in &rims {
            let all = peaks.iter().chain(&whole);
            let mut all = all.filter(|peak| rim.owns(peak.component.birth));
            features.extend(rim.features(laid, all.next()));
        }
        for crater in &craters {
            features.push(crater.feature(laid, FeatureKind::Crater, crater.component.birth));
        }
        let on_rim = whole
            .as_ref()
            .is_some_and(|one| rims.iter().any(|rim| rim.owns(one.component.birth)));
        let highest = if on_rim { [None, None] } else { [whole, met] };
        if let ([Some(whole), _], false) = (&highest, is_ring) {
            peaks.extend(one(Some(whole.component)));
        }
        let mut signature = contents(&peaks, &craters, &rims);
        signature.rings += usize::from(is_ring && !on_rim);
        Self {
            highest,
            is_ring,
            features,
            signature,
        }
    }

    /// All features, their places in the middle turn or beside it.
    fn features(&self, cover: &Cover<'_>) -> Vec<Feature> {
        let laid = &cover.laid;
        let mut features = self.features.clone();
        let [whole, met] = &self.highest;
        let saddle = met
            .as_ref()
            .and_then(|one| Some((one, one.component.death?)));
        let valley = saddle.map(|(one, at)| one.feature(laid, FeatureKind::Valley, at));
        if let Some(whole) = whole {
            let top = whole.feature(laid, FeatureKind::Peak, whole.component.birth);
            features.push(Feature {
                kind: if self.is_ring {
                    FeatureKind::Ring
                } else {
                    FeatureKind::Peak
                },
                partner: valley
                    .as_ref()
                    .filter(|_| !self.is_ring)
                    .map(|one| one.position.clone()),
                ..top
            });
        }
        features.extend(valley.filter(|_| !self.is_ring));
        features
    }
}
