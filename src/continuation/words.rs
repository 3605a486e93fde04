//! What happens at a P-bifurcation, in words.

use crate::topology::{IndicatorKind, Signature};

/// What happens as the parameter rises through a change of signature, decided by an indicator (`None`: by persistence)
/// that rises or falls.
pub(super) fn change(
    kind: Option<IndicatorKind>,
    rises: bool,
    before: Signature,
    after: Signature,
) -> &'static str {
    let craters = after.craters.cmp(&before.craters);
    let peaks = after.peaks.cmp(&before.peaks);
    use std::cmp::Ordering::{Equal, Greater, Less};
    if before == after {
        return "comes and goes";
    }
    // Beside other peaks that stand, the centre becomes a peak between two new valleys, or is one no more.
    let of_centre = match (rises, peaks) {
        (true, Less) => "peak at the centre vanishes",
        (true, _) => "symmetric split",
        (false, Greater) => "peak at the centre is born",
        (false, _) => "symmetric merger",
    };
    let several = before.peaks.abs_diff(after.peaks) > 1;
    match (kind, craters, peaks) {
        (Some(IndicatorKind::Curvature), ..) => of_centre,
        (Some(IndicatorKind::KinkSlope), Equal, _) if rises => "split at a kink",
        (Some(IndicatorKind::KinkSlope), Equal, _) => "merger at a kink",
        (Some(IndicatorKind::Shoulder { .. }), _, Greater) if several => {
            "peaks and valleys are born"
        }
        (Some(IndicatorKind::Shoulder { .. }), ..) if several => "peaks and valleys vanish",
        (Some(IndicatorKind::Shoulder { .. }), _, Greater) => "peak and valley are born",
        (Some(IndicatorKind::Shoulder { .. }), ..) => "peak and valley vanish",
        (Some(IndicatorKind::BesideKink { .. }), _, Greater) => {
            "peak and valley are born at a kink"
        }
        (Some(IndicatorKind::BesideKink { .. }), ..) => "peak and valley vanish at a kink",
        (Some(IndicatorKind::Fold), Equal, Greater) => "peak and saddle are born",
        (Some(IndicatorKind::Fold), Equal, _) => "peak and saddle vanish",
        _ if after.rings > before.rings && craters == Greater => {
            match before.peaks == after.peaks {
                true => "ring is born",
                false => "ring opens",
            }
        }
        _ if after.rings < before.rings && craters == Less => match before.peaks == after.peaks {
            true => "ring vanishes",
            false => "ring closes",
        },
        _ if after.rings < before.rings && after.rings > 0 => "rings merge",
        _ if after.rings > before.rings && before.rings > 0 => "ring parts",
        _ if after.rings > before.rings => "rim becomes level",
        _ if after.rings < before.rings => "rim breaks into peaks",
        (_, Greater, _) => "crater opens",
        (_, Less, _) => "crater closes",
        (Some(_), Equal, _) => of_centre,
        (None, Equal, Greater) => "peak appears",
        (None, Equal, _) => "peak vanishes",
    }
}
