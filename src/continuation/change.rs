//! Changes of signature between neighbouring points, and the indicator that decides each.
//!
//! A signature changes where persistence passes what noise and floor allow, or where an indicator at a centre of
//! symmetry changes sign. The indicator's own change of sign is the bifurcation: between the same two points, or, when
//! the signature is late, further on the side where the feature is absent.

use super::Point;
use super::bracket::{COUNTED, count, deciding_feature};
use crate::topology::{Detector, FeatureKind, Indicator, IndicatorKind, Signature};

/// A change of one observable's signature between two neighbouring points.
#[derive(Debug, Clone)]
pub(super) struct Change {
    /// Place of the observable among those that are watched.
    pub(super) observable: usize,
    /// The point below; the next one is the point above.
    pub(super) left: usize,
    pub(super) before: Signature,
    pub(super) after: Signature,
    /// Where the indicator that decides changes sign; `None` when only persistence tells.
    pub(super) crossing: Option<Crossing>,
}

/// A change of sign of an indicator between two neighbouring points.
#[derive(Debug, Clone)]
pub(super) struct Crossing {
    /// Place of the observable among those that are watched.
    pub(super) observable: usize,
    /// The point below; the next one is the point above.
    pub(super) left: usize,
    /// The indicator at both.
    pub(super) ends: [Indicator; 2],
}

impl Crossing {
    pub(super) fn kind(&self) -> IndicatorKind {
        self.ends[0].kind
    }
}

/// All changes along points that are solved, in ascending parameter; both indicators of a centre may change between
/// the same points, and are then changes of their own only where a point separates them.
pub(super) fn changes(points: &[&Point], detector: &dyn Detector) -> Vec<Change> {
    let observables = points.first().map_or(0, |point| point.detections.len());
    let mut found = Vec::new();
    for observable in 0..observables {
        for left in 1..points.len() {
            let signature = |index: usize| points[index].detections[observable].signature;
            let (before, after) = (signature(left - 1), signature(left));
            if before != after {
                found.push(Change {
                    observable,
                    left: left - 1,
                    before,
                    after,
                    crossing: crossing(points, detector, observable, left - 1),
                });
            }
        }
    }
    found
}

/// The change of sign that belongs to a change of signature.
fn crossing(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    left: usize,
) -> Option<Crossing> {
    let here = at_centre(points, observable, left);
    here.or_else(|| doubtful_centre(points, detector, observable, left))
        .or_else(|| at_shoulder(points, detector, observable, left))
}

/// An indicator of the centre that changes sign between two neighbours. A value of zero counts with the side below.
fn at_centre(points: &[&Point], observable: usize, left: usize) -> Option<Crossing> {
    let (a, b) = (points.get(left)?, points.get(left + 1)?);
    let pairs = a.detections[observable].indicators.iter();
    pairs
        .zip(&b.detections[observable].indicators)
        .find(|(a, b)| a.kind == b.kind && changes_sign(a, b))
        .map(|(a, b)| Crossing {
            observable,
            left,
            ends: [a.clone(), b.clone()],
        })
}

fn changes_sign(a: &Indicator, b: &Indicator) -> bool {
    (a.value <= 0.0) != (b.value <= 0.0)
}

/// The nearest change of sign at the centre, when all points on the way to it leave the sign in doubt.
fn doubtful_centre(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    left: usize,
) -> Option<Crossing> {
    let doubtful = |index: usize| {
        let indicators = &points[index].detections[observable].indicators;
        let unsure = |one: &Indicator| one.sign(detector.doubt()).is_none();
        indicators.iter().any(unsure)
    };
    let below = (0..=left).rev().take_while(|&index| doubtful(index));
    let above = (left + 1..points.len()).take_while(|&index| doubtful(index));
    let below = below.filter_map(|index| at_centre(points, observable, index.checked_sub(1)?));
    let above = above.filter_map(|index| at_centre(points, observable, index));
    below
        .chain(above)
        .min_by_key(|found| found.left.abs_diff(left))
}

/// The birth of the deciding peak with its valley: the slope between them, followed to where it changes sign.
fn at_shoulder(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    left: usize,
) -> Option<Crossing> {
    let below = sole_peak_is_below(points, observable, left)?;
    let present = if below { left } else { left + 1 };
    let (kind, near) = shoulder(points, observable, left, present)?;
    let path: Vec<usize> = match below {
        true => (present..points.len()).collect(),
        false => (0..=present).rev().collect(),
    };
    let (index, [previous, found]) = followed(points, detector, observable, &path, kind, near)?;
    Some(match below {
        true => Crossing {
            observable,
            left: index - 1,
            ends: [previous, found],
        },
        false => Crossing {
            observable,
            left: index,
            ends: [found, previous],
        },
    })
}

