//! Located and unresolved bifurcations over a diagram, of shape (P), of stability (D) and of spectra (SB): lines,
//! bands, and labels that do not overlap.

use plotters_backend::text_anchor::HPos;

use crate::continuation::{BifurcationStatus, Label, LevelCrossing, SweepResult};
use crate::density::Observable;

use crate::figure::canvas::legend::Swatch;
use crate::figure::canvas::look::{Look, on_heat};
use crate::figure::canvas::page::{Page, Panel, Rectangle, Shape, small};
use crate::figure::canvas::style::{
    BIFURCATION, Colour, D_BIFURCATION, GREY, PAPER, Stroke, TICK_TEXT, WHITE,
};
use crate::figure::canvas::{letters, symbols};

/// Height of a row of labels.
const ROW: f64 = 16.0;
/// Gap between the map and the lowest row.
const GAP: f64 = 4.0;
/// Shade of the band of an error.
const BAND: Colour = WHITE.at(0.45);

/// The lines of bifurcations of other observables.
const OTHERS: &[f64] = &[1.5, 3.0];

/// What a row is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// The shape of the diagram's own density.
    Own,
    /// The shape of another density.
    Other,
    /// The stability of a fixed point, whatever density is drawn.
    Stability,
    /// The shape of a power spectrum.
    Spectral,
}

impl Kind {
    fn colour(self) -> Colour {
        match self {
            Self::Own => BIFURCATION,
            Self::Other => GREY,
            Self::Stability | Self::Spectral => D_BIFURCATION,
        }
    }

    /// Whether it is drawn strongly.
    fn is_strong(self) -> bool {
        self != Self::Other
    }
}

/// The line of a bifurcation of the given status.
fn stroke(kind: Kind, status: BifurcationStatus) -> Stroke {
    let dash: &'static [f64] = match status {
        BifurcationStatus::Located => &[],
        BifurcationStatus::Unresolved => &[6.0, 3.0],
        BifurcationStatus::Unconfirmed => &[2.0, 3.0],
        BifurcationStatus::Unchecked => &[8.0, 2.0, 2.0, 2.0],
    };
    Stroke::solid(kind.colour(), 1.6).dashed(dash)
}

/// A bifurcation's label with its place above the map.
struct PlacedLabel<'a> {
    name: &'a str,
    kind: Kind,
    status: BifurcationStatus,
    value: f64,
    /// The interval of its stated error, as far as the figure shows it.
    band: (f64, f64),
    /// Pixels from the left of the page to the middle of the text.
    middle: f64,
    /// Half the width of the text, in pixels.
    half: f64,
    /// Row, the lowest being 0.
    row: usize,
}

