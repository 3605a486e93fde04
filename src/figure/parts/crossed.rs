//! Sweeps over one parameter in the figure of a plane: their lines, and the rows that they located, with errors.

use super::caption;
use super::names::symbol_of;
use crate::continuation::BifurcationStatus;
use crate::continuation::curve::{Plane, RowInPlane, SweepInPlane};
use crate::density::Observable;
use crate::figure::canvas::legend::Swatch;
use crate::figure::canvas::page::{Panel, Shape};
use crate::figure::canvas::style::{BIFURCATION, GREY, PAPER, Stroke};
use crate::figure::canvas::symbols;
use crate::system::Family;

/// Radius of a row's dot, and half the length of the caps of its error, in pixels.
const DOT: f64 = 3.2;
const CAP: f64 = 3.0;
/// The line of a sweep.
const DOTS: &[f64] = &[1.5, 3.0];

/// The sweeps of a figure of some observables.
pub(crate) struct Crossed<'a> {
    pub(crate) plane: &'a Plane,
    /// Gives symbols of parameters.
    pub(crate) family: &'a Family,
    pub(crate) sweeps: &'a [SweepInPlane],
    /// The observables that the figure is of.
    pub(crate) observables: &'a [Observable],
}

impl Crossed<'_> {
    /// The rows that are of the figure, each with its sweep.
    fn rows(&self) -> impl Iterator<Item = (&SweepInPlane, &RowInPlane)> {
        let rows = self.sweeps.iter();
        let rows = rows.flat_map(|sweep| sweep.rows.iter().map(move |row| (sweep, row)));
        rows.filter(|(_, row)| {
            row.observable
                .is_some_and(|one| self.observables.contains(&one))
        })
    }

    /// Draws them over the curves.
    pub(crate) fn draw(&self, panel: &Panel) {
        for sweep in self.sweeps {
            let ends = [sweep.range.0, sweep.range.1].map(|value| at(sweep, value));
            panel.draw(&ends, Shape::Line(line()));
        }
        for (sweep, row) in self.rows() {
            self.draw_row(panel, sweep, row);
        }
    }

    fn draw_row(&self, panel: &Panel, sweep: &SweepInPlane, row: &RowInPlane) {
        let side = &self.plane.sides()[sweep.side];
        let value = row.values[sweep.side];
        let stroke = Stroke::solid(BIFURCATION, 1.2);
        let ends = [value - row.error, value + row.error].map(|end| end.clamp(side.from, side.to));
        let places = ends.map(|end| panel.place(at(sweep, end)));
        let (wide, high) = (places[1].0 - places[0].0, places[1].1 - places[0].1);
        // An error within the dot is not seen.
        if wide.hypot(high) > 2.0 * DOT {
            panel.draw(&ends.map(|end| at(sweep, end)), Shape::Line(stroke));
            for end in ends {
                let cap = self.cap(panel, sweep, end);
                panel.draw(&cap, Shape::Line(stroke));
            }
        }
        let inside = match row.status {
            BifurcationStatus::Located => BIFURCATION,
            _ => PAPER,
        };
        panel.draw(&[at(sweep, value)], Shape::Dot(DOT, inside, stroke));
    }

    /// The short line across the end of an error.
    fn cap(&self, panel: &Panel, sweep: &SweepInPlane, end: f64) -> [(f64, f64); 2] {
        let side = &self.plane.sides()[1 - sweep.side];
        let [low, high] = [side.from, side.to].map(|held| {
            let beside = SweepInPlane {
                held,
                ..sweep.clone()
            };
            panel.place(at(&beside, end))
        });
        let pixels = (high.0 - low.0).hypot(high.1 - low.1);
        let half = CAP * side.length() / pixels;
        [-half, half].map(|off| {
            let held = (sweep.held + off).clamp(side.from, side.to);
            at(
                &SweepInPlane {
                    held,
                    ..sweep.clone()
                },
                end,
            )
        })
    }

    /// What the legend says of them.
    pub(crate) fn entries(&self) -> Vec<(Swatch, String)> {
        let mut entries: Vec<(Swatch, String)> = Vec::new();
        for sweep in self.sweeps {
            let name = &self.plane.sides()[sweep.side].parameter;
            let text = format!("sweep over {}", symbol_of(self.family, name));
            if entries.iter().all(|known| known.1 != text) {
                entries.push((Swatch::Curve(line()), text));
            }
        }
        if self.rows().next().is_some() {
            entries.push((Swatch::Symbol(BIFURCATION), "located by a sweep".to_owned()));
        }
        entries
    }

    /// What the caption says of them; nothing without any.
    pub(crate) fn caption(&self) -> String {
        let sides = self.plane.sides();
        let [first, second] = sides
            .each_ref()
            .map(|side| caption::parameter_named(self.family, &side.parameter));
        let words = |sweep: &SweepInPlane| {
            let (swept, held) = match sweep.side {
                0 => (&first, &second),
                _ => (&second, &first),
            };
            format!("over {swept} at {held} = {}", symbols::rounded(sweep.held))
        };
        let lines: Vec<String> = self.sweeps.iter().map(words).collect();
        if lines.is_empty() {
            return String::new();
        }
        format!(
            " Dotted lines are sweeps {}; dots with bars are what they locate, with its error, open where it is not located.",
            lines.join(", ")
        )
    }

    /// The rows for the figure's table: each with its error in both parameters.
    pub(crate) fn data(&self) -> impl Iterator<Item = (&RowInPlane, [f64; 2], &'static str)> {
        self.rows().map(|(sweep, row)| {
            let mut to_edge = [0.0; 2];
            to_edge[sweep.side] = row.error;
            (row, to_edge, row.status.word())
        })
    }
}

/// The place of a sweep's value in the panel.
fn at(sweep: &SweepInPlane, value: f64) -> (f64, f64) {
    match sweep.side {
        0 => (value, sweep.held),
        _ => (sweep.held, value),
    }
}

fn line() -> Stroke {
    Stroke::solid(GREY, 1.0).dashed(DOTS)
}
