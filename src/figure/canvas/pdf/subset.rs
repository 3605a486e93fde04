//! The part of a TrueType font that some glyphs need, as a PDF embeds it: glyphs keep their numbers, all others are
//! empty (ISO/IEC 14496-22, "The OpenType font format").

use std::collections::BTreeSet;

use ttf_parser::{Face, GlyphId, Tag, loca};

/// Tables of a PDF's font besides those that are written anew: the outlines' programs and the font's measures.
const KEPT: [&[u8; 4]; 6] = [b"cvt ", b"fpgm", b"head", b"hhea", b"maxp", b"prep"];
/// Place of `checkSumAdjustment` in the table `head`, and what all sums make together.
const ADJUSTMENT: (usize, u32) = (8, 0xb1b0_afba);
/// Place of `indexToLocFormat` in the table `head`.
const FORMAT: usize = 50;

/// A font with these glyphs alone, and those they are put together from.
pub(super) fn subset(face: &Face<'_>, glyphs: impl IntoIterator<Item = u16>) -> Option<Vec<u8>> {
    let glyphs = closure(face, glyphs);
    let (mut glyf, mut loca, mut hmtx) = (Vec::new(), Vec::new(), Vec::new());
    for id in 0..face.number_of_glyphs() {
        loca.extend((glyf.len() as u32).to_be_bytes());
        let is_kept = glyphs.contains(&id);
        if is_kept {
            glyf.extend(outline(face, id).unwrap_or_default());
            glyf.resize(glyf.len().next_multiple_of(4), 0);
        }
        hmtx.extend(metrics(face, id).filter(|_| is_kept).unwrap_or_default());
    }
    loca.extend((glyf.len() as u32).to_be_bytes());
    let mut tables = vec![(*b"glyf", glyf), (*b"hmtx", hmtx), (*b"loca", loca)];
    for name in KEPT {
        let mut table = face.raw_face().table(Tag::from_bytes(name))?.to_vec();
        match name {
            b"head" => {
                table.get_mut(ADJUSTMENT.0..)?.get_mut(..4)?.fill(0);
                table
                    .get_mut(FORMAT..)?
                    .get_mut(..2)?
                    .copy_from_slice(&[0, 1]);
            }
            // One pair of measures a glyph.
            b"hhea" => table
                .get_mut(34..36)?
                .copy_from_slice(&face.number_of_glyphs().to_be_bytes()),
            _ => {}
        }
        tables.push((*name, table));
    }
    tables.sort();
    file(tables)
}

/// Puts the tables into a file, with the directory before them.
fn file(tables: Vec<([u8; 4], Vec<u8>)>) -> Option<Vec<u8>> {
    let count = tables.len() as u16;
    let power = count.checked_ilog2()?;
    let range = 16 << power;
    let mut file = vec![0, 1, 0, 0];
    for word in [count, range, power as u16, 16 * count - range] {
        file.extend(word.to_be_bytes());
    }
    let mut body = Vec::new();
    let mut head = 0;
    for (name, mut table) in tables {
        let length = table.len() as u32;
        table.resize(table.len().next_multiple_of(4), 0);
        let place = 12 + 16 * usize::from(count) + body.len();
        if name == *b"head" {
            head = place;
        }
        file.extend(name);
        for word in [sum(&table), place as u32, length] {
            file.extend(word.to_be_bytes());
        }
        body.extend(table);
    }
    file.extend(body);
    let adjustment = ADJUSTMENT.1.wrapping_sub(sum(&file));
    file.get_mut(head + ADJUSTMENT.0..)?
        .get_mut(..4)?
        .copy_from_slice(&adjustment.to_be_bytes());
    Some(file)
}

/// The sum of all words of four bytes.
fn sum(bytes: &[u8]) -> u32 {
    let words = bytes.chunks(4).map(|word| {
        word.iter()
            .fold(0, |sum: u32, &byte| sum << 8 | u32::from(byte))
    });
    words.fold(0, u32::wrapping_add)
}

/// The glyphs, the one that stands for what is missing, and all that they are put together from.
fn closure(face: &Face<'_>, glyphs: impl IntoIterator<Item = u16>) -> BTreeSet<u16> {
    let mut open: Vec<u16> = glyphs.into_iter().chain([0]).collect();
    let mut all = BTreeSet::new();
    while let Some(id) = open.pop() {
        if all.insert(id) {
            open.extend(parts(outline(face, id).unwrap_or_default()));
        }
    }
    all
}

