//! The figures of a sweep, a comparison, a map, curves or a friction law as values: listed by name, drawn one by one or
//! all.

use rayon::prelude::*;

use super::FigureError;
use super::kinds::{self, Sketch, Sweep};
use super::parts::{caption, names};
use super::print::{Figure, Print};
use super::style::FigureStyle;
use crate::compare::Comparison;
use crate::continuation::SweepResult;
use crate::continuation::curve::{CurveOrigin, CurveTree, Plane, SweepInPlane};
use crate::continuation::map::RegimeMap;
use crate::density::Observable;
use crate::space::Axis;
use crate::system::{Family, Model, ParameterValues};

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
                solved_by: String::new(),
                modes: String::new(),
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
    /// parameter, and of those of levels and of a fixed point; none without a curve. What `sweeps` over one of the
    /// parameters located is marked. `family` gives names and symbols.
    pub fn of_curves(
        (plane, curves): (&'a Plane, &'a CurveTree),
        (row, sweeps): (&'a CurveOrigin, &'a [SweepInPlane]),
        family: &'a Family,
        title: &'a str,
    ) -> Self {
        Self::new(
            title,
            kinds::curve::sketches((plane, curves), (row, sweeps), family),
        )
    }

    /// The figure `friction_NAME` of a model with a friction law: left the force against the velocity, sliding steadily
    /// and pulled to and fro; right the same loops against the displacement. None of a model without a friction law, or
    /// with one that exerts no force with these values.
    pub fn of_friction(model: &'a Model, values: &'a ParameterValues, title: &'a str) -> Self {
        Self::new(title, kinds::friction::sketches(model, values))
    }

    /// The same figures of a map or of curves, whose captions then tell the method (by its name in sweep files) and the
    /// cells of the densities that are watched. Those of a sweep know it from its points.
    pub fn solved_by(
        mut self,
        method: &str,
        (family, watched): (&Family, Vec<(Observable, Vec<Axis>)>),
    ) -> Self {
        self.print.solved_by = caption::solved_by(family, method, watched);
        self
    }

    /// The same figures, whose captions then tell which of the axes of the state, given in their order, modes carry in
    /// place of cells, and how many: those of an internal state, of an angle, or of the phase of a forcing.
    pub fn carried_by(mut self, family: &Family, axes: &[Axis]) -> Self {
        self.print.modes = caption::modes(family, axes);
        self
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
    pub(crate) fn kinds(&self) -> &[&'static str] {
        &self.kinds
    }

    /// Draws the figure of that name and no other: nothing where no density is there to draw, several pages
    /// (`pairs_xy_page1`, `pairs_xy_page2`) where one has no room for all of its panels.
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
            let kind = names::of_sheets(word).unwrap_or(word);
            self.kinds.contains(&kind) || sketches.any(|one| one.is_named_by(word))
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
    /// `_` (`joint` names `joint_xy_0.5`), the same with `_sheets` for those that show all values (`joint_sheets` names
    /// `joint_xy` alone), or `all`. Those without any density are left out, and words that name none
    /// are passed over. One that has no room on a page has several, `…_page1`, `…_page2`.
    pub fn draw_named<S: AsRef<str>>(&self, words: &[S]) -> Vec<Figure> {
        let is_wanted = |sketch: &&Sketch<'_>| {
            let mut words = words.iter().map(AsRef::as_ref);
            words.any(|word| sketch.is_named_by(word))
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
