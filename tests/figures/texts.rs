//! The texts of an SVG with their boxes, as another program lays them out: advances of the fonts, without pairs that
//! move together.

use std::sync::LazyLock;

use roxmltree::{Document, Node};
use ttf_parser::Face;

/// A text of a figure with its box, in lengths of 1/96 inch.
#[derive(Debug)]
pub(crate) struct Text {
    pub(crate) letters: String,
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) top: f64,
    pub(crate) bottom: f64,
}

/// Width and height of a figure in lengths of 1/96 inch, and those of its units.
pub(crate) fn size(svg: &Document<'_>) -> ([f64; 2], [f64; 2]) {
    let root = svg.root_element();
    let length = |name: &str| {
        let text = root.attribute(name).unwrap();
        let millimetres = text.strip_suffix("mm");
        millimetres.map_or_else(
            || text.parse::<f64>().unwrap(),
            |text| text.parse::<f64>().unwrap() * 96.0 / 25.4,
        )
    };
    let view = root.attribute("viewBox").unwrap();
    let view: Vec<f64> = view.split(' ').map(|part| part.parse().unwrap()).collect();
    ([length("width"), length("height")], [view[2], view[3]])
}

fn number(node: Node<'_, '_>, name: &str) -> Option<f64> {
    node.attribute(name).map(|text| text.parse().unwrap())
}

/// The font of a text, or of a part of it.
fn font(is_serif: bool, is_bold: bool, is_slanted: bool) -> &'static [u8] {
    macro_rules! file {
        ($name:literal) => {{
            static FONT: LazyLock<Vec<u8>> = LazyLock::new(|| {
                let deflated = include_bytes!(concat!(
                    "../../src/figure/canvas/fonts/DejaVu",
                    $name,
                    ".ttf.z"
                ));
                miniz_oxide::inflate::decompress_to_vec_zlib(deflated).unwrap()
            });
            &FONT
        }};
    }
    match (is_serif, is_bold, is_slanted) {
        (false, true, _) => file!("Sans-Bold"),
        (false, false, true) => file!("Sans-Oblique"),
        (false, false, false) => file!("Sans"),
        (true, true, _) => file!("Serif-Bold"),
        (true, false, true) => file!("Serif-Italic"),
        (true, false, false) => file!("Serif"),
    }
}

/// Width of letters as a share of their size.
fn width(font: &[u8], letters: &str) -> f64 {
    let face = Face::parse(font, 0).unwrap();
    let advance = |letter: char| {
        let glyph = face.glyph_index(letter);
        let glyph = glyph.unwrap_or_else(|| panic!("no `{letter}`"));
        f64::from(face.glyph_hor_advance(glyph).unwrap()) / f64::from(face.units_per_em())
    };
    letters.chars().map(advance).sum()
}

/// All texts of a figure. Their boxes reach from the lowest to the highest place of any letter of the font.
pub(crate) fn texts(svg: &Document<'_>) -> Vec<Text> {
    let (page, units) = size(svg);
    let scale = page[0] / units[0];
    let is_serif = svg
        .root_element()
        .attribute("font-family")
        .unwrap()
        .starts_with("'DejaVu Serif'");
    let is_text = |node: &Node<'_, '_>| node.has_tag_name("text");
    let text = |node: Node<'_, '_>| {
        let own = number(node, "font-size").unwrap();
        let is_bold = node.attribute("font-weight") == Some("bold");
        let (x, y) = (number(node, "x").unwrap(), number(node, "y").unwrap());
        let (mut letters, mut length, mut shift, mut top, mut bottom) =
            (String::new(), 0.0, 0.0, 0.0_f64, 0.0_f64);
        for part in node.children() {
            let is_slanted = part.attribute("font-style") == Some("oblique");
            let size = number(part, "font-size").unwrap_or(own);
            let run = part.text().or_else(|| part.first_child()?.text()).unwrap();
            length += size * width(font(is_serif, is_bold, is_slanted), run);
            shift += number(part, "dy").unwrap_or(0.0);
            top = top.min(shift - 0.928 * size);
            bottom = bottom.max(shift + 0.236 * size);
            letters += run;
        }
        let before = match node.attribute("text-anchor").unwrap() {
            "start" => 0.0,
            "middle" => 0.5,
            "end" => 1.0,
            other => panic!("{other}"),
        };
        // Along the line, and below its point.
        let (from, to) = (-before * length, (1.0 - before) * length);
        let (left, right, top, bottom) = match node.attribute("transform") {
            None => (x + from, x + to, y + top, y + bottom),
            Some(turn) => {
                let about = turn
                    .strip_prefix("rotate(-90 ")
                    .and_then(|rest| rest.strip_suffix(')'))
                    .unwrap();
                let about: Vec<f64> = about.split(' ').map(|part| part.parse().unwrap()).collect();
                assert_eq!(about[0], x);
                let line = y - about[1];
                (
                    x + line + top,
                    x + line + bottom,
                    about[1] - to,
                    about[1] - from,
                )
            }
        };
        let [left, right, top, bottom] = [left, right, top, bottom].map(|place| scale * place);
        Text {
            letters,
            left,
            right,
            top,
            bottom,
        }
    };
    svg.descendants().filter(is_text).map(text).collect()
}
