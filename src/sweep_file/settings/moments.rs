//! Coordinates at a phase of the forcing, or over its period: `x @ phase 1/4`, `x @ 16 phases`, `x @ mean`.

use super::quantities::GivenQuantity;
use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::names::quotable;
use crate::sweep_file::reader::Reader;
use crate::system::{AtPhase, Model, Quantity};

/// An axis at phase 0 of the forcing, where there is one.
pub(super) fn at_zero(
    model: &Model,
    given: &mut Vec<GivenQuantity>,
    axis: usize,
    at: &Place,
) -> Option<usize> {
    let quantity = Quantity::at_phase(model, AtPhase { axis, phase: 0.0 })?;
    let known = given.iter().position(|one| one.name == quantity.name());
    let number = known.unwrap_or_else(|| {
        given.push(GivenQuantity {
            name: quantity.name().to_owned(),
            at_phase: Some(quantity),
            formula: None,
            name_place: at.clone(),
            place: at.clone(),
        });
        given.len() - 1
    });
    Some(model.axes.len() + number)
}

/// Both coordinates at the phase of the one that has one; `None` where they have two.
pub(super) fn of_one_moment(
    reader: &mut Reader<'_>,
    model: &Model,
    given: &mut Vec<GivenQuantity>,
    (one, other): (usize, usize),
    at: &Place,
) -> Option<(usize, usize)> {
    let dimension = model.axes.len();
    let phase = |number: usize, given: &[GivenQuantity]| {
        let known = given.get(number.checked_sub(dimension)?)?;
        known.at_phase.as_ref()?.phase()
    };
    let (first, second) = (phase(one, given), phase(other, given));
    let mut as_well = |axis: usize, at_phase: AtPhase| {
        let when = format!("phase {}", at_phase.phase);
        let name = model.axes.get(axis).map(|axis| axis.name.clone());
        match name {
            Some(name) => moment(reader, model, given, (&name, &when), at),
            None => {
                let title = "a joint density of a quantity and of an axis at a phase";
                let found = Diagnostic::new(title).at(at, "of two kinds");
                reader.report(found.remedy("watch axes, both at the phase"));
                None
            }
        }
    };
    match (first, second) {
        (None, None) => Some((one, other)),
        (Some(phase), None) => Some((one, as_well(other, phase)?)),
        (None, Some(phase)) => Some((as_well(one, phase)?, other)),
        (Some(a), Some(b)) if a.phase == b.phase => Some((one, other)),
        (Some(_), Some(_)) => {
            let found =
                Diagnostic::new("a joint density of two phases").at(at, "not of one moment");
            reader.report(found.remedy("give both the same phase"));
            None
        }
    }
}

/// The number of an axis at a phase of the forcing, or over the period: `x @ phase 1/4`, `x @ mean`.
pub(super) fn moment(
    reader: &mut Reader<'_>,
    model: &Model,
    given: &mut Vec<GivenQuantity>,
    (axis, when): (&str, &str),
    at: &Place,
) -> Option<usize> {
    let (axis, when) = (axis.trim(), when.trim());
    let phase_axis = model.phase_axis();
    let known = model.axes.iter().position(|one| one.name == axis);
    let number = known.filter(|&axis| Some(axis) != phase_axis);
    let phase = when
        .strip_prefix("phase")
        .and_then(|text| fraction(text.trim()));
    let refused = |title: String, remedy: &str| {
        Diagnostic::new(title)
            .at(at, "not at a phase")
            .remedy(remedy)
    };
    let found = match (number, phase_axis, phase) {
        (_, None, _) => refused(
            format!("`{}` is of a system without forcing", quotable(axis)),
            "leave `@` out: densities at phases are of systems with sin or cos of `t` in their equations",
        ),
        (None, ..) => refused(
            format!(
                "`{}` is no axis that has a density at a phase",
                quotable(axis)
            ),
            "name an axis of the state before `@`",
        ),
        (Some(axis), ..) if when == "mean" => return Some(axis),
        (Some(_), _, None) => refused(
            format!("`{}` is no phase", quotable(when)),
            "write `phase` and a part of the period from 0 to below 1, as `x @ phase 0` or `x @ phase 1/4`; `x @ 16 phases` for even ones, up to 64; or `mean`",
        ),
        (Some(axis), _, Some(phase)) => {
            let quantity = Quantity::at_phase(model, AtPhase { axis, phase })?;
            let name = quantity.name().to_owned();
            let place = given.iter().position(|one| one.name == name);
            let place = place.unwrap_or_else(|| {
                given.push(GivenQuantity {
                    name,
                    at_phase: Some(quantity),
                    formula: None,
                    name_place: at.clone(),
                    place: at.clone(),
                });
                given.len() - 1
            });
            return Some(model.axes.len() + place);
        }
    };
    reader.report(found);
    None
}

/// Most even parts of a period whose phases can be watched together.
const MOST_PHASES: usize = 64;

/// The phases that `x @ 8 phases` stands for; any other text by itself.
pub(super) fn spread_over_period(text: &str) -> Vec<String> {
    let count = |text: &str| {
        let (axis, when) = text.split_once('@')?;
        let count = when.trim().strip_suffix("phases")?.trim();
        Some((axis.trim().to_owned(), count.parse::<usize>().ok()?))
    };
    match count(text) {
        Some((axis, count)) if (1..=MOST_PHASES).contains(&count) => {
            let phases = 0..count;
            phases
                .map(|part| format!("{axis} @ phase {part}/{count}"))
                .collect()
        }
        _ => vec![text.to_owned()],
    }
}

/// A number from 0 to below 1, as a fraction or in decimals.
fn fraction(text: &str) -> Option<f64> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((above, below)) => number(above)? / number(below)?,
        None => number(text)?,
    };
    (0.0..1.0).contains(&value).then_some(value)
}
