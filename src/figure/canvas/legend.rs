//! Legends: samples with their meaning, in rows outside of the panels, so that no data are covered.

use plotters_backend::text_anchor::HPos;

use super::DrawError;
use super::look::Look;
use super::page::{Page, Shape, lettering};
use super::render;
use super::style::{
    BLACK, CURVE_LINE, Colour, ERROR_LINE, MARGIN, PAPER, Stroke, TEXT, TICK_TEXT, WHITE,
};

/// Length of a sample, in pixels.
const SAMPLE: f64 = 30.0;
/// Gap between a sample and its text.
const GAP: f64 = 6.0;
/// Gap between two entries.
const BETWEEN: f64 = 20.0;
/// Height of a row.
pub(in crate::figure) const ROW: f64 = 1.5 * TEXT;

/// What stands for an entry.
#[derive(Clone, Copy)]
pub(in crate::figure) enum Sample {
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
    /// A ring on a piece of heat map.
    Ring,
    /// A hatched box.
    Hatched,
    /// A box of one colour.
    Box(Colour),
}

/// A legend laid out in rows.
pub(in crate::figure) struct Legend {
    /// Sample, text, and place of the sample's left end: pixels from the left, number of the row.
    entries: Vec<(Sample, String, f64, usize)>,
    rows: Vec<f64>,
}

impl Legend {
    /// Lays out entries (texts are markup) in rows no wider than `width`.
    ///
    /// # Errors
    /// [`DrawError::Svg`].
    pub(in crate::figure) fn new(
        look: &Look,
        entries: Vec<(Sample, String)>,
        width: f64,
    ) -> Result<Self, DrawError> {
        let mut rows: Vec<f64> = Vec::new();
        let mut placed = Vec::new();
        for (sample, text) in entries {
            let entry = SAMPLE + GAP + render::text_width(look, &text, TICK_TEXT, false)?;
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
            placed.push((sample, text, left, rows.len() - 1));
        }
        Ok(Self {
            entries: placed,
            rows,
        })
    }

    /// Height of all rows.
    pub(in crate::figure) fn height(&self) -> f64 {
        ROW * self.rows.len() as f64
    }

    /// Draws it from `top` down, its rows centred on `middle` as far as the page's margins let them.
    ///
    /// # Errors
    /// [`DrawError::Layout`].
    pub(in crate::figure) fn draw(
        &self,
        page: &Page,
        middle: f64,
        top: f64,
    ) -> Result<(), DrawError> {
        for (sample, text, left, row) in &self.entries {
            let most = page.width() - MARGIN - self.rows[*row];
            let x = (middle - 0.5 * self.rows[*row]).min(most).max(MARGIN) + left;
            let y = top + (*row as f64 + 0.5) * ROW;
            draw_sample(page, *sample, (x, y))?;
            let mut text = lettering(text.as_str(), HPos::Left);
            text.size = TICK_TEXT;
            page.text((x + SAMPLE + GAP, y), text)?;
        }
        Ok(())
    }
}

fn draw_sample(page: &Page, sample: Sample, (x, y): (f64, f64)) -> Result<(), DrawError> {
    let line = [(x, y), (x + SAMPLE, y)];
    let half = 0.5 * TICK_TEXT;
    let corners = [
        (x, y - half),
        (x + SAMPLE, y - half),
        (x + SAMPLE, y + half),
        (x, y + half),
    ];
    let ground = |share: f64| {
        let colour = page.look().colours.colour(share);
        Shape::Area(Colour::fixed(colour))
    };
    let middle = (x + 0.5 * SAMPLE, y);
    match sample {
        Sample::Curve(stroke) => page.draw(&line, Shape::Line(stroke)),
        Sample::Symbol(colour) => {
            let bar = [
                (middle.0, y - 0.55 * TICK_TEXT),
                (middle.0, y + 0.55 * TICK_TEXT),
            ];
            page.draw(&bar, Shape::Line(Stroke::solid(colour, ERROR_LINE)))?;
            symbol(|points, shape| page.draw(points, shape), 0, middle, colour)
        }
        Sample::Marked(stroke, number) => {
            page.draw(&line, Shape::Line(stroke))?;
            let draw = |points: &[(f64, f64)], shape| page.draw(points, shape);
            symbol(draw, number, middle, stroke.colour)
        }
        Sample::Peaks => {
            page.draw(&corners, ground(0.5))?;
            draw_peaks(|points, shape| page.draw(points, shape), &line)
        }
        Sample::Valleys => {
            page.draw(&corners, ground(0.5))?;
            draw_valleys(|points, shape| page.draw(points, shape), &line)
        }
        Sample::Plus => {
            page.draw(&corners, ground(0.8))?;
            plus(|points, shape| page.draw(points, shape), middle)
        }
        Sample::Ring => {
            page.draw(&corners, ground(0.2))?;
            ring(|points, shape| page.draw(points, shape), middle)
        }
        Sample::Box(colour) => page.draw(&corners, Shape::Area(colour)),
        Sample::Hatched => super::hatch::draw(page, (x, x + SAMPLE), (y - half, y + half)),
    }
}