/// Whether it is the point below that has more peaks than its neighbour; `None` where peaks are not all that changes.
fn sole_peak_is_below(points: &[&Point], observable: usize, left: usize) -> Option<bool> {
    let detections = [left, left + 1].map(|index| &points[index].detections[observable]);
    let counts = |kind: FeatureKind| detections.map(|one| count(one, kind));
    let differs = |kind: FeatureKind| counts(kind)[0] != counts(kind)[1];
    let others = COUNTED.iter().filter(|&&kind| kind != FeatureKind::Peak);
    let [a, b] = counts(FeatureKind::Peak);
    (a != b && !others.copied().any(differs)).then_some(a > b)
}

/// The slope between the deciding peak and the valley it was born with, at the point where they are present, and the place
/// half way between them.
fn shoulder(
    points: &[&Point],
    observable: usize,
    left: usize,
    present: usize,
) -> Option<(IndicatorKind, Vec<f64>)> {
    let peaks = |index: usize| count(&points[index].detections[observable], FeatureKind::Peak);
    let detection = &points[present].detections[observable];
    let fewer = peaks(left).min(peaks(left + 1));
    let peak = deciding_feature(detection, FeatureKind::Peak, fewer)?;
    let valley = detection
        .features
        .iter()
        .find(|one| one.kind == FeatureKind::Valley && one.persistence == peak.persistence)?;
    let rising = valley.position.first()? < peak.position.first()?;
    let pairs = valley.position.iter().zip(&peak.position);
    let half_way = pairs.map(|(a, b)| 0.5 * (a + b)).collect();
    Some((IndicatorKind::Shoulder { rising }, half_way))
}

/// Follows an indicator from place to place along points, to the first where it is not positive any more: that point,
/// and the indicator before and there.
fn followed(
    points: &[&Point],
    detector: &dyn Detector,
    observable: usize,
    path: &[usize],
    kind: IndicatorKind,
    mut near: Vec<f64>,
) -> Option<(usize, [Indicator; 2])> {
    let mut last: Option<Indicator> = None;
    for &index in path {
        let density = &points[index].densities[observable];
        let found = detector.indicator(density, kind, &near)?;
        near.clone_from(&found.place);
        if let Some(previous) = last {
            if previous.value <= 0.0 {
                return None;
            }
            if found.value <= 0.0 {
                return Some((index, [previous, found]));
            }
        }
        last = Some(found);
    }
    None
}

/// Every change of sign of an indicator at a centre between neighbours, of densities without sampling errors: by
/// observable, ascending. (Noise changes signs often; there signatures say which of them matter.)
pub(super) fn crossings_at_centre(points: &[&Point]) -> Vec<Vec<Crossing>> {
    let observables = points.first().map_or(0, |point| point.detections.len());
    let of = |observable: usize| {
        let pairs = (0..points.len().saturating_sub(1)).flat_map(move |left| {
            let [a, b] = [left, left + 1].map(|at| &points[at].detections[observable].indicators);
            a.iter().zip(b).map(move |(a, b)| (left, a, b))
        });
        pairs
            .filter(|(_, a, b)| a.kind == b.kind && changes_sign(a, b))
            .filter(|(_, a, b)| a.sampling_error == 0.0 && b.sampling_error == 0.0)
            .map(|(left, a, b)| Crossing {
                observable,
                left,
                ends: [a.clone(), b.clone()],
            })
            .collect()
    };
    (0..observables).map(of).collect()
}

/// A parameter value between points where an indicator at a centre, of one sign at three neighbours, comes so near
/// to zero that it may have changed sign twice.
pub(super) fn dip(points: &[&Point], tolerance: f64) -> Option<f64> {
    let observables = points.first().map_or(0, |point| point.detections.len());
    let triples = points.windows(3);
    triples.into_iter().find_map(|triple| {
        (0..observables).find_map(|observable| {
            let of = |index: usize| &triple[index].detections[observable].indicators;
            (0..of(1).len()).find_map(|which| {
                let at = |index: usize| of(index).get(which);
                let (a, b, c) = (at(0)?, at(1)?, at(2)?);
                // Noise makes such places everywhere.
                let exact = b.sampling_error == 0.0;
                let same = exact && a.kind == b.kind && b.kind == c.kind;
                let x = [triple[0].value, triple[1].value, triple[2].value];
                let y = [a.value, b.value, c.value];
                let vertex = if same { lowest(x, y) } else { None }?;
                let apart = x.iter().all(|x| (x - vertex).abs() > tolerance);
                apart.then_some(vertex)
            })
        })
    })
}

/// Vertex of the parabola through three points of one sign, if it lies between them and nearer to zero than a
/// fourth of the middle one.
fn lowest(x: [f64; 3], y: [f64; 3]) -> Option<f64> {
    let sign = y[1].signum();
    let y = y.map(|value| value * sign);
    if y.iter().any(|&value| value <= 0.0) || y[1] >= y[0] || y[1] >= y[2] {
        return None;
    }
    let (h, k) = (x[1] - x[0], x[2] - x[1]);
    let (down, up) = ((y[1] - y[0]) / h, (y[2] - y[1]) / k);
    let bend = (up - down) / (h + k);
    let tilt = (down * k + up * h) / (h + k);
    let step = -0.5 * tilt / bend;
    let least = y[1] + 0.5 * tilt * step;
    (least < 0.25 * y[1]).then_some(x[1] + step)
}
