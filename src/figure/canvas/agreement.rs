//! SVG, PDF and PNG show the same: what stands in the SVG, read by an XML reader, is held against the numbers of the
//! PDF's content and against the pixels.

use miniz_oxide::inflate::decompress_to_vec_zlib;
use plotters_backend::text_anchor::HPos;
use roxmltree::{Document, Node};

use super::backend::Shape;
use super::drawing::Drawing;
use super::heat::Picture;
use super::letters::text_width;
use super::look::Look;
use super::page::{Page, lettering};
use super::style::{BLACK, Colour, INK, Stroke, UNITS};
use super::{pdf, raster, svg};

const RED: Colour = Colour::fixed((214, 20, 20));
/// A page on which a unit is a pixel.
const DPI: f64 = 1920.0;
const SIZE: (f64, f64) = (60.0, 40.0);

fn page() -> Page {
    let look = Look {
        dpi: DPI,
        ..Look::default()
    };
    Page::new(&look, SIZE.0, SIZE.1)
}

/// A page with one shape.
fn drawn(points: &[(f64, f64)], shape: Shape) -> Drawing {
    let page = page();
    page.draw(points, shape);
    page.drawing()
}

/// A page with all there is.
fn sheet() -> Drawing {
    let page = page();
    let dashed = Stroke::solid(RED.at(0.4), 1.3).dashed(&[4.0, 2.0]);
    page.draw(
        &[(1.0, 2.0), (20.3, 7.77), (31.4, 1.5)],
        Shape::Line(dashed),
    );
    page.draw(
        &[(5.0, 5.0), (9.0, 30.0), (2.0, 8.5)],
        Shape::Area(RED.at(0.25)),
    );
    let facet = |x: f64| [(x, 10.0), (x + 4.0, 11.0), (x + 5.0, 15.0), (x - 1.0, 14.0)];
    page.facets(&[(facet(30.0), RED), (facet(36.0), RED), (facet(42.0), INK)]);
    page.draw(
        &[(40.0, 30.0)],
        Shape::Dot(3.0, RED, Stroke::solid(INK, 0.8)),
    );
    page.draw(&[(50.0, 30.0)], Shape::Plus(2.5, Stroke::solid(INK, 0.8)));
    let share = |column: usize, row: usize| (column != row).then_some(0.5);
    let picture = Picture::new(page.look(), (3, 2), share);
    page.draw(&[(10.0, 35.0), (19.0, 20.5)], Shape::Image(picture));
    for (number, anchor) in [HPos::Left, HPos::Center, HPos::Right]
        .into_iter()
        .enumerate()
    {
        for upward in [false, true] {
            let mut text = lettering("AV $f_{c}$ < σ^{2}", anchor);
            text.upward = upward;
            page.text((30.0, 10.0 + 5.0 * number as f64), text);
        }
    }
    page.drawing()
}

