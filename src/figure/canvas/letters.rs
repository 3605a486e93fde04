//! Lettering laid out: which glyphs of which font stand where. DejaVu alone: no font of the machine, so that figures
//! are the same everywhere.

use std::sync::OnceLock;

use miniz_oxide::inflate::decompress_to_vec_zlib;
use ttf_parser::{Face, GlyphId};

use super::look::Look;
use super::style::UNITS;
use super::symbols::{self, Script};
use crate::figure::style::Typeface;

/// A font that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Font {
    Sans,
    SansOblique,
    SansBold,
    Serif,
    SerifItalic,
    SerifBold,
}

words! {
    Font, pub(super) name:
    Sans: "DejaVuSans", SansOblique: "DejaVuSans-Oblique", SansBold: "DejaVuSans-Bold",
    Serif: "DejaVuSerif", SerifItalic: "DejaVuSerif-Italic", SerifBold: "DejaVuSerif-Bold",
}

impl Font {
    fn new(typeface: Typeface, bold: bool, slanted: bool) -> Self {
        match (typeface, bold, slanted) {
            (Typeface::Sans, true, _) => Self::SansBold,
            (Typeface::Sans, false, true) => Self::SansOblique,
            (Typeface::Sans, false, false) => Self::Sans,
            (Typeface::Serif, true, _) => Self::SerifBold,
            (Typeface::Serif, false, true) => Self::SerifItalic,
            (Typeface::Serif, false, false) => Self::Serif,
        }
    }

    /// Where letters are looked for that it does not have: Sans has the most.
    fn others(self) -> [Self; 2] {
        match self {
            Self::Sans | Self::Serif => [Self::Sans, Self::Serif],
            Self::SansOblique | Self::SerifItalic => [Self::SansOblique, Self::Sans],
            Self::SansBold | Self::SerifBold => [Self::SansBold, Self::Sans],
        }
    }

    /// The file of the font, version 2.37, as it comes with the program: deflated to half its size.
    fn deflated(self) -> &'static [u8] {
        match self {
            Self::Sans => include_bytes!("fonts/DejaVuSans.ttf.z"),
            Self::SansOblique => include_bytes!("fonts/DejaVuSans-Oblique.ttf.z"),
            Self::SansBold => include_bytes!("fonts/DejaVuSans-Bold.ttf.z"),
            Self::Serif => include_bytes!("fonts/DejaVuSerif.ttf.z"),
            Self::SerifItalic => include_bytes!("fonts/DejaVuSerif-Italic.ttf.z"),
            Self::SerifBold => include_bytes!("fonts/DejaVuSerif-Bold.ttf.z"),
        }
    }

    /// The font, inflated and read when it is first asked for. All that come with the program can be.
    pub(super) fn face(self) -> Option<&'static Face<'static>> {
        static FILES: [OnceLock<Vec<u8>>; Font::ALL.len()] =
            [const { OnceLock::new() }; Font::ALL.len()];
        static FACES: [OnceLock<Option<Face<'static>>>; Font::ALL.len()] =
            [const { OnceLock::new() }; Font::ALL.len()];
        let inflated = || decompress_to_vec_zlib(self.deflated()).unwrap_or_default();
        let file = FILES.get(self as usize)?.get_or_init(inflated);
        let face = FACES.get(self as usize)?;
        face.get_or_init(|| Face::parse(file, 0).ok()).as_ref()
    }
}

/// Glyphs of one font and size that follow each other on a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    pub(super) font: Font,
    /// Size of the font, in units.
    pub(super) size: f64,
    /// Where its first glyph begins, from the start of the text, in units.
    pub(super) start: f64,
    /// How far it stands below the base line of the text, in units.
    pub(super) shift: f64,
    pub(super) glyphs: Vec<Glyph>,
}

/// A glyph of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Glyph {
    /// Its number in the font.
    pub(super) id: GlyphId,
    /// What it stands for: a letter, or several of a ligature.
    pub(super) letters: String,
    /// Its advance, in units of the font.
    pub(super) advance: f64,
    /// How much nearer (negative) or farther the next glyph of its run stands, in units of the font.
    pub(super) kerning: f64,
}

impl Run {
    /// Length of a unit of the font.
    pub(super) fn scale(&self) -> f64 {
        let face = self.font.face();
        self.size / face.map_or(1.0, |face| f64::from(face.units_per_em()))
    }

