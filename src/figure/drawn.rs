//! The figures of a sweep or a comparison as values: listed by name, drawn one by one or all.

use super::canvas::page::Page;
use super::canvas::{DrawError, pdf, render};
use super::select;
use super::sketch::{ComparisonScene, Sketch, SweepScene};
use super::style::FigureStyle;
use super::{
    FigureError, compared_joint, compared_marginals, diagram, health, homology, indicator, joint,
    marginals, pairs, peaks, section, surface, time_to_accuracy,
};
use super::{caption, compared_told, data};
use crate::compare::Comparison;
use crate::continuation::{CellCheck, Subject, SweepResult};
use crate::density::Observable;
use crate::system::Family;

/// The kinds of figures of a sweep, in the order in which they are drawn: a new kind is one line here.
const OF_SWEEPS: [for<'a> fn(&'a SweepScene<'a>) -> Vec<Sketch<'a>>; 10] = [
    diagram::sketches,
    marginals::sketches,
    joint::sketches,
    surface::sketches,
    pairs::sketches,
    section::sketches,
    peaks::sketches,
    indicator::sketches,
    homology::sketches,
    health::sketches,
];

/// The kinds of figures of a comparison.
const OF_COMPARISONS: [for<'a> fn(&'a ComparisonScene<'a>) -> Vec<Sketch<'a>>; 3] = [
    compared_marginals::sketches,
    compared_joint::sketches,
    time_to_accuracy::sketches,
];

/// The kinds of figures of a sweep: what the names of all figures of a kind begin with.
pub const KINDS: [&str; 12] = [
    "diagram",
    "marginals",
    "joint",
    "multiples",
    "surface",
    "pairs",
    "section",
    "conditional",
    "peaks",
    "indicator",
    "homology",
    "health",
];
/// The kinds that are drawn where none is named.
pub const USUAL_KINDS: [&str; 3] = ["diagram", "marginals", "joint"];

/// Whether a word names a figure: its whole name, the beginning of it up to a `_` (`joint` names `joint_xy_0.5`), or
/// `all`.
pub fn matches_figure(word: &str, figure: &str) -> bool {
    let rest = figure.strip_prefix(word);
    word == "all" || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
}

/// Names of the figures that a sweep can have at no value in particular.
pub fn sweep_figures(family: &Family, observables: &[Observable]) -> Vec<String> {
    let nothing = SweepResult {
        subject: Subject {
            family: family.clone(),
            observables: observables.to_vec(),
            measures: Vec::new(),
            cell_check: CellCheck::Needless,
        },
        points: Vec::new(),
        labels: Vec::new(),
        checks: Default::default(),
        interrupted: false,
    };
    Figures::of_sweep(&nothing, "", &[]).names()
}

/// A figure: an SVG document with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of its file without the extension, such as `diagram_x`.
    pub name: String,
    /// What is to be printed below it: what is seen, of which system, by which method, what is marked.
    pub caption: String,
    /// The numbers it was drawn from, as CSV with a header.
    pub data: String,
    svg: String,
    /// Pixels of a PNG to the inch.
    dpi: f64,
}

impl Figure {
    /// A drawn page as a figure of that name, with its caption and its numbers.
    pub(super) fn new(name: &str, (caption, data): (String, String), page: &Page) -> Self {
        Self {
            name: name.to_owned(),
            caption,
            data,
            svg: page.svg(),
            dpi: page.look().dpi,
        }
    }

    /// The figure as an SVG document. Heat maps are embedded pictures; equal results give equal bytes.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The figure as a PNG: 8-bit RGB, with as many pixels to the inch as its style says, which is written into it.
    ///
    /// # Errors
    /// [`DrawError`].
    pub fn png(&self) -> Result<Vec<u8>, DrawError> {
        render::png(&self.svg, self.dpi)
    }

    /// The figure as a PDF of one page, in its size, with its fonts embedded and its text as text; equal figures give
    /// equal bytes.
    ///
    /// # Errors
    /// [`DrawError`].
    pub fn pdf(&self) -> Result<Vec<u8>, DrawError> {
        pdf::pdf(&self.svg, &self.name)
    }
}

enum Scene<'a> {
    Sweep(SweepScene<'a>),
    Comparison(ComparisonScene<'a>),
}

/// The figures that can be drawn of a sweep or of a comparison. Nothing is drawn before it is asked for, and no file is
/// written: see [`write_figures`](super::write_figures).
pub struct Figures<'a>(Scene<'a>);

