//! From an SVG to pixels, and the measure of a text, both by resvg with the fonts that come with the program.

use std::sync::{Arc, OnceLock};

use plotters_backend::text_anchor::HPos;
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{self, fontdb};

use super::backend::{Canvas, Lettering};
use super::look::Look;
use super::style::BLACK;
use crate::figure::FigureError;

/// DejaVu alone: no font of the machine, so that figures are the same everywhere.
fn options() -> usvg::Options<'static> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut fonts = fontdb::Database::new();
        let faces = [
            dejavu::sans::regular(),
            dejavu::sans::oblique(),
            dejavu::sans::bold(),
            dejavu::sans::bold_oblique(),
            dejavu::serif::regular(),
            dejavu::serif::italic(),
            dejavu::serif::bold(),
            dejavu::serif::bold_italic(),
        ];
        for face in faces {
            fonts.load_font_source(fontdb::Source::Binary(Arc::new(face)));
        }
        fonts.set_sans_serif_family("DejaVu Sans");
        fonts.set_serif_family("DejaVu Serif");
        Arc::new(fonts)
    });
    usvg::Options {
        font_family: "DejaVu Sans".to_owned(),
        fontdb: Arc::clone(fonts),
        ..usvg::Options::default()
    }
}

/// An SVG read back, its text laid out.
///
/// # Errors
/// [`FigureError::Svg`].
pub(super) fn tree(svg: &str) -> Result<usvg::Tree, FigureError> {
    Ok(usvg::Tree::from_str(svg, &options())?)
}

/// An SVG as a PNG of 8-bit RGB, with that many pixels to the inch, which is written into it.
///
/// # Errors
/// [`FigureError::Svg`], [`FigureError::Raster`] or [`FigureError::Png`].
pub(crate) fn png(svg: &str, dpi: f64) -> Result<Vec<u8>, FigureError> {
    let tree = tree(svg)?;
    // Lengths of the tree are 1/96 inch.
    let scale = (dpi / 96.0) as f32;
    let width = (tree.size().width() * scale).round() as u32;
    let height = (tree.size().height() * scale).round() as u32;
    let mut pixels = Pixmap::new(width, height).ok_or(FigureError::Raster { width, height })?;
    pixels.fill(Color::WHITE);
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut pixels.as_mut(),
    );
    let colours: Vec<u8> = pixels
        .pixels()
        .iter()
        .flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // The last tenth of a file's size would take as long as all the rest.
    encoder.set_compression(png::Compression::Balanced);
    let pixels_a_metre = (dpi / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: pixels_a_metre,
        yppu: pixels_a_metre,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&colours)?;
    writer.finish()?;
    Ok(bytes)
}

/// Width of a text, in pixels, as it will be drawn.
///
/// # Errors
/// [`FigureError::Svg`].
pub(crate) fn text_width(
    look: &Look,
    markup: &str,
    size: f64,
    bold: bool,
) -> Result<f64, FigureError> {
    if markup.is_empty() {
        return Ok(0.0);
    }
    // Measured at the usual size: lengths of the tree are then figure pixels.
    let look = Look {
        typeface: look.typeface,
        ..Look::default()
    };
    let canvas = Canvas::new(look, 1.0, 1.0);
    let lettering = Lettering {
        markup: markup.to_owned(),
        size,
        colour: BLACK,
        anchor: HPos::Left,
        upward: false,
        bold,
    };
    canvas.text((0, 0), &lettering);
    let tree = tree(&canvas.document())?;
    // The text is the node beside the background.
    let width = tree
        .root()
        .children()
        .iter()
        .map(text_right)
        .fold(0.0, f64::max);
    Ok(width)
}

/// Right end of the texts in a node, in pixels.
fn text_right(node: &usvg::Node) -> f64 {
    match node {
        usvg::Node::Group(group) => group.children().iter().map(text_right).fold(0.0, f64::max),
        usvg::Node::Text(text) => f64::from(text.abs_bounding_box().right()),
        _ => 0.0,
    }
}

/// The text cut into lines that fit a width, at spaces.
///
/// # Errors
/// [`FigureError::Svg`].
pub(crate) fn wrap(
    look: &Look,
    markup: &str,
    size: f64,
    width: f64,
) -> Result<Vec<String>, FigureError> {
    let mut lines: Vec<String> = Vec::new();
    for word in markup.split_whitespace() {
        let longer = match lines.last() {
            Some(line) => format!("{line} {word}"),
            None => word.to_owned(),
        };
        let fits = text_width(look, &longer, size, false)? <= width;
        match lines.last_mut() {
            Some(line) if fits => *line = longer,
            _ => lines.push(word.to_owned()),
        }
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::style::Typeface;

    #[test]
    fn widths_are_those_of_the_font() {
        // Advance of a DejaVu Sans digit: 1303 of 2048 units an em.
        let digits = text_width(&Look::default(), "00000", 20.0, false).unwrap();
        assert!(
            (digits - 5.0 * 20.0 * 1303.0 / 2048.0).abs() < 0.3,
            "{digits}"
        );
        let lowered = text_width(&Look::default(), "0_{0}", 20.0, false).unwrap();
        assert!(
            (lowered / (1.72 * 20.0 * 1303.0 / 2048.0) - 1.0).abs() < 0.02,
            "{lowered}"
        );
        assert_eq!(text_width(&Look::default(), "", 20.0, false).unwrap(), 0.0);
    }

    #[test]
    fn every_symbol_of_the_models_has_a_glyph() {
        for typeface in Typeface::ALL {
            let look = Look {
                typeface,
                ..Look::default()
            };
            let width =
                |letter: char| text_width(&look, &format!("${letter}$"), 1000.0, false).unwrap();
            // What stands for a letter that no font has; no letter below happens to be as wide.
            let missing = width('\u{16a0}');
            for letter in "ẋẏżxyzaακμλσ".chars() {
                assert!((width(letter) - missing).abs() > 1.0, "{letter}");
            }
        }
    }

    #[test]
    fn long_titles_are_cut_at_spaces() {
        let lines = wrap(&Look::default(), "one two three four", 12.0, 60.0).unwrap();
        assert!(lines.len() > 1);
        assert_eq!(lines.join(" "), "one two three four");
        for line in lines {
            assert!(text_width(&Look::default(), &line, 12.0, false).unwrap() <= 60.0);
        }
    }
}
