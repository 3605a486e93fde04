//! A page and the panels on it, in figure pixels and in the units of the data; plotters' coordinates lead from these to
//! the [`Canvas`].

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{Cartesian2d, CoordTranslate};
use plotters_backend::BackendCoord;
use plotters_backend::text_anchor::HPos;

use super::backend::Canvas;
pub(crate) use super::backend::{Lettering, Shape};
use super::drawing::Drawing;
use super::facets::grow;
use super::letters;
use super::look::Look;
use super::style::{Colour, GREY, INK, MARGIN, TEXT, TICK_TEXT, TITLE_TEXT, UNITS};
use super::symbols;

/// A rectangle on the page, in pixels from the upper left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rectangle {
    pub(crate) fn new((left, top): (f64, f64), (width, height): (f64, f64)) -> Self {
        Self {
            left,
            top,
            width,
            height,
        }
    }

    /// The rectangle with that number in rows of so many columns, of which this is the first; `step` leads to the next
    /// column and row.
    pub(crate) fn tile(&self, number: usize, columns: usize, step: (f64, f64)) -> Self {
        let (row, column) = ((number / columns) as f64, (number % columns) as f64);
        Self {
            left: self.left + column * step.0,
            top: self.top + row * step.1,
            ..*self
        }
    }

    /// Upper left, upper right, lower right and lower left corner.
    pub(crate) fn corners(&self) -> [(f64, f64); 4] {
        let (left, right, top, bottom) = (self.left, self.right(), self.top, self.bottom());
        [(left, top), (right, top), (right, bottom), (left, bottom)]
    }

    /// Its border, from the upper left corner round to it again.
    pub(crate) fn rim(&self) -> [(f64, f64); 5] {
        let [a, b, c, d] = self.corners();
        [a, b, c, d, a]
    }

    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// A page in figure pixels.
pub(crate) struct Page {
    canvas: Canvas,
}

/// A rectangle of a page in the units of the data.
pub(crate) struct Panel {
    canvas: Canvas,
    coordinates: Cartesian2d<RangedCoordf64, RangedCoordf64>,
}

/// A place in pixels as the canvas counts.
fn on_canvas((x, y): (f64, f64)) -> BackendCoord {
    ((x * UNITS).round() as i32, (y * UNITS).round() as i32)
}

impl Page {
    /// An empty page; size in pixels.
    pub(crate) fn new(look: &Look, width: f64, height: f64) -> Self {
        Self {
            canvas: Canvas::new(*look, width, height),
        }
    }

    /// How everything on it looks.
    pub(crate) fn look(&self) -> &Look {
        self.canvas.look()
    }

    /// Its width in pixels.
    pub(crate) fn width(&self) -> f64 {
        f64::from(self.canvas.size().0) / UNITS
    }

    /// Draws at points given in pixels.
    pub(crate) fn draw(&self, points: &[(f64, f64)], shape: Shape) {
        let points: Vec<BackendCoord> = points.iter().map(|&place| on_canvas(place)).collect();
        self.canvas.draw(&points, &shape);
    }

    /// Draws shapes over each other.
    pub(crate) fn mark(&self, points: &[(f64, f64)], shapes: impl IntoIterator<Item = Shape>) {
        shapes
            .into_iter()
            .for_each(|shape| self.draw(points, shape));
    }

    /// Fills neighbouring facets, in this order; corners in pixels. They overlap a little, so that no seams are between
    /// them.
    pub(crate) fn facets(&self, facets: &[([(f64, f64); 4], Colour)]) {
        for run in facets.chunk_by(|a, b| a.1 == b.1) {
            let corners: Vec<Vec<BackendCoord>> = run
                .iter()
                .map(|(corners, _)| grow(corners).into_iter().map(on_canvas).collect())
                .collect();
            if let Some((_, colour)) = run.first() {
                self.canvas.facets(corners, *colour);
            }
        }
    }

    /// Writes a text whose end `anchor` stands at a point, centred on it in height.
    pub(crate) fn text(&self, at: (f64, f64), text: Lettering) {
        self.draw(&[at], Shape::Text(text));
    }

