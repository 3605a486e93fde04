//! Curves of a fixed point in the figure of a plane: where its exponent is zero, and where the density turns from
//! infinite to zero there.

use crate::continuation::curve::{Plane, StabilityCurve, StabilityKind, stability_curves};
use crate::figure::canvas::legend::Swatch;
use crate::figure::canvas::page::{Panel, Shape};
use crate::figure::canvas::style::{BIFURCATION, D_BIFURCATION, Stroke};
use crate::system::Family;

/// Width of their lines, in pixels.
const WIDE: f64 = 1.8;

/// Where the density turns, beside curves of changes that cells show.
const DASHES: &[f64] = &[7.0, 2.5];

/// The curves of a plane.
pub(crate) struct Stability(Vec<StabilityCurve>);

impl Stability {
    /// Those of the fixed point that a family asks for; `is_whole` where the figure is of a density of all axes, which
    /// alone turns from infinite to zero.
    pub(crate) fn new(family: &Family, plane: &Plane, is_whole: bool) -> Self {
        let mut curves = stability_curves(family, plane);
        curves.retain(|curve| is_whole || curve.kind == StabilityKind::Exponent);
        Self(curves)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn draw(&self, panel: &Panel) {
        for curve in &self.0 {
            let places = curve.points.iter();
            let places: Vec<(f64, f64)> = places
                .map(|point| (point.values[0], point.values[1]))
                .collect();
            panel.draw(&places, Shape::Line(stroke(curve.kind)));
        }
    }

    /// Where the exponent is zero at a value of the first parameter, if there is one such place.
    pub(crate) fn zero_at(&self, value: f64) -> Option<(f64, f64)> {
        let curves = self.0.iter();
        let curves = curves.filter(|curve| curve.kind == StabilityKind::Exponent);
        let pieces = curves.flat_map(|curve| curve.points.windows(2));
        let mut places = pieces.filter_map(|piece| {
            let [[a, low], [b, high]] = [piece[0].values, piece[1].values];
            let is_within = (a <= value) != (b <= value);
            is_within.then(|| (value, low + (value - a) / (b - a) * (high - low)))
        });
        let first = places.next()?;
        places.next().is_none().then_some(first)
    }

    /// The places that each goes through.
    pub(crate) fn lines(&self) -> impl Iterator<Item = Vec<[f64; 2]>> {
        let points = self.0.iter().map(|curve| curve.points.iter());
        points.map(|points| points.map(|point| point.values).collect())
    }

    /// What the legend says of them.
    pub(crate) fn entries(&self) -> Vec<(Swatch, String)> {
        let mut entries: Vec<(Swatch, String)> = Vec::new();
        for curve in &self.0 {
            let words = match curve.kind {
                StabilityKind::Exponent => "D-bifurcation: λ of the fixed point is 0",
                StabilityKind::Density => "p turns from ∞ to 0 at the fixed point",
            };
            if entries.iter().all(|known| known.1 != words) {
                entries.push((Swatch::Curve(stroke(curve.kind)), words.to_owned()));
            }
        }
        entries
    }

    /// What the caption says of them; nothing without any.
    pub(crate) fn caption(&self) -> String {
        let sentences = self.0.iter().map(|curve| {
            format!(
                " On {} {}, known to {:.0e} of the sides of the box.",
                curve.name,
                curve.kind.words(),
                curve.largest_error()
            )
        });
        sentences.collect()
    }

    /// Names, values and words of all points, for the figure's table.
    pub(crate) fn data(&self) -> impl Iterator<Item = (&StabilityCurve, [f64; 2])> {
        self.0.iter().flat_map(|curve| {
            let points = curve.points.iter();
            points.map(move |point| (curve, point.values))
        })
    }
}

fn stroke(kind: StabilityKind) -> Stroke {
    match kind {
        StabilityKind::Exponent => Stroke::solid(D_BIFURCATION, WIDE),
        StabilityKind::Density => Stroke::solid(BIFURCATION, WIDE).dashed(DASHES),
    }
}
