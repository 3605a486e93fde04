//! Prints beside each other on one picture, each below its label.

use std::path::Path;

use tiny_skia::{
    Color, FillRule, FilterQuality, IntSize, Paint, PathBuilder, Pixmap, PixmapPaint, Transform,
};
use ttf_parser::{Face, OutlineBuilder};

/// Prints beside each other.
const COLUMNS: usize = 3;
/// Pixels between prints.
const GAP: f32 = 12.0;
/// Height of a label, in pixels.
const LABEL: f32 = 22.0;

/// A figure as a picture.
pub(super) struct Print {
    label: String,
    picture: Pixmap,
}

impl Print {
    pub(super) fn read(label: impl Into<String>, path: &Path) -> Self {
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut colours = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut colours).unwrap();
        let pixels = colours
            .chunks(3)
            .flat_map(|rgb| [rgb[0], rgb[1], rgb[2], 255]);
        let size = IntSize::from_wh(info.width, info.height).unwrap();
        let picture = Pixmap::from_vec(pixels.collect(), size).unwrap();
        let label = label.into();
        Self { label, picture }
    }

    /// What it is scaled by so that it is as wide as asked for, and no higher than that and a half.
    fn scale(&self, wide: f32) -> f32 {
        let [width, height] =
            [self.picture.width(), self.picture.height()].map(|length| length as f32);
        (wide / width).min(1.5 * wide / height)
    }

    fn height(&self, wide: f32) -> f32 {
        self.picture.height() as f32 * self.scale(wide)
    }
}

/// Writes the sheet as a PNG; a print is as wide as that at most.
pub(super) fn write_sheet(prints: &[Print], wide: f32, path: &Path) {
    let sheet = sheet(prints, wide);
    let file = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
    let mut encoder = png::Encoder::new(file, sheet.width(), sheet.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(sheet.data())
        .unwrap();
}

fn sheet(prints: &[Print], wide: f32) -> Pixmap {
    let heights: Vec<f32> = prints
        .chunks(COLUMNS)
        .map(|row| {
            let heights = row.iter().map(|print| print.height(wide));
            heights.fold(0.0, f32::max) + LABEL + GAP
        })
        .collect();
    let columns = COLUMNS.min(prints.len()) as f32;
    let size = [columns * (wide + GAP) + GAP, heights.iter().sum::<f32>()];
    let [width, height] = size.map(|length| length.ceil() as u32);
    let mut sheet = Pixmap::new(width, height).unwrap();
    sheet.fill(Color::from_rgba8(225, 225, 225, 255));
    let mut top = 0.0;
    for (row, height) in prints.chunks(COLUMNS).zip(heights) {
        for (column, print) in row.iter().enumerate() {
            let left = GAP + column as f32 * (wide + GAP);
            write(&mut sheet, &print.label, (left, top + LABEL - 6.0));
            let scale = print.scale(wide);
            let place = Transform::from_row(scale, 0.0, 0.0, scale, left, top + LABEL);
            let paint = PixmapPaint {
                quality: FilterQuality::Bicubic,
                ..PixmapPaint::default()
            };
            sheet.draw_pixmap(0, 0, print.picture.as_ref(), &paint, place, None);
        }
        top += height;
    }
    sheet
}

/// Writes a line from a place on its base line on.
fn write(sheet: &mut Pixmap, line: &str, (left, base): (f32, f32)) {
    let font = include_bytes!("../../../src/figure/canvas/fonts/DejaVuSans.ttf.z");
    let font = miniz_oxide::inflate::decompress_to_vec_zlib(font).unwrap();
    let face = Face::parse(&font, 0).unwrap();
    let scale = 15.0 / f32::from(face.units_per_em());
    let mut pen = left;
    for letter in line.chars() {
        let glyph = face.glyph_index(letter).unwrap_or_default();
        let mut outline = Outline(PathBuilder::new());
        face.outline_glyph(glyph, &mut outline);
        if let Some(path) = outline.0.finish() {
            let place = Transform::from_row(scale, 0.0, 0.0, -scale, pen, base);
            let paint = Paint {
                anti_alias: true,
                ..Paint::default()
            };
            sheet.fill_path(&path, &paint, FillRule::Winding, place, None);
        }
        pen += scale * f32::from(face.glyph_hor_advance(glyph).unwrap_or_default());
    }
}

/// An outline as a path.
struct Outline(PathBuilder);

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, a: f32, b: f32, x: f32, y: f32) {
        self.0.quad_to(a, b, x, y);
    }

    fn curve_to(&mut self, a: f32, b: f32, c: f32, d: f32, x: f32, y: f32) {
        self.0.cubic_to(a, b, c, d, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
