//! What figures are drawn from, and figures that are not drawn yet.

use super::canvas::DrawError;
use super::canvas::look::Look;
use super::canvas::page::Page;
use super::told::Shows;
use crate::compare::Comparison;
use crate::continuation::{Point, SweepResult};
use crate::system::Family;

/// What the figures of a sweep are drawn from.
pub(super) struct SweepScene<'a> {
    /// The points with what was found in them.
    pub(super) result: &'a SweepResult,
    /// Stands above each figure; plain text, may be empty.
    pub(super) title: &'a str,
    /// How it looks.
    pub(super) look: Look,
    /// The points at which marginals and joint densities are drawn.
    pub(super) chosen: Vec<&'a Point>,
}

impl<'a> SweepScene<'a> {
    /// The systems that were swept.
    pub(super) fn family(&self) -> &'a Family {
        &self.result.subject.family
    }
}

/// What the figures of a comparison of methods are drawn from.
pub(super) struct ComparisonScene<'a> {
    /// What was found.
    pub(super) comparison: &'a Comparison,
    /// Stands above each figure; plain text, may be empty.
    pub(super) title: &'a str,
    /// How it looks.
    pub(super) look: Look,
}

impl<'a> ComparisonScene<'a> {
    /// The systems of which some were compared.
    pub(super) fn family(&self) -> &'a Family {
        &self.comparison.subject.family
    }
}

/// Draws a figure; gives `None` where there is nothing to see.
type Draw<'a> = dyn Fn() -> Result<Option<Page>, DrawError> + 'a;

/// A figure that is not drawn yet.
pub(super) struct Sketch<'a> {
    /// Its name: that of its file without the extension.
    pub(super) name: String,
    draw: Box<Draw<'a>>,
    /// What it shows.
    pub(super) shows: Shows<'a>,
}

impl<'a> Sketch<'a> {
    /// A figure of that name, which `draw` draws.
    pub(super) fn new(
        name: impl Into<String>,
        draw: impl Fn() -> Result<Option<Page>, DrawError> + 'a,
    ) -> Self {
        Self {
            name: name.into(),
            draw: Box::new(draw),
            shows: Shows::Nothing,
        }
    }

    /// The same figure, which shows this.
    pub(super) fn showing(self, shows: Shows<'a>) -> Self {
        Self { shows, ..self }
    }

    /// Draws it; `None` where there is nothing to see.
    ///
    /// # Errors
    /// [`DrawError`].
    pub(super) fn draw(&self) -> Result<Option<Page>, DrawError> {
        (self.draw)()
    }
}