    /// How far it leads along the line.
    fn advance(&self) -> f64 {
        let steps = self
            .glyphs
            .iter()
            .map(|glyph| glyph.advance + glyph.kerning);
        self.scale() * steps.sum::<f64>()
    }
}

/// A line of lettering.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Line {
    /// Height of the letters' body, in units.
    pub(super) size: i64,
    pub(super) is_bold: bool,
    pub(super) spans: Vec<Span>,
}

/// Letters of one size and slant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) letters: String,
    /// How far they stand below the base line, in units.
    pub(super) shift: i64,
    /// Their size in units, where it is not that of the line.
    pub(super) size: Option<i64>,
    /// Whether they are slanted; bold ones never are.
    pub(super) is_slanted: bool,
}

impl Line {
    /// Markup of a size in figure pixels.
    pub(super) fn new(markup: &str, size: f64, is_bold: bool) -> Self {
        let size = size * UNITS;
        let span = |run: symbols::Run| {
            let (shift, is_small) = match run.script {
                Script::Base => (0, false),
                Script::Lower => ((0.22 * size) as i64, true),
                Script::Upper => ((-0.36 * size) as i64, true),
            };
            Span {
                letters: run.text,
                shift,
                size: is_small.then_some((0.72 * size).round() as i64),
                is_slanted: run.slanted && !is_bold,
            }
        };
        Self {
            size: size.round() as i64,
            is_bold,
            spans: symbols::runs(markup).into_iter().map(span).collect(),
        }
    }

    /// Its glyphs, and its length in units.
    pub(super) fn lay_out(&self, typeface: Typeface) -> (Vec<Run>, f64) {
        let mut runs = Vec::new();
        let mut length = 0.0;
        for span in &self.spans {
            let font = Font::new(typeface, self.is_bold, span.is_slanted);
            let glyphs = clusters(font, &span.letters).filter_map(|letters| glyph(font, letters));
            let glyphs: Vec<(Font, Glyph)> = glyphs.collect();
            for run in glyphs.chunk_by(|a, b| a.0 == b.0) {
                let Some(&(font, _)) = run.first() else {
                    continue;
                };
                let mut run = Run {
                    font,
                    size: span.size.unwrap_or(self.size) as f64,
                    start: length,
                    shift: span.shift as f64,
                    glyphs: run.iter().map(|(_, glyph)| glyph.clone()).collect(),
                };
                kern(&mut run);
                length += run.advance();
                runs.push(run);
            }
        }
        (runs, length)
    }
}

/// Letters that DejaVu joins, in the order in which Sans looks for them.
const LIGATURES: [(&str, char); 5] = [
    ("ffl", '\u{fb04}'),
    ("ffi", '\u{fb03}'),
    ("fl", '\u{fb02}'),
    ("fi", '\u{fb01}'),
    ("ff", '\u{fb00}'),
];

/// Whether a font joins letters: Serif looks for `ff` before `ffi`, which is then never found.
fn joins(font: Font, letters: &str) -> bool {
    let is_serif = matches!(font, Font::Serif | Font::SerifItalic | Font::SerifBold);
    !(is_serif && letters == "ffi")
}

/// The letters one by one, those that a font joins together.
fn clusters(font: Font, letters: &str) -> impl Iterator<Item = &str> {
    let mut rest = letters;
    std::iter::from_fn(move || {
        let mut joined = LIGATURES.iter().map(|(joined, _)| *joined);
        let length = match joined.find(|joined| rest.starts_with(joined) && joins(font, joined)) {
            Some(joined) => joined.len(),
            None => rest.chars().next()?.len_utf8(),
        };
        let (cluster, after) = rest.split_at_checked(length)?;
        rest = after;
        Some(cluster)
    })
}

/// The glyph of a cluster in a font, or in the first that has it; a box where none has.
fn glyph(font: Font, letters: &str) -> Option<(Font, Glyph)> {
    let joined = LIGATURES.iter().find(|(joined, _)| *joined == letters);
    let letter = joined.map_or_else(|| letters.chars().next(), |(_, letter)| Some(*letter))?;
    let has = |font: Font| Some((font, font.face()?.glyph_index(letter)?));
    let found = std::iter::once(font).chain(font.others()).find_map(has);
    let (font, id) = found.unwrap_or((font, GlyphId(0)));
    let advance = font.face()?.glyph_hor_advance(id).unwrap_or(0);
    let glyph = Glyph {
        id,
        letters: letters.to_owned(),
        advance: f64::from(advance),
        kerning: 0.0,
    };
    Some((font, glyph))
}