fn number(node: Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// All numbers of a text.
fn numbers(text: &str) -> Vec<f64> {
    let apart = text.replace('-', " -");
    let parts = apart.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    parts.filter_map(|part| part.parse().ok()).collect()
}

fn pairs(numbers: &[f64]) -> Vec<[f64; 2]> {
    numbers
        .chunks_exact(2)
        .map(|pair| [pair[0], pair[1]])
        .collect()
}

/// The corners of the paths of an SVG, in its units; a disc has five, and is drawn twice: its inside and its rim.
fn paths_of_svg(svg: &Document<'_>) -> Vec<Vec<[f64; 2]>> {
    let mut found = Vec::new();
    for node in svg.descendants() {
        match node.tag_name().name() {
            "polyline" | "polygon" => {
                found.push(pairs(&numbers(node.attribute("points").unwrap())))
            }
            "path" => {
                let parts = node.attribute("d").unwrap().split('M').skip(1);
                found.extend(parts.map(|part| {
                    let mut place = [0.0; 2];
                    let steps = pairs(&numbers(part)).into_iter();
                    steps
                        .map(|step| {
                            place = [place[0] + step[0], place[1] + step[1]];
                            place
                        })
                        .collect()
                }));
            }
            "circle" => {
                let [x, y, r] = ["cx", "cy", "r"].map(|name| number(node, name));
                let rim = vec![[x + r, y], [x, y + r], [x - r, y], [x, y - r], [x + r, y]];
                found.extend([rim.clone(), rim]);
            }
            _ => {}
        }
    }
    found
}

/// The lines of a page's content whose operands are numbers.
fn operations(pdf: &[u8]) -> Vec<(Vec<f64>, String)> {
    let find = |bytes: &[u8], mark: &[u8]| {
        bytes
            .windows(mark.len())
            .position(|part| part == mark)
            .unwrap()
    };
    let rest = &pdf[find(pdf, b"stream\n") + 7..];
    let content = decompress_to_vec_zlib(&rest[..find(rest, b"\nendstream")]).unwrap();
    let lines = content.split(|&byte| byte == b'\n');
    let operation = |line: &[u8]| {
        let line = std::str::from_utf8(line).ok()?;
        let (operands, operator) = line.rsplit_once(' ').unwrap_or(("", line));
        let operands = operands.split_whitespace().map(str::parse);
        Some((
            operands.collect::<Result<_, _>>().ok()?,
            operator.to_owned(),
        ))
    };
    lines.filter_map(operation).collect()
}

#[test]
fn paths_of_svg_and_pdf_have_the_same_corners() {
    let drawing = sheet();
    let text = svg::svg(&drawing);
    let mut found: Vec<Vec<[f64; 2]>> = Vec::new();
    for (operands, operator) in operations(&pdf::pdf(&drawing, "a", "b")) {
        match (operator.as_str(), operands.as_slice()) {
            ("m", &[x, y]) => found.push(vec![[x, y]]),
            ("l", &[x, y]) | ("c", &[_, _, _, _, x, y]) => found.last_mut().unwrap().push([x, y]),
            _ => {}
        }
    }
    let expected = paths_of_svg(&Document::parse(&text).unwrap());
    assert!(expected.len() > 8);
    assert_eq!(found, expected);
}

#[test]
fn pictures_and_texts_of_svg_and_pdf_stand_at_the_same_places() {
    let drawing = sheet();
    let text = svg::svg(&drawing);
    let document = Document::parse(&text).unwrap();
    let operations = operations(&pdf::pdf(&drawing, "a", "b"));
    let named = |name: &'static str| {
        document
            .descendants()
            .filter(move |node| node.has_tag_name(name))
    };
    let frames = operations
        .iter()
        .filter(|(_, operator)| operator == "cm")
        .skip(1);
    let frames: Vec<Vec<f64>> = frames.map(|(frame, _)| frame.clone()).collect();
    let images = named("image").map(|node| {
        let [x, y, width, height] = ["x", "y", "width", "height"].map(|name| number(node, name));
        vec![width, 0.0, 0.0, -height, x, y + height]
    });
    assert_eq!(frames, images.collect::<Vec<_>>());

    // The first frame of a text is that of its start.
    let starts = operations.split(|(_, operator)| operator == "BT").skip(1);
    let starts = starts.map(|text| {
        text.iter()
            .find(|(_, operator)| operator == "Tm")
            .unwrap()
            .0
            .clone()
    });
    let length = UNITS * text_width(&drawing.look, "AV $f_{c}$ < σ^{2}", 14.0, false);
    let mut count = 0;
    for (frame, node) in starts.zip(named("text")) {
        let before = match node.attribute("text-anchor").unwrap() {
            "start" => 0.0,
            "middle" => 0.5 * length,
            _ => length,
        };
        let (x, y) = (number(node, "x"), number(node, "y"));
        let expected = match node.attribute("transform").map(numbers) {
            None => vec![1.0, 0.0, 0.0, -1.0, x - before, y],
            // About the point (a, b) what lies right of it goes up, and what lies below it to the right.
            Some(turn) => {
                let (a, b) = (turn[1], turn[2]);
                vec![0.0, -1.0, -1.0, 0.0, a + (y - b), b - (x - before - a)]
            }
        };
        let far = frame
            .iter()
            .zip(&expected)
            .map(|(one, other)| (one - other).abs());
        assert!(far.fold(0.0, f64::max) < 1e-3, "{frame:?} {expected:?}");
        count += 1;
    }
    assert_eq!(count, 6);
}

/// The pixels of a drawing, and the box of those that are not white: left, right, top and bottom.
fn ink(drawing: &Drawing) -> (impl Fn(f64, f64) -> [u8; 3] + use<>, [f64; 4]) {
    let file = raster::png(drawing).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(file))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.width, info.height), drawing.size);
    let width = info.width as usize;
    let mut inked = [f64::INFINITY, 0.0, f64::INFINITY, 0.0];
    for (place, pixel) in bytes.chunks(3).enumerate() {
        if pixel.iter().any(|&value| value < 128) {
            let (x, y) = ((place % width) as f64, (place / width) as f64);
            inked = [
                inked[0].min(x),
                inked[1].max(x + 1.0),
                inked[2].min(y),
                inked[3].max(y + 1.0),
            ];
        }
    }
    let at = move |x: f64, y: f64| {
        let place = 3 * (y as usize * width + x as usize);
        [bytes[place], bytes[place + 1], bytes[place + 2]]
    };
    (at, inked)
}

fn assert_near(found: [f64; 4], expected: [f64; 4]) {
    let far = found
        .iter()
        .zip(&expected)
        .map(|(one, other)| (one - other).abs());
    assert!(far.fold(0.0, f64::max) <= 1.0, "{found:?}, {expected:?}");
}

