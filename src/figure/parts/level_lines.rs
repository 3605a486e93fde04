//! Curves of levels in the figure of a plane: where a number of the steady state, such as a mean time of first passage,
//! is at a level.

use super::caption;
use super::curve_line::draw_points;
use super::measure_names::Named;
use crate::continuation::BifurcationStatus;
use crate::continuation::curve::{CurvePoint, LevelCurve, Plane, level_name};
use crate::density::Observable;
use crate::figure::canvas::legend::Swatch;
use crate::figure::canvas::page::Panel;
use crate::figure::canvas::style::{INK, Stroke};
use crate::figure::canvas::symbols;
use crate::system::Family;

/// Width of their lines, in pixels, and dashes of several, so that each is told from the others.
const WIDE: f64 = 1.6;
const DASHES: [&[f64]; 3] = [&[9.0, 2.0, 2.0, 2.0], &[3.0, 2.0], &[12.0, 3.0]];

/// The curves of a plane.
#[derive(Clone, Copy)]
pub(crate) struct LevelLines<'a> {
    pub(crate) plane: &'a Plane,
    pub(crate) curves: &'a [LevelCurve],
    /// Gives symbols of states.
    pub(crate) family: &'a Family,
    /// The densities that are watched.
    pub(crate) observables: &'a [Observable],
}

impl LevelLines<'_> {
    pub(crate) fn draw(&self, panel: &Panel) {
        for (number, curve) in self.curves.iter().enumerate() {
            draw_points(panel, (self.plane, &curve.points), stroke(number));
        }
    }

    /// The places that each goes through.
    pub(crate) fn lines(&self) -> impl Iterator<Item = Vec<[f64; 2]>> {
        let points = self.curves.iter().map(|curve| curve.points.iter());
        points.map(|points| points.map(|point| point.values).collect())
    }

    /// What is where on one of them, as markup: `mean time (exit) = 1000`.
    pub(crate) fn words(&self, curve: &LevelCurve) -> String {
        let title = Named::new(self.family, self.observables).title(&curve.asked.measure);
        format!("{title} = {}", symbols::value(curve.asked.level))
    }

    /// What the legend says of them.
    pub(crate) fn entries(&self) -> Vec<(Swatch, String)> {
        let curves = self.curves.iter().enumerate();
        let entry = |(number, curve): (usize, &LevelCurve)| {
            (Swatch::Curve(stroke(number)), self.words(curve))
        };
        curves.map(entry).collect()
    }

    /// What the caption says of them; nothing without any.
    pub(crate) fn caption(&self) -> String {
        let sentence = |(number, curve): (usize, &LevelCurve)| {
            let is_located = |point: &&CurvePoint| point.status() == BifurcationStatus::Located;
            let located = curve.points.iter().filter(is_located).count();
            let errors = curve.points.iter().map(|point| point.error);
            format!(
                " On {} {} ({} points, {located} of them located; the error across it is at most {:.1e} of the sides of the box).",
                level_name(number),
                caption::in_letters(&self.words(curve)),
                curve.points.len(),
                errors.fold(0.0, f64::max)
            )
        };
        self.curves.iter().enumerate().map(sentence).collect()
    }

    /// All points with the names of their curves, for the figure's table.
    pub(crate) fn data(&self) -> impl Iterator<Item = (String, &LevelCurve, &CurvePoint)> {
        self.curves.iter().enumerate().flat_map(|(number, curve)| {
            let points = curve.points.iter();
            points.map(move |point| (level_name(number), curve, point))
        })
    }
}

/// The line of the curve with the given number.
fn stroke(number: usize) -> Stroke {
    Stroke::solid(INK, WIDE).dashed(DASHES[number % DASHES.len()])
}
