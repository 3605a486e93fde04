//! Roots of the rise to a maximum of a power spectrum above zero, which is not there at every value.
//!
//! Where the extremum at frequency zero turns, the rise begins, or ends, with a jump, which is no change of its own.
//! Elsewhere it passes zero before it is lost: a maximum that is there at one value, and no rise at the next, have a
//! zero between them.

use super::{Excess, Root, measure_of};
use crate::continuation::Point;
use crate::continuation::measure::SPECTRAL_CURVATURE;
use crate::numerics::sort_ascending;
use crate::system::MeasureLevel;

/// Of the roots between samples of a rise those that are changes, and those beside values that have no rise; `of` is
/// the observable's name.
pub(super) fn roots_of_rise(
    points: &[Point],
    of: &str,
    samples: &[Excess],
    mut found: Vec<Root>,
) -> Vec<Root> {
    let turn = MeasureLevel {
        measure: SPECTRAL_CURVATURE.name(of),
        level: 0.0,
    };
    let curvature = |at: f64| {
        let point = points.iter().find(|point| point.value == at)?;
        Some(measure_of(&point.report, &turn)?.value)
    };
    found.retain(|root| match root.ends.map(|end| curvature(end.at)) {
        [Some(below), Some(above)] => (below < 0.0) == (above < 0.0),
        _ => true,
    });
    let values: Vec<f64> = points.iter().map(|point| point.value).collect();
    for lost in lost_maxima(&values, samples, &curvature) {
        found.retain(|root| !root.holds(&lost));
        found.push(lost);
    }
    sort_ascending(&mut found, |root| root.value);
    found
}

/// Neighbouring values of which one has a spectrum with a maximum above zero, and the other one whose slope only falls,
/// both with a maximum at zero: a spectrum that rises from there has a maximum in any case.
fn lost_maxima(
    values: &[f64],
    samples: &[Excess],
    curvature: &dyn Fn(f64) -> Option<f64>,
) -> Vec<Root> {
    let sample = |at: f64| samples.iter().find(|one| one.at == at).copied();
    let between = |pair: &[f64]| {
        let (known, is_first) = match [sample(pair[0]), sample(pair[1])] {
            [Some(known), None] => (known, true),
            [None, Some(known)] => (known, false),
            _ => return None,
        };
        let is_maximum = known.over > known.error;
        let falls = [curvature(pair[0])?, curvature(pair[1])?]
            .iter()
            .all(|one| *one < 0.0);
        let lost = Excess {
            at: if is_first { pair[1] } else { pair[0] },
            over: -known.over,
            ..known
        };
        (is_maximum && falls).then(|| Root {
            ends: if is_first {
                [known, lost]
            } else {
                [lost, known]
            },
            value: 0.5 * (pair[0] + pair[1]),
            interpolation: 0.5 * (pair[1] - pair[0]),
            of_measure: 0.0,
            is_jump: true,
            alone: None,
        })
    };
    values.windows(2).filter_map(between).collect()
}
