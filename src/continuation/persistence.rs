//! Where a signature changes when no indicator tells: the band from persistence alone.
//!
//! A feature is counted when its persistence exceeds the noise, which is later than its birth. With q the logarithm of
//! its density over that at the saddle where it merges, so that it does not matter whether the density there rises or
//! sinks as a whole, q grows like (θ - θ*)² near a smooth P-bifurcation, and at the kink of a switching surface; at the
//! birth of a peak away from symmetry like (θ - θ*)^{3/2}; where the rim of a crater breaks like θ - θ*. The straight
//! line through √q therefore meets zero at θ* in the first case and beyond it, seen from the side where the feature
//! is present, in the others: θ* lies between that zero and the last point where the feature is present.
//! The zero's own uncertainty comes from shifting all q by ± two standard errors (common random numbers make
//! neighbouring errors alike, so they do not average out) and from dropping the point farthest away. A feature only a
//! few cells from its neighbour is seen through the cells' averages, which shift its birth: a second line through
//! points where it is well apart must agree, and the band holds both zeros. So must a line through points that reach
//! as far as the zero is away. A change whose feature is nowhere well apart is `unconfirmed`: it may be one of the
//! cells, not of the density.
//!
//! Where no line meets zero and the feature stands well above its saddle when it is last seen, it was not born there:
//! the density has sunk below its errors, and the band reaches to where it is a clear multiple of them again.

use super::Point;
use super::bracket::{count, deciding_feature};
use super::events::COUNTED;
use super::follow::WELL;
use crate::density::EstimatedDensity;
use crate::topology::{Detection, Feature, FeatureKind, Verdict, is_clear};

/// Points used to extrapolate the birth of a feature.
const FITTED_POINTS: usize = 5;

/// Cells between two features beyond which the cells' averages do not blur them into one.
const WELL_APART: f64 = 5.0;

/// The band of a change of one observable's signature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Band {
    pub(super) value: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// Whether every deciding feature is well apart from others at some point.
    pub(super) resolved_by_cells: bool,
    /// Whether a deciding feature was lost in the errors of the density, not seen to vanish.
    pub(super) sinks: bool,
}

/// The band of a change between `points[left]` and its successor: the hull over the counts that differ.
/// `doubt` is the probability with which signs at a centre may be wrong.
pub(super) fn band(points: &[&Point], observable: usize, left: usize, doubt: f64) -> Band {
    let (a, b) = (points[left], points[left + 1]);
    let mut change = Band {
        value: 0.5 * (a.value + b.value),
        lower: a.value,
        upper: b.value,
        resolved_by_cells: true,
        sinks: false,
    };
    let mut births = Vec::new();
    for kind in COUNTED {
        let counts = [a, b].map(|point| count(&point.detections[observable], kind));
        if counts[0] != counts[1] {
            let rank = counts[0].min(counts[1]);
            let present = present_side(points, observable, left, kind, rank, counts[0] > counts[1]);
            change.resolved_by_cells &= present.iter().any(|seen| seen.cells_apart >= WELL_APART);
            let found = births_of(&present);
            let last = present
                .first()
                .filter(|seen| found.is_empty() && seen.height > YOUNG);
            if let Some(seen) = last {
                let far = clear_again(points, observable, left, seen, counts[0] > counts[1]);
                change.sinks |= far.is_some();
                births.extend(far.map(|far| (change.value, far.min(a.value), far.max(b.value))));
            }
            births.extend(found);
        }
    }
    let untold = (births.is_empty()).then(|| next_certain_value(points, observable, left, doubt));
    if let Some(far) = untold.flatten() {
        change.sinks = true;
        births.push((change.value, far.min(a.value), far.max(b.value)));
    }
    for &(value, lower, upper) in &births {
        change.lower = change.lower.min(lower);
        change.upper = change.upper.max(upper);
        change.value = value;
    }
    if births.len() > 1 {
        change.value = births.iter().map(|birth| birth.0).sum::<f64>() / births.len() as f64;
    }
    let range = (points[0].value, points[points.len() - 1].value);
    change.lower = change.lower.max(range.0);
    change.upper = change.upper.min(range.1);
    change.value = change.value.clamp(change.lower, change.upper);
    change
}

/// Where the signs of indicators at a centre are certain on one side only: the first value on the other side at which
/// they are so again, or the last one there is. Until then nothing tells whether what is there changes.
fn next_certain_value(
    points: &[&Point],
    observable: usize,
    left: usize,
    doubt: f64,
) -> Option<f64> {
    let is_told = |point: &&Point| {
        let mut indicators = point.detections[observable].indicators.iter().peekable();
        indicators.peek().is_some() && indicators.all(|one| one.sign(doubt).is_some())
    };
    let far = |mut outward: Vec<&&Point>| {
        let told = outward.iter().position(|point| is_told(point));
        outward.truncate(told.map_or(outward.len(), |told| told + 1));
        outward.last().map(|point| point.value)
    };
    match (is_told(&points[left]), is_told(&points[left + 1])) {
        (true, false) => far(points.iter().skip(left + 1).collect()),
        (false, true) => far(points.iter().take(left + 1).rev().collect()),
        _ => None,
    }
}

