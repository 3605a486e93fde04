//! The colour bar beside a heat map.

use plotters_backend::text_anchor::HPos;

use super::frame::{self, Scale};
use super::heat::Picture;
use super::letters;
use super::look::{DECADES, Look, on_heat};
use super::page::{Page, Rectangle, Shape, lettering};
use super::style::{Stroke, TEXT};

/// Width of the bar, in pixels.
const WIDTH: f64 = 13.0;
/// Gap between map and bar.
const GAP: f64 = 14.0;

/// A colour bar from zero, or from the floor of logarithmic colours, to a largest value, laid out.
pub(crate) struct ColourBar {
    scale: Scale,
    title_width: f64,
}

impl ColourBar {
    /// Lays out a bar of the given height; the title (markup) stands above it.
    pub(crate) fn new(look: &Look, largest: f64, height: f64, title: &str) -> Self {
        let scale = if look.is_logarithmic && largest > 0.0 {
            let top = largest.log10();
            Scale::logarithmic(look, (top - DECADES, top), height, title)
        } else {
            Scale::vertical(look, (0.0, largest), height, title)
        };
        let title_width = letters::text_width(look, scale.title(), TEXT, false);
        Self { scale, title_width }
    }

    /// Room it takes to the right of a map.
    pub(crate) fn width(&self) -> f64 {
        GAP + (WIDTH + self.scale.label_width()).max(self.title_width)
    }

    /// Room it takes above the map.
    pub(crate) fn above() -> f64 {
        2.0 * TEXT
    }

    /// Draws it right of `map`, with marks at some shares (0 to 1) of the largest value.
    pub(crate) fn draw(&self, page: &Page, map: Rectangle, marks: &[f64]) {
        let bar = Rectangle {
            left: map.right() + GAP,
            width: WIDTH,
            ..map
        };
        let ramp = Picture::ramp(page.look());
        let corners = [(bar.left, bar.top), (bar.right(), bar.bottom())];
        page.draw(&corners, Shape::Image(ramp));
        for &share in marks {
            let y = bar.bottom() - page.look().along_colours(share) * bar.height;
            let stroke = Stroke::solid(on_heat(page.look(), share), 1.0);
            page.draw(&[(bar.left, y), (bar.right(), y)], Shape::Line(stroke));
        }
        frame::border(page, bar);
        self.scale.draw_right(page, bar);
        let above = (bar.left, bar.top - 1.15 * TEXT);
        page.text(above, lettering(self.scale.title(), HPos::Left));
    }
}
