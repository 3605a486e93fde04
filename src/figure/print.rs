//! A figure as a value, written as SVG, PNG and PDF, and how figures are printed.

use super::FigureError;
use super::canvas::drawing::Drawing;
use super::canvas::look::Look;
use super::canvas::page::Page;
use super::canvas::{pdf, raster, svg};

/// A figure: a drawing with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of its file without the extension, such as `diagram_x`.
    pub name: String,
    /// What is to be printed below it: what is seen, of which system, by which method, what is marked.
    pub caption: String,
    /// The numbers it was drawn from, as CSV with a header.
    pub data: String,
    /// Panels that may stand on further pages where one has no room for all.
    panels: usize,
    drawing: Drawing,
}

impl Figure {
    /// A page with its caption and its numbers; the sketch gives it its name.
    pub(super) fn new(page: &Page, caption: String, data: String) -> Self {
        Self {
            name: String::new(),
            caption,
            data,
            panels: 1,
            drawing: page.drawing(),
        }
    }

    /// The same, of so many panels in all, of which [`Print::share`] says those that stand on one page.
    pub(super) fn of_panels(self, panels: usize) -> Self {
        Self { panels, ..self }
    }

    /// Panels that may stand on further pages.
    pub(super) fn panels(&self) -> usize {
        self.panels
    }

    /// Its height, in figure pixels.
    pub(super) fn height(&self) -> f64 {
        self.drawing.height()
    }

    /// The same in the middle of a page of that height, where it is lower.
    pub(super) fn on_page(mut self, height: f64) -> Self {
        self.drawing.centre(height);
        self
    }

    /// The figure as an SVG document. Heat maps are embedded pictures; equal results give equal bytes.
    pub fn svg(&self) -> String {
        svg::svg(&self.drawing)
    }

    /// The figure as a PNG: 8-bit RGB, with as many pixels to the inch as its style says, which is written into it.
    ///
    /// # Errors
    /// [`FigureError::Raster`] where that are more than memory holds.
    pub fn png(&self) -> Result<Vec<u8>, FigureError> {
        raster::png(&self.drawing)
    }

    /// The figure as a PDF of one page, in its size, with its fonts embedded and its text as text; its name is the
    /// title, its caption the subject and what stands for the figure where a program reads it aloud. Equal figures give
    /// equal bytes.
    pub fn pdf(&self) -> Vec<u8> {
        pdf::pdf(&self.drawing, &self.name, &self.caption)
    }
}

/// How figures are printed: what stands above each, and how they look.
pub(super) struct Print<'a> {
    /// Plain text, may be empty.
    pub(super) title: &'a str,
    /// Of a plane: by which method and on which cells it was solved, as captions have it; may be empty.
    pub(super) solved_by: String,
    /// Which axes modes carry, as captions have it; may be empty.
    pub(super) modes: String,
    pub(super) look: Look,
    /// Which of how many pages, counted from zero.
    pub(super) part: (usize, usize),
}

impl Print<'_> {
    /// Those of so many panels that stand on this page: about as many as on the others, in their order.
    pub(super) fn share(&self, panels: usize) -> std::ops::Range<usize> {
        let (number, pages) = self.part;
        number * panels / pages..(number + 1) * panels / pages
    }
}
