//! `points.csv`: a row a parameter value, written and read back.

use std::path::Path;

use super::RunError;
use super::cell::Cell;
use super::columns::{Column, Columns, count, digits, number, optional, word};
use super::findings::{findings_cell, parse_findings};
use super::sentences::sentences;
use crate::continuation::measure::{
    DEVIATION, EDGE_MASS, ESCAPE_RATE, FACTORISATIONS, MAP_STEP, MEAN, NEGATIVE_MASS,
    NUMERICAL_DIFFUSION, TIME_STEP_BIAS,
};
use crate::continuation::{
    Finding, MeasureColumn, MeasureKind, Point, PointStatus, Solution, SolveReport, Subject,
};
use crate::density::Observable;
use crate::system::Family;
use crate::topology::Detection;

/// The table's columns. `methods` are the names that a row may give as its method where the table is read.
///
/// A point without a density has empty cells. `edge_mass` is the largest over the axes of the mass in cells at an end
/// of that axis' range. Signatures and distances are not read back: they follow from the densities.
pub(super) fn columns<'a>(
    family: &'a Family,
    observables: &[Observable],
    measures: &[MeasureColumn],
    methods: &'a [&'static str],
) -> Columns<'a, Point> {
    let mut columns = Vec::from(of_solve(family, methods));
    for name in family.averages() {
        columns.extend([measure(&MEAN, name), measure(&DEVIATION, name)]);
    }
    columns.extend(of_detections(family, observables));
    columns.push(optional("distance", |point: &Point| point.distance));
    columns.push(
        digits("seconds", |point: &Point| format!("{:.3}", point.seconds))
            .read(|cell| cell.number(), |point, value| point.seconds = value),
    );
    columns.push(measure(&MAP_STEP, ""));
    columns.push(or_zero(&FACTORISATIONS));
    let axes = family.model().axes.iter();
    columns.extend(axes.map(|axis| measure(&NUMERICAL_DIFFUSION, &axis.name)));
    columns.extend(of_doubts(family));
    columns.extend(rings(family, observables));
    for column in measures {
        columns.extend(derived_measure(column));
    }
    for name in family.averages() {
        columns.extend([&MEAN, &DEVIATION].map(|kind| error_of(kind.name(name))));
    }
    Columns(columns)
}

/// What was solved, and how.
fn of_solve<'a>(family: &'a Family, methods: &'a [&'static str]) -> [Column<'a, Point>; 8] {
    [
        number(family.parameter(), |point: &Point| point.value)
            .read(|cell| cell.number(), |point, value| point.value = value),
        word("status", |point: &Point| point.report.status.word()).read(
            |cell| cell.choice(&PointStatus::ALL, PointStatus::word),
            |point, status| point.report.status = status,
        ),
        word("method", |point: &Point| point.report.method).read(
            |cell| cell.choice(methods, |name| name),
            |point, method| point.report.method = method,
        ),
        count("iterations", |point: &Point| point.report.iterations).read(
            |cell| cell.count(),
            |point, value| point.report.iterations = value,
        ),
        number("residual", |point: &Point| point.report.residual).read(
            |cell| cell.number_or_nan(),
            |point, value| point.report.residual = value,
        ),
        or_zero(&ESCAPE_RATE),
        or_zero(&NEGATIVE_MASS),
        optional(EDGE_MASS.word, |point: &Point| point.report.edge_mass()).read(
            |cell| cell.optional(),
            |point, value| set(point, &EDGE_MASS, "", value),
        ),
    ]
}

/// A measure that may be missing.
fn measure<'a>(kind: &'static MeasureKind, of: &str) -> Column<'a, Point> {
    let (name, of) = (kind.name(of), of.to_owned());
    optional(name.clone(), move |point: &Point| {
        point.report.measure(&name)
    })
    .read(
        |cell| cell.optional(),
        move |point, value| set(point, kind, &of, value),
    )
}

/// A derived measure and its error.
fn derived_measure<'a>(column: &MeasureColumn) -> [Column<'a, Point>; 2] {
    let name = column.kind.name(&column.of);
    let (own, of) = (name.clone(), column.clone());
    let value = optional(name.clone(), move |point: &Point| {
        point.report.measure(&own)
    })
    .read(
        |cell| cell.optional(),
        move |point, value| {
            let value = value.map(|value| of.kind.measure(&of.of, value));
            point.report.measures.extend(value);
        },
    );
    // A run may have been made without.
    [value.newer(), error_of(name)]
}

/// The error of a measure whose column comes before.
fn error_of<'a>(name: String) -> Column<'a, Point> {
    let (own, known) = (name.clone(), format!("{name}_error"));
    optional(known, move |point: &Point| point.report.error_of(&own))
        .read(
            |cell| cell.optional(),
            move |point, error| {
                let mut measures = point.report.measures.iter_mut();
                if let Some(measure) = measures.find(|one| one.name == name) {
                    measure.error = error;
                }
            },
        )
        .newer()
}

/// A measure that is zero where a method does not know it; an empty cell is one that is no number.
fn or_zero<'a>(kind: &'static MeasureKind) -> Column<'a, Point> {
    let of = |point: &Point| point.report.of(kind, "").unwrap_or(0.0);
    number(kind.word, of).read(
        |cell| cell.number_or_nan(),
        |point, value| set(point, kind, "", Some(value)),
    )
}

