//! A font of a PDF: its outlines, as far as they are used, its widths, and the letters of its glyphs.

use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use ttf_parser::GlyphId;

use super::content::Letters;
use super::subset;
use crate::figure::canvas::letters::Font;

/// How glyphs are numbered: as in the font.
const NUMBERS: SystemInfo<'_> = SystemInfo {
    registry: Str(b"Adobe"),
    ordering: Str(b"Identity"),
    supplement: 0,
};

/// Writes a font with the glyphs of these letters; returns its object.
pub(super) fn write(file: &mut Pdf, free: &mut Ref, font: Font, letters: &Letters) -> Ref {
    let [whole, glyphs, descriptor, outlines, unicode] = std::array::from_fn(|_| free.bump());
    let name = format!("{}+{}", tag(letters), font.name());
    let name = Name(name.as_bytes());
    let mut one = file.type0_font(whole);
    one.base_font(name)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(glyphs)
        .to_unicode(unicode);
    one.finish();
    let Some(face) = font.face() else {
        return whole;
    };
    // Lengths are in thousandths of the letters' body.
    let unit = 1000.0 / f32::from(face.units_per_em());
    let mut one = file.cid_font(glyphs);
    one.subtype(CidFontType::Type2)
        .base_font(name)
        .system_info(NUMBERS)
        .font_descriptor(descriptor);
    one.default_width(0.0)
        .cid_to_gid_map_predefined(Name(b"Identity"));
    let mut widths = one.widths();
    for &id in letters.keys() {
        let width = face.glyph_hor_advance(GlyphId(id)).unwrap_or(0);
        widths.consecutive(id, [unit * f32::from(width)]);
    }
    widths.finish();
    one.finish();
    let corners = face.global_bounding_box();
    let [left, low, right, high] = [corners.x_min, corners.y_min, corners.x_max, corners.y_max]
        .map(|place| unit * f32::from(place));
    let mut flags = FontFlags::SYMBOLIC;
    flags.set(FontFlags::ITALIC, face.italic_angle() != 0.0);
    flags.set(FontFlags::SERIF, font.name().contains("Serif"));
    let mut one = file.font_descriptor(descriptor);
    one.name(name)
        .flags(flags)
        .bbox(Rect::new(left, low, right, high))
        .italic_angle(face.italic_angle());
    one.ascent(unit * f32::from(face.ascender()))
        .descent(unit * f32::from(face.descender()));
    one.cap_height(unit * f32::from(face.capital_height().unwrap_or(0)));
    // No program that shows an embedded font asks for the width of its stems, but it has to be there.
    one.stem_v(80.0).font_file2(outlines);
    one.finish();
    let bytes = subset::subset(face, letters.keys().copied()).unwrap_or_default();
    let deflated = compress_to_vec_zlib(&bytes, 9);
    let mut stream = file.stream(outlines, &deflated);
    stream
        .filter(Filter::FlateDecode)
        .pair(Name(b"Length1"), bytes.len() as i32);
    stream.finish();
    let mut map = UnicodeCmap::new(Name(b"Custom"), NUMBERS);
    for (&id, letters) in letters {
        map.pair_with_multiple(id, letters.chars());
    }
    file.cmap(unicode, &compress_to_vec_zlib(&map.finish(), 9))
        .filter(Filter::FlateDecode);
    whole
}

/// Six capitals that tell a part of a font from other parts of it.
fn tag(letters: &Letters) -> String {
    let sum = letters.keys().fold(0xcbf2_9ce4_8422_2325, |sum: u64, &id| {
        (sum ^ u64::from(id)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    let letter = |place: u32| char::from(b'A' + (sum / 26_u64.pow(place) % 26) as u8);
    (0..6).map(letter).collect()
}
