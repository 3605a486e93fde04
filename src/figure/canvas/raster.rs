//! A drawing as pixels.

use plotters_backend::BackendCoord;
use tiny_skia::{
    FillRule, FilterQuality, IntSize, LineJoin, Paint, Path, PathBuilder, Pattern, Pixmap, Rect,
    SpreadMode, Stroke, StrokeDash, Transform,
};
use ttf_parser::OutlineBuilder;

use super::drawing::{Drawing, Element, Ink, Pen, Text, arcs};
use super::heat::Picture;
use super::png::{self, Pixels};
use crate::figure::FigureError;
use crate::figure::style::Typeface;

/// A drawing as a PNG of 8-bit RGB, with as many pixels to the inch as its look says, which is written into it.
///
/// # Errors
/// [`FigureError::Raster`].
pub(crate) fn png(drawing: &Drawing) -> Result<Vec<u8>, FigureError> {
    let pixels = pixels(drawing)?;
    let size = (pixels.width(), pixels.height());
    let colours = pixels.pixels().iter();
    let colours = colours.flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]);
    let metre = (drawing.look.dpi / 0.0254).round() as u32;
    Ok(png::encode(
        size,
        &Pixels::Colours(metre),
        &colours.collect::<Vec<u8>>(),
    ))
}

fn pixels(drawing: &Drawing) -> Result<Pixmap, FigureError> {
    let scale = drawing.pixels();
    let length = |units: u32| (scale * f64::from(units)).round() as u32;
    let (width, height) = (length(drawing.size.0), length(drawing.size.1));
    let pixels = Pixmap::new(width, height).ok_or(FigureError::Raster { width, height })?;
    let mut brush = Brush {
        pixels,
        page: Transform::from_scale(scale as f32, scale as f32),
    };
    let (r, g, b) = drawing.paper().rgb;
    brush
        .pixels
        .fill(tiny_skia::Color::from_rgba8(r, g, b, 255));
    for element in &drawing.elements {
        brush.draw(element, drawing.look.typeface);
    }
    Ok(brush.pixels)
}

/// Draws on pixels.
struct Brush {
    pixels: Pixmap,
    /// From units to pixels.
    page: Transform,
}

impl Brush {
    /// Draws an element; nothing where it has no extent.
    fn draw(&mut self, element: &Element, typeface: Typeface) -> Option<()> {
        match element {
            Element::Line(points, pen) => self.stroke(&path([points.as_slice()], false)?, pen),
            Element::Area(points, ink) => {
                self.fill(&path([points.as_slice()], true)?, *ink, self.page)
            }
            Element::Facets(facets, ink) => {
                self.fill(
                    &path(facets.iter().map(Vec::as_slice), true)?,
                    *ink,
                    self.page,
                );
            }
            Element::Disc(centre, radius, inside, rim) => {
                let disc = disc(*centre, *radius)?;
                self.fill(&disc, *inside, self.page);
                self.stroke(&disc, rim);
            }
            Element::Image(corner, size, picture) => self.image(*corner, *size, picture)?,
            Element::Text(text) => self.text(text, typeface),
        }
        Some(())
    }

    fn fill(&mut self, path: &Path, ink: Ink, place: Transform) {
        self.pixels
            .fill_path(path, &paint(ink), FillRule::Winding, place, None);
    }

    fn stroke(&mut self, path: &Path, pen: &Pen) {
        let dash: Vec<f32> = pen.dash.iter().map(|&part| part as f32).collect();
        let stroke = Stroke {
            width: pen.width as f32,
            line_join: LineJoin::Round,
            dash: StrokeDash::new(dash, 0.0),
            ..Stroke::default()
        };
        self.pixels
            .stroke_path(path, &paint(pen.ink), &stroke, self.page, None);
    }

    fn image(
        &mut self,
        (x, y): BackendCoord,
        (width, height): (u32, u32),
        picture: &Picture,
    ) -> Option<()> {
        let (columns, rows) = (picture.size.0 as u32, picture.size.1 as u32);
        let colour = |&number: &u8| match picture.palette.get(usize::from(number)) {
            Some(&[r, g, b, 255]) => [r, g, b, 255],
            _ => [0; 4],
        };
        let cells = picture.numbers.iter().flat_map(colour).collect();
        let cells = Pixmap::from_vec(cells, IntSize::from_wh(columns, rows)?)?;
        let pattern = Pattern::new(
            cells.as_ref(),
            SpreadMode::Pad,
            FilterQuality::Nearest,
            1.0,
            Transform::default(),
        );
        let paint = Paint {
            shader: pattern,
            ..Paint::default()
        };
        let (columns, rows) = (columns as f32, rows as f32);
        let place = self
            .page
            .pre_translate(x as f32, y as f32)
            .pre_scale(width as f32 / columns, height as f32 / rows);
        let all = Rect::from_xywh(0.0, 0.0, columns, rows)?;
        self.pixels.fill_rect(all, &paint, place, None);
        Some(())
    }

    fn text(&mut self, text: &Text, typeface: Typeface) {
        for (frame, run) in text.runs(typeface) {
            let Some(face) = run.font.face() else {
                continue;
            };
            let mut outline = Outline {
                path: PathBuilder::new(),
                along: 0.0,
            };
            for glyph in &run.glyphs {
                face.outline_glyph(glyph.id, &mut outline);
                outline.along += (glyph.advance + glyph.kerning) as f32;
            }
            let [a, b, c, d, e, f] = frame.map(|part| part as f32);
            let scale = run.scale() as f32;
            let place = self
                .page
                .pre_concat(Transform::from_row(a, b, c, d, e, f))
                .pre_scale(scale, scale);
            if let Some(path) = outline.path.finish() {
                self.fill(&path, text.ink, place);
            }
        }
    }
}

fn paint(
    Ink {
        rgb: (r, g, b),
        alpha,
    }: Ink,
) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, (255.0 * alpha).round() as u8);
    paint
}

/// Straight lines through points, closed or not.
fn path<'a>(lines: impl IntoIterator<Item = &'a [BackendCoord]>, is_closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for line in lines {
        for (number, &(x, y)) in line.iter().enumerate() {
            match number {
                0 => path.move_to(x as f32, y as f32),
                _ => path.line_to(x as f32, y as f32),
            }
        }
        if is_closed {
            path.close();
        }
    }
    path.finish()
}

fn disc((x, y): BackendCoord, radius: i64) -> Option<Path> {
    let mut path = PathBuilder::new();
    path.move_to((i64::from(x) + radius) as f32, y as f32);
    for arc in arcs((x, y), radius) {
        let [(a, b), (c, d), (e, f)] = arc.map(|(x, y)| (x as f32, y as f32));
        path.cubic_to(a, b, c, d, e, f);
    }
    path.close();
    path.finish()
}

/// Outlines of glyphs side by side, in units of their font.
struct Outline {
    path: PathBuilder,
    /// Where the next glyph begins.
    along: f32,
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.along + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.along + x, y);
    }

    fn quad_to(&mut self, a: f32, b: f32, x: f32, y: f32) {
        self.path.quad_to(self.along + a, b, self.along + x, y);
    }

    fn curve_to(&mut self, a: f32, b: f32, c: f32, d: f32, x: f32, y: f32) {
        self.path
            .cubic_to(self.along + a, b, self.along + c, d, self.along + x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
