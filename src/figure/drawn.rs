//! The figures of a sweep or a comparison as values: listed by name, drawn one by one or all.

use super::canvas::{DrawError, render};
use super::select;
use super::sketch::{ComparisonScene, Sketch, SweepScene};
use super::{
    FigureError, compared_joint, compared_marginals, diagram, joint, marginals, time_to_accuracy,
};
use crate::compare::Comparison;
use crate::continuation::SweepResult;

/// The kinds of figures of a sweep, in the order in which they are drawn: a new kind is one line here.
const OF_SWEEPS: [for<'a> fn(&'a SweepScene<'a>) -> Vec<Sketch<'a>>; 3] =
    [diagram::sketches, marginals::sketches, joint::sketches];

/// The kinds of figures of a comparison.
const OF_COMPARISONS: [for<'a> fn(&'a ComparisonScene<'a>) -> Vec<Sketch<'a>>; 3] = [
    compared_marginals::sketches,
    compared_joint::sketches,
    time_to_accuracy::sketches,
];

/// A figure: an SVG document with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of its file without the extension, such as `diagram_x`.
    pub name: String,
    svg: String,
}

impl Figure {
    /// The figure as an SVG document. Heat maps are embedded pictures; equal results give equal bytes.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The figure as a PNG: 8-bit RGB on white, three pixels to a figure pixel (288 to the inch).
    ///
    /// # Errors
    /// [`DrawError`].
    pub fn png(&self) -> Result<Vec<u8>, DrawError> {
        render::png(&self.svg)
    }
}

enum Scene<'a> {
    Sweep(SweepScene<'a>),
    Comparison(ComparisonScene<'a>),
}

/// The figures that can be drawn of a sweep or of a comparison. Nothing is drawn before it is asked for, and no file is written:
/// see [`write_figures`](super::write_figures).
pub struct Figures<'a>(Scene<'a>);

impl<'a> Figures<'a> {
    /// The figures of a sweep: a diagram an observed marginal (`diagram_x`), the marginals at the parameter values `at`,
    /// overlaid (`marginals`), and an observed pair's joint densities at these values, all on one sheet (`joint_xy`) and each
    /// (`joint_xy_-0.5`).
    ///
    /// For each value in `at` the nearest computed point is taken; points without densities are not drawn. `title` (plain text,
    /// may be empty) stands above each figure.
    pub fn of_sweep(result: &'a SweepResult, title: &'a str, at: &[f64]) -> Self {
        Self(Scene::Sweep(SweepScene {
            result,
            title,
            chosen: select::nearest(result, at),
        }))
    }

    /// The figures of a comparison of methods: marginals by every method (`marginals`), joint densities side by side (`joint_xy`), and
    /// the error against time (`time_to_accuracy`).
    pub fn of_comparison(comparison: &'a Comparison, title: &'a str) -> Self {
        Self(Scene::Comparison(ComparisonScene { comparison, title }))
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
            Some(sketch) => Ok(drawn(sketch)?),
            None => Err(FigureError::Unknown {
                name: name.to_owned(),
                known: self.names(),
            }),
        }
    }

    /// Draws all figures, in their order; those without any density are left out.
    ///
    /// # Errors
    /// [`FigureError::Draw`].
    pub fn draw_all(&self) -> Result<Vec<Figure>, FigureError> {
        let mut figures = Vec::new();
        for sketch in self.sketches() {
            figures.extend(drawn(&sketch)?);
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

fn drawn(sketch: &Sketch<'_>) -> Result<Option<Figure>, DrawError> {
    let page = sketch.draw()?;
    Ok(page.map(|page| Figure {
        name: sketch.name.clone(),
        svg: page.svg(),
    }))
}
