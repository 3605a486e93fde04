//! The peak and the valley between which a shoulder of a density along one axis lies.

use super::Point;
use crate::density::Density;
use crate::space::Axis;
use crate::topology::{Detection, FeatureKind, Flank, Indicator, Verdict};

/// How far a feature may be from the cell that is highest or lowest around it, in widths of that cell.
const BESIDE: f64 = 1.5;

/// Whether the inflection at a place of a density along one axis is that of a flank between a peak and a valley that
/// are both counted at the point. It is theirs then, and tells nothing of a pair that is not counted.
pub(super) fn is_between_counted(point: &Point, observable: usize, inflection: &Indicator) -> bool {
    let (density, detection) = (
        &point.densities[observable].density,
        &point.detections[observable],
    );
    let (Some(rising), &[place]) = (inflection.kind.traits().rising, &inflection.place[..]) else {
        return false;
    };
    let is_counted = |kind, cell| is_counted(kind, cell, &density.axes[0], detection);
    ends_of_flank(density, place, rising).is_some_and(|(peak, valley)| {
        is_counted(FeatureKind::Peak, peak) && is_counted(FeatureKind::Valley, valley)
    })
}

/// Whether the slope of a density along one axis is that between a valley and a peak which is not counted, where it
/// is not low: cells show the peak, or are too wide to show it.
pub(super) fn rises_to_uncounted(
    density: &Density,
    detection: &Detection,
    (flank, least): (&Flank, f64),
) -> bool {
    let axis = &density.axes[0];
    if flank.line != 0 || flank.value <= 0.0 {
        return false;
    }
    let Some(cell) = (axis.find(flank.place)).filter(|cell| density.values[*cell] > least) else {
        return false;
    };
    let is_within = |cell: usize| 0 < cell && cell + 1 < density.values.len();
    let is_counted = |kind, cell| is_counted(kind, cell, axis, detection);
    match ends_of_flank(density, flank.place, flank.rising) {
        Some((peak, _)) => is_within(peak) && !is_counted(FeatureKind::Peak, peak),
        // The flank of a pair that is narrower than cells may be of one that is counted.
        None => {
            let mut kinds = [FeatureKind::Peak, FeatureKind::Valley].into_iter();
            is_within(cell) && !kinds.all(|kind| is_counted(kind, cell))
        }
    }
}

/// Whether a feature is counted that may be in this cell.
fn is_counted(kind: FeatureKind, cell: usize, axis: &Axis, detection: &Detection) -> bool {
    let (centre, width) = (axis.centre(cell), axis.width(cell));
    let features = detection.features.iter();
    let mut counted = features.filter(|one| one.kind == kind && one.verdict == Verdict::Present);
    counted.any(|one| (one.position[0] - centre).abs() <= BESIDE * width)
}

/// The cells at the upper and the lower end of the flank that a place lies on; `None` off a density along one axis, and
/// where cells do not rise, or fall, as they should: a pair may be narrower than they are.
fn ends_of_flank(density: &Density, place: f64, rises: bool) -> Option<(usize, usize)> {
    let ([axis], values) = (&density.axes[..], &density.values) else {
        return None;
    };
    let start = axis
        .edges()
        .partition_point(|edge| *edge <= place)
        .checked_sub(1)?;
    let is_inside = 0 < start && start + 1 < values.len();
    if !is_inside || (values[start + 1] > values[start - 1]) != rises {
        return None;
    }
    let mut right = start;
    while right + 1 < values.len() && (values[right + 1] > values[right]) == rises {
        right += 1;
    }
    let mut left = start;
    while left > 0 && (values[left] > values[left - 1]) == rises {
        left -= 1;
    }
    Some(if rises { (right, left) } else { (left, right) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flank_ends_at_its_peak_and_its_valley() {
        // Peaks at -1 and 1 with a valley between them.
        let axis = Axis::uniform(-2.0, 2.0, 40).unwrap();
        let values = axis
            .centres()
            .iter()
            .map(|x| 2.0 + 2.0 * x * x - x.powi(4))
            .collect();
        let axes = vec![axis];
        let density = Density { axes, values };
        let cells = |place: f64, rises: bool| ends_of_flank(&density, place, rises);
        let at = |cell: usize| density.axes[0].centre(cell);
        let (peak, valley) = cells(0.5, true).unwrap();
        assert!((at(peak) - 1.0).abs() < 0.1 && at(valley).abs() < 0.1);
        let (peak, valley) = cells(-0.5, false).unwrap();
        assert!((at(peak) + 1.0).abs() < 0.1 && at(valley).abs() < 0.1);
        assert_eq!(cells(1.5, false).unwrap().1, 39);
        assert_eq!((cells(0.5, false), cells(-1.99, true)), (None, None));
    }
}