/// A branch of peaks: black on white, seen on every colour of the map.
pub(in crate::figure) fn draw_peaks(
    draw: impl Fn(&[(f64, f64)], Shape) -> Result<(), DrawError>,
    places: &[(f64, f64)],
) -> Result<(), DrawError> {
    if let [place] = places {
        let rim = Stroke::solid(WHITE, 0.8);
        return draw(&[*place], Shape::Dot(2.2, BLACK, rim));
    }
    draw(places, Shape::Line(Stroke::solid(WHITE, CURVE_LINE + 1.8)))?;
    draw(places, Shape::Line(Stroke::solid(BLACK, CURVE_LINE)))
}

/// A branch of valleys: white dashes on black.
pub(in crate::figure) fn draw_valleys(
    draw: impl Fn(&[(f64, f64)], Shape) -> Result<(), DrawError>,
    places: &[(f64, f64)],
) -> Result<(), DrawError> {
    if let [place] = places {
        let rim = Stroke::solid(BLACK, 1.0);
        return draw(&[*place], Shape::Dot(2.0, WHITE, rim));
    }
    draw(places, Shape::Line(Stroke::solid(BLACK, CURVE_LINE + 1.4)))?;
    let dashes = Stroke {
        colour: WHITE,
        width: CURVE_LINE,
        dash: &[4.0, 3.0],
    };
    draw(places, Shape::Line(dashes))
}

/// One of four symbols, told apart without colour: disc, circle, and these with a cross.
pub(in crate::figure) fn symbol(
    draw: impl Fn(&[(f64, f64)], Shape) -> Result<(), DrawError>,
    number: usize,
    place: (f64, f64),
    colour: Colour,
) -> Result<(), DrawError> {
    let rim = Stroke::solid(colour, 1.2);
    match number % 4 {
        0 => draw(&[place], Shape::Dot(2.0, colour, rim)),
        1 => draw(&[place], Shape::Dot(3.6, PAPER, rim)),
        2 => {
            draw(&[place], Shape::Dot(4.4, PAPER, rim))?;
            draw(&[place], Shape::Plus(4.4, rim))
        }
        _ => {
            draw(&[place], Shape::Plus(5.0, Stroke::solid(PAPER, 4.0)))?;
            draw(&[place], Shape::Plus(4.6, Stroke::solid(colour, 2.2)))
        }
    }
}

/// The mark of a peak in a map.
pub(in crate::figure) fn plus(
    draw: impl Fn(&[(f64, f64)], Shape) -> Result<(), DrawError>,
    place: (f64, f64),
) -> Result<(), DrawError> {
    draw(&[place], Shape::Plus(5.0, Stroke::solid(WHITE, 3.0)))?;
    draw(&[place], Shape::Plus(4.5, Stroke::solid(BLACK, 1.4)))
}

/// The mark of a crater in a map.
pub(in crate::figure) fn ring(
    draw: impl Fn(&[(f64, f64)], Shape) -> Result<(), DrawError>,
    place: (f64, f64),
) -> Result<(), DrawError> {
    let clear = WHITE.at(0.0);
    draw(&[place], Shape::Dot(4.0, clear, Stroke::solid(BLACK, 3.2)))?;
    draw(&[place], Shape::Dot(4.0, clear, Stroke::solid(WHITE, 1.5)))
}
