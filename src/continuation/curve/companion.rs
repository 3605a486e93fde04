//! What vanishes beside a curve's own indicator at its points of codimension two.
//!
//! Along a curve one indicator is zero. What happens across it depends on the signs of others, its companions: where
//! one of them passes zero too, what the change leads to differs from there on, and other curves begin.
//!
//! Beside a kink the slope of log p is s + c u + …, with the distance u from it. On the curve s = 0, and the curvature
//! c tells whether the kink turns from a peak into a valley as s does (c < 0, at a centre of symmetry), or a peak away
//! from it is there before (c > 0). Where there is no centre, the kink is an extremum only as long as the slope on its
//! other side has its sign, and a peak or valley comes out of it, rather than moves off it, only as long as c has:
//! beyond, nothing happens on the line s = 0, and the curve ends.

use super::CodimensionTwoKind;
use crate::density::EstimatedDensity;
use crate::topology::{Detector, IndicatorKind};

/// What the point is where an indicator and this companion of it vanish.
pub(super) fn meeting(companion: IndicatorKind) -> CodimensionTwoKind {
    let is_beside_kink = companion.traits().side_of_kink.is_some();
    match (companion.traits().is_bifurcation, is_beside_kink) {
        (false, false) => CodimensionTwoKind::DegenerateSplit,
        (false, true) => CodimensionTwoKind::DegenerateKink,
        (true, true) => CodimensionTwoKind::KinkCorner,
        (true, false) => CodimensionTwoKind::Crossing,
    }
}

/// Whether nothing happens on the line beyond the point at which a companion vanishes.
pub(super) fn ends_there(kind: IndicatorKind) -> bool {
    kind.traits().side_of_kink.is_some()
}

/// The values of the companions, in their order; `None` where there is no such indicator. Of a kink's, where its sign
/// is in doubt too.
pub(super) fn values(
    detector: &dyn Detector,
    density: &EstimatedDensity,
    kind: IndicatorKind,
    place: &[f64],
) -> Vec<Option<f64>> {
    let all = (kind.traits().companions)(density.density.axes.len()).into_iter();
    all.map(|companion| {
        let indicator = detector.indicator(density, companion, place)?;
        let is_sure =
            indicator.sampling_error == 0.0 && indicator.value.abs() > indicator.systematic_error;
        (is_sure || companion == IndicatorKind::QUARTIC).then_some(indicator.value)
    })
    .collect()
}

/// The companion, by its place among them, that has another sign than where it was known last; what is known is brought
/// up to date.
pub(super) fn turn(known: &mut [Option<f64>], values: &[Option<f64>]) -> Option<usize> {
    let mut found = None;
    for (index, (known, value)) in known.iter_mut().zip(values).enumerate() {
        let Some(value) = *value else {
            continue;
        };
        if known.is_some_and(|before| (before > 0.0) != (value > 0.0)) {
            found = found.or(Some(index));
        }
        *known = Some(value);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_companion_turns_where_its_sign_is_known_to_differ() {
        let mut known = vec![Some(1.0), None];
        assert_eq!(turn(&mut known, &[None, Some(-2.0)]), None);
        assert_eq!(turn(&mut known, &[Some(2.0), None]), None);
        assert_eq!(turn(&mut known, &[Some(3.0), Some(0.5)]), Some(1));
        assert_eq!(turn(&mut known, &[Some(-3.0), Some(0.6)]), Some(0));
        assert_eq!(known, [Some(-3.0), Some(0.6)]);
    }
}