/// Logarithm of a feature's density over that at its saddle from which on it is not about to be born.
const YOUNG: f64 = 0.1;

/// The value of the first point on the side where a feature is absent at which the density is a clear multiple of its
/// error where the feature was last seen, or of the last point there is; `None` where the next point is such.
fn clear_again(
    points: &[&Point],
    observable: usize,
    left: usize,
    seen: &Sighting,
    is_present_below: bool,
) -> Option<f64> {
    let clear = |point: &&&Point| is_clear(&point.densities[observable], &seen.place, WELL);
    let outward: Vec<&&Point> = if is_present_below {
        points.iter().skip(left + 1).collect()
    } else {
        points.iter().take(left + 1).rev().collect()
    };
    let sunk = outward.iter().take_while(|point| !clear(point)).count();
    let far = outward.get(sunk).or(outward.last())?;
    (sunk > 0).then_some(far.value)
}

/// The deciding feature at one point where it is present.
#[derive(Debug, Clone)]
struct Sighting {
    value: f64,
    place: Vec<f64>,
    /// Logarithm of the larger of the densities at the feature and at its saddle over the other one.
    height: f64,
    /// Its standard error.
    error: f64,
    /// Distance to the nearest other feature, in cells.
    cells_apart: f64,
}

/// The deciding feature at the points where it is present, nearest to the change first.
fn present_side(
    points: &[&Point],
    observable: usize,
    left: usize,
    kind: FeatureKind,
    rank: usize,
    present_below: bool,
) -> Vec<Sighting> {
    let indices: Vec<usize> = if present_below {
        (0..=left).rev().collect()
    } else {
        (left + 1..points.len()).collect()
    };
    let seen = |index: usize| {
        let point = points[index];
        let detection = &point.detections[observable];
        let feature = deciding_feature(detection, kind, rank)
            .filter(|feature| feature.verdict == Verdict::Present)?;
        let (height, error) = height(feature);
        Some(Sighting {
            value: point.value,
            place: feature.position.clone(),
            height,
            error,
            cells_apart: cells_apart(feature, detection, &point.densities[observable]),
        })
    };
    indices.into_iter().map_while(seen).collect()
}

/// Logarithm of the ratio of the densities at a feature and at its saddle, with its standard error. A density below the
/// error of the difference is taken as that: the ratio is as large at least.
fn height(feature: &Feature) -> (f64, f64) {
    let (top, low) = match feature.kind {
        FeatureKind::Crater => (feature.density + feature.persistence, feature.density),
        _ => (feature.density, feature.density - feature.persistence),
    };
    let low = low.max(feature.standard_error).max(LEAST * top);
    ((top / low).ln().max(0.0), feature.standard_error / low)
}

/// Share of a peak that a saddle has at least: rounding.
const LEAST: f64 = 1e-12;

