//! Mean and standard deviation of a state over the period of a forcing: the mean at each phase that is watched, in a
//! band of one deviation to either side, a colour a value of the parameter.

use super::{Drawn, Kind, Sketch};
use crate::continuation::{Point, SweepResult};
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::page::{Heading, Page, Rectangle, Shape};
use crate::figure::canvas::style::{MARGIN, Stroke};
use crate::figure::parts::{caption, names, table};
use crate::figure::print::{Figure, Print};
use crate::numerics::{ends_of, sort_ascending};

/// Width and height of the panel, in pixels.
const PANEL: (f64, f64) = (380.0, 210.0);
/// Room right of the panel, for half a label of its axis.
const BESIDE: f64 = 10.0;
/// Opacity of the band.
const BAND: f64 = 0.18;
/// Fewest phases that show how a mean moves.
const FEWEST: usize = 3;
/// Room above and below what is drawn, as a share of it.
const AROUND: f64 = 0.05;

/// A figure of each state of which three phases are watched.
pub(super) const KIND: Kind = Kind {
    names: &["period"],
    usual: None,
    sketches: |sweep| {
        let (result, chosen) = (sweep.result, sweep.chosen.clone());
        let sketch = |(axis, name): (usize, &str)| {
            let chosen = chosen.clone();
            let draw = move |print: &Print<'_>| draw(result, (axis, &chosen), print);
            let is_seen = phases(result, axis).len() >= FEWEST;
            is_seen.then(|| Sketch::new(format!("period_{name}"), draw))
        };
        sweep
            .family()
            .states_on_lines()
            .filter_map(sketch)
            .collect()
    },
};

/// The phases of an axis that are watched, ascending, with the names of their moments.
fn phases(result: &SweepResult, axis: usize) -> Vec<(f64, String)> {
    let all = result.subject.family.at_phases();
    let own = all.filter(|(at, _)| at.axis == axis);
    let mut own: Vec<(f64, String)> = own.map(|(at, name)| (at.phase, name.to_owned())).collect();
    sort_ascending(&mut own, |one| one.0);
    own
}

/// A phase with mean and deviation, each with its error.
type Moment = (f64, [(f64, f64); 2]);

/// The moments at a point at all phases; the first comes back after a period.
fn moments(point: &Point, phases: &[(f64, String)]) -> Vec<Moment> {
    let of = |word: &str, name: &str| {
        let name = format!("{word}_{name}");
        let value = point.report.measure(&name)?;
        let error = point.report.error_of(&name).unwrap_or(0.0);
        (value.is_finite() && error.is_finite()).then_some((value, error))
    };
    let known = phases.iter();
    let known =
        known.filter_map(|(phase, name)| Some((*phase, [of("mean", name)?, of("sd", name)?])));
    let mut found: Vec<Moment> = known.collect();
    let first = found.first().copied();
    found.extend(first.map(|(phase, moments)| (phase + 1.0, moments)));
    found
}

fn draw(result: &SweepResult, (axis, chosen): (usize, &[&Point]), print: &Print<'_>) -> Drawn {
    let (family, look) = (&result.subject.family, &print.look);
    let phases = phases(result, axis);
    let curves: Vec<(&Point, Vec<Moment>)> = chosen
        .iter()
        .map(|point| (*point, moments(point, &phases)))
        .filter(|(_, moments)| moments.len() > FEWEST)
        .collect();
    let ends = curves.iter().flat_map(|(_, moments)| moments);
    let ends = ends.flat_map(|(_, [mean, deviation])| {
        [-1.0, 1.0].map(|sign| mean.0 + sign * (deviation.0 + deviation.1))
    });
    let (low, high) = ends_of(ends);
    if low >= high {
        return None;
    }
    let around = AROUND * (high - low);
    let tall = look.height(PANEL.1, PANEL.0);
    let up = Scale::vertical(
        look,
        (low - around, high + around),
        tall,
        &names::axis(family, axis),
    );
    let beside = 2.0 * MARGIN + BESIDE + up.left();
    let wide = look.fill(PANEL.0, beside);
    let width = beside + wide;
    let heading = Heading::new(look, print.title, width);
    let entries = curves.iter().enumerate().map(|(number, (point, _))| {
        let sample = Swatch::Curve(Stroke::curve(number));
        (sample, names::at(family, point.value))
    });
    let legend = Legend::new(look, entries.collect(), width - 2.0 * MARGIN);
    let top = heading.height() + legend.height() + 6.0;
    let first = phases.first().map_or(0.0, |(phase, _)| *phase);
    let window = (first, first + 1.0);
    let across = Scale::horizontal(look, window, wide, "phase (periods)");
    let rect = Rectangle::new((MARGIN + up.left(), top), (wide, tall));
    let page = Page::new(look, width, rect.bottom() + Scale::below() + MARGIN);
    heading.draw(&page);
    legend.draw(&page, 0.5 * width, heading.height());
    let panel = page.panel(rect, window, up.range);
    for (number, (_, moments)) in curves.iter().enumerate() {
        let edge = |sign: f64| {
            let places = moments.iter();
            places.map(move |(phase, [mean, deviation])| (*phase, mean.0 + sign * deviation.0))
        };
        let outline: Vec<(f64, f64)> = edge(1.0).chain(edge(-1.0).rev()).collect();
        panel.draw(&outline, Shape::Area(Stroke::curve(number).colour.at(BAND)));
    }
    for (number, (_, moments)) in curves.iter().enumerate() {
        let means = moments.iter().map(|(phase, [mean, _])| (*phase, mean.0));
        let line: Vec<(f64, f64)> = means.collect();
        panel.draw(&line, Shape::Line(Stroke::curve(number)));
    }
    frame::around(&page, rect, (&across, &up));
    let seen = format!(
        "Mean of {} over the period of the forcing{}, in a band of one standard deviation to either side, by straight lines between the {} phases that are watched.",
        names::axis(family, axis),
        caption::at(family, curves.iter().map(|(point, _)| point.value)),
        phases.len()
    );
    let rows = curves.iter().flat_map(|(point, moments)| {
        let own = &moments[..moments.len() - 1];
        own.iter().map(|(phase, [mean, deviation])| {
            let numbers = [
                point.value,
                *phase,
                mean.0,
                mean.1,
                deviation.0,
                deviation.1,
            ];
            numbers.map(table::number).to_vec()
        })
    });
    let columns = [
        family.parameter(),
        "phase",
        "mean",
        "mean_error",
        "sd",
        "sd_error",
    ];
    Some(Figure::new(
        &page,
        caption::of_sweep(result, seen, &[]),
        table::table(&columns, rows),
    ))
}