    /// A panel over a rectangle; `x` grows to the right, `y` upward.
    pub(crate) fn panel(&self, rect: Rectangle, x: (f64, f64), y: (f64, f64)) -> Panel {
        let (left, top) = on_canvas((rect.left, rect.top));
        let (right, bottom) = on_canvas((rect.right(), rect.bottom()));
        // plotters counts the ordinate from the upper end of the range of pixels.
        let pixels = (left..right, bottom..top);
        Panel {
            canvas: self.canvas.clone(),
            coordinates: Cartesian2d::new(x.0..x.1, y.0..y.1, pixels),
        }
    }

    /// What is on it.
    pub(crate) fn drawing(&self) -> Drawing {
        self.canvas.drawing()
    }
}

impl Panel {
    /// Draws at points given in the units of the data.
    pub(crate) fn draw(&self, points: &[(f64, f64)], shape: Shape) {
        let points = points.iter().map(|place| self.coordinates.translate(place));
        self.canvas.draw(&points.collect::<Vec<_>>(), &shape);
    }

    /// Draws shapes over each other.
    pub(crate) fn mark(&self, points: &[(f64, f64)], shapes: impl IntoIterator<Item = Shape>) {
        shapes
            .into_iter()
            .for_each(|shape| self.draw(points, shape));
    }

    /// Place of a point on the page, in pixels.
    pub(crate) fn place(&self, point: (f64, f64)) -> (f64, f64) {
        let (x, y) = self.coordinates.translate(&point);
        (f64::from(x) / UNITS, f64::from(y) / UNITS)
    }
}

/// Lettering of the usual size.
pub(crate) fn lettering(markup: impl Into<String>, anchor: HPos) -> Lettering {
    Lettering {
        markup: markup.into(),
        size: TEXT,
        colour: INK,
        anchor,
        upward: false,
        bold: false,
    }
}

/// Lettering of the size of tick labels.
pub(crate) fn small(markup: impl Into<String>, anchor: HPos, colour: Colour) -> Lettering {
    Lettering {
        size: TICK_TEXT,
        colour,
        ..lettering(markup, anchor)
    }
}

/// The title of a run, cut into lines, above everything else on a page.
pub(crate) struct Heading {
    lines: Vec<String>,
}

impl Heading {
    /// Cuts a title (plain text, may be empty) for a page of the given width.
    pub(crate) fn new(look: &Look, title: &str, width: f64) -> Self {
        let title = if look.has_title { title } else { "" };
        let lines = letters::wrap(
            look,
            &symbols::plain(title),
            TITLE_TEXT,
            width - 2.0 * MARGIN,
        );
        Self { lines }
    }

    /// Height it takes, the upper margin included.
    pub(crate) fn height(&self) -> f64 {
        MARGIN + 1.5 * TITLE_TEXT * self.lines.len() as f64
    }

    /// Draws it.
    pub(crate) fn draw(&self, page: &Page) {
        for (number, line) in self.lines.iter().enumerate() {
            let y = MARGIN + 1.5 * TITLE_TEXT * (number as f64 + 0.45);
            let text = Lettering {
                size: TITLE_TEXT,
                colour: GREY,
                ..lettering(line.as_str(), HPos::Left)
            };
            page.text((MARGIN, y), text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_put_the_data_where_they_belong() {
        let page = Page::new(&Look::default(), 100.0, 50.0);
        let rect = Rectangle::new((10.0, 5.0), (80.0, 40.0));
        let panel = page.panel(rect, (-1.0, 1.0), (0.0, 2.0));
        let near = |place: (f64, f64), x: f64, y: f64| {
            // plotters loses up to two of its units at the end of a range.
            (place.0 - x).abs() <= 0.1 && (place.1 - y).abs() <= 0.1
        };
        assert!(
            near(panel.place((-1.0, 0.0)), 10.0, 45.0),
            "{:?}",
            panel.place((-1.0, 0.0))
        );
        assert!(
            near(panel.place((1.0, 2.0)), 90.0, 5.0),
            "{:?}",
            panel.place((1.0, 2.0))
        );
        assert!(near(panel.place((0.0, 1.0)), 50.0, 25.0));
    }
}
