//! Where two changes may lie between two values that were solved: an indicator of one sign on either side comes near
//! zero, or passes it twice.
//!
//! At a centre of symmetry, on the flanks of a marginal, and on those of rings in a joint density. The parabola through
//! three neighbouring values shows where to look.

use super::Point;
use crate::density::EstimatedDensity;
use crate::topology::{FeatureKind, Flank, Verdict};

/// Flanks at neighbouring points farther apart than this, in ranges, are not one that moved.
const ONE_FLANK: f64 = 0.1;

/// A density below this share of another is clearly lower.
const CLEARLY: f64 = 0.99;

/// A value between is no nearer to its neighbours than this share of their distance.
const NEAREST: f64 = 0.1;

/// What the flanks of one point's densities show, by observable.
pub(super) type Flanks = Vec<Vec<Flank>>;

/// A parameter value between points where an indicator at a centre, of one sign at three neighbours, comes so near
/// to zero that it may have changed sign twice.
pub(super) fn at_centre(points: &[&Point], tolerance: f64) -> Option<f64> {
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

/// The same on flanks, away from any centre: a pair of peak and valley may come and go between neighbours, or go and
/// come.
pub(super) fn on_flanks(points: &[(&Point, &Flanks)], tolerance: f64) -> Option<f64> {
    let observables = points.first().map_or(0, |point| point.1.len());
    let triples = points.windows(3);
    triples.into_iter().find_map(|triple| {
        let x = [0, 1, 2].map(|index| triple[index].0.value);
        (0..observables).find_map(|observable| {
            let reach = reach(&triple[1].0.densities[observable]);
            let mut middle = triple[1].1[observable].iter();
            middle.find_map(|flank| {
                let near = |index: usize| nearest(&triple[index].1[observable], flank, &reach);
                let (before, after) = (near(0)?, near(2)?);
                let vertex = lowest(x, [before.value, flank.value, after.value])?;
                let apart = x.iter().all(|x| (x - vertex).abs() > tolerance);
                apart.then_some(vertex)
            })
        })
    })
}

/// A value between two neighbours where one pair of peak and valley was born on a flank and another has vanished: the
/// shoulders of both have changed their signs. Where the signatures of both are not the same, a change between them is
/// found without that, and the slopes must be known without cells for two more to be told from it.
pub(super) fn between_flanks(points: &[(&Point, &Flanks)], tolerance: f64) -> Option<f64> {
    let observables = points.first().map_or(0, |point| point.1.len());
    let mut pairs = points.windows(2);
    pairs.find_map(|pair| {
        let (a, b) = (pair[0].0, pair[1].0);
        let width = b.value - a.value;
        if width <= tolerance {
            return None;
        }
        (0..observables).find_map(|observable| {
            let same = a.detections[observable].signature == b.detections[observable].signature;
            let is_exact = |point: &Point| point.densities[observable].structure.profile.is_some();
            if !(same || is_exact(a) && is_exact(b)) {
                return None;
            }
            let reach = reach(&a.densities[observable]);
            let (below, above) = (&pair[0].1[observable], &pair[1].1[observable]);
            let zero = |flank: &Flank, rises: bool| {
                let zero = zero_of(flank, below, above, &reach)?;
                ((flank.value <= 0.0) == rises).then_some(zero)
            };
            let born = below.iter().filter_map(|flank| zero(flank, true));
            let first = born.min_by(f64::total_cmp)?;
            let vanished = below.iter().filter_map(|flank| zero(flank, false));
            let apart = |share: &f64| (share - first).abs();
            let next = vanished.min_by(|x, y| apart(x).total_cmp(&apart(y)))?;
            let share = (0.5 * (first + next)).clamp(NEAREST, 1.0 - NEAREST);
            Some(a.value + share * width)
        })
    })
}

/// The middle of two neighbours that count the same peaks of a marginal, one of which has moved farther than a peak
/// moves: one may have been born between them, and the other have vanished, where no value was solved.
pub(super) fn between_leaps(points: &[(&Point, &Flanks)], tolerance: f64) -> Option<f64> {
    let mut pairs = points.windows(2).map(|pair| (pair[0].0, pair[1].0));
    pairs.find_map(|(a, b)| {
        let middle = 0.5 * (a.value + b.value);
        let is_wide = b.value - a.value > tolerance && a.value < middle && middle < b.value;
        let mut observables = 0..a.densities.len();
        (is_wide && observables.any(|observable| leaps(a, b, observable))).then_some(middle)
    })
}

/// Whether a peak of a marginal leaps between two values.
fn leaps(a: &Point, b: &Point, observable: usize) -> bool {
    let density = &a.densities[observable];
    let axes = &density.density.axes;
    // Noise moves peaks on plateaus, and where a turn begins, none is before another.
    let is_exact = density.variants.second_scheme().is_some();
    if !is_exact || axes.len() != 1 || axes[0].is_closed() {
        return false;
    }
    let reach = reach(density)[0];
    // Each place is clearly the higher one at its own value: of two that are alike, rounding decides.
    let is_lower = |point: &Point, own: f64, other: f64| {
        let [own, other] = [own, other].map(|at| value_at(point, observable, at));
        let both = own.zip(other);
        both.is_some_and(|(own, other)| other < CLEARLY * own)
    };
    let [first, second] = [a, b].map(|point| peaks(point, observable));
    let mut moved = first.iter().zip(&second);
    first.len() == second.len()
        && moved.any(|(&one, &other)| {
            let is_far = (one - other).abs() > reach;
            is_far && is_lower(a, one, other) && is_lower(b, other, one)
        })
}

/// A marginal in the cell that holds a place.
fn value_at(point: &Point, observable: usize, at: f64) -> Option<f64> {
    let density = &point.densities[observable].density;
    let cell = density.axes.first()?.find(at)?;
    density.values.get(cell).copied()
}

/// Where the peaks of a marginal are that are counted, ascending.
fn peaks(point: &Point, observable: usize) -> Vec<f64> {
    let features = point.detections[observable].features.iter();
    let counted =
        features.filter(|one| one.kind == FeatureKind::Peak && one.verdict == Verdict::Present);
    let mut places: Vec<f64> = counted
        .filter_map(|one| one.position.first().copied())
        .collect();
    places.sort_by(f64::total_cmp);
    places
}

/// A value between two neighbours at which a centre of symmetry turns and a pair is born on a flank, or vanishes there:
/// between both zeros.
pub(super) fn beside_centre(points: &[(&Point, &Flanks)], tolerance: f64) -> Option<f64> {
    let observables = points.first().map_or(0, |point| point.1.len());
    let mut pairs = points.windows(2);
    pairs.find_map(|pair| {
        let (a, b) = (pair[0].0, pair[1].0);
        let width = b.value - a.value;
        (0..observables)
            .filter(|_| width > tolerance)
            .find_map(|observable| {
                let [first, second] = [a, b].map(|point| &point.detections[observable].indicators);
                let turn = first.iter().zip(second).find(|(one, other)| {
                    let exact = one.sampling_error == 0.0 && other.sampling_error == 0.0;
                    let is_turn = (one.value <= 0.0) != (other.value <= 0.0);
                    exact && one.kind == other.kind && is_turn
                });
                let centre = turn.map(|(one, other)| one.value / (one.value - other.value))?;
                let reach = reach(&a.densities[observable]);
                let (below, above) = (&pair[0].1[observable], &pair[1].1[observable]);
                let zeros = below
                    .iter()
                    .filter_map(|flank| zero_of(flank, below, above, &reach));
                let apart = |share: &f64| (share - centre).abs();
                let zero = zeros.min_by(|x, y| apart(x).total_cmp(&apart(y)))?;
                let share = (0.5 * (centre + zero)).clamp(NEAREST, 1.0 - NEAREST);
                (apart(&zero) * width > tolerance).then_some(a.value + share * width)
            })
    })
}

/// Where between two neighbours, as a share of their distance, a flank of the first changes its sign.
fn zero_of(flank: &Flank, below: &[Flank], above: &[Flank], reach: &[f64]) -> Option<f64> {
    let other = nearest(above, flank, reach)?;
    let is_mutual = nearest(below, other, reach) == Some(flank);
    let is_turn = (flank.value <= 0.0) != (other.value <= 0.0);
    let share = flank.value / (flank.value - other.value);
    (is_mutual && is_turn && share.is_finite()).then_some(share)
}

/// How far a flank may move along each axis from one point to the next.
fn reach(density: &EstimatedDensity) -> Vec<f64> {
    let axes = density.density.axes.iter();
    axes.map(|axis| ONE_FLANK * (axis.to() - axis.from()))
        .collect()
}

/// The flank of a neighbouring point that is the same, moved.
fn nearest<'a>(flanks: &'a [Flank], sought: &Flank, reach: &[f64]) -> Option<&'a Flank> {
    let distance = |one: &&Flank| (one.place - sought.place).abs();
    let reach = reach.get(sought.line.saturating_sub(1))?;
    let is_alike = |one: &&Flank| one.rising == sought.rising && one.line == sought.line;
    let near = flanks.iter().filter(is_alike);
    let near = near.filter(|one| distance(one) <= *reach);
    near.min_by(|a, b| distance(a).total_cmp(&distance(b)))
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
