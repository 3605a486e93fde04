//! The canvas: it takes shapes at places down as a [`Drawing`].
//!
//! The coordinates of plotters are whole pixels, which would make curves stair-stepped. Here such a pixel is 1/20 of a
//! figure pixel; what writes a drawing scales back.

use std::cell::RefCell;
use std::rc::Rc;

use plotters_backend::BackendCoord;
use plotters_backend::text_anchor::HPos;

use super::drawing::{Anchor, Drawing, Element, Ink, Pen, Text};
use super::heat::Picture;
use super::letters::Line;
use super::look::Look;
use super::style::{Colour, Stroke, UNITS};

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
    /// A picture over the rectangle between two opposite corners.
    Image(Picture),
    /// Lettering at the first point.
    Text(Lettering),
}

/// A page that collects what is drawn. Clones share the page.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    look: Look,
    size: (u32, u32),
    elements: Rc<RefCell<Vec<Element>>>,
}

/// A length in canvas units.
fn units(pixels: f64) -> i64 {
    (pixels * UNITS).round() as i64
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

    /// What was drawn on the page.
    pub(super) fn drawing(&self) -> Drawing {
        Drawing {
            size: self.size,
            look: self.look,
            elements: self.elements.borrow().clone(),
        }
    }

    /// Its size in units.
    pub(super) fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The look of everything that is drawn.
    pub(super) fn look(&self) -> &Look {
        &self.look
    }

    fn ink(&self, colour: Colour) -> Ink {
        Ink::new(self.look.resolve(colour))
    }

    fn pen(&self, stroke: &Stroke) -> Pen {
        Pen {
            ink: self.ink(stroke.colour),
            width: units(stroke.width * self.look.lines),
            dash: stroke.dash.iter().map(|&part| units(part)).collect(),
        }
    }

    fn push(&self, element: Element) {
        self.elements.borrow_mut().push(element);
    }

    /// A shape at its points; nothing without a point.
    pub(super) fn draw(&self, points: &[BackendCoord], shape: &Shape) {
        let [first @ (x, y), ..] = *points else {
            return;
        };
        match shape {
            Shape::Line(stroke) => self.line(points, stroke),
            Shape::Area(fill) => self.push(Element::Area(points.to_vec(), self.ink(*fill))),
            Shape::Dot(radius, fill, rim) => self.push(Element::Disc(
                first,
                units(*radius),
                self.ink(*fill),
                self.pen(rim),
            )),
            Shape::Plus(half, stroke) => {
                let half = (half * UNITS).round() as i32;
                self.line(&[(x - half, y), (x + half, y)], stroke);
                self.line(&[(x, y - half), (x, y + half)], stroke);
            }
            Shape::Image(picture) => {
                if let [one, other] = *points {
                    let corner = (one.0.min(other.0), one.1.min(other.1));
                    let size = (one.0.abs_diff(other.0), one.1.abs_diff(other.1));
                    self.push(Element::Image(corner, size, picture.clone()));
                }
            }
            Shape::Text(lettering) => self.text(first, lettering),
        }
    }

    fn line(&self, points: &[BackendCoord], stroke: &Stroke) {
        self.push(Element::Line(points.to_vec(), self.pen(stroke)));
    }

    /// Filled polygons of one colour.
    pub(super) fn facets(&self, facets: Vec<Vec<BackendCoord>>, fill: Colour) {
        self.push(Element::Facets(facets, self.ink(fill)));
    }

    /// Lettering that is centred on the point across its direction.
    fn text(&self, at: BackendCoord, text: &Lettering) {
        self.push(Element::Text(Text {
            at,
            // Half the height of DejaVu's capitals and digits (0.729 em) below the middle lies the base line.
            below: (0.365 * text.size * UNITS).round() as i32,
            anchor: match text.anchor {
                HPos::Left => Anchor::Start,
                HPos::Center => Anchor::Middle,
                HPos::Right => Anchor::End,
            },
            is_upward: text.upward,
            ink: self.ink(text.colour),
            line: Line::new(&text.markup, text.size, text.bold),
        }));
    }
}
