//! Legends: swatches with their meaning, in rows outside of the panels, so that no data are covered.

use plotters_backend::text_anchor::HPos;

use super::letters;
use super::look::Look;
use super::page::{Page, Rectangle, Shape, small};
use super::style::{
    BLACK, CURVE_LINE, Colour, ERROR_LINE, INK, MARGIN, PAPER, Stroke, TEXT, TICK_TEXT, WHITE,
};

/// Length of a swatch, in pixels.
const SAMPLE: f64 = 30.0;
/// Gap between a swatch and its text.
const GAP: f64 = 6.0;
/// Gap between two entries.
const BETWEEN: f64 = 20.0;
/// Height of a row.
pub(crate) const ROW: f64 = 1.5 * TEXT;

/// What stands for an entry.
#[derive(Clone, Copy)]
pub(crate) enum Swatch {
    /// A curve.
    Curve(Stroke),
    /// A symbol with an error bar.
    Symbol(Colour),
    /// A line through symbols: line, place in the list of symbols.
    Marked(Stroke, usize),
    /// The line of a branch of peaks.
    Peaks,
    /// The line of a branch of valleys.
    Valleys,
    /// A `+` on a piece of heat map.
    Plus,
    /// A small `+` alone, of this half length and stroke.
    Cross(f64, Stroke),
    /// A ring on a piece of heat map.
    Ring,
    /// A hatched box.
    Hatched,
    /// A box of one colour.
    Box(Colour),
}

/// A legend laid out in rows.
pub(crate) struct Legend {
    /// Swatch, text, and place of the swatch's left end: pixels from the left, number of the row.
    entries: Vec<(Swatch, String, f64, usize)>,
    rows: Vec<f64>,
}

impl Legend {
    /// Lays out entries (texts are markup) in rows no wider than `width`.
    pub(crate) fn new(look: &Look, entries: Vec<(Swatch, String)>, width: f64) -> Self {
        let mut rows: Vec<f64> = Vec::new();
        let mut placed = Vec::new();
        for (swatch, text) in entries {
            let entry = SAMPLE + GAP + letters::text_width(look, &text, TICK_TEXT, false);
            let left = match rows.last_mut() {
                Some(row) if *row + BETWEEN + entry <= width => {
                    let left = *row + BETWEEN;
                    *row = left + entry;
                    left
                }
                _ => {
                    rows.push(entry);
                    0.0
                }
            };
            placed.push((swatch, text, left, rows.len() - 1));
        }
        Self {
            entries: placed,
            rows,
        }
    }

    /// Height of all rows.
    pub(crate) fn height(&self) -> f64 {
        ROW * self.rows.len() as f64
    }

    /// Draws it from `top` down, its rows centred on `middle` as far as the page's margins let them.
    pub(crate) fn draw(&self, page: &Page, middle: f64, top: f64) {
        for (swatch, text, left, row) in &self.entries {
            let most = page.width() - MARGIN - self.rows[*row];
            let x = (middle - 0.5 * self.rows[*row]).min(most).max(MARGIN) + left;
            let y = top + (*row as f64 + 0.5) * ROW;
            draw_swatch(page, *swatch, (x, y));
            page.text((x + SAMPLE + GAP, y), small(text.as_str(), HPos::Left, INK));
        }
    }
}

fn draw_swatch(page: &Page, swatch: Swatch, (x, y): (f64, f64)) {
    let line = [(x, y), (x + SAMPLE, y)];
    let rect = Rectangle::new((x, y - 0.5 * TICK_TEXT), (SAMPLE, TICK_TEXT));
    let fill = |colour| page.draw(&rect.corners(), Shape::Area(colour));
    let heat = |share: f64| fill(Colour::fixed(page.look().colours.colour(share)));
    let middle = (x + 0.5 * SAMPLE, y);
    match swatch {
        Swatch::Curve(stroke) => page.draw(&line, Shape::Line(stroke)),
        Swatch::Symbol(colour) => {
            let end = |sign: f64| (middle.0, y + sign * 0.55 * TICK_TEXT);
            let bar = Stroke::solid(colour, ERROR_LINE);
            page.draw(&[end(-1.0), end(1.0)], Shape::Line(bar));
            page.mark(&[middle], symbol(0, colour));
        }
        Swatch::Marked(stroke, number) => {
            page.draw(&line, Shape::Line(stroke));
            page.mark(&[middle], symbol(number, stroke.colour));
        }
        Swatch::Peaks => {
            heat(0.5);
            page.mark(&line, peaks(&line));
        }
        Swatch::Valleys => {
            heat(0.5);
            page.mark(&line, valleys(&line));
        }
        Swatch::Plus => {
            heat(0.8);
            page.mark(&[middle], plus());
        }
        Swatch::Cross(half, stroke) => page.draw(&[middle], Shape::Plus(half, stroke)),
        Swatch::Ring => {
            heat(0.2);
            page.mark(&[middle], ring());
        }
        Swatch::Box(colour) => fill(colour),
        Swatch::Hatched => {
            super::hatch::draw(page, (rect.left, rect.right()), (rect.top, rect.bottom()));
        }
    }
}

/// A branch of peaks: black on white, seen on every colour of the map.
pub(crate) fn peaks(places: &[(f64, f64)]) -> Vec<Shape> {
    match places {
        [_] => vec![Shape::Dot(2.2, BLACK, Stroke::solid(WHITE, 0.8))],
        _ => vec![
            Shape::Line(Stroke::solid(WHITE, CURVE_LINE + 1.8)),
            Shape::Line(Stroke::solid(BLACK, CURVE_LINE)),
        ],
    }
}

/// A branch of valleys: white dashes on black.
pub(crate) fn valleys(places: &[(f64, f64)]) -> Vec<Shape> {
    match places {
        [_] => vec![Shape::Dot(2.0, WHITE, Stroke::solid(BLACK, 1.0))],
        _ => vec![
            Shape::Line(Stroke::solid(BLACK, CURVE_LINE + 1.4)),
            Shape::Line(Stroke::solid(WHITE, CURVE_LINE).dashed(&[4.0, 3.0])),
        ],
    }
}

/// One of four symbols, told apart without colour: disc, circle, and these with a cross.
pub(crate) fn symbol(number: usize, colour: Colour) -> Vec<Shape> {
    let rim = Stroke::solid(colour, 1.2);
    match number % 4 {
        0 => vec![Shape::Dot(2.0, colour, rim)],
        1 => vec![Shape::Dot(3.6, PAPER, rim)],
        2 => vec![Shape::Dot(4.4, PAPER, rim), Shape::Plus(4.4, rim)],
        _ => vec![
            Shape::Plus(5.0, Stroke::solid(PAPER, 4.0)),
            Shape::Plus(4.6, Stroke::solid(colour, 2.2)),
        ],
    }
}

/// The mark of a peak in a map.
pub(crate) fn plus() -> [Shape; 2] {
    let [under, over] = [Stroke::solid(WHITE, 3.0), Stroke::solid(BLACK, 1.4)];
    [Shape::Plus(5.0, under), Shape::Plus(4.5, over)]
}

/// The mark of a crater in a map.
pub(crate) fn ring() -> [Shape; 2] {
    let clear = WHITE.at(0.0);
    let [under, over] = [Stroke::solid(BLACK, 3.2), Stroke::solid(WHITE, 1.5)];
    [Shape::Dot(4.0, clear, under), Shape::Dot(4.0, clear, over)]
}
