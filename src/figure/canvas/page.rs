//! A page and the panels on it: plotters' drawing areas over the [`Canvas`], in figure pixels and in the
//! units of the data.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::{Drawable, PointCollection};
use plotters::prelude::{Cartesian2d, CoordTranslate, DrawingArea, IntoDrawingArea};
use plotters_backend::BackendCoord;
use plotters_backend::text_anchor::HPos;

use super::DrawError;
use super::backend::{Canvas, Drawn, Lettering};
use super::facets::grown;
use super::look::Look;
use super::render;
use super::style::{Colour, GREY, INK, MARGIN, Stroke, TEXT, TITLE_TEXT, UNITS};
use super::symbols;

/// A rectangle on the page, in pixels from the upper left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::figure) struct Rectangle {
    pub(in crate::figure) left: f64,
    pub(in crate::figure) top: f64,
    pub(in crate::figure) width: f64,
    pub(in crate::figure) height: f64,
}

impl Rectangle {
    pub(in crate::figure) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(in crate::figure) fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// What is drawn at one or several points.
#[derive(Clone)]
pub(in crate::figure) enum Shape {
    /// A polyline through the points.
    Line(Stroke),
    /// The polygon of the points.
    Area(Colour),
    /// A disc about the first point: radius in pixels, inside, rim.
    Dot(f64, Colour, Stroke),
    /// A `+` about the first point: half its length in pixels, line.
    Plus(f64, Stroke),
    /// A PNG over the rectangle between two opposite corners.
    Image(Vec<u8>),
    /// Lettering at the first point.
    Text(Lettering),
}

/// A shape with its points, in whatever coordinates: an element of plotters.
struct Mark<Coord> {
    points: Vec<Coord>,
    shape: Shape,
}

impl<'a, Coord: 'a> PointCollection<'a, Coord> for &'a Mark<Coord> {
    type Point = &'a Coord;
    type IntoIter = std::slice::Iter<'a, Coord>;

    fn point_iter(self) -> Self::IntoIter {
        self.points.iter()
    }
}

impl<Coord> Drawable<Canvas> for Mark<Coord> {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        points: I,
        canvas: &mut Canvas,
        _parent: (u32, u32),
    ) -> Drawn {
        let points: Vec<BackendCoord> = points.collect();
        let Some(&first) = points.first() else {
            return Ok(());
        };
        match &self.shape {
            Shape::Line(stroke) => canvas.line(&points, stroke),
            Shape::Area(fill) => canvas.area(&points, *fill),
            Shape::Dot(radius, fill, rim) => canvas.dot(first, *radius, *fill, rim),
            Shape::Plus(half, stroke) => {
                let half = (half * UNITS).round() as i32;
                let (x, y) = first;
                canvas.line(&[(x - half, y), (x + half, y)], stroke);
                canvas.line(&[(x, y - half), (x, y + half)], stroke);
            }
            Shape::Image(png) => {
                if let [one, other] = points[..] {
                    canvas.image(one, other, png);
                }
            }
            Shape::Text(lettering) => canvas.text(first, lettering),
        }
        Ok(())
    }
}

/// A page in figure pixels.
pub(in crate::figure) struct Page {
    canvas: Canvas,
    area: DrawingArea<Canvas, Shift>,
}

/// A rectangle of a page in the units of the data.
pub(in crate::figure) struct Panel {
    area: DrawingArea<Canvas, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
}

impl Page {
    /// An empty page; size in pixels.
    pub(in crate::figure) fn new(look: &Look, width: f64, height: f64) -> Self {
        let canvas = Canvas::new(*look, width, height);
        Self {
            area: canvas.clone().into_drawing_area(),
            canvas,
        }
    }

    /// How everything on it looks.
    pub(in crate::figure) fn look(&self) -> &Look {
        self.canvas.look()
    }

    /// Its width in pixels.
    pub(in crate::figure) fn width(&self) -> f64 {
        f64::from(self.canvas.size().0) / UNITS
    }

    /// Draws at points given in pixels.
    pub(in crate::figure) fn draw(
        &self,
        points: &[(f64, f64)],
        shape: Shape,
    ) -> Result<(), DrawError> {
        let on_canvas =
            |&(x, y): &(f64, f64)| ((x * UNITS).round() as i32, (y * UNITS).round() as i32);
        let points = points.iter().map(on_canvas).collect();
        Ok(self.area.draw(&Mark { points, shape })?)
    }

