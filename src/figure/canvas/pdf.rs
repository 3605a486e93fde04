//! From an SVG to PDF: what the canvas writes (paths, pictures, lettering) and no more, with the fonts embedded and the
//! text kept as text.

use std::collections::HashMap;

use krilla::color::rgb;
use krilla::geom::{PathBuilder, Point, Size, Transform};
use krilla::image::Image;
use krilla::metadata::Metadata;
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{Fill, FillRule, LineCap, LineJoin, Paint, Stroke, StrokeDash};
use krilla::surface::Surface;
use krilla::text::{Font, GlyphId, KrillaGlyph};
use krilla::{Document, SerializeSettings};
use resvg::tiny_skia::PathSegment;
use resvg::usvg::{self, fontdb};

use super::render;
use crate::figure::FigureError;

/// Points of a length of 1/96 inch, which is the unit of a tree.
const POINTS: f32 = 0.75;

/// An SVG of the canvas as a PDF of one page, in its size. `title` is what a reader shows above its window. Equal
/// drawings give equal bytes.
///
/// # Errors
/// [`FigureError::Svg`], [`FigureError::Pdf`].
pub(crate) fn pdf(svg: &str, title: &str) -> Result<Vec<u8>, FigureError> {
    let tree = render::tree(svg)?;
    let (width, height) = (tree.size().width(), tree.size().height());
    let mut document = Document::new_with(SerializeSettings {
        enable_tagging: false,
        ..SerializeSettings::default()
    });
    let size = PageSettings::from_wh(width * POINTS, height * POINTS);
    let mut page = document.start_page_with(size.ok_or(FigureError::Pdf("no size".to_owned()))?);
    let mut surface = page.surface();
    surface.push_transform(&Transform::from_scale(POINTS, POINTS));
    let mut writer = Writer {
        fonts: HashMap::new(),
        tree: &tree,
    };
    writer.group(&mut surface, tree.root())?;
    surface.pop();
    surface.finish();
    page.finish();
    let creator = format!("pbif {}", env!("CARGO_PKG_VERSION"));
    let metadata = Metadata::new().creator(creator).title(title.to_owned());
    document.set_metadata(metadata);
    document
        .finish()
        .map_err(|error| FigureError::Pdf(format!("{error:?}")))
}

/// Writes the nodes of a tree.
struct Writer<'a> {
    fonts: HashMap<fontdb::ID, Font>,
    tree: &'a usvg::Tree,
}

impl Writer<'_> {
    fn group(&mut self, surface: &mut Surface<'_>, group: &usvg::Group) -> Result<(), FigureError> {
        surface.push_transform(&transform(group.transform()));
        for node in group.children() {
            match node {
                usvg::Node::Group(group) => self.group(surface, group)?,
                usvg::Node::Path(path) => draw_path(surface, path),
                usvg::Node::Image(image) => draw_image(surface, image)?,
                usvg::Node::Text(text) => self.text(surface, text)?,
            }
        }
        surface.pop();
        Ok(())
    }

    /// Draws a text: glyphs of a font that follow each other on a line are one run, so that words are found and copied
    /// whole.
    fn text(&mut self, surface: &mut Surface<'_>, text: &usvg::Text) -> Result<(), FigureError> {
        for span in text.layouted() {
            let size = span.font_size.get();
            surface.set_stroke(None);
            surface.set_fill(span.fill.as_ref().map(fill));
            for run in span.positioned_glyphs.chunk_by(|a, b| a.font == b.font) {
                let Some(first) = run.first() else { continue };
                let font = self.font(first.font)?;
                // A glyph's transform includes the scale of its outline, which is the font's own affair in a PDF.
                let unscale = font.units_per_em() / size;
                let place = first.transform().pre_scale(unscale, unscale);
                let Some(back) = place.invert() else { continue };
                surface.push_transform(&transform(place));
                let (letters, glyphs) = laid_out(run, back, size);
                let start = Point::from_xy(0.0, 0.0);
                surface.draw_glyphs(start, &glyphs, font, &letters, size, false);
                surface.pop();
            }
        }
        Ok(())
    }

    fn font(&mut self, id: fontdb::ID) -> Result<Font, FigureError> {
        if let Some(font) = self.fonts.get(&id) {
            return Ok(font.clone());
        }
        let font = self
            .tree
            .fontdb()
            .with_face_data(id, |data, index| Font::new(data.to_vec().into(), index));
        let font = font.flatten();
        let font = font.ok_or_else(|| FigureError::Pdf("a font cannot be read".to_owned()))?;
        self.fonts.insert(id, font.clone());
        Ok(font)
    }
}

