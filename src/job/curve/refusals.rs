//! Which rows curves start from, and what is said where one cannot be followed.

use super::row::FirstRow;
use crate::continuation::curve::{CurveError, Plane};
use crate::continuation::{BifurcationStatus, Label, SweepResult};
use crate::sweep_file::{Diagnostic, Report, Sweep, list};

/// Share of an axis by which a bound may be beyond it: rounding.
const BEYOND: f64 = 1e-9;

/// The box of `[curve]`; `None` where there is no such section.
pub(super) fn plane(sweep: &Sweep) -> Result<Option<Plane>, Report> {
    let parameter = sweep.problem.family().parameter();
    let plane = sweep.settings.curve.as_ref().map(|curve| {
        let (from, to) = curve.first;
        Plane::new(
            (parameter, from, to),
            (curve.parameter.as_str(), curve.from, curve.to),
        )
    });
    plane.transpose().map_err(refusal)
}

/// Refuses the curves that a sweep file asks for before its sweep is run.
///
/// # Errors
/// A report where the box has a corner that is not allowed, or at which a state that modes carry goes beyond its axis.
pub(crate) fn check_curves(sweep: &Sweep) -> Result<(), Report> {
    plane(sweep)?.map_or(Ok(()), |plane| check_corners(sweep, &plane))
}

/// The rows of a result that are followed: those that `curve.rows` names, or all that an indicator has located, an
/// exponent or the level of a number, and that are in the box. With `only`, the one that can be followed, where none is
/// named.
///
/// # Errors
/// A report where one is not there, or which one is not clear.
pub fn curve_rows<'r>(
    sweep: &Sweep,
    result: &'r SweepResult,
    only: bool,
) -> Result<Vec<FirstRow<'r>>, Report> {
    let Some(curve) = &sweep.settings.curve else {
        return Err(which_parameter(sweep));
    };
    if let Some(labels) = &curve.rows {
        return labels.iter().map(|label| by_label(label, result)).collect();
    }
    let mut rows = followable(result);
    if only {
        return match (rows.next(), rows.next()) {
            (Some(row), None) => Ok(vec![row]),
            _ => Err(
                Diagnostic::new("which row is the curve to be followed from?")
                    .allowed(rows_in_words(result))
                    .remedy("give its label, such as `--row PB1`")
                    .into(),
            ),
        };
    }
    let (from, to) = curve.first;
    let is_wanted = |row: &FirstRow<'_>| {
        let known = [BifurcationStatus::Located, BifurcationStatus::Unchecked];
        known.contains(&row.status()) && (from..=to).contains(&row.value())
    };
    Ok(rows.filter(is_wanted).collect())
}

/// P- and D-bifurcations of a sweep, and crossings of levels.
fn all_rows(result: &SweepResult) -> impl Iterator<Item = FirstRow<'_>> {
    let is_of_point = result.subject.family.questions.fixed_point.is_some();
    result.labels.iter().filter_map(move |label| match label {
        Label::Bifurcation(row) => Some(FirstRow::Shape(row)),
        Label::Level(row) if is_of_point && label.d_bifurcation().is_some() => {
            Some(FirstRow::Stability(row))
        }
        Label::Level(row) => Some(FirstRow::Level(row)),
        Label::End { .. } | Label::Failure { .. } => None,
    })
}

fn followable(result: &SweepResult) -> impl Iterator<Item = FirstRow<'_>> {
    all_rows(result).filter(|row| row.has_curve())
}

fn by_label<'r>(label: &str, result: &'r SweepResult) -> Result<FirstRow<'r>, Report> {
    let rows = || all_rows(result);
    rows().find(|row| row.label() == label).ok_or_else(|| {
        Diagnostic::new(format!(
            "the sweep has no P- or D-bifurcation `{label}`, and no such crossing of a level"
        ))
        .allowed(rows_in_words(result))
        .nearest(label, rows().map(FirstRow::label))
        .into()
    })
}

