//! The content of a page: what draws it, and what that refers to.

use std::collections::BTreeMap;

use pdf_writer::types::LineJoinStyle;
use pdf_writer::{Content, Finish, Name, Str};
use plotters_backend::BackendCoord;

use crate::figure::canvas::drawing::{Drawing, Element, Ink, Pen, Text, arcs};
use crate::figure::canvas::heat::Picture;
use crate::figure::canvas::letters::Font;
use crate::figure::style::Typeface;

/// Letters of the glyphs of a font that are used, by the number of the glyph.
pub(super) type Letters = BTreeMap<u16, String>;

/// Writes the content of a page and notes what it refers to.
pub(super) struct Writer<'a> {
    content: Content,
    /// Opacity of what is drawn next.
    opacity: f64,
    /// Opacities that were set, by number.
    pub(super) opacities: Vec<f64>,
    /// Pictures, by number.
    pub(super) pictures: Vec<&'a Picture>,
    /// Fonts with the glyphs that are used of them; the number of a font is its place among all.
    pub(super) fonts: BTreeMap<Font, Letters>,
}

/// The name by which content refers to an opacity (`O`), a picture (`P`) or a font (`F`) with a number.
pub(super) fn name(kind: char, number: usize) -> String {
    format!("{kind}{number}")
}

impl<'a> Writer<'a> {
    /// The content of a page on which everything is one figure, with what it refers to; `place` leads from units, the
    /// ordinate downward, to points.
    pub(super) fn write(drawing: &'a Drawing, place: [f32; 6]) -> (Vec<u8>, Self) {
        let mut writer = Self {
            content: Content::new(),
            opacity: 1.0,
            opacities: Vec::new(),
            pictures: Vec::new(),
            fonts: BTreeMap::new(),
        };
        let mut figure = writer
            .content
            .begin_marked_content_with_properties(Name(b"Figure"));
        figure.properties().identify(0);
        figure.finish();
        writer.content.transform(place);
        writer.content.set_line_join(LineJoinStyle::RoundJoin);
        let (width, height) = (drawing.size.0 as f32, drawing.size.1 as f32);
        writer.fill(drawing.paper(), |content| {
            content.rect(0.0, 0.0, width, height);
        });
        for element in &drawing.elements {
            writer.draw(element, drawing.look.typeface);
        }
        writer.content.end_marked_content();
        let content = std::mem::replace(&mut writer.content, Content::new());
        (content.finish().to_vec(), writer)
    }

    fn draw(&mut self, element: &'a Element, typeface: Typeface) {
        match element {
            Element::Line(points, pen) => self.stroke(pen, |content| line(content, points)),
            Element::Area(points, ink) => self.fill(*ink, |content| polygon(content, points)),
            Element::Facets(facets, ink) => self.fill(*ink, |content| {
                facets.iter().for_each(|facet| polygon(content, facet));
            }),
            Element::Disc(centre, radius, inside, rim) => {
                self.fill(*inside, |content| disc(content, *centre, *radius));
                self.stroke(rim, |content| disc(content, *centre, *radius));
            }
            Element::Image(corner, size, picture) => self.image(*corner, *size, picture),
            Element::Text(text) => self.text(text, typeface),
        }
    }

    fn fill(&mut self, ink: Ink, path: impl FnOnce(&mut Content)) {
        self.set_fill(ink);
        path(&mut self.content);
        self.content.fill_nonzero();
    }

    fn stroke(&mut self, pen: &Pen, path: impl FnOnce(&mut Content)) {
        // Here a line without width would be drawn as thin as can be.
        if pen.width == 0 {
            return;
        }
        let [r, g, b] = shares(pen.ink);
        self.set_opacity(pen.ink.alpha);
        self.content.set_stroke_rgb(r, g, b);
        self.content.set_line_width(pen.width as f32);
        let dash = pen.dash.iter().map(|&part| part as f32);
        self.content.set_dash_pattern(dash, 0.0);
        path(&mut self.content);
        self.content.stroke();
    }

    fn set_fill(&mut self, ink: Ink) {
        let [r, g, b] = shares(ink);
        self.set_opacity(ink.alpha);
        self.content.set_fill_rgb(r, g, b);
    }

    fn set_opacity(&mut self, alpha: f64) {
        if alpha == self.opacity {
            return;
        }
        self.opacity = alpha;
        let number = place(&mut self.opacities, alpha);
        self.content
            .set_parameters(Name(name('O', number).as_bytes()));
    }

    fn image(&mut self, (x, y): BackendCoord, (width, height): (u32, u32), picture: &'a Picture) {
        self.set_opacity(1.0);
        let number = place(&mut self.pictures, picture);
        let (width, height) = (width as f32, height as f32);
        let frame = [width, 0.0, 0.0, -height, x as f32, y as f32 + height];
        self.content.save_state().transform(frame);
        self.content
            .x_object(Name(name('P', number).as_bytes()))
            .restore_state();
    }

    fn text(&mut self, text: &Text, typeface: Typeface) {
        self.set_fill(text.ink);
        self.content.begin_text();
        for (frame, run) in text.runs(typeface) {
            let font = name('F', run.font as usize);
            self.content
                .set_font(Name(font.as_bytes()), run.size as f32);
            self.content.set_text_matrix(frame.map(|part| part as f32));
            let mut shown = self.content.show_positioned();
            let mut items = shown.items();
            let thousandths = 1000.0 * run.scale() / run.size;
            // Glyphs that stand as far apart as they are wide are written together.
            for glyphs in run.glyphs.chunk_by(|glyph, _| glyph.kerning == 0.0) {
                let numbers: Vec<u8> = glyphs
                    .iter()
                    .flat_map(|glyph| glyph.id.0.to_be_bytes())
                    .collect();
                items.show(Str(&numbers));
                let kerning = glyphs.last().map_or(0.0, |glyph| glyph.kerning);
                if kerning != 0.0 {
                    items.adjust((-kerning * thousandths) as f32);
                }
            }
            let letters = self.fonts.entry(run.font).or_default();
            letters.extend(
                run.glyphs
                    .into_iter()
                    .map(|glyph| (glyph.id.0, glyph.letters)),
            );
        }
        self.content.end_text();
    }
}

/// Red, green and blue as shares.
fn shares(Ink { rgb: (r, g, b), .. }: Ink) -> [f32; 3] {
    [r, g, b].map(|value| f32::from(value) / 255.0)
}

/// The place of something in a list, to which it is added where it is new.
fn place<T: PartialEq>(list: &mut Vec<T>, one: T) -> usize {
    list.iter()
        .position(|known| *known == one)
        .unwrap_or_else(|| {
            list.push(one);
            list.len() - 1
        })
}

fn line(content: &mut Content, points: &[BackendCoord]) {
    for (number, &(x, y)) in points.iter().enumerate() {
        match number {
            0 => content.move_to(x as f32, y as f32),
            _ => content.line_to(x as f32, y as f32),
        };
    }
}

fn polygon(content: &mut Content, corners: &[BackendCoord]) {
    line(content, corners);
    if !corners.is_empty() {
        content.close_path();
    }
}

fn disc(content: &mut Content, (x, y): BackendCoord, radius: i64) {
    content.move_to((i64::from(x) + radius) as f32, y as f32);
    for arc in arcs((x, y), radius) {
        let [(a, b), (c, d), (e, f)] = arc.map(|(x, y)| (x as f32, y as f32));
        content.cubic_to(a, b, c, d, e, f);
    }
    content.close_path();
}