fn set(point: &mut Point, kind: &MeasureKind, of: &str, value: Option<f64>) {
    if let Some(value) = value {
        point.report.add(kind, of, value);
    }
}

/// Counts of peaks and craters.
fn of_detections<'a>(family: &Family, observables: &[Observable]) -> Vec<Column<'a, Point>> {
    let all = 0..observables.len();
    let peaks = |number| {
        counts(family, observables, "peaks", number, |one| {
            one.signature.peaks
        })
    };
    let craters = |number| {
        counts(family, observables, "craters", number, |one| {
            one.signature.craters
        })
    };
    let joint = |number: &usize| matches!(observables[*number], Observable::Joint(..));
    let peaks = all.clone().map(peaks);
    peaks.chain(all.filter(joint).map(craters)).collect()
}

/// Counts of rings.
fn rings<'a>(family: &Family, observables: &[Observable]) -> Vec<Column<'a, Point>> {
    let joint = |number: &usize| matches!(observables[*number], Observable::Joint(..));
    let rings = |number| {
        counts(family, observables, "rings", number, |one| {
            one.signature.rings
        })
    };
    (0..observables.len()).filter(joint).map(rings).collect()
}

/// Counts of one kind in the observable of the given number.
fn counts<'a>(
    family: &Family,
    observables: &[Observable],
    kind: &str,
    number: usize,
    count: fn(&Detection) -> usize,
) -> Column<'a, Point> {
    let of = move |point: &Point| point.detections.get(number).map(count);
    let name = format!("{kind}_{}", observables[number].name(family));
    digits(name, move |point| {
        of(point).map_or(String::new(), |count| count.to_string())
    })
}

/// What the solve says of its own errors, and what else it found.
fn of_doubts<'a>(family: &'a Family) -> [Column<'a, Point>; 4] {
    // Tables of earlier versions have sentences alone, which are then kept as one.
    let set_told = |point: &mut Point, text: String| {
        let told = Some(text).filter(|text| !text.is_empty());
        point.report.findings = told.into_iter().map(Finding::Told).collect();
    };
    let set_findings = |point: &mut Point, findings: Vec<Finding>| {
        if !findings.is_empty() {
            point.report.findings = findings;
        }
    };
    [
        number("solver_error", |point: &Point| point.report.solver_error)
            .read(
                |cell| cell.number_or_nan(),
                |point, value| point.report.solver_error = value,
            )
            .newer(),
        measure(&TIME_STEP_BIAS, "").newer(),
        word("warnings", move |point: &Point| {
            sentences(family, &point.report.findings)
        })
        .read(|cell| Ok(cell.text.to_owned()), set_told),
        word("findings", move |point: &Point| {
            findings_cell(family, &point.report.findings)
        })
        .read(move |cell| findings(family, cell), set_findings)
        .newer(),
    ]
}

/// The findings that a cell tells.
fn findings(family: &Family, cell: &Cell<'_>) -> Result<Vec<Finding>, RunError> {
    parse_findings(family, cell.text).map_err(|word| {
        let wrong = Cell {
            text: word,
            ..*cell
        };
        wrong.wrong("a finding with its numbers")
    })
}

/// The columns of a subject's table, to be written.
pub(super) fn of_subject(subject: &Subject) -> Columns<'_, Point> {
    columns(
        &subject.family,
        &subject.observables,
        &subject.measures,
        &[],
    )
}

/// The table, ascending in the parameter.
///
/// # Errors
/// [`RunError::Table`].
pub(crate) fn points_csv(subject: &Subject, points: &[Point]) -> Result<String, RunError> {
    of_subject(subject).csv(ascending(points))
}

/// Reads the table back: everything of its points but densities and what follows from them, in the order of the table.
/// One that is not `complete` may lack the end of its last row.
///
/// # Errors
/// [`RunError::Read`]; [`RunError::Column`] and [`RunError::Row`] when the table is not one of this sweep.
pub(super) fn read_points(
    path: &Path,
    subject: &Subject,
    methods: &[&'static str],
    complete: bool,
) -> Result<Vec<Point>, RunError> {
    let family = &subject.family;
    let points = columns(family, &[], &subject.measures, methods).read(path, complete, blank)?;
    for (row, point) in points.iter().enumerate() {
        let same = |other: &Point| other.value == point.value;
        if let Some(first) = points[..row].iter().position(same) {
            return Err(RunError::Row {
                path: path.to_owned(),
                line: row as u64 + 2,
                column: family.parameter().to_owned(),
                value: point.value.to_string(),
                wanted: format!("a new value: line {} has it", first + 2),
            });
        }
    }
    Ok(points)
}

/// Points in the order of tables.
pub(super) fn ascending(points: &[Point]) -> Vec<&Point> {
    let mut sorted: Vec<&Point> = points.iter().collect();
    sorted.sort_by(|a, b| a.value.total_cmp(&b.value));
    sorted
}

/// A point of which nothing is known.
fn blank() -> Point {
    let solution = Solution::without_density(SolveReport::solved(""));
    Point::undetected(f64::NAN, solution)
}
