//! The caption of a figure of a sweep, ready to be pasted: what is seen, of which system, by which method, what is
//! marked.

use crate::continuation::{BifurcationStatus, LabelledPoint, Point, PointType, SweepResult};
use crate::density::Observable;
use crate::space::Axis;
use crate::system::Family;
use crate::topology::Between;

use super::canvas::symbols;
use super::told::Shows;

/// How densities without sampling noise are drawn.
pub(super) const BETWEEN_CELLS: &str =
    "Between the cells the density is followed by parabolas with the averages of the cells.";

/// The caption of a figure; empty for one that has none.
pub(super) fn caption(result: &SweepResult, shows: &Shows<'_>) -> String {
    let seen = seen(result, shows);
    if seen.is_empty() {
        return seen;
    }
    let parts = [
        seen,
        system_of(&result.subject.family),
        method(result),
        between_cells(result, shows),
        marked(result, shows),
    ];
    let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    let version = env!("CARGO_PKG_VERSION");
    format!("{} Computed with pbif {version}.\n", parts.join(" "))
}

/// `p(x, y)`.
fn density(result: &SweepResult, observable: usize) -> String {
    let observable = result.subject.observables[observable];
    format!(
        "p({})",
        observable.symbols(&result.subject.family).join(", ")
    )
}

/// A number as captions have it.
pub(super) fn number(value: f64) -> String {
    let value = symbols::rounded(value);
    match value == 0.0 || (1e-4..1e6).contains(&value.abs()) {
        true => format!("{value}"),
        false => format!("{value:e}"),
    }
}

/// ` at f_c = -0.02, 0 and 0.01`.
fn at(result: &SweepResult, points: &[&Point]) -> String {
    let values: Vec<f64> = points.iter().map(|point| point.value).collect();
    at_values(&result.subject.family, &values)
}

/// The same of any values.
pub(super) fn at_values(family: &Family, values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|&value| number(value)).collect();
    let values = match values.as_slice() {
        [] => return String::new(),
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        all => all.join(", "),
    };
    format!(" at {} = {values}", family.parameter())
}

/// A value to the second digit of its error.
fn located(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite()) {
        return number(value);
    }
    let decimals = (1.0 - error.log10().floor()).clamp(0.0, 15.0) as usize;
    let text = format!("{value:.decimals$}");
    match text.chars().all(|c| matches!(c, '-' | '0' | '.')) {
        true => "0".to_owned(),
        false => text,
    }
}

/// What the figure shows.
fn seen(result: &SweepResult, shows: &Shows<'_>) -> String {
    let parameter = result.subject.family.parameter();
    match shows {
        Shows::Nothing
        | Shows::ComparedMarginals
        | Shows::ComparedJoint(_)
        | Shows::TimeToAccuracy => String::new(),
        Shows::Diagram(observable) => format!(
            "Steady-state marginal density {} over {parameter} (colours), with its peaks (solid) and valleys (dashed).",
            density(result, *observable)
        ),
        Shows::Marginals(points) => {
            format!("Steady-state marginal densities{}.", at(result, points))
        }
        Shows::Joint(observable, points, way) => format!(
            "Steady-state joint density {}{}, {way}.",
            density(result, *observable),
            at(result, points)
        ),
        Shows::Peaks(observable) => format!(
            "Places and heights of the peaks (solid) and valleys (dashed) of the steady-state marginal density {} over {parameter}.",
            density(result, *observable)
        ),
        Shows::Indicators(observable) => format!(
            "Indicators of P-bifurcations of the steady-state density {} over {parameter}; a P-bifurcation is where one is zero, bands are \
             systematic errors and two standard errors of sampling.",
            density(result, *observable)
        ),
        Shows::Homology(observable) => format!(
            "Betti numbers of the sets where the steady-state density {} exceeds a level: their pieces and holes, over {parameter} and the level as a share of \
             the highest peak.",
            density(result, *observable)
        ),
        Shows::Health => format!(
            "How well each value of {parameter} was solved: what is left of the equation, what leaves the domain, and the Hellinger \
             distance between neighbouring densities."
        ),
    }
}

