//! The canvas: it writes SVG.
//!
//! The coordinates of plotters are whole pixels, which would make curves stair-stepped. Here such a pixel is 1/20 of a
//! figure pixel, and the SVG's `viewBox` scales back.

use std::cell::RefCell;
use std::rc::Rc;

use base64::Engine;
use plotters_backend::BackendCoord;
use plotters_backend::text_anchor::HPos;

use super::look::Look;
use super::style::{Colour, PAPER, Stroke, UNITS};
use super::symbols::{self, Script};

/// Lettering: markup with size and place.
#[derive(Clone)]
pub(crate) struct Lettering {
    /// The text, as markup of [`symbols`].
    pub(crate) markup: String,
    /// Height of the letters' body, in pixels.
    pub(crate) size: f64,
    /// Colour.
    pub(crate) colour: Colour,
    /// Which end stands at the given point.
    pub(crate) anchor: HPos,
    /// Whether the text runs upward.
    pub(crate) upward: bool,
    /// Whether it is bold.
    pub(crate) bold: bool,
}

/// What is drawn at one or several points.
#[derive(Clone)]
pub(crate) enum Shape {
    /// A polyline through the points.
    Line(Stroke),
    /// The polygon of the points.
    Area(Colour),
    /// A disc about the first point: radius in pixels, inside, rim.
    Dot(f64, Colour, Stroke),
    /// A `+` about the first point: half its length in pixels, line.
    Plus(f64, Stroke),
    /// A PNG over the rectangle between two opposite corners.
    Image(Vec<u8>),
    /// Lettering at the first point.
    Text(Lettering),
}

/// A page that collects SVG elements. Clones share the page.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    look: Look,
    size: (u32, u32),
    elements: Rc<RefCell<String>>,
}

