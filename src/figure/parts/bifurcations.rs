//! Located and unresolved bifurcations over a diagram: lines, bands, and labels that do not overlap.

use plotters_backend::text_anchor::HPos;

use crate::continuation::{BifurcationStatus, Located, SweepResult};
use crate::density::Observable;

use crate::figure::canvas::legend::Sample;
use crate::figure::canvas::look::{Look, on_heat};
use crate::figure::canvas::page::{Page, Panel, Rectangle, Shape, small};
use crate::figure::canvas::style::{BIFURCATION, Colour, GREY, PAPER, Stroke, TICK_TEXT, WHITE};
use crate::figure::canvas::{letters, symbols};

/// Height of a row of labels.
const ROW: f64 = 16.0;
/// Gap between the map and the lowest row.
const GAP: f64 = 4.0;
/// Shade of the band in which an unresolved bifurcation lies.
const BAND: Colour = WHITE.at(0.45);

/// The lines of bifurcations of other observables.
const OTHERS: &[f64] = &[1.5, 3.0];

/// The line of a bifurcation of the given status.
fn stroke(status: BifurcationStatus) -> Stroke {
    let dash: &'static [f64] = match status {
        BifurcationStatus::Located => &[],
        BifurcationStatus::Unresolved => &[6.0, 3.0],
        BifurcationStatus::Unconfirmed => &[2.0, 3.0],
        BifurcationStatus::Unchecked => &[8.0, 2.0, 2.0, 2.0],
    };
    Stroke::solid(BIFURCATION, 1.6).dashed(dash)
}

/// A bifurcation's label with its place above the map.
struct Placed<'a> {
    point: &'a Located,
    own: bool,
    /// Pixels from the left of the page to the middle of the text.
    middle: f64,
    /// Half the width of the text, in pixels.
    half: f64,
    /// Row, the lowest being 0.
    row: usize,
}

/// The bifurcations of a sweep, those of the diagram's own observable and the others.
pub(crate) struct Labels<'a> {
    placed: Vec<Placed<'a>>,
    rows: usize,
    range: (f64, f64),
}

impl<'a> Labels<'a> {
    /// Places labels in as few rows as keep them apart, the diagram's own ones lowest.
    ///
    /// `range` is that of the parameter; the map begins `map.0` pixels from the left and is `map.1` wide.
    pub(crate) fn new(
        look: &Look,
        result: &'a SweepResult,
        watched: Option<Observable>,
        range: (f64, f64),
        (left, width): (f64, f64),
    ) -> Self {
        let inside = |point: &&Located| point.value >= range.0 && point.value <= range.1;
        let mut points: Vec<&Located> = result.bifurcations().filter(inside).collect();
        let is_own = |point: &Located| watched == Some(point.observable);
        points.sort_by_key(|point| !is_own(point));
        let mut placed = Vec::new();
        let mut rows: Vec<Vec<(f64, f64)>> = Vec::new();
        for point in points {
            let own = is_own(point);
            let half = 0.5 * letters::text_width(look, &point.label, TICK_TEXT, own);
            let share = (point.value - range.0) / (range.1 - range.0);
            let middle = (left + share * width).clamp(left + half, left + width - half);
            let (from, to) = (middle - half - 3.0, middle + half + 3.0);
            let free =
                |row: &Vec<(f64, f64)>| row.iter().all(|taken| to <= taken.0 || from >= taken.1);
            let row = rows.iter().position(free).unwrap_or(rows.len());
            if row == rows.len() {
                rows.push(Vec::new());
            }
            rows[row].push((from, to));
            placed.push(Placed {
                point,
                own,
                middle,
                half,
                row,
            });
        }
        Self {
            placed,
            rows: rows.len(),
            range,
        }
    }

    /// Room above the map.
    pub(crate) fn height(&self) -> f64 {
        self.rows as f64 * ROW + GAP
    }

    /// Draws bands and lines over the map: strongly for the own observable, faintly for others.
    pub(crate) fn draw_lines(&self, look: &Look, panel: &Panel, (from, to): (f64, f64)) {
        for label in self.placed.iter().rev() {
            let point = label.point;
            let line = [(point.value, from), (point.value, to)];
            if !label.own {
                let faint = Stroke::solid(on_heat(look, 0.0).at(0.7), 0.9);
                panel.draw(&line, Shape::Line(faint.dashed(OTHERS)));
                continue;
            }
            let status = point.status();
            if status == BifurcationStatus::Unresolved {
                let a = point.lower.max(self.range.0);
                let b = point.upper.min(self.range.1);
                panel.draw(&[(a, from), (b, from), (b, to), (a, to)], Shape::Area(BAND));
            }
            panel.draw(&line, Shape::Line(Stroke::solid(WHITE, 3.2)));
            panel.draw(&line, Shape::Line(stroke(status)));
        }
    }

    /// Draws bands and lines on the ground of a panel: strongly for the own observable, faintly for others.
    pub(crate) fn draw_plain(&self, panel: &Panel, (from, to): (f64, f64)) {
        for label in self.placed.iter().rev() {
            let point = label.point;
            let line = [(point.value, from), (point.value, to)];
            let status = point.status();
            let a = point.lower.max(self.range.0);
            let b = point.upper.min(self.range.1);
            if label.own && b > a {
                let band = BIFURCATION.at(0.08);
                panel.draw(&[(a, from), (b, from), (b, to), (a, to)], Shape::Area(band));
            }
            let stroke = if label.own {
                Stroke {
                    width: 1.1,
                    ..stroke(status)
                }
            } else {
                Stroke::solid(GREY, 0.9).dashed(OTHERS)
            };
            panel.draw(&line, Shape::Line(stroke));
        }
    }

    /// Writes the labels above the map, with leaders to the higher rows.
    pub(crate) fn draw_texts(&self, page: &Page, map: Rectangle) {
        let middle_of = |row: usize| map.top - GAP - (row as f64 + 0.5) * ROW;
        for label in self.placed.iter().filter(|label| label.row > 0) {
            let line = [
                (label.middle, map.top),
                (label.middle, middle_of(label.row) + 0.5 * ROW),
            ];
            page.draw(&line, Shape::Line(Stroke::solid(GREY, 0.6)));
        }
        for label in &self.placed {
            let (x, y) = (label.middle, middle_of(label.row));
            // A ground of its own keeps leaders from striking the lower labels through.
            let corner = (x - label.half - 1.0, y - 0.45 * ROW);
            let ground = Rectangle::new(corner, (2.0 * label.half + 2.0, 0.9 * ROW));
            page.draw(&ground.corners(), Shape::Area(PAPER));
            let colour = if label.own { BIFURCATION } else { GREY };
            let mut text = small(symbols::plain(&label.point.label), HPos::Center, colour);
            text.bold = label.own;
            page.text((x, y), text);
        }
    }

    /// Entries of a legend, for what is drawn of the diagram's own bifurcations.
    pub(crate) fn entries(&self) -> Vec<(Sample, String)> {
        let words = [
            (BifurcationStatus::Located, "P-bifurcation"),
            (BifurcationStatus::Unresolved, "P-bifurcation, unresolved"),
            (BifurcationStatus::Unconfirmed, "P-bifurcation, unconfirmed"),
            (BifurcationStatus::Unchecked, "P-bifurcation, unchecked"),
        ];
        let own = || self.placed.iter().filter(|label| label.own);
        let shown = words
            .into_iter()
            .filter(|(status, _)| own().any(|label| label.point.status() == *status));
        shown
            .map(|(status, text)| (Sample::Curve(stroke(status)), text.to_owned()))
            .collect()
    }
}
