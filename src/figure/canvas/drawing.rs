//! What a page holds once it is drawn: lines, faces, discs, pictures and lettering with their places, colours and
//! weights as numbers. `svg`, `pdf` and `raster` write the same elements, each in its own language.
//!
//! Lengths are whole units, [`UNITS`](super::style::UNITS) to a figure pixel, the ordinate downward.

use plotters_backend::BackendCoord;

use super::heat::Picture;
use super::letters::{Line, Run};
use super::look::Look;
use super::style::{PAPER, UNITS};
use crate::figure::style::Typeface;

/// Points of an inch.
const POINTS_AN_INCH: f64 = 72.0;

/// A page with all that is on it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drawing {
    /// Width and height.
    pub(super) size: (u32, u32),
    /// How everything on it looks.
    pub(super) look: Look,
    /// What is on it, later elements over earlier ones.
    pub(super) elements: Vec<Element>,
}

impl Drawing {
    /// The colour of the page.
    pub(super) fn paper(&self) -> Ink {
        Ink::new(self.look.resolve(PAPER))
    }

    /// Its height in figure pixels.
    pub(crate) fn height(&self) -> f64 {
        f64::from(self.size.1) / UNITS
    }

    /// Makes the page so many figure pixels high, with what is on it in the middle; nothing where it is as high.
    pub(crate) fn centre(&mut self, height: f64) {
        let wanted = (height * UNITS).round() as u32;
        if wanted <= self.size.1 {
            return;
        }
        let down = ((wanted - self.size.1) / 2) as i32;
        self.size.1 = wanted;
        for element in &mut self.elements {
            element.move_down(down);
        }
    }

    /// Points of a unit.
    pub(super) fn points(&self) -> f64 {
        self.look.points / UNITS
    }

    /// Pixels of a PNG in a unit.
    pub(super) fn pixels(&self) -> f64 {
        self.points() / POINTS_AN_INCH * self.look.dpi
    }
}

/// What is on a page.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Element {
    /// A polyline.
    Line(Vec<BackendCoord>, Pen),
    /// A filled polygon.
    Area(Vec<BackendCoord>, Ink),
    /// Filled polygons of one colour, drawn as one.
    Facets(Vec<Vec<BackendCoord>>, Ink),
    /// A disc with a rim: centre, radius, inside, rim.
    Disc(BackendCoord, i64, Ink, Pen),
    /// A picture over a rectangle with this upper left corner, width and height, its pixels kept as crisp cells.
    Image(BackendCoord, (u32, u32), Picture),
    /// A line of lettering.
    Text(Text),
}

impl Element {
    /// Moves it by so many units.
    fn move_down(&mut self, by: i32) {
        match self {
            Self::Line(points, _) | Self::Area(points, _) => {
                points.iter_mut().for_each(|point| point.1 += by);
            }
            Self::Facets(facets, _) => {
                let points = facets.iter_mut().flatten();
                points.for_each(|point| point.1 += by);
            }
            Self::Disc(at, ..) | Self::Image(at, ..) => at.1 += by,
            Self::Text(text) => text.at.1 += by,
        }
    }
}

/// A colour with its opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ink {
    /// Red, green, blue.
    pub(super) rgb: (u8, u8, u8),
    /// Opacity, 1 for a cover.
    pub(super) alpha: f64,
}

impl Ink {
    pub(super) fn new((rgb, alpha): ((u8, u8, u8), f64)) -> Self {
        Self { rgb, alpha }
    }
}

/// How a line is drawn: butt ends, round joints.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pen {
    /// Its colour.
    pub(super) ink: Ink,
    /// Its width.
    pub(super) width: i64,
    /// Lengths of dashes and gaps by turns, as many of these as of those; empty for a solid line.
    pub(super) dash: Vec<i64>,
}

/// A line of lettering on a page.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Text {
    /// The point it belongs to, about which it is turned.
    pub(super) at: BackendCoord,
    /// How far its base line lies below that point.
    pub(super) below: i32,
    /// Which part of it stands at the point.
    pub(super) anchor: Anchor,
    /// Whether it runs upward, turned by a quarter.
    pub(super) is_upward: bool,
    /// Its colour.
    pub(super) ink: Ink,
    /// Its letters.
    pub(super) line: Line,
}

/// Which part of a line of lettering stands at its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Text {
    /// Its glyphs, each run with its frame on the page: the origin is where the run starts on its base line, the axes
    /// are the directions of the letters, to the right and up. `[a, b, c, d, e, f]` leads from (u, v) in the frame to
    /// (a u + c v + e, b u + d v + f) on the page.
    pub(super) fn runs(&self, typeface: Typeface) -> impl Iterator<Item = ([f64; 6], Run)> {
        let (runs, length) = self.line.lay_out(typeface);
        let before = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * length,
            Anchor::End => length,
        };
        let (x, y) = (f64::from(self.at.0), f64::from(self.at.1));
        let frame = move |run: &Run| {
            let (along, below) = (run.start - before, f64::from(self.below) + run.shift);
            if self.is_upward {
                [0.0, -1.0, -1.0, 0.0, x + below, y - along]
            } else {
                [1.0, 0.0, 0.0, -1.0, x + along, y + below]
            }
        };
        runs.into_iter().map(move |run| (frame(&run), run))
    }
}

/// A circle as four arcs, each its end after two points that it bends toward, from the place right of the centre.
pub(super) fn arcs((x, y): BackendCoord, radius: i64) -> [[(f64, f64); 3]; 4] {
    /// An arc of a quarter leaves the radius by 3e-4 at most with points this far along its tangents.
    const BEND: f64 = 0.552_284_749_8;
    let (x, y, r) = (f64::from(x), f64::from(y), radius as f64);
    [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(|(u, v): (f64, f64)| {
        let at = |along: f64, across: f64| {
            (
                x + r * (along * u - across * v),
                y + r * (along * v + across * u),
            )
        };
        [at(1.0, BEND), at(BEND, 1.0), at(0.0, 1.0)]
    })
}