    /// Fills neighbouring facets, in this order; corners in pixels. They overlap a little, so that no seams are between
    /// them.
    pub(in crate::figure) fn facets(&self, facets: &[([(f64, f64); 4], Colour)]) {
        let on_canvas =
            |(x, y): (f64, f64)| ((x * UNITS).round() as i32, (y * UNITS).round() as i32);
        for run in facets.chunk_by(|a, b| a.1 == b.1) {
            let corners: Vec<Vec<BackendCoord>> = run
                .iter()
                .map(|(corners, _)| grown(corners).into_iter().map(on_canvas).collect())
                .collect();
            if let Some((_, colour)) = run.first() {
                self.canvas.facets(&corners, *colour);
            }
        }
    }

    /// Writes a text whose end `anchor` stands at a point, centred on it in height.
    pub(in crate::figure) fn text(&self, at: (f64, f64), text: Lettering) -> Result<(), DrawError> {
        self.draw(&[at], Shape::Text(text))
    }

    /// A panel over a rectangle; `x` grows to the right, `y` upward.
    pub(in crate::figure) fn panel(&self, rect: Rectangle, x: (f64, f64), y: (f64, f64)) -> Panel {
        let whole = |pixels: f64| (pixels * UNITS).round() as i32;
        let across = whole(rect.left)..whole(rect.right());
        let down = whole(rect.top)..whole(rect.bottom());
        // plotters counts the ordinate from the upper end of the range of pixels.
        let coordinates = Cartesian2d::new(x.0..x.1, y.0..y.1, (across, down.end..down.start));
        Panel {
            area: self.area.apply_coord_spec(coordinates),
        }
    }

    /// The page as SVG.
    pub(in crate::figure) fn svg(&self) -> String {
        self.canvas.document()
    }
}

impl Panel {
    /// Draws at points given in the units of the data.
    pub(in crate::figure) fn draw(
        &self,
        points: &[(f64, f64)],
        shape: Shape,
    ) -> Result<(), DrawError> {
        let points = points.to_vec();
        Ok(self.area.draw(&Mark { points, shape })?)
    }

    /// Place of a point on the page, in pixels.
    pub(in crate::figure) fn place(&self, point: (f64, f64)) -> (f64, f64) {
        let (x, y) = self.area.as_coord_spec().translate(&point);
        (f64::from(x) / UNITS, f64::from(y) / UNITS)
    }
}

/// Lettering of the usual size.
pub(in crate::figure) fn lettering(markup: impl Into<String>, anchor: HPos) -> Lettering {
    Lettering {
        markup: markup.into(),
        size: TEXT,
        colour: INK,
        anchor,
        upward: false,
        bold: false,
    }
}

/// The title of a run, cut into lines, above everything else on a page.
pub(in crate::figure) struct Heading {
    lines: Vec<String>,
}

impl Heading {
    /// Cuts a title (plain text, may be empty) for a page of the given width.
    ///
    /// # Errors
    /// [`DrawError::Svg`].
    pub(in crate::figure) fn new(look: &Look, title: &str, width: f64) -> Result<Self, DrawError> {
        let title = if look.has_title { title } else { "" };
        let lines = render::wrap(
            look,
            &symbols::plain(title),
            TITLE_TEXT,
            width - 2.0 * MARGIN,
        )?;
        Ok(Self { lines })
    }

    /// Height it takes, the upper margin included.
    pub(in crate::figure) fn height(&self) -> f64 {
        MARGIN + 1.5 * TITLE_TEXT * self.lines.len() as f64
    }

    /// Draws it.
    ///
    /// # Errors
    /// [`DrawError::Layout`].
    pub(in crate::figure) fn draw(&self, page: &Page) -> Result<(), DrawError> {
        for (number, line) in self.lines.iter().enumerate() {
            let y = MARGIN + 1.5 * TITLE_TEXT * (number as f64 + 0.45);
            let text = Lettering {
                size: TITLE_TEXT,
                colour: GREY,
                ..lettering(line.as_str(), HPos::Left)
            };
            page.text((MARGIN, y), text)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_put_the_data_where_they_belong() {
        let page = Page::new(&Look::default(), 100.0, 50.0);
        let rect = Rectangle {
            left: 10.0,
            top: 5.0,
            width: 80.0,
            height: 40.0,
        };
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
