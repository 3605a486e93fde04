//! The kinds of figures, one file each: what it draws, its caption, its table, its names. A new kind is one file like
//! `diagram`, and its line in a list here.

mod compared_joint;
mod compared_marginals;
pub(super) mod curve;
mod diagram;
mod field;
pub(super) mod friction;
mod health;
mod homology;
mod indicator;
mod joint;
pub(super) mod map;
mod marginals;
mod measures;
mod pairs;
mod peaks;
mod period;
mod phases;
mod section;
mod spectrogram;
mod spectrum;
mod surface;
mod survival;
mod time_to_accuracy;

use super::parts::{caption, names, pages, view};
use super::print::{Figure, Print};
use crate::compare::Comparison;
use crate::continuation::{Point, SweepResult};
use crate::density::Observable;
use crate::system::Family;

/// The kinds of figures of a sweep, in the order in which they are drawn: a new kind is one line here.
pub(super) const OF_SWEEPS: [Kind; 17] = [
    diagram::KIND,
    marginals::KIND,
    joint::KIND,
    surface::KIND,
    pairs::KIND,
    section::KIND,
    peaks::KIND,
    indicator::KIND,
    homology::KIND,
    health::KIND,
    measures::KIND,
    phases::KIND,
    period::KIND,
    field::KIND,
    survival::KIND,
    spectrum::KIND,
    spectrogram::KIND,
];

/// The kinds of figures of a comparison.
pub(super) const OF_COMPARISONS: [for<'a> fn(&'a Comparison) -> Vec<Sketch<'a>>; 3] = [
    compared_marginals::sketches,
    compared_joint::sketches,
    time_to_accuracy::sketches,
];

/// A kind of figures of a sweep.
pub(super) struct Kind {
    /// What the names of its figures begin with.
    pub(super) names: &'static [&'static str],
    /// The word for those of its figures that are drawn where none is named.
    pub(super) usual: Option<&'static str>,
    /// The figures that it has of a sweep.
    pub(super) sketches: for<'a> fn(&Sweep<'a>) -> Vec<Sketch<'a>>,
}

/// Words for the figures that are drawn where none is named.
pub(super) fn usual() -> Vec<String> {
    let words = OF_SWEEPS.iter().filter_map(|kind| kind.usual);
    words.map(str::to_owned).collect()
}

/// A sweep with the points that figures are drawn at.
pub(super) struct Sweep<'a> {
    /// The points with what was found in them.
    pub(super) result: &'a SweepResult,
    /// The points at which marginals and joint densities are drawn.
    pub(super) chosen: Vec<&'a Point>,
}

impl<'a> Sweep<'a> {
    /// For each value in `at` the nearest computed point is chosen.
    pub(super) fn new(result: &'a SweepResult, at: &[f64]) -> Self {
        let chosen = view::nearest(result, at);
        Self { result, chosen }
    }

    /// The systems that were swept.
    pub(super) fn family(&self) -> &'a Family {
        &self.result.subject.family
    }

    /// Numbers and names in files of the observables.
    pub(super) fn observables(&self) -> impl Iterator<Item = (usize, Observable, String)> + 'a {
        let (result, family) = (self.result, self.family());
        let observables = result.subject.observables.iter().enumerate();
        observables.map(|(number, &one)| (number, one, names::file(family, one)))
    }

    /// Numbers and names in files of the observed pairs of axes.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, String)> + 'a {
        let joint = |(number, observable, file)| match observable {
            Observable::Joint(..) => Some((number, file)),
            Observable::Marginal(_) => None,
        };
        self.observables().filter_map(joint)
    }

    /// A figure of each marginal, `NAME_x`, drawn from its number among the observables and that of its axis.
    pub(super) fn of_marginals(
        &self,
        name: &str,
        draw: for<'r> fn(&'r SweepResult, (usize, usize), &Print<'_>) -> Drawn,
    ) -> Vec<Sketch<'a>> {
        let result = self.result;
        let sketch = |(number, observable, file)| match observable {
            Observable::Marginal(axis) => {
                Some(Sketch::new(format!("{name}_{file}"), move |print| {
                    draw(result, (number, axis), print)
                }))
            }
            Observable::Joint(..) => None,
        };
        self.observables().filter_map(sketch).collect()
    }

    /// A figure of each observable, `NAME_xy`, drawn from its number.
    pub(super) fn of_observables(
        &self,
        name: &str,
        draw: for<'r> fn(&'r SweepResult, usize, &Print<'_>) -> Drawn,
    ) -> Vec<Sketch<'a>> {
        let result = self.result;
        let sketch = |(number, _, file)| {
            Sketch::new(format!("{name}_{file}"), move |print| {
                draw(result, number, print)
            })
        };
        self.observables().map(sketch).collect()
    }
}

/// A figure; `None` where there is nothing to see.
pub(super) type Drawn = Option<Figure>;

/// A figure that is not drawn yet.
pub(super) struct Sketch<'a> {
    /// Its name: that of its file without the extension.
    pub(super) name: String,
    /// Whether it shows one of the values that another figure shows together.
    is_single: bool,
    draw: Box<dyn Fn(&Print<'_>) -> Drawn + Sync + 'a>,
}

impl<'a> Sketch<'a> {
    /// A figure of that name, which `draw` draws.
    pub(super) fn new(
        name: impl Into<String>,
        draw: impl Fn(&Print<'_>) -> Drawn + Sync + 'a,
    ) -> Self {
        Self {
            name: name.into(),
            is_single: false,
            draw: Box::new(draw),
        }
    }

    /// The same figure, of one of the values that another one shows together.
    pub(super) fn of_one_value(self) -> Self {
        Self {
            is_single: true,
            ..self
        }
    }

    /// Whether a word is for it.
    pub(super) fn is_named_by(&self, word: &str) -> bool {
        let kind = names::of_sheets(word).filter(|_| !self.is_single);
        names::matches(word, &self.name)
            || kind.is_some_and(|kind| names::matches(kind, &self.name))
    }

    /// Draws it, on several pages where one has no room for it; none where there is nothing to see.
    pub(super) fn draw(&self, print: &Print<'_>) -> Vec<Figure> {
        let mut drawn = pages::fitted(print, &*self.draw);
        let count = drawn.len();
        for (number, figure) in drawn.iter_mut().enumerate() {
            figure.name.clone_from(&self.name);
            figure.caption = caption::with_sentence(&figure.caption, &print.modes);
            if count > 1 {
                figure.name += &format!("_page{}", number + 1);
                let caption = figure.caption.trim_end();
                figure.caption = format!("{caption} Page {} of {count}.\n", number + 1);
            }
        }
        drawn
    }
}