/// Moves the glyphs of a run together or apart as the font's table of pairs says.
fn kern(run: &mut Run) {
    let table = run.font.face().and_then(|face| face.tables().kern);
    let Some(pairs) = table.and_then(|table| table.subtables.into_iter().next()) else {
        return;
    };
    let after: Vec<GlyphId> = run.glyphs.iter().skip(1).map(|glyph| glyph.id).collect();
    for (glyph, next) in run.glyphs.iter_mut().zip(after) {
        glyph.kerning = pairs.glyphs_kerning(glyph.id, next).map_or(0.0, f64::from);
    }
}

/// Width of a text of markup, in figure pixels, as it will be drawn.
pub(crate) fn text_width(look: &Look, markup: &str, size: f64, bold: bool) -> f64 {
    Line::new(markup, size, bold).lay_out(look.typeface).1 / UNITS
}

/// The text cut into lines that fit a width, at spaces.
pub(crate) fn wrap(look: &Look, markup: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in markup.split_whitespace() {
        let longer = match lines.last() {
            Some(line) => format!("{line} {word}"),
            None => word.to_owned(),
        };
        let fits = text_width(look, &longer, size, false) <= width;
        match lines.last_mut() {
            Some(line) if fits => *line = longer,
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fonts_are_whole() {
        // The numbers of four bytes of a font file add up to this one.
        for font in Font::ALL {
            let file = decompress_to_vec_zlib(font.deflated()).unwrap();
            let sum = file.chunks(4).fold(0_u32, |sum, bytes| {
                let mut number = [0; 4];
                number[..bytes.len()].copy_from_slice(bytes);
                sum.wrapping_add(u32::from_be_bytes(number))
            });
            assert_eq!(sum, 0xb1b0_afba, "{font:?}");
        }
    }

    #[test]
    fn widths_are_those_of_the_font() {
        // Advance of a DejaVu Sans digit: 1303 of 2048 units an em.
        let width = |markup: &str| text_width(&Look::default(), markup, 20.0, false);
        assert!((width("00000") - 5.0 * 20.0 * 1303.0 / 2048.0).abs() < 1e-9);
        assert!((width("0_{0}") - 1.72 * 20.0 * 1303.0 / 2048.0).abs() < 1e-9);
        assert_eq!(width(""), 0.0);
        // A and V stand 131 units nearer than their advances of 1401 say.
        assert!((width("AV") - 20.0 * (2.0 * 1401.0 - 131.0) / 2048.0).abs() < 1e-9);
    }

    #[test]
    fn every_symbol_of_the_models_has_a_glyph() {
        for font in Font::ALL {
            for letter in "ẋẏżxyzaακμλσ−×²√≥·".chars() {
                let (found, glyph) = glyph(font, &letter.to_string()).unwrap();
                assert_eq!(found, font, "{letter}");
                assert_ne!(glyph.id, GlyphId(0), "{letter} of {font:?}");
            }
        }
        // A letter that Serif has not is taken from Sans; a rune, from neither.
        assert_eq!(glyph(Font::Serif, "☃").unwrap().0, Font::Sans);
        assert_eq!(glyph(Font::Serif, "\u{16a0}").unwrap().1.id, GlyphId(0));
    }

    #[test]
    fn joined_letters_are_one_glyph_and_stay_letters() {
        for (typeface, joined) in [(Typeface::Sans, "ffi"), (Typeface::Serif, "ff")] {
            let (runs, _) = Line::new("coefficient of flow", 10.0, false).lay_out(typeface);
            let glyphs = runs[0].glyphs.iter();
            let letters: Vec<&str> = glyphs.map(|one| one.letters.as_str()).collect();
            assert_eq!(letters.concat(), "coefficient of flow");
            assert!(
                letters.contains(&joined) && letters.contains(&"fl"),
                "{letters:?}"
            );
        }
    }

    #[test]
    fn long_titles_are_cut_at_spaces() {
        let lines = wrap(&Look::default(), "one two three four", 12.0, 60.0);
        assert!(lines.len() > 1);
        assert_eq!(lines.join(" "), "one two three four");
        for line in lines {
            assert!(text_width(&Look::default(), &line, 12.0, false) <= 60.0);
        }
    }
}
