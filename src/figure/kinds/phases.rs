//! Densities of a forced system at the phases that are watched, overlaid: a panel a value of the parameter, on one
//! sheet.

use std::borrow::Cow;

use super::marginals::{Overlaid, as_drawn, draw_overlaid};
use super::{Drawn, Kind, Sketch};
use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::figure::parts::{caption, names, table, view};
use crate::figure::print::{Figure, Print};
use crate::numerics::sort_ascending;

/// Fewest phases that make a sheet.
const FEWEST: usize = 2;

/// A sheet of each state of which two phases are watched.
pub(super) const KIND: Kind = Kind {
    names: &["phases"],
    usual: None,
    sketches: |sweep| {
        let (result, chosen) = (sweep.result, sweep.chosen.clone());
        let states = sweep.family().states_on_lines();
        let sketch = |(axis, name): (usize, &str)| {
            let chosen = chosen.clone();
            let name = format!("phases_{name}");
            let draw = move |print: &Print<'_>| draw(result, axis, &chosen, print);
            (of_axis(result, axis).len() >= FEWEST).then(|| Sketch::new(name, draw))
        };
        states.filter_map(sketch).collect()
    },
};

/// The densities of an axis at phases: each with its number among the observables, and its phase in words, ascending.
fn of_axis(result: &SweepResult, axis: usize) -> Vec<(usize, String)> {
    let family = &result.subject.family;
    let observables = result.subject.observables.iter().enumerate();
    let at_phase = observables.filter_map(|(number, one)| match *one {
        Observable::Marginal(watched) => {
            let at = family.quantity(watched)?.phase()?;
            (at.axis == axis).then(|| (number, at.phase, format!("phase {}", at.fraction())))
        }
        Observable::Joint(..) => None,
    });
    let mut found: Vec<(usize, f64, String)> = at_phase.collect();
    sort_ascending(&mut found, |one| one.1);
    let found = found.into_iter();
    found.map(|(number, _, words)| (number, words)).collect()
}

fn draw(result: &SweepResult, axis: usize, chosen: &[&Point], print: &Print<'_>) -> Drawn {
    let family = &result.subject.family;
    let phases = of_axis(result, axis);
    let title = names::axis(family, axis);
    let ordinate = names::density(family, Observable::Marginal(axis));
    let (count, share) = (chosen.len(), print.share(chosen.len()));
    let mut panels = Vec::new();
    let first = share.start;
    for point in &chosen[share] {
        let densities = phases.iter().enumerate();
        let densities = densities.filter_map(|(place, (number, _))| {
            Some((place, Cow::Borrowed(view::density(point, *number)?)))
        });
        let panel = Overlaid::new(print, &title, densities.collect(), &ordinate);
        panels.extend(panel.map(|panel| panel.under(names::at(family, point.value))));
    }
    let words: Vec<String> = phases.iter().map(|(_, words)| words.clone()).collect();
    let page = draw_overlaid(&words, (first, &panels), print)?;
    let values = chosen.iter().map(|point| point.value);
    let seen = format!(
        "Densities {} at phases of the forcing, in periods after t = 0{}.",
        caption::density(family, Observable::Marginal(axis)),
        caption::at(family, values)
    );
    let numbers: Vec<usize> = phases.iter().map(|(number, _)| *number).collect();
    let rows = |estimated: &EstimatedDensity, number: usize| {
        let all = chosen.iter();
        let all = all.filter_map(|point| view::density(point, number));
        let all: Vec<&Density> = all.map(|one| &one.density).collect();
        as_drawn(estimated, view::window(&all, 0))
    };
    let figure = Figure::new(
        &page,
        caption::of_sweep(result, seen, &[]),
        table::of_marginals(result, (&numbers, chosen), rows),
    );
    Some(figure.of_panels(count))
}