/// The bifurcations of a sweep, those of the diagram's own observable and the others.
pub(crate) struct Labels<'a> {
    placed: Vec<PlacedLabel<'a>>,
    rows: usize,
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
        let kind = |row: &Label| match (row.bifurcation(), row.d_bifurcation()) {
            (Some(located), _) if watched == Some(located.observable) => Some(Kind::Own),
            (Some(_), _) => Some(Kind::Other),
            (_, Some(_)) => Some(Kind::Stability),
            _ => None,
        };
        Self::placed(look, result, &kind, (range, (left, width)))
    }

    /// The same for a figure of one power spectrum, by its name: its own changes stand out, and those of other spectra
    /// stand back.
    pub(crate) fn of_spectrum(
        look: &Look,
        result: &'a SweepResult,
        name: &str,
        place: ((f64, f64), (f64, f64)),
    ) -> Self {
        let of = |crossing: &LevelCrossing| crossing.spectral().is_some_and(|(_, of)| of == name);
        let kind = |row: &Label| match (row.bifurcation(), row.spectral_change()) {
            (None, Some(crossing)) if of(crossing) => Some(Kind::Spectral),
            (Some(_), _) | (_, Some(_)) => Some(Kind::Other),
            _ => row.d_bifurcation().map(|_| Kind::Stability),
        };
        Self::placed(look, result, &kind, place)
    }

    fn placed(
        look: &Look,
        result: &'a SweepResult,
        kind: &dyn Fn(&Label) -> Option<Kind>,
        (range, (left, width)): ((f64, f64), (f64, f64)),
    ) -> Self {
        let inside = |row: &&Label| row.value() >= range.0 && row.value() <= range.1;
        let rows_of = result.labels.iter().filter(inside);
        let mut points: Vec<(&Label, Kind, BifurcationStatus)> = rows_of
            .filter_map(|row| Some((row, kind(row)?, row.status()?)))
            .collect();
        points.sort_by_key(|(_, kind, _)| !kind.is_strong());
        let mut placed = Vec::new();
        let mut rows: Vec<Vec<(f64, f64)>> = Vec::new();
        for (row_of, kind, status) in points {
            let (name, value) = (row_of.name(), row_of.value());
            let half = 0.5 * letters::text_width(look, name, TICK_TEXT, kind.is_strong());
            let share = (value - range.0) / (range.1 - range.0);
            let middle = (left + share * width).clamp(left + half, left + width - half);
            let (from, to) = (middle - half - 3.0, middle + half + 3.0);
            let free =
                |row: &Vec<(f64, f64)>| row.iter().all(|taken| to <= taken.0 || from >= taken.1);
            let row = rows.iter().position(free).unwrap_or(rows.len());
            if row == rows.len() {
                rows.push(Vec::new());
            }
            rows[row].push((from, to));
            placed.push(PlacedLabel {
                name,
                kind,
                status,
                value,
                band: [-1.0, 1.0]
                    .map(|sign| (value + sign * row_of.error()).clamp(range.0, range.1))
                    .into(),
                middle,
                half,
                row,
            });
        }
        Self {
            placed,
            rows: rows.len(),
        }
    }

    /// Room above the map.
    pub(crate) fn height(&self) -> f64 {
        self.rows as f64 * ROW + GAP
    }

    /// Draws bands and lines over the map: strongly for the own observable, faintly for others.
    pub(crate) fn draw_lines(&self, look: &Look, panel: &Panel, (from, to): (f64, f64)) {
        for label in self.placed.iter().rev() {
            let line = [(label.value, from), (label.value, to)];
            if !label.kind.is_strong() {
                let faint = Stroke::solid(on_heat(look, 0.0).at(0.7), 0.9);
                panel.draw(&line, Shape::Line(faint.dashed(OTHERS)));
                continue;
            }
            let (a, b) = label.band;
            if b > a {
                panel.draw(&[(a, from), (b, from), (b, to), (a, to)], Shape::Area(BAND));
            }
            panel.draw(&line, Shape::Line(Stroke::solid(WHITE, 3.2)));
            panel.draw(&line, Shape::Line(stroke(label.kind, label.status)));
        }
    }

    /// Draws bands and lines on the ground of a panel: strongly for the own observable, faintly for others.
    pub(crate) fn draw_plain(&self, panel: &Panel, (from, to): (f64, f64)) {
        for label in self.placed.iter().rev() {
            let line = [(label.value, from), (label.value, to)];
            let (a, b) = label.band;
            if label.kind.is_strong() && b > a {
                let band = label.kind.colour().at(0.08);
                panel.draw(&[(a, from), (b, from), (b, to), (a, to)], Shape::Area(band));
            }
            let stroke = if label.kind.is_strong() {
                Stroke {
                    width: 1.1,
                    ..stroke(label.kind, label.status)
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
        // Where a lower label stands in the way nothing but dots of a leader would be seen.
        let is_free = |label: &&PlacedLabel<'_>| {
            let mut lower = self.placed.iter().filter(|one| one.row < label.row);
            lower.all(|one| (one.middle - label.middle).abs() > one.half + 1.0)
        };
        let higher = self.placed.iter().filter(|label| label.row > 0);
        for label in higher.filter(is_free) {
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
            let colour = label.kind.colour();
            let mut text = small(symbols::plain(label.name), HPos::Center, colour);
            text.bold = label.kind.is_strong();
            page.text((x, y), text);
        }
    }

    /// Entries of a legend, for what is drawn of the diagram's own bifurcations.
    pub(crate) fn entries(&self) -> Vec<(Swatch, String)> {
        let words = [
            (BifurcationStatus::Located, ""),
            (BifurcationStatus::Unresolved, ", unresolved"),
            (BifurcationStatus::Unconfirmed, ", unconfirmed"),
            (BifurcationStatus::Unchecked, ", unchecked"),
        ];
        let of_kind = |(kind, name): (Kind, &'static str)| {
            let own = move || self.placed.iter().filter(move |label| label.kind == kind);
            let shown = words
                .into_iter()
                .filter(move |(status, _)| own().any(|label| label.status == *status));
            shown.map(move |(status, text)| {
                let sample = Swatch::Curve(stroke(kind, status));
                (sample, format!("{name}{text}"))
            })
        };
        let kinds = [
            (Kind::Own, "P-bifurcation"),
            (Kind::Stability, "D-bifurcation"),
            (Kind::Spectral, "change of a spectrum"),
        ];
        kinds.into_iter().flat_map(of_kind).collect()
    }
}
