//! Splits at a centre in a plane whose other parameter breaks the symmetry.
//!
//! The centre is there on one line of the plane alone, and the split is a point. With a tilt, one peak that splits into
//! two is a cusp, from which two folds leave, and a kink that turns is a corner, from which the curves of both of its
//! sides leave.

use super::walked::{Walked, within};
use super::{CurvePoint, CurveStart, CurveWork, EndReason, Task};
use crate::continuation::{BifurcationStatus, Doubt};
use crate::topology::IndicatorKind;

/// Distances from the point at which the others are looked for, in sides of the box.
const BESIDE: [f64; 3] = [0.05, 0.1, 0.02];
/// Farthest that a curve may be from there.
const NEAR: f64 = 0.1;

impl Task<'_> {
    /// Ends a curve that is one point in it, where that is because the symmetry is lost beside it; gives where the
    /// curves pass that begin there.
    pub(super) fn break_symmetry(
        &self,
        walked: &mut Walked,
        points: &mut [CurvePoint],
        work: &mut CurveWork,
    ) -> Vec<CurveStart> {
        let ([node], [point]) = (walked.points.as_slice(), points) else {
            return Vec::new();
        };
        if walked
            .ends
            .iter()
            .any(|end| *end != EndReason::SymmetryLost)
        {
            return Vec::new();
        }
        let companion = node.reading.companions.first().copied().flatten();
        let (Some(companion), [_]) = (companion, self.start.place.as_slice()) else {
            return Vec::new();
        };
        let is_valley = companion < 0.0;
        let sides = [true, false];
        let (reason, kinds) = if self.start.kind == IndicatorKind::CURVATURE {
            (EndReason::Cusp, sides.map(IndicatorKind::shoulder))
        } else if self.start.kind == IndicatorKind::KINK_SLOPE {
            let kinds = sides.map(|above| IndicatorKind::beside_kink(above, is_valley));
            (EndReason::KinkCorner, kinds)
        } else {
            return Vec::new();
        };
        // Three extrema are there where the indicator and the next derivative have opposite signs.
        let side = if is_valley { 1.0 } else { -1.0 };
        let uphill = node.reading.uphill();
        let found = BESIDE.iter().find_map(|length| {
            let at = [0, 1].map(|k| node.foot[k] + side * length * uphill[k]);
            if !within(at) {
                return None;
            }
            self.plane.begin(at);
            let mut reader = self.reader(self.source, self.start.kind);
            let starts = kinds.map(|kind| {
                reader.kind = kind;
                let reading = reader.read(at, &self.start.place).ok()?;
                let foot = reading.foot();
                let is_near = reading.distance().abs() <= NEAR && within(foot);
                is_near.then(|| CurveStart {
                    values: self.plane.values(foot),
                    observable: self.start.observable,
                    kind,
                    place: reading.indicator.place,
                })
            });
            work.add(&reader.work);
            let [Some(one), Some(other)] = starts else {
                return None;
            };
            Some(vec![one, other])
        });
        let Some(found) = found else {
            return Vec::new();
        };
        if point.status() == BifurcationStatus::Unconfirmed {
            // Finer cells may move the centre, beside which the indicator is not read.
            let is_imprecise = |doubt: &Doubt| doubt.status() == BifurcationStatus::Unresolved;
            point.doubts.retain(is_imprecise);
        }
        walked.ends = vec![reason];
        found
    }
}
