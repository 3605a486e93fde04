//! What appears and what vanishes between two neighbouring points: features matched from one to the other by their
//! places.
//!
//! Features of one kind are paired, the nearest first. What is left on one side was born, or has vanished, in between,
//! and says which indicator passes zero there: the slope between a peak and the saddle where it merges, or from a
//! ring's inside to the ring.

use super::Point;
use crate::density::EstimatedDensity;
use crate::space::Axis;
use crate::topology::{
    Feature, FeatureKind, Indicator, IndicatorKind, Signature, Verdict, born_at_kink, peaks_at_ends,
};

/// Kinds that make a signature.
pub(super) const COUNTED: [FeatureKind; 3] =
    [FeatureKind::Peak, FeatureKind::Crater, FeatureKind::Ring];

/// Distance, in ranges, up to which a peak and the middle of a ring are one place: what a ring that has just opened
/// lies beside its middle.
const AT_REST: f64 = 0.03;

/// A feature that one of two neighbouring points has and the other has not.
#[derive(Debug, Clone)]
pub(super) struct Event {
    /// What it is.
    pub(super) feature: FeatureKind,
    /// Whether the point above has it.
    pub(super) above: bool,
    /// The indicator whose zero it is, and where to look for it; `None` where none is known.
    pub(super) indicator: Option<(IndicatorKind, Vec<f64>)>,
    /// Distance of the feature from the centre of symmetry, in ranges; infinite without one.
    pub(super) from_centre: f64,
    /// Where the feature is, at the point that has it.
    pub(super) place: Vec<f64>,
    /// Of a ring, or a crater: whether a peak stands inside it at the point that has it not.
    pub(super) was_peak: bool,
}

