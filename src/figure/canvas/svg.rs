//! A drawing as SVG: lengths are units, and the `viewBox` scales them.

use std::fmt::Write as _;

use plotters_backend::BackendCoord;

use super::drawing::{Anchor, Drawing, Element, Ink, Pen, Text};
use super::heat::Picture;
use super::letters::Span;
use super::style::UNITS;

/// A drawing as an SVG document; equal drawings give equal bytes.
pub(crate) fn svg(drawing: &Drawing) -> String {
    let (width, height) = drawing.size;
    let look = &drawing.look;
    let length = |units: u32| {
        let pixels = f64::from(units) / UNITS;
        if look.is_usual_size() {
            pixels.to_string()
        } else {
            format!("{:.4}mm", look.millimetres(pixels))
        }
    };
    let mut written = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{}\" \
         xml:space=\"preserve\">\n<rect width=\"{width}\" height=\"{height}\"{}/>\n",
        length(width),
        length(height),
        look.typeface.families(),
        paint("fill", drawing.paper()),
    );
    for one in &drawing.elements {
        written.push_str(&element(one));
        written.push('\n');
    }
    written.push_str("</svg>\n");
    written
}

fn element(element: &Element) -> String {
    match element {
        Element::Line(line, pen) => {
            let dash: Vec<String> = pen.dash.iter().map(i64::to_string).collect();
            let dash = match dash.as_slice() {
                [] => String::new(),
                parts => format!(" stroke-dasharray=\"{}\"", parts.join(" ")),
            };
            format!(
                "<polyline{} fill=\"none\"{} stroke-linejoin=\"round\"{dash}/>",
                points(line),
                stroke(pen),
            )
        }
        Element::Area(area, ink) => format!("<polygon{}{}/>", points(area), paint("fill", *ink)),
        Element::Facets(facets, ink) => {
            let path: String = facets.iter().map(|facet| outline(facet)).collect();
            format!("<path d=\"{path}\"{}/>", paint("fill", *ink))
        }
        Element::Disc((x, y), radius, inside, rim) => format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{}{}/>",
            paint("fill", *inside),
            stroke(rim)
        ),
        Element::Image(corner, size, picture) => image(*corner, *size, picture),
        Element::Text(line) => text(line),
    }
}

/// A colour as a property, with opacity where it is not one.
fn paint(
    property: &str,
    Ink {
        rgb: (r, g, b),
        alpha,
    }: Ink,
) -> String {
    if alpha < 1.0 {
        return format!(" {property}=\"#{r:02x}{g:02x}{b:02x}\" {property}-opacity=\"{alpha}\"");
    }
    format!(" {property}=\"#{r:02x}{g:02x}{b:02x}\"")
}

fn stroke(pen: &Pen) -> String {
    format!(
        "{} stroke-width=\"{}\"",
        paint("stroke", pen.ink),
        pen.width
    )
}

fn points(points: &[BackendCoord]) -> String {
    let pairs: Vec<String> = points.iter().map(|(x, y)| format!("{x},{y}")).collect();
    format!(" points=\"{}\"", pairs.join(" "))
}

/// A polygon as part of a path, in steps from corner to corner.
fn outline(corners: &[BackendCoord]) -> String {
    let [first, rest @ ..] = corners else {
        return String::new();
    };
    let mut path = format!("M{} {}", first.0, first.1);
    let mut last = *first;
    for (number, &corner) in rest.iter().enumerate() {
        let steps = [corner.0 - last.0, corner.1 - last.1];
        for (part, step) in steps.into_iter().enumerate() {
            let leads = number == 0 && part == 0;
            // A sign separates numbers, and nothing follows a letter.
            let gap = if leads || step < 0 { "" } else { " " };
            let lead = if leads { "l" } else { "" };
            let _ = write!(path, "{lead}{gap}{step}");
        }
        last = corner;
    }
    path.push('z');
    path
}

/// A picture stretched over a rectangle, its pixels kept as crisp cells.
fn image((x, y): BackendCoord, (width, height): (u32, u32), picture: &Picture) -> String {
    format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>",
        base64(&picture.png())
    )
}

fn base64(bytes: &[u8]) -> String {
    use base64::Engine as _;
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

fn text(text: &Text) -> String {
    let (x, y) = text.at;
    let anchor = match text.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let turn = if text.is_upward {
        format!(" transform=\"rotate(-90 {x} {y})\"")
    } else {
        String::new()
    };
    let weight = if text.line.is_bold {
        " font-weight=\"bold\""
    } else {
        ""
    };
    format!(
        "<text x=\"{x}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\"{weight}{}{turn}>{}</text>",
        y + text.below,
        text.line.size,
        paint("fill", text.ink),
        spans(&text.line.spans)
    )
}

/// Lettering as `<tspan>`s. Raising is written as `dy`, which every program understands, unlike `baseline-shift`.
fn spans(spans: &[Span]) -> String {
    let mut written = String::new();
    let mut shift = 0;
    for span in spans {
        let mut attributes = String::new();
        if span.shift != shift {
            let _ = write!(attributes, " dy=\"{}\"", span.shift - shift);
        }
        if let Some(size) = span.size {
            let _ = write!(attributes, " font-size=\"{size}\"");
        }
        if span.is_slanted {
            attributes.push_str(" font-style=\"oblique\"");
        }
        shift = span.shift;
        let letters = escape(&span.letters);
        if attributes.is_empty() {
            written.push_str(&letters);
        } else {
            let _ = write!(written, "<tspan{attributes}>{letters}</tspan>");
        }
    }
    written
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::canvas::letters::Line;

    #[test]
    fn lowered_text_returns_to_the_line() {
        let expected = "<tspan font-style=\"oblique\">f</tspan><tspan dy=\"61\" font-size=\"202\">c</tspan>\
                        <tspan dy=\"-61\"> &lt; 1</tspan>";
        assert_eq!(
            spans(&Line::new("$f_{c}$ < 1", 14.0, false).spans),
            expected
        );
    }

    #[test]
    fn facets_are_written_in_steps() {
        let facet = [(10, 20), (12, 15), (12, 30)];
        assert_eq!(outline(&facet), "M10 20l2-5 0 15z");
    }
}