/// A length in canvas units, as written.
fn units(pixels: f64) -> i64 {
    (pixels * UNITS).round() as i64
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

fn points_attribute(points: &[BackendCoord]) -> String {
    let pairs: Vec<String> = points.iter().map(|(x, y)| format!("{x},{y}")).collect();
    format!(" points=\"{}\"", pairs.join(" "))
}

impl Canvas {
    /// An empty page; size in figure pixels.
    pub(super) fn new(look: Look, width: f64, height: f64) -> Self {
        Self {
            look,
            size: (units(width).max(1) as u32, units(height).max(1) as u32),
            elements: Rc::default(),
        }
    }

    /// The page as an SVG document.
    pub(super) fn document(&self) -> String {
        let (width, height) = self.size;
        let length = |units: u32| {
            let pixels = f64::from(units) / UNITS;
            if self.look.is_usual_size() {
                pixels.to_string()
            } else {
                format!("{:.4}mm", self.look.millimetres(pixels))
            }
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{}\" \
             xml:space=\"preserve\">\n<rect width=\"{width}\" height=\"{height}\"{}/>\n{}</svg>\n",
            length(width),
            length(height),
            self.look.typeface.families(),
            self.paint("fill", PAPER),
            self.elements.borrow()
        )
    }

    /// Its size in units.
    pub(super) fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The look of everything that is drawn.
    pub(super) fn look(&self) -> &Look {
        &self.look
    }

    /// A colour as a property of SVG, with opacity where it is not one.
    fn paint(&self, property: &str, colour: Colour) -> String {
        let ((r, g, b), alpha) = self.look.resolve(colour);
        if alpha < 1.0 {
            return format!(
                " {property}=\"#{r:02x}{g:02x}{b:02x}\" {property}-opacity=\"{alpha}\""
            );
        }
        format!(" {property}=\"#{r:02x}{g:02x}{b:02x}\"")
    }

    /// The width of a line, as written.
    fn weight(&self, stroke: &Stroke) -> i64 {
        units(stroke.width * self.look.lines)
    }

    fn push(&self, element: &str) {
        let mut elements = self.elements.borrow_mut();
        elements.push_str(element);
        elements.push('\n');
    }

    /// A shape at its points; nothing without a point.
    pub(super) fn draw(&self, points: &[BackendCoord], shape: &Shape) {
        let [first @ (x, y), ..] = *points else {
            return;
        };
        match shape {
            Shape::Line(stroke) => self.line(points, stroke),
            Shape::Area(fill) => self.area(points, *fill),
            Shape::Dot(radius, fill, rim) => self.dot(first, *radius, *fill, rim),
            Shape::Plus(half, stroke) => {
                let half = (half * UNITS).round() as i32;
                self.line(&[(x - half, y), (x + half, y)], stroke);
                self.line(&[(x, y - half), (x, y + half)], stroke);
            }
            Shape::Image(png) => {
                if let [one, other] = *points {
                    self.image(one, other, png);
                }
            }
            Shape::Text(lettering) => self.text(first, lettering),
        }
    }

    /// A polyline.
    fn line(&self, points: &[BackendCoord], stroke: &Stroke) {
        let dash: Vec<String> = stroke
            .dash
            .iter()
            .map(|&part| units(part).to_string())
            .collect();
        let dash = if dash.is_empty() {
            String::new()
        } else {
            format!(" stroke-dasharray=\"{}\"", dash.join(" "))
        };
        self.push(&format!(
            "<polyline{} fill=\"none\"{} stroke-width=\"{}\" stroke-linejoin=\"round\"{dash}/>",
            points_attribute(points),
            self.paint("stroke", stroke.colour),
            self.weight(stroke)
        ));
    }

    /// A filled polygon.
    fn area(&self, points: &[BackendCoord], fill: Colour) {
        let points = points_attribute(points);
        self.push(&format!("<polygon{points}{}/>", self.paint("fill", fill)));
    }

    /// Filled polygons of one colour.
    pub(super) fn facets(&self, facets: &[Vec<BackendCoord>], fill: Colour) {
        let mut path = String::new();
        for facet in facets {
            let [first, rest @ ..] = facet.as_slice() else {
                continue;
            };
            path.push_str(&format!("M{} {}", first.0, first.1));
            let mut last = *first;
            for (number, &corner) in rest.iter().enumerate() {
                let lead = if number == 0 { "l" } else { "" };
                for (part, step) in [corner.0 - last.0, corner.1 - last.1]
                    .into_iter()
                    .enumerate()
                {
                    // A sign separates numbers, and nothing follows a letter.
                    let is_apart = step < 0 || (number == 0 && part == 0);
                    let gap = if is_apart { "" } else { " " };
                    let lead = if part == 0 { lead } else { "" };
                    path.push_str(&format!("{lead}{gap}{step}"));
                }
                last = corner;
            }
            path.push('z');
        }
        self.push(&format!("<path d=\"{path}\"{}/>", self.paint("fill", fill)));
    }

    /// A disc with a rim; radius and rim in pixels.
    fn dot(&self, (x, y): BackendCoord, radius: f64, fill: Colour, rim: &Stroke) {
        self.push(&format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"{}{} stroke-width=\"{}\"/>",
            units(radius),
            self.paint("fill", fill),
            self.paint("stroke", rim.colour),
            self.weight(rim)
        ));
    }

    /// A PNG stretched over the rectangle between two corners, its pixels kept as crisp cells.
    fn image(&self, one: BackendCoord, other: BackendCoord, png: &[u8]) {
        let data = base64::engine::general_purpose::STANDARD.encode(png);
        self.push(&format!(
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{data}\"/>",
            one.0.min(other.0),
            one.1.min(other.1),
            one.0.abs_diff(other.0),
            one.1.abs_diff(other.1),
        ));
    }

    /// Lettering that is centred on the point across its direction.
    pub(super) fn text(&self, (x, y): BackendCoord, text: &Lettering) {
        let size = text.size * UNITS;
        // Half the height of DejaVu's capitals and digits (0.729 em) below the middle lies the base line.
        let below = (0.365 * size).round() as i32;
        let anchor = match text.anchor {
            HPos::Left => "start",
            HPos::Center => "middle",
            HPos::Right => "end",
        };
        let turn = if text.upward {
            format!(" transform=\"rotate(-90 {x} {y})\"")
        } else {
            String::new()
        };
        let weight = if text.bold {
            " font-weight=\"bold\""
        } else {
            ""
        };
        self.push(&format!(
            "<text x=\"{x}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\"{weight}{}{turn}>{}</text>",
            y + below,
            units(text.size),
            self.paint("fill", text.colour),
            spans(&text.markup, size)
        ));
    }
}

/// Markup as `<tspan>`s. Raising is written as `dy`, which every program understands, unlike `baseline-shift`.
fn spans(markup: &str, size: f64) -> String {
    let mut written = String::new();
    let mut shift = 0;
    for run in symbols::runs(markup) {
        let (wanted, small) = match run.script {
            Script::Base => (0, false),
            Script::Lower => ((0.22 * size) as i64, true),
            Script::Upper => ((-0.36 * size) as i64, true),
        };
        let mut attributes = String::new();
        if wanted != shift {
            attributes.push_str(&format!(" dy=\"{}\"", wanted - shift));
        }
        if small {
            attributes.push_str(&format!(" font-size=\"{}\"", (0.72 * size).round()));
        }
        if run.slanted {
            attributes.push_str(" font-style=\"oblique\"");
        }
        shift = wanted;
        let text = escape(&run.text);
        if attributes.is_empty() {
            written.push_str(&text);
        } else {
            written.push_str(&format!("<tspan{attributes}>{text}</tspan>"));
        }
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lowered_text_returns_to_the_line() {
        let spans = spans("$f_{c}$ < 1", 280.0);
        let expected = "<tspan font-style=\"oblique\">f</tspan><tspan dy=\"61\" font-size=\"202\">c</tspan>\
                        <tspan dy=\"-61\"> &lt; 1</tspan>";
        assert_eq!(spans, expected);
    }
}