impl Event {
    /// Whether a natural end of the range becomes a peak, or is one no more.
    pub(super) fn is_at_natural_end(&self) -> bool {
        let ends = [false, true].map(IndicatorKind::natural_end);
        let indicator = self.indicator.as_ref();
        indicator.is_some_and(|(kind, _)| ends.contains(kind))
    }

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
        let (kind, _) = self.indicator.as_ref()?;
        let (rising, &[peak]) = (kind.traits().rising?, self.place.as_slice()) else {
            return None;
        };
        let axis = &point.densities[observable].density.axes[0];
        let beyond = present(point, observable, FeatureKind::Valley)
            .into_iter()
            .map(|valley| axis.apart(valley.position[0], peak))
            .filter(|apart| (*apart > 0.0) == rising);
        let nearest = beyond.min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let between = peak + 0.5 * nearest;
        Some(Self {
            indicator: Some((IndicatorKind::shoulder(!rising), vec![between])),
            ..self.clone()
        })
    }

    /// The same of a marginal as the end of a valley between two peaks, or of a peak between two valleys: its valley
    /// and the peak itself.
    pub(super) fn at_merger(&self, point: &Point, observable: usize) -> Vec<Self> {
        let Some((kind, _)) = &self.indicator else {
            return Vec::new();
        };
        let (Some(rising), &[peak]) = (kind.traits().rising, self.place.as_slice()) else {
            return Vec::new();
        };
        let axis = &point.densities[observable].density.axes[0];
        let valleys = present(point, observable, FeatureKind::Valley);
        let places = valleys.iter().map(|valley| valley.position[0]);
        let on_flank = places.filter(|&valley| (axis.apart(valley, peak) < 0.0) == rising);
        let valley = on_flank.min_by(|a, b| {
            let [a, b] = [a, b].map(|valley| axis.apart(*valley, peak).abs());
            a.total_cmp(&b)
        });
        let valley = valley.map(|valley| (IndicatorKind::merger(false), valley));
        let own = (IndicatorKind::merger(true), peak);
        let both = valley.into_iter().chain([own]);
        both.map(|(kind, place)| Self {
            indicator: Some((kind, vec![place])),
            ..self.clone()
        })
        .collect()
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

/// All of them for one observable.
pub(super) fn events(a: &Point, b: &Point, observable: usize) -> Vec<Event> {
    let axes = &a.densities[observable].density.axes;
    let mut found = Vec::new();
    for kind in COUNTED {
        let (below, above) = pair_off(
            present(a, observable, kind),
            present(b, observable, kind),
            axes,
        );
        let centre = a.densities[observable].structure.centre.as_deref();
        let density = |above: bool| match above {
            true => &b.densities[observable],
            false => &a.densities[observable],
        };
        let event = |feature: &Feature, above: bool| Event {
            feature: kind,
            above,
            indicator: indicator(density(above), feature),
            from_centre: centre.map_or(f64::INFINITY, |centre| {
                from_centre(&feature.position, centre, axes)
            }),
            place: feature.position.clone(),
            was_peak: false,
        };
        found.extend(below.into_iter().map(|feature| event(feature, false)));
        found.extend(above.into_iter().map(|feature| event(feature, true)));
    }
    let mut found = without_moats(found);
    rings_at_rest(&mut found, (a, b), observable, axes);
    // A ring that is there on both sides says that the density follows the energy.
    if [a, b]
        .iter()
        .all(|one| one.detections[observable].signature.rings > 0)
    {
        craters_at_rest(&mut found, axes);
    }
    let at_ends = at_natural_ends(a, b, observable);
    if !at_ends.is_empty() {
        found.retain(|event| !event.is_at_natural_end());
        found.extend(at_ends);
    }
    found
}

/// Whether a crater becomes a peak between two points, or a peak a crater, and this signature has neither.
pub(super) fn turns_over(a: &Point, b: &Point, observable: usize, between: &Signature) -> bool {
    let least = |of: fn(&Signature) -> usize| {
        let counts = [a, b].map(|point| of(&point.detections[observable].signature));
        counts[0].min(counts[1])
    };
    let is_turn = |one: &Event| one.feature == FeatureKind::Crater && one.was_peak;
    between.peaks <= least(|one| one.peaks)
        && between.craters <= least(|one| one.craters)
        && events(a, b, observable).iter().any(is_turn)
}

/// Natural ends that become peaks, or are peaks no more. The peak comes out of the range, or goes into it, where as
/// many are counted on both sides.
fn at_natural_ends(a: &Point, b: &Point, observable: usize) -> Vec<Event> {
    let ends =
        |point: &Point| -> Vec<Indicator> { peaks_at_ends(&point.densities[observable]).collect() };
    let peaks = |point: &Point| point.detections[observable].signature.peaks;
    let (below, above) = (ends(a), ends(b));
    let only = |own: &[Indicator], other: &[Indicator]| -> Vec<Indicator> {
        let is_other = |one: &&Indicator| !other.iter().any(|other| other.kind == one.kind);
        own.iter().filter(is_other).cloned().collect()
    };
    let event = |end: Indicator, is_above: bool| Event {
        // Between the two only one of several ends can be the cause that a count changes.
        feature: match peaks(a) == peaks(b) {
            true => FeatureKind::Valley,
            false => FeatureKind::Peak,
        },
        above: is_above,
        indicator: Some((end.kind, end.place.clone())),
        from_centre: f64::INFINITY,
        place: end.place,
        was_peak: false,
    };
    let vanish = only(&below, &above)
        .into_iter()
        .map(|end| event(end, false));
    let appear = only(&above, &below).into_iter().map(|end| event(end, true));
    vanish.chain(appear).collect()
}

/// Rings that open where a peak was, and rings that merge at the saddle between them, in either direction: both
/// curvatures vanish there together. The peak that becomes the bottom within a ring is a part of the ring's event.
fn rings_at_rest(
    events: &mut Vec<Event>,
    (a, b): (&Point, &Point),
    observable: usize,
    axes: &[Axis],
) {
    let is_ring = |one: &Event| one.feature == FeatureKind::Ring;
    for index in 0..events.len() {
        let above = events[index].above;
        let Some(inside) = inside(&events[index]).filter(|_| is_ring(&events[index])) else {
            continue;
        };
        let own = present(if above { b } else { a }, observable, FeatureKind::Ring);
        let others = present(if above { a } else { b }, observable, FeatureKind::Ring);
        let was_peak = events.iter().position(|one| {
            // At a centre of symmetry the curvatures there tell.
            one.feature == FeatureKind::Peak
                && one.above != above
                && one.from_centre > AT_REST
                && distance(&one.place, &inside, axes) < AT_REST
        });
        let at = match was_peak {
            Some(peak) => Some((events[peak].place.clone(), inside.clone())),
            None if others.len() + 1 == own.len() => {
                between_rings(if above { b } else { a }, observable, &own, axes)
            }
            None => None,
        };
        if let Some((place, middle)) = at {
            let along_second = match was_peak {
                Some(_) => false,
                None => {
                    let length = |k: usize| axes[k].to() - axes[k].from();
                    let apart = |k: usize| (axes[k].apart(place[k], middle[k]) / length(k)).abs();
                    apart(1) > apart(0)
                }
            };
            events[index].indicator = Some((IndicatorKind::level(along_second), place));
            events[index].was_peak = was_peak.is_some();
        }
        if let Some(peak) = was_peak {
            // Kept in its place, so that indices hold; taken away below.
            events[peak].feature = FeatureKind::Valley;
        }
    }
    events.retain(|one| one.feature != FeatureKind::Valley);
}

/// Craters that peaks become, in either direction, within a ring that stays, or that goes around others as well: both
/// curvatures vanish there together too, and third derivatives with them. Both are one event.
fn craters_at_rest(events: &mut Vec<Event>, axes: &[Axis]) {
    let peaks = events.iter().filter(|one| one.feature == FeatureKind::Peak);
    let peaks: Vec<Event> = peaks.cloned().collect();
    let mut turned = Vec::new();
    for crater in events
        .iter_mut()
        .filter(|one| one.feature == FeatureKind::Crater)
    {
        let was_peak = peaks.iter().find(|one| {
            one.above != crater.above
                && one.from_centre > AT_REST
                && distance(&one.place, &crater.place, axes) < AT_REST
        });
        if let Some(peak) = was_peak {
            crater.indicator = Some((IndicatorKind::level(false), peak.place.clone()));
            crater.was_peak = true;
            turned.push(peak.place.clone());
        }
    }
    events.retain(|one| one.feature != FeatureKind::Peak || !turned.contains(&one.place));
}

/// The point inside the ring of an event.
fn inside(event: &Event) -> Option<Vec<f64>> {
    event.indicator.as_ref().map(|(_, inside)| inside.clone())
}

/// The saddle at which two rings that lie beside each other merge, and the middle of one of them.
fn between_rings(
    point: &Point,
    observable: usize,
    rings: &[&Feature],
    axes: &[Axis],
) -> Option<(Vec<f64>, Vec<f64>)> {
    let saddles = present(point, observable, FeatureKind::Valley);
    let found = rings.iter().find_map(|ring| {
        let saddle = saddles
            .iter()
            .find(|one| one.persistence == ring.persistence)?;
        Some((saddle.position.clone(), ring.partner.clone()?))
    })?;
    // Of rings one within the other the middles are one.
    let is_beside = rings.iter().any(|ring| {
        let other = ring.partner.as_ref();
        other.is_some_and(|other| distance(other, &found.1, axes) > AT_REST)
    });
    is_beside.then_some(found)
}

/// A ring comes and goes with the moat inside it: one event.
fn without_moats(mut events: Vec<Event>) -> Vec<Event> {
    for above in [false, true] {
        let rings = |one: &&Event| one.feature == FeatureKind::Ring && one.above == above;
        for _ in 0..events.iter().filter(rings).count() {
            let moat = |one: &Event| one.feature == FeatureKind::Crater && one.above == above;
            if let Some(moat) = events.iter().position(moat) {
                events.remove(moat);
            }
        }
    }
    events
}

fn present(point: &Point, observable: usize, kind: FeatureKind) -> Vec<&Feature> {
    let features = point.detections[observable].features.iter();
    features
        .filter(|one| one.kind == kind && one.verdict == Verdict::Present)
        .collect()
}

/// Distance of two places in units of the ranges.
pub(super) fn distance(a: &[f64], b: &[f64], axes: &[Axis]) -> f64 {
    let terms = a.iter().zip(b).zip(axes);
    terms
        .map(|((&a, &b), axis)| (axis.apart(a, b) / (axis.to() - axis.from())).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Distance from the centre of symmetry; on a circle the place half a turn from it is one too.
fn from_centre(place: &[f64], centre: &[f64], axes: &[Axis]) -> f64 {
    let own = distance(place, centre, axes);
    match axes {
        [axis] if axis.is_closed() => own.min(0.5 - own),
        _ => own,
    }
}

/// What is left of two lists when their nearest members have been paired.
fn pair_off<'a>(
    mut below: Vec<&'a Feature>,
    mut above: Vec<&'a Feature>,
    axes: &[Axis],
) -> (Vec<&'a Feature>, Vec<&'a Feature>) {
    while !below.is_empty() && !above.is_empty() {
        let pairs = (0..below.len()).flat_map(|i| (0..above.len()).map(move |j| (i, j)));
        let apart =
            |&(i, j): &(usize, usize)| distance(&below[i].position, &above[j].position, axes);
        let Some((i, j)) = pairs.min_by(|a, b| apart(a).total_cmp(&apart(b))) else {
            break;
        };
        below.remove(i);
        above.remove(j);
    }
    (below, above)
}

/// The indicator that is zero where a feature is born.
fn indicator(density: &EstimatedDensity, feature: &Feature) -> Option<(IndicatorKind, Vec<f64>)> {
    let partner = feature.partner.as_ref()?;
    let between = || {
        let pairs = feature.position.iter().zip(partner);
        pairs.map(|(a, b)| 0.5 * (a + b)).collect()
    };
    Some(
        match (
            feature.kind,
            feature.position.as_slice(),
            partner.as_slice(),
        ) {
            (FeatureKind::Ring, ..) => (IndicatorKind::RING, partner.clone()),
            (FeatureKind::Peak, [peak], [valley]) => {
                let (valley, peak) = (*valley, *peak);
                let mut ends = peaks_at_ends(density);
                if let Some(end) = ends.find(|end| end.place == [peak]) {
                    return Some((end.kind, end.place));
                }
                let rising = valley < peak;
                let at_kink = born_at_kink(density, feature, valley);
                let steepest = steepest(density, [valley, peak]).map(|place| vec![place]);
                let place = steepest.unwrap_or_else(between);
                at_kink.unwrap_or((IndicatorKind::shoulder(rising), place))
            }
            (FeatureKind::Peak | FeatureKind::Crater, [_, _], _) => {
                (IndicatorKind::FOLD, between())
            }
            _ => return None,
        },
    )
}

/// Where between a valley and a peak the density is steepest, if its equations tell.
fn steepest(density: &EstimatedDensity, [valley, peak]: [f64; 2]) -> Option<f64> {
    let profile = density.structure.profile.as_ref()?;
    let (low, high) = (valley.min(peak), valley.max(peak));
    let turns = profile.turns.iter();
    let between = turns.filter(|turn| low <= turn.place && turn.place <= high);
    let alike = between.filter(|turn| turn.is_largest == (valley < peak));
    let steepest = alike.max_by(|a, b| a.slope.abs().total_cmp(&b.slope.abs()))?;
    Some(steepest.place)
}