/// The system with its parameters.
pub(super) fn system_of(family: &Family) -> String {
    let model = family.model();
    let equations = model.equations.join("; ");
    let fixed: Vec<String> = family
        .fixed()
        .map(|(name, value)| format!("{name} = {}", number(value)))
        .collect();
    let fixed = match fixed.is_empty() {
        true => String::new(),
        false => format!(", with {}", fixed.join(", ")),
    };
    format!("System: {} ({equations}){fixed}.", model.title)
}

/// The method and the cells.
fn method(result: &SweepResult) -> String {
    let Some(solved) = result
        .points
        .iter()
        .find(|point| !point.densities.is_empty())
    else {
        return String::new();
    };
    let family = &result.subject.family;
    let mut axes: Vec<(usize, &Axis)> = Vec::new();
    for estimated in &solved.densities {
        let numbers = match estimated.observable {
            Observable::Marginal(axis) => vec![axis],
            Observable::Joint(first, second) => vec![first, second],
        };
        for (number, axis) in numbers.into_iter().zip(&estimated.density.axes) {
            if axes.iter().all(|(known, _)| *known != number) {
                axes.push((number, axis));
            }
        }
    }
    axes.sort_by_key(|(number, _)| *number);
    let cells = axes.iter().map(|(number, axis)| {
        let (from, to) = (self::number(axis.from()), self::number(axis.to()));
        format!(
            "{} of {} in [{from}, {to}]",
            axis.count(),
            family.axis(*number)
        )
    });
    let cells: Vec<String> = cells.collect();
    format!(
        "Method: {}; cells: {}.",
        solved.report.method,
        cells.join(", ")
    )
}

/// What is drawn between the cells.
fn between_cells(result: &SweepResult, shows: &Shows<'_>) -> String {
    let is_shown = |observable: &Observable| match shows {
        Shows::Diagram(number) | Shows::Joint(number, ..) => {
            result.subject.observables.get(*number) == Some(observable)
        }
        Shows::Marginals(_) => matches!(observable, Observable::Marginal(_)),
        _ => false,
    };
    let densities = result.points.iter().flat_map(|point| &point.densities);
    let mut shown = densities.filter(|one| is_shown(&one.observable));
    match shown.any(|one| Between::new(one).is_some()) {
        true => BETWEEN_CELLS.to_owned(),
        false => String::new(),
    }
}

/// The P-bifurcations that are marked.
fn marked(result: &SweepResult, shows: &Shows<'_>) -> String {
    if matches!(shows, Shows::Nothing | Shows::Marginals(_)) {
        return String::new();
    }
    if let Shows::Joint(_, _, way) = shows {
        return match way.contains("map") {
            true => "Marked are peaks (+) and craters (o).".to_owned(),
            false => String::new(),
        };
    }
    let family = &result.subject.family;
    let words = |row: &LabelledPoint| {
        let status = match row.status {
            Some(BifurcationStatus::Located) | None => String::new(),
            Some(status) => format!(", {}", status.word()),
        };
        let observable = row
            .observable
            .map(|one| one.name(family))
            .unwrap_or_default();
        let error = format!("{:.1e}", row.error);
        format!(
            "{} at {} ± {error} ({observable}{status})",
            row.label,
            located(row.value, row.error)
        )
    };
    let rows = result
        .labels
        .iter()
        .filter(|row| row.kind == PointType::Bifurcation);
    let rows: Vec<String> = rows.map(words).collect();
    match rows.is_empty() {
        true => String::new(),
        false => format!("P-bifurcations: {}.", rows.join("; ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_digits_of_their_errors() {
        assert_eq!(located(-0.00284863, 2.7e-6), "-0.0028486");
        assert_eq!(located(2.3e-17, 4.5e-11), "0");
        assert_eq!(located(0.25, 0.0), "0.25");
        assert_eq!(located(12.34, 30.0), "12");
    }
}
