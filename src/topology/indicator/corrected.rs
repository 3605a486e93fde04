//! The signature that the indicators at a centre of symmetry imply.
//!
//! By symmetry the centre is a critical point of the density at every parameter value, so its type is that of the
//! signs of the indicators there: all negative, a peak; all positive, the bottom of a valley or crater; mixed, a
//! saddle. The type is known long before peaks stand out from each other, and decides between the signatures
//! that persistence cannot tell apart: other critical points come in pairs.

use super::Indicator;
use crate::density::EstimatedDensity;
use crate::topology::Signature;

/// Distance from the centre, in cells, within which a peak is the one at the centre.
const NEAR: f64 = 3.0;

/// Type of the centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Type {
    Peak,
    Saddle,
    Bottom,
}

/// The type, if every sign is beyond doubt.
fn type_of(indicators: &[Indicator], doubt: f64) -> Option<Type> {
    let signs: Option<Vec<bool>> = indicators.iter().map(|one| one.sign(doubt)).collect();
    let signs = signs?;
    let up = signs.iter().filter(|&&up| up).count();
    (!signs.is_empty()).then_some(match up {
        0 => Type::Peak,
        up if up == signs.len() => Type::Bottom,
        _ => Type::Saddle,
    })
}

/// What persistence counts.
pub(crate) struct Counted<'a> {
    pub(crate) signature: Signature,
    /// Places of the peaks that are present, rings left out.
    pub(crate) peaks: &'a [Vec<f64>],
    /// Places of the craters that are present.
    pub(crate) craters: &'a [Vec<f64>],
    /// Rings that the centre lies in.
    pub(crate) rings_around_centre: usize,
}

/// The signature that persistence found, corrected by the type of the centre where that is beyond doubt. Peaks, unlike
/// rings, come in pairs about the centre.
pub(crate) fn correct(
    estimated: &EstimatedDensity,
    indicators: &[Indicator],
    doubt: f64,
    counted: &Counted<'_>,
) -> Signature {
    let mut signature = counted.signature;
    let (Some(kind), Some(centre)) = (type_of(indicators, doubt), &estimated.structure.centre)
    else {
        return signature;
    };
    let near = |place: &Vec<f64>| cells_from(estimated, centre, place) <= NEAR;
    let is_marginal = centre.len() == 1;
    let even = signature.peaks.is_multiple_of(2);
    let at_centre = counted.craters.iter().filter(|place| near(place)).count();
    let encloses = counted.rings_around_centre > 0;
    match (kind, even) {
        // A peak at the centre is one, all others are pairs: a pair that straddles the centre is this one peak.
        (Type::Peak, true) if counted.peaks.iter().any(near) => {
            signature.peaks -= 1;
            signature.enclosed_peaks -= usize::from(signature.enclosed_peaks > 1);
        }
        (Type::Peak, true) => {
            signature.peaks += 1;
            signature.enclosed_peaks += usize::from(encloses);
        }
        (Type::Saddle, false) => signature.peaks += 1,
        (Type::Bottom, false) if is_marginal => signature.peaks += 1,
        _ => {}
    }
    if !is_marginal {
        match (kind == Type::Bottom, at_centre) {
            (true, 0) => signature.craters += 1,
            // Between a peak at the centre and a ring lies a moat.
            (false, _) => {
                let others = signature.craters - at_centre.min(signature.craters);
                signature.craters = others.max(counted.rings_around_centre.min(signature.craters));
            }
            _ => {}
        }
    }
    signature
}

/// Distance of a place from the centre in cells, those at the centre or of mean width, whichever are wider; the larger
/// over the axes.
fn cells_from(estimated: &EstimatedDensity, centre: &[f64], place: &[f64]) -> f64 {
    let axes = estimated.density.axes.iter().enumerate();
    axes.map(|(k, axis)| {
        let local = axis.find(centre[k]).map_or(0.0, |cell| axis.width(cell));
        let mean = (axis.to() - axis.from()) / axis.count() as f64;
        (place[k] - centre[k]).abs() / local.max(mean)
    })
    .fold(0.0, f64::max)
}