impl<'a> Figures<'a> {
    /// The figures of a sweep: a diagram an observed marginal (`diagram_x`), the marginals at the parameter values
    /// `at`, overlaid (`marginals`), and an observed pair's joint densities at these values, all on one sheet
    /// (`joint_xy`) and each (`joint_xy_-0.5`).
    ///
    /// For each value in `at` the nearest computed point is taken; points without densities are not drawn. `title`
    /// (plain text, may be empty) stands above each figure.
    pub fn of_sweep(result: &'a SweepResult, title: &'a str, at: &[f64]) -> Self {
        Self(Scene::Sweep(SweepScene {
            result,
            title,
            look: FigureStyle::default().look(),
            chosen: select::nearest(result, at),
        }))
    }

    /// The figures of a comparison of methods: marginals by every method (`marginals`), joint densities side by side
    /// (`joint_xy`), and the error against time (`time_to_accuracy`).
    pub fn of_comparison(comparison: &'a Comparison, title: &'a str) -> Self {
        Self(Scene::Comparison(ComparisonScene {
            comparison,
            title,
            look: FigureStyle::default().look(),
        }))
    }

    /// The same figures in a style of their own.
    pub fn with_style(mut self, style: &FigureStyle) -> Self {
        match &mut self.0 {
            Scene::Sweep(scene) => scene.look = style.look(),
            Scene::Comparison(scene) => scene.look = style.look(),
        }
        self
    }

    fn drawn(&self, sketch: &Sketch<'_>) -> Result<Option<Figure>, DrawError> {
        let Some(page) = sketch.draw()? else {
            return Ok(None);
        };
        let shows = &sketch.shows;
        let texts = match &self.0 {
            Scene::Sweep(scene) => (
                caption::caption(scene.result, shows),
                data::table(scene.result, shows),
            ),
            Scene::Comparison(scene) => (
                compared_told::caption(scene.comparison, shows),
                compared_told::table(scene.comparison, shows),
            ),
        };
        Ok(Some(Figure::new(&sketch.name, texts, &page)))
    }

    /// Names of all figures, in their order. Some may turn out to have nothing to show.
    pub fn names(&self) -> Vec<String> {
        let sketches = self.sketches().into_iter();
        sketches.map(|sketch| sketch.name).collect()
    }

    /// Draws the figure of that name and no other; `None` where no density is there to draw.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] for a name that is not one of [`Figures::names`], [`FigureError::Draw`].
    pub fn draw(&self, name: &str) -> Result<Option<Figure>, FigureError> {
        let sketches = self.sketches();
        match sketches.iter().find(|sketch| sketch.name == name) {
            Some(sketch) => Ok(self.drawn(sketch)?),
            None => Err(FigureError::Unknown {
                name: name.to_owned(),
                known: self.names(),
            }),
        }
    }

    /// The first of some words that names no figure there is; a kind may have none.
    pub fn unknown<'w, S: AsRef<str>>(&self, words: &'w [S]) -> Option<&'w str> {
        let names = self.names();
        let is_known = |word: &&str| {
            *word == "all"
                || KINDS.contains(word)
                || names.iter().any(|name| matches_figure(word, name))
        };
        let mut words = words.iter().map(AsRef::as_ref);
        words.find(|word| !is_known(word))
    }

    /// Draws the figures that some words name (see [`matches_figure`]), in their order; those without any density are
    /// left out, and words that name none are passed over.
    ///
    /// # Errors
    /// [`FigureError::Draw`].
    pub fn draw_named<S: AsRef<str>>(&self, words: &[S]) -> Result<Vec<Figure>, FigureError> {
        let sketches = self.sketches();
        let is_wanted = |sketch: &&Sketch<'_>| {
            let mut words = words.iter().map(AsRef::as_ref);
            words.any(|word| matches_figure(word, &sketch.name))
        };
        let mut figures = Vec::new();
        for sketch in sketches.iter().filter(is_wanted) {
            figures.extend(self.drawn(sketch)?);
        }
        Ok(figures)
    }

    /// Draws all figures, in their order; those without any density are left out.
    ///
    /// # Errors
    /// [`FigureError::Draw`].
    pub fn draw_all(&self) -> Result<Vec<Figure>, FigureError> {
        let mut figures = Vec::new();
        for sketch in self.sketches() {
            figures.extend(self.drawn(&sketch)?);
        }
        Ok(figures)
    }

    fn sketches(&self) -> Vec<Sketch<'_>> {
        match &self.0 {
            Scene::Sweep(scene) => OF_SWEEPS.iter().flat_map(|kind| kind(scene)).collect(),
            Scene::Comparison(scene) => {
                OF_COMPARISONS.iter().flat_map(|kind| kind(scene)).collect()
            }
        }
    }
}
