//! Indicators of a density over one axis that follow from its equations: no cells take part.

use super::{Indicator, IndicatorKind};
use crate::density::Profile;

/// An extremum of the slope of a marginal's logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flank {
    /// Whether the density rises with the coordinate between valley and peak, when both are there.
    pub rising: bool,
    /// Where.
    pub place: f64,
    /// The slope, positive when both are there.
    pub value: f64,
    /// The line that it is on: 0 of a marginal and on a ray from a centre, 1 + k on a crest along the axis k.
    pub line: usize,
    /// Whether a second scheme tells the sign of the slope, and that it has an extremum there. Where it does not, a
    /// pair may be there or not.
    pub is_sure: bool,
}

impl Flank {
    /// The extremum at a place of a marginal or a ray, from the slope there and at its neighbours on either side.
    pub(super) fn between(place: f64, [left, here, right]: [f64; 3]) -> Option<Self> {
        let is_highest = here >= left && here > right;
        let is_lowest = here <= left && here < right;
        (is_highest || is_lowest).then(|| Self {
            line: 0,
            is_sure: true,
            rising: is_highest,
            place,
            value: if is_highest { here } else { -here },
        })
    }
}

/// The slope at its extremum of the given kind nearest to a place; none at a jump, where the slope beside it tells.
pub(super) fn shoulder(
    profile: &Profile,
    near: f64,
    rising: bool,
    kind: IndicatorKind,
) -> Option<Indicator> {
    let distance = |place: f64| (place - near).abs();
    let is_jump = |place: f64| profile.jumps.iter().any(|jump| jump.place == place);
    let turns = profile.turns.iter();
    let alike = turns.filter(|one| one.is_largest == rising && !is_jump(one.place));
    let turn = alike.min_by(|a, b| distance(a.place).total_cmp(&distance(b.place)))?;
    let value = if rising { turn.slope } else { -turn.slope };
    Indicator::known(kind, turn.place, value, turn.error)
}

/// The slope on one side of the jump nearest to a place.
pub(super) fn beside_kink(
    profile: &Profile,
    near: f64,
    (above, is_valley): (bool, bool),
    kind: IndicatorKind,
) -> Option<Indicator> {
    let distance = |place: f64| (place - near).abs();
    let jumps = profile.jumps.iter();
    let jump = jumps.min_by(|a, b| distance(a.place).total_cmp(&distance(b.place)))?;
    // Uphill is away from a valley.
    let sign = if above == is_valley { 1.0 } else { -1.0 };
    Indicator::known(
        kind,
        jump.place,
        sign * jump.slopes[usize::from(above)],
        jump.error,
    )
}

/// The curvature at the centre of symmetry.
pub(super) fn curvature(profile: &Profile, centre: f64, kind: IndicatorKind) -> Option<Indicator> {
    let (value, error) = profile.curvature?;
    Indicator::known(kind, centre, value, error)
}

/// All extrema of the slope.
pub(super) fn flanks(profile: &Profile) -> Vec<Flank> {
    let turns = profile.turns.iter();
    turns
        .map(|turn| Flank {
            rising: turn.is_largest,
            place: turn.place,
            line: 0,
            is_sure: true,
            value: if turn.is_largest {
                turn.slope
            } else {
                -turn.slope
            },
        })
        .collect()
}