/// Distance of a feature to the nearest other one that is present, in cells (the largest over the axes).
fn cells_apart(feature: &Feature, detection: &Detection, density: &EstimatedDensity) -> f64 {
    let others = detection.features.iter();
    others
        .filter(|other| other.verdict == Verdict::Present && other.position != feature.position)
        .map(|other| {
            let axes = density.density.axes.iter().enumerate();
            axes.map(|(axis, cells)| {
                let (from, to) = (feature.position[axis], other.position[axis]);
                let width = cells.find(from).map_or(f64::INFINITY, |c| cells.width(c));
                (to - from).abs() / width
            })
            .fold(0.0, f64::max)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Births by a line through the nearest points, and by one through the nearest where the feature is well apart; and by
/// one through points farther from each other, where the first lies farther off than its points reach.
fn births_of(present: &[Sighting]) -> Vec<(f64, f64, f64)> {
    let nearest = |apart: f64| -> Vec<(f64, f64, f64)> {
        let points = present.iter().filter(|seen| seen.cells_apart >= apart);
        points
            .map(|seen| (seen.value, seen.height, seen.error))
            .take(FITTED_POINTS)
            .collect()
    };
    let near = birth(&nearest(0.0));
    let apart = birth(&nearest(WELL_APART));
    let wide = birth(&spread(present, near.map(|near| near.0)));
    let near = match (near, wide) {
        (Some(near), Some(wide)) => Some((wide.0, near.1.min(wide.1), near.2.max(wide.2))),
        (near, wide) => near.or(wide),
    };
    match (near, apart) {
        // The zero of the line that the cells do not blur is the better value; the band holds both.
        (Some(near), Some(apart)) => {
            vec![(apart.0, near.1.min(apart.1), near.2.max(apart.2))]
        }
        (near, apart) => near.into_iter().chain(apart).collect(),
    }
}

/// Points that reach as far from the change as a birth is said to be away, or over all that there are, each at least
/// half as far from the next.
fn spread(present: &[Sighting], birth: Option<f64>) -> Vec<(f64, f64, f64)> {
    let Some((first, last)) = present.first().zip(present.last()) else {
        return Vec::new();
    };
    let reach = birth.unwrap_or(last.value) - first.value;
    let mut kept: Vec<(f64, f64, f64)> = Vec::new();
    for seen in present {
        let is_apart = |one: &(f64, f64, f64)| (seen.value - one.0).abs() >= 0.5 * reach.abs();
        if kept.len() < FITTED_POINTS && kept.last().is_none_or(is_apart) {
            kept.push((seen.value, seen.height, seen.error));
        }
    }
    kept
}

/// Birth of a feature with the ends of its uncertainty: `(value, lower, upper)`, from the zero of the line through
/// √q. `None` with fewer than two points, or when q does not grow away from the change.
fn birth(present: &[(f64, f64, f64)]) -> Option<(f64, f64, f64)> {
    let value = zero_of_root(present, 0.0)?;
    let mut ends = vec![value];
    for shift in [-2.0, 2.0] {
        ends.extend(zero_of_root(present, shift));
    }
    if present.len() > 2 {
        ends.extend(zero_of_root(&present[..present.len() - 1], 0.0));
    }
    let lower = ends.iter().copied().fold(f64::INFINITY, f64::min);
    let upper = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some((value, lower, upper))
}

/// Zero of the least-squares line through √(q + shift · standard error) against the parameter.
fn zero_of_root(present: &[(f64, f64, f64)], shift: f64) -> Option<f64> {
    if present.len() < 2 {
        return None;
    }
    let samples: Vec<(f64, f64)> = present
        .iter()
        .map(|&(value, q, error)| (value, (q + shift * error).max(0.0).sqrt()))
        .collect();
    let n = samples.len() as f64;
    let mean_value = samples.iter().map(|s| s.0).sum::<f64>() / n;
    let mean_root = samples.iter().map(|s| s.1).sum::<f64>() / n;
    let covariance: f64 = samples
        .iter()
        .map(|s| (s.0 - mean_value) * (s.1 - mean_root))
        .sum();
    let spread: f64 = samples.iter().map(|s| (s.0 - mean_value).powi(2)).sum();
    let slope = covariance / spread;
    // The line must fall toward the change, else it says nothing of a birth.
    let outward = present[present.len() - 1].0 - present[0].0;
    (slope * outward > 0.0).then(|| mean_value - mean_root / slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_law_is_extrapolated_to_its_zero() {
        let present: Vec<(f64, f64, f64)> = [0.1, 0.2, 0.3, 0.4]
            .map(|theta: f64| (theta + 0.05, 7.0 * theta * theta, 0.0))
            .to_vec();
        let (value, lower, upper) = birth(&present).unwrap();
        assert!((value - 0.05).abs() < 1e-12 && (upper - lower) < 1e-12);
    }

    #[test]
    fn slower_laws_are_extrapolated_before_the_first_present_point_and_after_the_birth() {
        for exponent in [1.5, 1.0] {
            let present: Vec<(f64, f64, f64)> = [0.1, 0.2, 0.3]
                .map(|theta: f64| (theta, theta.powf(exponent), 0.0))
                .to_vec();
            let (value, _, _) = birth(&present).unwrap();
            assert!(
                value < 0.0,
                "the band from {value} to 0.1 holds the birth at 0"
            );
        }
    }

    #[test]
    fn a_birth_is_where_it_is_whatever_the_density_sinks_by() {
        // A peak of e^{-40 θ} stands above its saddle by the square law from 0 on, and is seen from 0.05 on.
        let seen = |theta: f64| {
            let (top, q) = ((-40.0 * theta).exp(), 0.3 * theta * theta);
            let feature = Feature {
                kind: FeatureKind::Peak,
                position: vec![0.0],
                density: top,
                persistence: top * -(-q).exp_m1(),
                standard_error: 1e-9 * top,
                significance: 2.0,
                verdict: Verdict::Present,
                partner: None,
                errors: crate::topology::FeatureErrors::default(),
            };
            let (height, error) = height(&feature);
            Sighting {
                value: theta,
                place: vec![0.0],
                height,
                error,
                cells_apart: 9.0,
            }
        };
        let near = [0.05, 0.0501, 0.0502, 0.0504, 0.0508, 0.1, 0.15, 0.2];
        let births = births_of(&near.map(seen));
        assert_eq!(births.len(), 1);
        let (value, lower, upper) = births[0];
        assert!(
            value.abs() < 1e-6 && lower <= 1e-6 && upper >= -1e-6,
            "{births:?}"
        );
    }

    #[test]
    fn errors_widen_the_band_and_a_falling_law_gives_none() {
        let present = [(0.1, 0.01, 0.002), (0.2, 0.04, 0.002), (0.3, 0.09, 0.002)];
        let (value, lower, upper) = birth(&present).unwrap();
        assert!(value.abs() < 1e-12 && lower < -0.005 && upper > 0.005);
        assert!(birth(&[(0.1, 0.04, 0.0), (0.2, 0.01, 0.0)]).is_none());
        assert!(birth(&[(0.1, 0.04, 0.0)]).is_none());
    }
}
