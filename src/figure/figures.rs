//! The figures of a sweep, a comparison, a map, curves or a friction law as values: listed by name, drawn one by one or
//! all.

use rayon::prelude::*;

use super::FigureError;
use super::canvas::drawing::Drawing;
use super::canvas::{pdf, raster, svg};
use super::kinds::{self, Sketch, Sweep};
use super::parts::names;
use super::style::FigureStyle;
use crate::compare::Comparison;
use crate::continuation::SweepResult;
use crate::continuation::curve::{Curve, CurveOrigin, SweepInPlane};
use crate::continuation::map::RegimeMap;
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::Page;
use crate::system::{Family, Model, ParameterValues};

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

/// The figures that can be drawn of a sweep, a comparison, a map, curves or a friction law. Nothing is drawn before it
/// is asked for, and no file is written: see [`write_figures`](super::write_figures). A title (plain text, may be
/// empty) stands above each.
pub struct Figures<'a> {
    sketches: Vec<Sketch<'a>>,
    /// What their names may begin with, whether there is such a figure or not.
    kinds: Vec<&'static str>,
    print: Print<'a>,
}

impl<'a> Figures<'a> {
    fn new(title: &'a str, sketches: Vec<Sketch<'a>>) -> Self {
        let look = FigureStyle::default().look();
        Self {
            sketches,
            kinds: Vec::new(),
            print: Print {
                title,
                look,
                part: (0, 1),
            },
        }
    }

    /// The figures of a sweep: a diagram an observed marginal (`diagram_x`), the marginals at the parameter values
    /// `at`, overlaid (`marginals`), an observed pair's joint densities at these values, all on one sheet
    /// (`joint_xy`) and each (`joint_xy_-0.5`), and more.
    ///
    /// For each value in `at` the nearest computed point is taken; points without densities are not drawn.
    pub fn of_sweep(result: &'a SweepResult, title: &'a str, at: &[f64]) -> Self {
        let sweep = Sweep::new(result, at);
        let kinds = kinds::OF_SWEEPS.iter();
        let sketches = kinds.clone().flat_map(|kind| (kind.sketches)(&sweep));
        Self {
            kinds: kinds.flat_map(|kind| kind.names).copied().collect(),
            ..Self::new(title, sketches.collect())
        }
    }

    /// The figures of a comparison of methods: marginals by every method (`marginals`), joint densities side by side
    /// (`joint_xy`), and the error against time (`time_to_accuracy`).
    pub fn of_comparison(comparison: &'a Comparison, title: &'a str) -> Self {
        let kinds = kinds::OF_COMPARISONS.iter();
        Self::new(title, kinds.flat_map(|kind| kind(comparison)).collect())
    }

    /// The figures of a map of regimes: one an observable, `map_x` or `map_xy`. What `sweeps` over one of the
    /// parameters located is marked.
    pub fn of_map(map: &'a RegimeMap, sweeps: &'a [SweepInPlane], title: &'a str) -> Self {
        Self::new(title, kinds::map::sketches(map, sweeps))
    }

    /// The figure `curve` of curves in one plane, the first of which was begun at a row of a sweep over its first
    /// parameter; none without a curve. What `sweeps` over one of the parameters located is marked. `family` gives
    /// names and symbols.
    pub fn of_curves(
        curves: &'a [Curve],
        (row, sweeps): (&'a CurveOrigin, &'a [SweepInPlane]),
        family: &'a Family,
        title: &'a str,
    ) -> Self {
        Self::new(title, kinds::curve::sketches(curves, (row, sweeps), family))
    }

    /// The figure `friction_NAME` of a model with a friction law: left the force against the velocity, sliding steadily
    /// and pulled to and fro; right the same loops against the displacement. None of a model without a friction law, or
    /// with one that exerts no force with these values.
    pub fn of_friction(model: &'a Model, values: &'a ParameterValues, title: &'a str) -> Self {
        Self::new(title, kinds::friction::sketches(model, values))
    }

    /// The same figures in a style of their own.
    pub fn with_style(mut self, style: &FigureStyle) -> Self {
        self.print.look = style.look();
        self
    }

    /// Names of all figures, in their order. Some may turn out to have nothing to show.
    pub fn names(&self) -> Vec<String> {
        let sketches = self.sketches.iter();
        sketches.map(|sketch| sketch.name.clone()).collect()
    }

    /// The kinds of figures of a sweep, whether it has such a figure or not: what names begin with.
    pub fn kinds(&self) -> &[&'static str] {
        &self.kinds
    }

    /// Draws the figure of that name and no other: nothing where no density is there to draw, several pages
    /// (`pairs_xy_1`, `pairs_xy_2`) where one has no room for all of its panels.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] for a name that is not one of [`Figures::names`].
    pub fn draw(&self, name: &str) -> Result<Vec<Figure>, FigureError> {
        match self.sketches.iter().find(|sketch| sketch.name == name) {
            Some(sketch) => Ok(sketch.draw(&self.print)),
            None => Err(FigureError::Unknown {
                name: name.to_owned(),
                known: self.names(),
            }),
        }
    }

    /// Refuses words that name no figure there is; a kind may have none.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] with the first of them.
    pub fn check<S: AsRef<str>>(&self, words: &[S]) -> Result<(), FigureError> {
        let is_known = |word: &&str| {
            let mut sketches = self.sketches.iter();
            self.kinds.contains(word) || sketches.any(|one| names::matches(word, &one.name))
        };
        let mut words = words.iter().map(AsRef::as_ref);
        match words.find(|word| *word != "all" && !is_known(word)) {
            None => Ok(()),
            Some(name) => Err(FigureError::Unknown {
                name: name.to_owned(),
                known: self.names(),
            }),
        }
    }

    /// Draws the figures that some words name, in their order: a word is a whole name, the beginning of names up to a
    /// `_` (`joint` names `joint_xy_0.5`), or `all`. Those without any density are left out, and words that name none
    /// are passed over. One that has no room on a page has several, `…_1`, `…_2`.
    pub fn draw_named<S: AsRef<str>>(&self, words: &[S]) -> Vec<Figure> {
        let is_wanted = |sketch: &&Sketch<'_>| {
            let mut words = words.iter().map(AsRef::as_ref);
            words.any(|word| names::matches(word, &sketch.name))
        };
        let wanted: Vec<&Sketch<'_>> = self.sketches.iter().filter(is_wanted).collect();
        let drawn = wanted.par_iter().map(|sketch| sketch.draw(&self.print));
        drawn.flatten().collect()
    }

    /// Draws all figures, in their order; those without any density are left out.
    pub fn draw_all(&self) -> Vec<Figure> {
        self.draw_named(&["all"])
    }
}
