//! Curves of P-bifurcations in their plane of two parameters: the lines, their bands of error, their ends, points of
//! codimension two, and the row that the first was begun at.

mod words;

use plotters_backend::text_anchor::HPos;

use super::Sketch;
use crate::continuation::BifurcationStatus;
use crate::continuation::curve::{
    Curve, CurveOrigin, CurvePoint, CurveTree, EndReason, LevelCurve, Plane, SweepInPlane,
    codimension_two,
};
use crate::density::Observable;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::page::{Heading, Lettering, Page, Panel, Rectangle, Shape, small};
use crate::figure::canvas::style::{
    BIFURCATION, Colour, D_BIFURCATION, GREY, INK, MARGIN, PAPER, Stroke,
};
use crate::figure::canvas::symbols;
use crate::figure::parts::crossed::Crossed;
use crate::figure::parts::curve_line::{BAND, DASHES, draw_points, into_box};
use crate::figure::parts::level_lines::LevelLines;
use crate::figure::parts::names;
use crate::figure::parts::names::symbol_of;
use crate::figure::parts::stability::Stability;
use crate::figure::print::{Figure, Print};
use crate::system::Family;
use crate::topology::IndicatorKind;

/// Size of the panel on a page of its own width, in pixels, and that width.
const PANEL: (f64, f64) = (390.0, 300.0);
const USUAL: f64 = 480.0;
/// Room right of the panel, for half a label.
const BESIDE: f64 = 14.0;
/// A band narrower than this, in pixels, is not seen beside the line.
const SEEN: f64 = 2.0;
/// Radius of the dots at the ends and at the start, in pixels.
const DOT: f64 = 3.4;
/// Distance of letters from what they name, in pixels.
const AWAY: f64 = 9.0;
/// Room that a label takes beside its point, in pixels.
const ROOM: f64 = 45.0;

/// The figure of curves in one plane; none without a curve.
pub(in crate::figure) fn sketches<'a>(
    (plane, tree): (&'a Plane, &'a CurveTree),
    (row, sweeps): (&'a CurveOrigin, &'a [SweepInPlane]),
    family: &'a Family,
) -> Vec<Sketch<'a>> {
    let stability = Stability::new(family, plane, true);
    let (curves, levels) = (tree.curves.as_slice(), tree.levels.as_slice());
    if curves.is_empty() && levels.is_empty() && stability.is_empty() {
        return Vec::new();
    }
    let draw = move |print: &Print<'_>| {
        let watched: Vec<Observable> = curves.iter().map(|curve| curve.observable).collect();
        let crossed = Crossed {
            plane,
            family,
            sweeps,
            observables: &watched,
        };
        let scene = Scene {
            plane,
            curves,
            stability: &stability,
            levels: LevelLines {
                plane,
                curves: levels,
                family,
                observables: &watched,
            },
            row,
            crossed,
            family,
        };
        let page = scene.draw(print);
        Some(Figure::new(&page, scene.caption(print), scene.data()))
    };
    vec![Sketch::new("curve", draw)]
}

struct Scene<'a> {
    plane: &'a Plane,
    /// The first is the one that was begun at the row, unless that is no P-bifurcation.
    curves: &'a [Curve],
    stability: &'a Stability,
    levels: LevelLines<'a>,
    row: &'a CurveOrigin,
    crossed: Crossed<'a>,
    family: &'a Family,
}