fn outline<'a>(face: &Face<'a>, id: u16) -> Option<&'a [u8]> {
    let table = |name| face.raw_face().table(Tag::from_bytes(name));
    let (measures, format) = (
        face.tables().maxp,
        face.tables().head.index_to_location_format,
    );
    let places = loca::Table::parse(measures.number_of_glyphs, format, table(b"loca")?)?;
    table(b"glyf")?.get(places.glyph_range(GlyphId(id))?)
}

fn word(bytes: &[u8], at: usize) -> Option<u16> {
    bytes
        .get(at..)?
        .first_chunk()
        .map(|&pair| u16::from_be_bytes(pair))
}

/// The advance of a glyph and where it begins, as the table `hmtx` has them.
fn metrics(face: &Face<'_>, id: u16) -> Option<[u8; 4]> {
    let advance = face.glyph_hor_advance(GlyphId(id))?.to_be_bytes();
    let bearing = face
        .glyph_hor_side_bearing(GlyphId(id))
        .unwrap_or(0)
        .to_be_bytes();
    Some([advance[0], advance[1], bearing[0], bearing[1]])
}

/// The glyphs that an outline is put together from; none where it is drawn itself.
fn parts(outline: &[u8]) -> Vec<u16> {
    const WORDS: u16 = 1;
    const MORE: u16 = 1 << 5;
    /// Flags, and bytes of the numbers that scale the part.
    const SCALES: [(u16, usize); 3] = [(1 << 3, 2), (1 << 6, 4), (1 << 7, 8)];
    let mut found = Vec::new();
    // A count of contours below zero, four corners, then the parts.
    let mut at = 10;
    if word(outline, 0).is_none_or(|count| count.cast_signed() >= 0) {
        return found;
    }
    while let (Some(flags), Some(part)) = (word(outline, at), word(outline, at + 2)) {
        found.push(part);
        if flags & MORE == 0 {
            break;
        }
        let scale = SCALES
            .iter()
            .filter(|(flag, _)| flags & flag != 0)
            .map(|(_, bytes)| bytes);
        at += if flags & WORDS == 0 { 6 } else { 8 } + scale.sum::<usize>();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::canvas::letters::Font;

    /// What a glyph draws, as text.
    fn drawn(face: &Face<'_>, letter: GlyphId) -> String {
        struct Pen(String);
        impl ttf_parser::OutlineBuilder for Pen {
            fn move_to(&mut self, x: f32, y: f32) {
                self.0 += &format!("M{x} {y}");
            }
            fn line_to(&mut self, x: f32, y: f32) {
                self.0 += &format!("L{x} {y}");
            }
            fn quad_to(&mut self, a: f32, b: f32, x: f32, y: f32) {
                self.0 += &format!("Q{a} {b} {x} {y}");
            }
            fn curve_to(&mut self, _: f32, _: f32, _: f32, _: f32, _: f32, _: f32) {}
            fn close(&mut self) {
                self.0 += "Z";
            }
        }
        let mut pen = Pen(String::new());
        face.outline_glyph(letter, &mut pen);
        pen.0
    }

    #[test]
    fn a_subset_draws_its_letters_and_no_others() {
        for font in Font::ALL {
            let face = font.face().unwrap();
            let id = |letter: char| face.glyph_index(letter).unwrap();
            let wanted = ["ẋ", "a", "−", "ﬃ"].map(|text| id(text.chars().next().unwrap()));
            let bytes = subset(face, wanted.map(|id| id.0)).unwrap();
            assert_eq!(sum(&bytes), ADJUSTMENT.1);
            assert!(bytes.len() < 200_000);
            let part = Face::parse(&bytes, 0).unwrap();
            for id in wanted {
                let outline = drawn(face, id);
                assert!(outline.len() > 20);
                assert_eq!(drawn(&part, id), outline);
                assert_eq!(part.glyph_hor_advance(id), face.glyph_hor_advance(id));
                assert_eq!(
                    part.glyph_hor_side_bearing(id),
                    face.glyph_hor_side_bearing(id)
                );
            }
            assert_eq!(drawn(&part, id('b')), "");
        }
    }
}