/// The letters of a run, and its glyphs with advances as they were laid out; `back` leads from the page to the run's
/// own line.
fn laid_out(
    run: &[usvg::layout::PositionedGlyph],
    back: usvg::Transform,
    size: f32,
) -> (String, Vec<KrillaGlyph>) {
    let along = |glyph: &usvg::layout::PositionedGlyph| {
        let place = back.pre_concat(glyph.transform());
        (place.tx / size, -place.ty / size)
    };
    let mut letters = String::new();
    let glyphs = run
        .iter()
        .enumerate()
        .map(|(number, glyph)| {
            let from = letters.len();
            letters.push_str(&glyph.text);
            let (here, up) = along(glyph);
            let advance = run.get(number + 1).map_or(0.0, |next| along(next).0 - here);
            KrillaGlyph::new(
                GlyphId::new(glyph.id.0),
                advance,
                0.0,
                up,
                0.0,
                from..letters.len(),
                None,
            )
        })
        .collect();
    (letters, glyphs)
}

fn draw_path(surface: &mut Surface<'_>, path: &usvg::Path) {
    let mut builder = PathBuilder::new();
    for segment in path.data().segments() {
        match segment {
            PathSegment::MoveTo(p) => builder.move_to(p.x, p.y),
            PathSegment::LineTo(p) => builder.line_to(p.x, p.y),
            PathSegment::QuadTo(a, p) => builder.quad_to(a.x, a.y, p.x, p.y),
            PathSegment::CubicTo(a, b, p) => builder.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y),
            PathSegment::Close => builder.close(),
        }
    }
    let Some(outline) = builder.finish() else {
        return;
    };
    surface.set_fill(path.fill().map(fill));
    surface.set_stroke(path.stroke().map(stroke));
    surface.draw_path(&outline);
}

/// An embedded PNG, its pixels left crisp.
fn draw_image(surface: &mut Surface<'_>, image: &usvg::Image) -> Result<(), FigureError> {
    let usvg::ImageKind::PNG(bytes) = image.kind() else {
        return Ok(());
    };
    let unreadable = |error: png::DecodingError| FigureError::Pdf(error.to_string());
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes.as_slice()));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(unreadable)?;
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let info = reader.next_frame(&mut pixels).map_err(unreadable)?;
    let size = Size::from_wh(image.size().width(), image.size().height());
    if let (Some(size), png::ColorType::Rgba) = (size, info.color_type) {
        let picture = Image::from_rgba8(pixels, info.width, info.height);
        surface.draw_image(picture, size);
    }
    Ok(())
}

fn paint(paint: &usvg::Paint) -> Paint {
    match paint {
        usvg::Paint::Color(colour) => rgb::Color::new(colour.red, colour.green, colour.blue).into(),
        // The canvas draws with plain colours.
        _ => rgb::Color::black().into(),
    }
}

fn opacity(opacity: usvg::Opacity) -> NormalizedF32 {
    NormalizedF32::new(opacity.get()).unwrap_or(NormalizedF32::ONE)
}

fn fill(fill: &usvg::Fill) -> Fill {
    Fill {
        paint: paint(fill.paint()),
        opacity: opacity(fill.opacity()),
        rule: FillRule::NonZero,
    }
}

fn stroke(stroke: &usvg::Stroke) -> Stroke {
    Stroke {
        paint: paint(stroke.paint()),
        width: stroke.width().get(),
        miter_limit: stroke.miterlimit().get(),
        line_cap: LineCap::Butt,
        line_join: match stroke.linejoin() {
            usvg::LineJoin::Round => LineJoin::Round,
            _ => LineJoin::Miter,
        },
        opacity: opacity(stroke.opacity()),
        dash: stroke.dasharray().map(|array| StrokeDash {
            array: array.to_vec(),
            offset: stroke.dashoffset(),
        }),
    }
}

fn transform(t: usvg::Transform) -> Transform {
    Transform::from_row(t.sx, t.ky, t.kx, t.sy, t.tx, t.ty)
}
