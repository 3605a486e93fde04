//! Which row a curve starts from and which parameter is the second, and what is said where that does not go.

use crate::cli::CommandError;
use crate::continuation::curve::{CurveError, Plane};
use crate::continuation::{LabelledPoint, PointType, SweepResult};
use crate::method::MethodError;
use crate::sweep_file::{Diagnostic, Sweep, list};

/// The row of that label, or the only one that has an indicator.
pub(super) fn chosen_row<'a>(
    label: Option<&str>,
    result: &'a SweepResult,
) -> Result<&'a LabelledPoint, CommandError> {
    let rows = || {
        result
            .labels
            .iter()
            .filter(|row| row.kind == PointType::Bifurcation)
    };
    let Some(label) = label else {
        let mut with_curves = rows().filter(|row| row.indicator.is_some());
        return match (with_curves.next(), with_curves.next()) {
            (Some(row), None) => Ok(row),
            _ => {
                let report = Diagnostic::new("which row is the curve to be followed from?")
                    .allowed(rows_in_words(result))
                    .remedy("give its label, such as `--row PB1`");
                Err(CommandError::Input(report.into()))
            }
        };
    };
    let row = rows().find(|row| row.label == label);
    row.ok_or_else(|| {
        let known: Vec<&str> = rows().map(|row| row.label.as_str()).collect();
        let report = Diagnostic::new(format!("the sweep has no P-bifurcation `{label}`"))
            .allowed(rows_in_words(result))
            .nearest(label, known);
        CommandError::Input(report.into())
    })
}

/// The rows that curves can be followed from.
fn rows_in_words(result: &SweepResult) -> String {
    let family = &result.subject.family;
    let rows = result.labels.iter().filter(|row| row.indicator.is_some());
    let rows: Vec<String> = rows
        .map(|row| {
            let observable = row
                .observable
                .map(|one| one.name(family))
                .unwrap_or_default();
            format!("{} ({} of {observable})", row.label, row.method)
        })
        .collect();
    match rows.is_empty() {
        true => "no row of this sweep has an indicator to follow".to_owned(),
        false => list(&rows),
    }
}

pub(super) fn no_indicator(row: &LabelledPoint, result: &SweepResult) -> CommandError {
    let title = format!(
        "{} was located by {}: it has no indicator whose zero could be followed",
        row.label, row.method
    );
    let report = Diagnostic::new(title).allowed(rows_in_words(result));
    CommandError::Input(report.into())
}

/// The value at which a sweep holds the second parameter.
pub(super) fn held_value(name: &str, spec: &Sweep) -> Result<f64, CommandError> {
    let family = spec.problem.family();
    let held: Vec<(&str, f64)> = family.fixed().collect();
    if let Some((_, value)) = held.iter().find(|(known, _)| *known == name) {
        return Ok(*value);
    }
    let names: Vec<&str> = held.iter().map(|(name, _)| *name).collect();
    let title = match name == family.parameter() {
        true => format!("the second parameter is the swept one, `{name}`"),
        false => format!("there is no parameter `{name}`"),
    };
    let report = Diagnostic::new(title);
    let report = match names.is_empty() {
        true => report.remedy(
            "the system has no parameter but the swept one: name another number of its formulas, and give it under `[system.parameters]`",
        ),
        false => report
            .allowed(format!("the parameters that the sweep holds: {}", list(&names)))
            .nearest(name, names.iter().copied()),
    };
    Err(CommandError::Input(report.into()))
}

pub(super) fn refused(error: CurveError) -> CommandError {
    let report = Diagnostic::new(error.to_string());
    let report = match error {
        CurveError::EmptySide { .. } => report.remedy("the box needs a lower and a higher value of each parameter"),
        CurveError::TooFewSamples => report.remedy(
            "sweep with more of them (errors fall with the root of their number), or with `method.kind = \"generator\"`, whose densities have no sampling error",
        ),
        CurveError::NoStart { .. } => {
            report.remedy("another row, or cells that resolve this one (`pbif sweep` says which do not), may have a curve")
        }
        _ => report,
    };
    CommandError::Input(report.into())
}

pub(super) fn refused_plane(error: &MethodError) -> CommandError {
    let report = Diagnostic::new(format!("the box has a corner that is not allowed: {error}"))
        .remedy("narrow the box with `--from`, `--to`, `--first-from` and `--first-to`");
    CommandError::Input(report.into())
}

pub(super) fn which_parameter(spec: &Sweep) -> CommandError {
    let names: Vec<&str> = spec
        .problem
        .family()
        .fixed()
        .map(|(name, _)| name)
        .collect();
    let report = Diagnostic::new("which is the second parameter of the plane?")
        .allowed(format!(
            "the parameters that the sweep holds: {}",
            list(&names)
        ))
        .remedy("give `--second PARAMETER --from VALUE --to VALUE`, or a section `[curve]` in the sweep file");
    CommandError::Input(report.into())
}

pub(super) fn which_box(second: &str) -> CommandError {
    let report = Diagnostic::new(format!("from where to where does the box go in `{second}`?"))
        .allowed("two numbers, on either side of the value that the sweep holds")
        .remedy("give `--from VALUE --to VALUE`, or `from` and `to` in a section `[curve]` of the sweep file");
    CommandError::Input(report.into())
}

/// Refuses a plane with a corner that is not allowed, or at whose corners a state that modes carry goes beyond its
/// axis, which the sweep has chosen for the values that it holds.
pub(super) fn check_corners(spec: &Sweep, plane: &Plane) -> Result<(), CommandError> {
    let (family, space) = (spec.problem.family(), spec.problem.space());
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
        let values = values.map_err(|error| refused_plane(&MethodError::from(error)))?;
        let system = model.system(&values);
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
            let report = Diagnostic::new(title)
                .allowed("a box in which the axis holds the state everywhere")
                .remedy(format!(
                    "narrow the box, or sweep with a wider axis: `--set cells.{name}.from={low} --set cells.{name}.to={high}`"
                ));
            return Err(CommandError::Input(report.into()));
        }
    }
    Ok(())
}

/// Share of an axis by which a bound may be beyond it: rounding.
const BEYOND: f64 = 1e-9;