/// The box of a path's corners.
fn corners(path: &[[f64; 2]], beyond: f64) -> [f64; 4] {
    let by = |axis: usize| path.iter().map(move |corner| corner[axis]);
    let least = |axis| by(axis).fold(f64::INFINITY, f64::min) - beyond;
    let most = |axis| by(axis).fold(0.0, f64::max) + beyond;
    [least(0), most(0), least(1), most(1)]
}

#[test]
fn pixels_are_where_the_svg_says() {
    let around = [
        (10.0, 10.0),
        (41.3, 10.0),
        (41.3, 22.2),
        (10.0, 22.2),
        (10.0, 10.0),
    ];
    let shapes = [
        (&around[..], Shape::Line(Stroke::solid(RED, 2.0))),
        (&around[..4], Shape::Area(RED)),
        (&around[..1], Shape::Dot(5.0, INK, Stroke::solid(RED, 2.0))),
    ];
    for (points, shape) in shapes {
        let drawing = drawn(points, shape);
        let text = svg::svg(&drawing);
        let document = Document::parse(&text).unwrap();
        let widths = document
            .descendants()
            .filter_map(|node| node.attribute("stroke-width")?.parse().ok());
        let beyond = 0.5 * widths.fold(0.0, f64::max);
        let (at, inked) = ink(&drawing);
        assert_near(inked, corners(&paths_of_svg(&document)[0], beyond));
        assert_eq!(
            at(inked[0] + 5.0, 0.5 * (inked[2] + inked[3])),
            [214, 20, 20]
        );
        assert_eq!(at(3.0, 3.0), [255; 3]);
    }
}

#[test]
fn dashes_opacity_and_gaps_of_pictures_are_drawn() {
    let dashed = Stroke::solid(BLACK.at(0.4), 2.0).dashed(&[4.0, 2.0]);
    let (at, _) = ink(&drawn(&[(10.0, 10.0), (40.0, 10.0)], Shape::Line(dashed)));
    for (along, expected) in [(2.0, 153), (3.9, 153), (4.1, 255), (5.9, 255), (6.1, 153)] {
        assert_eq!(
            at(UNITS * (10.0 + along), UNITS * 10.0),
            [expected; 3],
            "{along}"
        );
    }
    let picture = Picture::patches((2, 1), &[(1, 2, 3), (7, 8, 9)], |column, _| column);
    let (at, inked) = ink(&drawn(&[(30.0, 20.0), (10.0, 30.0)], Shape::Image(picture)));
    assert_eq!(inked, [200.0, 600.0, 400.0, 600.0]);
    assert_eq!([at(399.0, 500.0), at(401.0, 500.0)], [[1, 2, 3], [7, 8, 9]]);
    let picture = Picture::new(&Look::default(), (2, 1), |column, _| {
        (column == 1).then_some(0.0)
    });
    let (at, _) = ink(&drawn(&[(30.0, 20.0), (10.0, 30.0)], Shape::Image(picture)));
    assert_eq!(at(399.0, 500.0), [255; 3]);
    assert_ne!(at(401.0, 500.0), [255; 3]);
}

#[test]
fn letters_have_the_size_and_the_place_of_the_font() {
    // An H of DejaVu Sans: an advance of 1540, from 201 to 1339 along the line, 1493 high, of 2048 units an em.
    let size = 14.0 * UNITS;
    let [advance, from, to, high] =
        [1540.0, 201.0, 1339.0, 1493.0].map(|units| units * size / 2048.0);
    let (x, y) = (UNITS * 30.0, UNITS * 20.0);
    let below = 0.365 * size;
    for (anchor, before) in [(HPos::Left, 0.0), (HPos::Center, 0.5), (HPos::Right, 1.0)] {
        let start = -before * advance;
        let mut text = lettering("H", anchor);
        let (_, inked) = ink(&drawn(&[(30.0, 20.0)], Shape::Text(text.clone())));
        assert_near(
            inked,
            [
                x + start + from,
                x + start + to,
                y + below - high,
                y + below,
            ],
        );
        text.upward = true;
        let (_, inked) = ink(&drawn(&[(30.0, 20.0)], Shape::Text(text)));
        assert_near(
            inked,
            [
                x + below - high,
                x + below,
                y - start - to,
                y - start - from,
            ],
        );
    }
    // A raised H is 0.72 as high and stands 0.36 em higher.
    let (_, inked) = ink(&drawn(
        &[(30.0, 20.0)],
        Shape::Text(lettering("^{H}", HPos::Left)),
    ));
    let line = y + below - 0.36 * size;
    assert_near(
        inked,
        [x + 0.72 * from, x + 0.72 * to, line - 0.72 * high, line],
    );
}
