//! Where other curves pass that begin at a point of codimension two of a curve, found beside it.

use super::companion::ends_there;
use super::degenerate::{Both, solve_pair};
use super::reading::Reader;
use super::walked::{Walked, within};
use super::{CodimensionTwoKind, CurvePoint, CurveStart, CurveWork, Task};
use crate::density::Density;
use crate::topology::IndicatorKind;

/// Length along the curve at which the fold is looked for, where the two are told apart.
const LEAVES: f64 = 0.1;
/// Between centre and peak, the steepest place when the curvature at the centre is zero: √(3/5).
const STEEPEST: f64 = 0.77;
/// Cells about the centre among which no other peak is looked for.
const AT_CENTRE: f64 = 2.0;
/// Farthest from a kink that the inflection of a fold is which begins there, as a share of the range.
const NEAR_KINK: f64 = 0.25;
/// Farthest that its curve may be from where the inflection is read, in sides of the box.
const NEAR_CURVE: f64 = 0.05;
/// Distance from a corner at which the other curve is met.
const BESIDE_CORNER: f64 = 0.03;

impl Task<'_> {
    /// Where another curve passes that begins at a point; `away` are the places of the points on the side of it where
    /// the companion is positive, from it on.
    pub(super) fn branch(
        &self,
        kind: CodimensionTwoKind,
        (walked, away): (&Walked, &[usize]),
        (point, both): (&CurvePoint, &Both),
        work: &mut CurveWork,
    ) -> Option<CurveStart> {
        match kind {
            CodimensionTwoKind::DegenerateSplit => {
                self.fold_of_centre(walked, away, point.arclength, work)
            }
            CodimensionTwoKind::DegenerateKink => self.fold_of_kink(both, work),
            CodimensionTwoKind::KinkCorner => self.other_side(both),
            CodimensionTwoKind::Crossing => Some(CurveStart {
                values: point.values,
                observable: self.start.observable,
                kind: both.companion.kind,
                place: both.companion.place.clone(),
            }),
            CodimensionTwoKind::Cusp => None,
        }
    }

    /// The fold that begins at a degenerate split: beside the curve, on the side of it on which peaks stand away from
    /// the centre.
    fn fold_of_centre(
        &self,
        walked: &Walked,
        away: &[usize],
        begins: f64,
        work: &mut CurveWork,
    ) -> Option<CurveStart> {
        let nodes = away.iter().map(|&index| &walked.points[index]);
        let is_away = |quartic: &Option<f64>| quartic.is_some_and(|quartic| quartic > 0.0);
        let nodes = nodes.take_while(|node| node.reading.companions.first().is_some_and(is_away));
        let mut node = None;
        for one in nodes {
            node = Some(one);
            if (one.arclength - begins).abs() >= LEAVES {
                break;
            }
        }
        let node = node?;
        let centre = &self.start.place;
        let peak = peak_away(&node.reading.density, centre)?;
        let steepest = centre
            .iter()
            .zip(peak)
            .map(|(c, x)| c + STEEPEST * (x - c))
            .collect();
        let tried: Vec<(IndicatorKind, Vec<f64>)> = match centre.len() {
            1 => vec![(IndicatorKind::shoulder(true), steepest)],
            _ => vec![
                (IndicatorKind::RING, centre.clone()),
                (IndicatorKind::FOLD, steepest),
            ],
        };
        let mut reader = self.reader(self.source, self.start.kind);
        self.plane.begin(node.foot);
        let found = tried.into_iter().find_map(|(kind, near)| {
            reader.kind = kind;
            let reading = reader.read(node.foot, &near).ok()?;
            Some(self.start_at(node.foot, kind, reading.indicator.place))
        });
        work.add(&reader.work);
        found
    }

    /// The fold that begins at a degenerate kink: it leaves along the curve, so it is near on one side of the point or
    /// the other. Of the inflections beside the kink that one tells which is nearest to a zero.
    fn fold_of_kink(&self, both: &Both, work: &mut CurveWork) -> Option<CurveStart> {
        let kink = self.start.place.first().copied()?;
        let above = self.start.kind.traits().side_of_kink.unwrap_or(true);
        let side = if above { 1.0 } else { -1.0 };
        let mut reader = self.reader(self.source, self.start.kind);
        let mut nearest: Option<(f64, CurveStart)> = None;
        let along = both.reading.tangent();
        for length in [LEAVES, -LEAVES, 0.5 * LEAVES, -0.5 * LEAVES] {
            if length.abs() < LEAVES && nearest.is_some() {
                break;
            }
            let at = [0, 1].map(|k| both.at[k] + length * along[k]);
            if !within(at) {
                continue;
            }
            self.plane.begin(at);
            for rising in [true, false] {
                reader.kind = IndicatorKind::shoulder(rising);
                let Some((gap, start)) = self.inflection(&mut reader, at, kink, side) else {
                    continue;
                };
                if nearest.as_ref().is_none_or(|(least, _)| gap < *least) {
                    nearest = Some((gap, start));
                }
            }
        }
        work.add(&reader.work);
        Some(nearest?.1)
    }

    /// The inflection beside a kink: how far from there its curve is, and where it passes.
    fn inflection(
        &self,
        reader: &mut Reader<'_>,
        at: [f64; 2],
        kink: f64,
        side: f64,
    ) -> Option<(f64, CurveStart)> {
        let reading = reader.read(at, &[kink]).ok()?;
        let axis = reading.density.axes.first()?.clone();
        let cell = axis.width(axis.find(kink)?);
        // Of a density with a centre the mirror image is as near.
        let near = if side * (reading.indicator.place[0] - kink) > 0.0 {
            reading
        } else {
            reader.read(at, &[kink + side * AT_CENTRE * cell]).ok()?
        };
        let place = near.indicator.place[0];
        let away = side * (place - kink) / (axis.to() - axis.from());
        let gap = near.distance().abs();
        let is_it = (0.0..NEAR_KINK).contains(&away) && gap < NEAR_CURVE;
        let foot = near.foot();
        (is_it && within(foot)).then(|| (gap, self.start_at(foot, reader.kind, vec![place])))
    }

    /// The curve of the slope on the other side of a kink, where that on this side has the sign of the extremum that
    /// the kink is.
    fn other_side(&self, both: &Both) -> Option<CurveStart> {
        let [own, other] = [&both.reading, &both.companion_reading].map(|one| one.gradient);
        let along = solve_pair([(other, 0.0), (own, 1.0)])?;
        let length = along[0].hypot(along[1]);
        let at = [0, 1].map(|k| both.at[k] + BESIDE_CORNER * along[k] / length);
        let is_new = ends_there(both.companion.kind) && within(at);
        is_new.then(|| self.start_at(at, both.companion.kind, both.companion.place.clone()))
    }

    fn start_at(&self, at: [f64; 2], kind: IndicatorKind, place: Vec<f64>) -> CurveStart {
        CurveStart {
            values: self.plane.values(at),
            observable: self.start.observable,
            kind,
            place,
        }
    }
}

/// The middle of the cell in which a density is largest, not at the centre; of a marginal on the upper side of it.
fn peak_away(density: &Density, centre: &[f64]) -> Option<Vec<f64>> {
    let axes = &density.axes;
    let columns = axes.get(1).map_or(1, crate::space::Axis::count);
    let place = |cell: usize| -> Vec<f64> {
        let first = axes[0].centre(cell / columns);
        let second = axes.get(1).map(|axis| axis.centre(cell % columns));
        std::iter::once(first).chain(second).collect()
    };
    let is_away = |place: &[f64]| {
        let cells = place.iter().zip(centre).zip(axes).map(|((x, c), axis)| {
            let cell = axis.find(*c).unwrap_or(0);
            (x - c) / axis.width(cell)
        });
        let cells: Vec<f64> = cells.collect();
        match cells.as_slice() {
            [along] => *along > AT_CENTRE,
            all => all.iter().any(|one| one.abs() > AT_CENTRE),
        }
    };
    let away = (0..density.values.len()).filter(|&cell| is_away(&place(cell)));
    let highest = away.max_by(|&a, &b| density.values[a].total_cmp(&density.values[b]))?;
    Some(place(highest))
}
