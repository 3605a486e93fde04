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
    Feature, FeatureKind, Indicator, IndicatorKind, Verdict, born_at_kink, peaks_at_ends,
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

    /// Whether it is a peak at a place, on one side, away from a centre of symmetry: there the curvatures tell.
    fn is_peak_at(&self, place: &[f64], above: bool, axes: &[Axis]) -> bool {
        self.feature == FeatureKind::Peak
            && self.above == above
            && self.from_centre > AT_REST
            && distance(&self.place, place, axes) < AT_REST
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
        let was_peak = events
            .iter()
            .position(|one| one.is_peak_at(&inside, !above, axes));
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
    let is_crater = |one: &&mut Event| one.feature == FeatureKind::Crater;
    for crater in events.iter_mut().filter(is_crater) {
        let was_peak = |one: &&Event| one.is_peak_at(&crater.place, !crater.above, axes);
        if let Some(peak) = peaks.iter().find(was_peak) {
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

/// The features of a kind that are present at a point.
pub(super) fn present(point: &Point, observable: usize, kind: FeatureKind) -> Vec<&Feature> {
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