/// The rows that curves can be followed from.
fn rows_in_words(result: &SweepResult) -> String {
    let rows: Vec<String> = followable(result)
        .map(|row| format!("{} ({})", row.label(), row.words(result)))
        .collect();
    if rows.is_empty() {
        "no row of this sweep has an indicator to follow".to_owned()
    } else {
        list(&rows)
    }
}

pub(super) fn no_indicator(row: FirstRow<'_>, result: &SweepResult) -> Report {
    let by = row.words(result);
    let title = format!(
        "{} was located by {by}: it has no indicator whose zero could be followed",
        row.label()
    );
    Diagnostic::new(title).allowed(rows_in_words(result)).into()
}

pub(super) fn which_parameter(sweep: &Sweep) -> Report {
    let held = sweep.problem.family().fixed();
    let names: Vec<&str> = held.map(|(name, _)| name).collect();
    let report = Diagnostic::new("which is the second parameter of the plane?");
    let report = if names.is_empty() {
        report.allowed("another number of the system's formulas, given under `[system.parameters]`")
    } else {
        report.allowed(format!(
            "the parameters that the sweep holds: {}",
            list(&names)
        ))
    };
    report
        .remedy("give `--second PARAMETER --from VALUE --to VALUE`, or a section `[curve]` in the sweep file")
        .into()
}

pub(super) fn refusal(error: CurveError) -> Report {
    let report = Diagnostic::new(error.to_string());
    let report = match error {
        CurveError::TooFewSamples => report.remedy(
            "sweep with more of them (errors fall with the root of their number), or with `method.kind = \"generator\"`, whose densities have no sampling error",
        ),
        CurveError::NoStart { .. } => {
            report.remedy("another row, or cells that resolve this one (`pbif sweep` says which do not), may have a curve")
        }
        _ => report,
    };
    report.into()
}

pub(super) fn refused_plane(error: &dyn std::error::Error) -> Report {
    Diagnostic::new(format!("the box has a corner that is not allowed: {error}"))
        .remedy("narrow the box with `--from`, `--to`, `--first-from` and `--first-to`")
        .into()
}

/// Refuses a plane with a corner that is not allowed, or at whose corners a state that modes carry goes beyond its
/// axis, which the sweep has chosen for the values that it holds.
pub(super) fn check_corners(sweep: &Sweep, plane: &Plane) -> Result<(), Report> {
    let (family, space) = (sweep.problem.family(), sweep.problem.space());
    let (model, [first, second]) = (family.model(), plane.sides());
    let Ok(held) = family.values_at(family.ends().0) else {
        return Ok(());
    };
    let pairs = [first.from, first.to]
        .into_iter()
        .flat_map(|one| [second.from, second.to].map(|other| [one, other]));
    for [one, other] in pairs {
        let values = model.with(&held, &first.parameter, one);
        let values = values.and_then(|values| model.with(&values, &second.parameter, other));
        let system = model.system(&values.map_err(|error| refused_plane(&error))?);
        for (index, axis) in space.axes().iter().enumerate() {
            let Some((low, high)) = system.facts().bounds(index).filter(|_| axis.is_modes()) else {
                continue;
            };
            let slack = BEYOND * (axis.to() - axis.from());
            if low >= axis.from() - slack && high <= axis.to() + slack {
                continue;
            }
            let name = family.axis(index);
            let title = format!(
                "at {} = {one}, {} = {other} the state `{name}` goes from {low} to {high}, and its modes only from {} to {}",
                first.parameter,
                second.parameter,
                axis.from(),
                axis.to()
            );
            let remedy = format!(
                "narrow the box, or sweep with a wider axis: `--set cells.{name}.from={low} --set cells.{name}.to={high}`"
            );
            let report = Diagnostic::new(title)
                .allowed("a box in which the axis holds the state everywhere")
                .remedy(remedy);
            return Err(report.into());
        }
    }
    Ok(())
}
