//! The line of a curve in a plane of two parameters with the band of its error, in dashes where it is not located.

use crate::continuation::BifurcationStatus;
use crate::continuation::curve::{CurvePoint, Plane};
use crate::figure::canvas::page::{Panel, Shape};
use crate::figure::canvas::style::Stroke;

/// Opacity of the band.
pub(crate) const BAND: f64 = 0.25;
/// Where the line is not located.
pub(crate) const DASHES: &[f64] = &[5.0, 4.0];

/// Draws the line through points of a plane.
pub(crate) fn draw_points(panel: &Panel, (plane, points): (&Plane, &[CurvePoint]), stroke: Stroke) {
    let edge = |sign: f64| {
        points.iter().map(move |point| {
            let [x, y] = [0, 1].map(|k| point.values[k] + sign * point.to_edge[k]);
            into_box(plane, x, y)
        })
    };
    let mut outline: Vec<(f64, f64)> = edge(1.0).collect();
    outline.extend(edge(-1.0).collect::<Vec<_>>().into_iter().rev());
    panel.draw(&outline, Shape::Area(stroke.colour.at(BAND)));
    for (places, located) in pieces(plane, points) {
        let stroke = if located {
            stroke
        } else {
            stroke.dashed(DASHES)
        };
        panel.draw(&places, Shape::Line(stroke));
    }
}

/// Pieces of the line of which both ends are located, or not.
fn pieces(plane: &Plane, points: &[CurvePoint]) -> Vec<(Vec<(f64, f64)>, bool)> {
    let mut pieces: Vec<(Vec<(f64, f64)>, bool)> = Vec::new();
    for pair in points.windows(2) {
        let mut both = pair.iter();
        let located = both.all(|point| point.status() == BifurcationStatus::Located);
        let [a, b] = [0, 1].map(|k| into_box(plane, pair[k].values[0], pair[k].values[1]));
        match pieces.last_mut().filter(|piece| piece.1 == located) {
            Some((places, _)) => places.push(b),
            None => pieces.push((vec![a, b], located)),
        }
    }
    pieces
}

/// A place moved into the box.
pub(crate) fn into_box(plane: &Plane, x: f64, y: f64) -> (f64, f64) {
    let [first, second] = plane.sides();
    (
        x.clamp(first.from, first.to),
        y.clamp(second.from, second.to),
    )
}