impl Scene<'_> {
    /// Symbol of a side's parameter.
    fn symbol(&self, side: usize) -> String {
        symbol_of(self.family, &self.plane.sides()[side].parameter)
    }

    fn draw(&self, print: &Print<'_>) -> Page {
        let look = &print.look;
        let [x, y] = self.plane.sides();
        let (x, y) = ((x.from, x.to), (y.from, y.to));
        let high = look.height(PANEL.1, USUAL);
        let up = Scale::vertical(look, y, high, &self.symbol(1));
        let left = MARGIN + up.left();
        let wide = look.fill(PANEL.0, left + BESIDE + MARGIN);
        let width = left + wide + BESIDE + MARGIN;
        let across = Scale::horizontal(look, x, wide, &self.symbol(0));
        let heading = Heading::new(look, print.title, width);
        let top = heading.height() + 6.0;
        let rect = Rectangle::new((left, top), (wide, high));
        let below = rect.bottom() + Scale::below();
        let mut entries = entries(self.curves, self.family, rect);
        entries.extend(self.stability.entries());
        entries.extend(self.levels.entries());
        entries.extend(self.crossed.entries());
        let legend = Legend::new(look, entries, width - 2.0 * MARGIN);
        let page = Page::new(look, width, below + legend.height() + MARGIN);
        heading.draw(&page);
        let panel = page.panel(rect, x, y);
        for curve in self.curves {
            let points = (&curve.plane, curve.points.as_slice());
            draw_points(&panel, points, stroke_of(self.curves, curve.kind));
        }
        self.stability.draw(&panel);
        self.levels.draw(&panel);
        self.crossed.draw(&panel);
        frame::around(&page, rect, (&across, &up));
        self.draw_marks(&page, &panel, rect);
        legend.draw(&page, left + 0.5 * wide, below);
        page
    }

    /// The start with its label and the signatures on both sides, and the ends with theirs.
    fn draw_marks(&self, page: &Page, panel: &Panel, rect: Rectangle) {
        let place = |point: &CurvePoint| into_box(self.plane, point.values[0], point.values[1]);
        let rim = || Stroke::solid(INK, 1.2);
        for (number, curve) in self.curves.iter().enumerate() {
            let told = |reason: &EndReason| {
                matches!(
                    reason,
                    EndReason::Cusp
                        | EndReason::DegenerateSplit
                        | EndReason::DegenerateKink
                        | EndReason::KinkCorner
                )
            };
            for end in curve.ends.iter().filter(|end| !told(&end.reason)) {
                let Some(point) = curve.points.get(end.point) else {
                    continue;
                };
                panel.draw(&[place(point)], Shape::Dot(DOT, PAPER, rim()));
                if number == 0 {
                    let at = seen(panel, self.plane, &curve.points, end.point);
                    write(page, rect, at, &end.label, (GREY, false));
                }
            }
        }
        for point in codimension_two(self.curves) {
            let [x, y] = point.values;
            let at = into_box(self.plane, x, y);
            panel.draw(&[at], Shape::Dot(DOT, PAPER, rim()));
            let at = panel.place(at);
            write(page, rect, (at, false), &point.label, (INK, true));
        }
        let Some(first) = self.curves.first() else {
            if let Some(curve) = self.levels.curves.first() {
                self.draw_level_marks(page, panel, rect, curve);
            } else if let Some(start) = self.stability.zero_at(self.row.value) {
                let rim = Stroke::solid(D_BIFURCATION, 1.2);
                panel.draw(&[start], Shape::Dot(DOT, D_BIFURCATION, rim));
                let at = panel.place(start);
                let colour = (D_BIFURCATION, true);
                write(page, rect, (at, false), &self.row.label, colour);
            }
            return;
        };
        let Some(start) = first.points.get(first.start) else {
            return;
        };
        let rim = Stroke::solid(BIFURCATION, 1.2);
        panel.draw(&[place(start)], Shape::Dot(DOT, BIFURCATION, rim));
        let (at, rises) = seen(panel, self.plane, &first.points, first.start);
        write(
            page,
            rect,
            (at, rises),
            &self.row.label,
            (BIFURCATION, true),
        );
        for (signature, side) in self.row.sides.into_iter().flatten().zip([-1.0, 1.0]) {
            let anchor = if side < 0.0 { HPos::Right } else { HPos::Left };
            let text = small(symbols::plain(&signature.to_string()), anchor, GREY);
            page.text((at.0 + side * 2.5 * AWAY, at.1 + AWAY), text);
        }
    }

    /// The start of the curve of a level with its label, and its ends.
    fn draw_level_marks(&self, page: &Page, panel: &Panel, rect: Rectangle, curve: &LevelCurve) {
        let rim = Stroke::solid(INK, 1.2);
        let ends = curve.ends.iter();
        let ends = ends.map(|end| (end.point, end.label.as_str(), PAPER, (GREY, false)));
        let start = (curve.start, self.row.label.as_str(), INK, (INK, true));
        for (index, label, inside, letters) in ends.chain([start]) {
            let Some(point) = curve.points.get(index) else {
                continue;
            };
            let place = into_box(self.plane, point.values[0], point.values[1]);
            panel.draw(&[place], Shape::Dot(DOT, inside, rim));
            let at = seen(panel, self.plane, &curve.points, index);
            write(page, rect, at, label, letters);
        }
    }
}

/// The line of an indicator among those of several curves: a colour each.
pub(super) fn stroke_of<'c>(
    curves: impl IntoIterator<Item = &'c Curve>,
    kind: IndicatorKind,
) -> Stroke {
    let mut kinds: Vec<&str> = Vec::new();
    for curve in curves {
        if !kinds.contains(&curve.kind.name()) {
            kinds.push(curve.kind.name());
        }
    }
    let number = kinds.iter().position(|name| *name == kind.name());
    Stroke::curve(number.unwrap_or(0)).dashed(&[])
}

/// What a legend says of curves: the meaning of each line, its band, where it is wider than the line, and what dashes
/// mean.
pub(super) fn entries<'c>(
    curves: impl IntoIterator<Item = &'c Curve> + Clone,
    family: &Family,
    rect: Rectangle,
) -> Vec<(Swatch, String)> {
    let mut entries: Vec<(Swatch, String)> = Vec::new();
    let mut add = |is_shown: bool, stroke: Stroke, words: String| {
        if is_shown && entries.iter().all(|known| known.1 != words) {
            entries.push((Swatch::Curve(stroke), words));
        }
    };
    let shorter = rect.width.min(rect.height);
    for curve in curves.clone() {
        let stroke = stroke_of(curves.clone(), curve.kind);
        let density = names::density(family, curve.observable);
        add(
            true,
            stroke,
            format!("{} of {density} is 0", curve.kind.name()),
        );
        let is_seen = |point: &CurvePoint| 2.0 * point.error * shorter > SEEN;
        let band = Stroke::solid(stroke.colour.at(BAND), 8.0);
        add(
            curve.points.iter().any(is_seen),
            band,
            "its error".to_owned(),
        );
        let doubtful = |point: &CurvePoint| point.status() != BifurcationStatus::Located;
        let is_doubtful = curve.points.iter().any(doubtful);
        add(is_doubtful, stroke.dashed(DASHES), "not located".to_owned());
    }
    entries
}

/// Where one of the points of a curve is on the page, and whether the curve rises to the right there.
fn seen(panel: &Panel, plane: &Plane, points: &[CurvePoint], index: usize) -> ((f64, f64), bool) {
    let last = points.len().saturating_sub(1);
    let place = |index: usize| {
        let values = points
            .get(index.min(last))
            .map_or([0.0; 2], |point| point.values);
        panel.place(into_box(plane, values[0], values[1]))
    };
    let (before, after) = (place(index.saturating_sub(1)), place(index + 1));
    let rises = (after.0 - before.0) * (after.1 - before.1) < 0.0;
    (place(index), rises)
}

/// Writes beside a point of a curve, on the side on which the curve is not: above it where there is room, or else
/// below.
fn write(
    page: &Page,
    rect: Rectangle,
    (at, rises): ((f64, f64), bool),
    words: &str,
    (colour, bold): (Colour, bool),
) {
    let above = if rises { -1.0 } else { 1.0 };
    let fits = |side: f64, down: f64| {
        let (x, y) = (at.0 + side * ROOM, at.1 + 2.0 * down);
        (rect.left..=rect.right()).contains(&x) && (rect.top..=rect.bottom()).contains(&y)
    };
    let places = [
        (above, -AWAY),
        (-above, AWAY),
        (-above, -AWAY),
        (above, AWAY),
    ];
    let free = places.into_iter().find(|&(side, down)| fits(side, down));
    let (side, down) = free.unwrap_or(places[0]);
    let anchor = if side > 0.0 { HPos::Left } else { HPos::Right };
    let text = Lettering {
        bold,
        ..small(symbols::plain(words), anchor, colour)
    };
    page.text((at.0 + side * AWAY, at.1 + down), text);
}
