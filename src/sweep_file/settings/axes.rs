//! The cells of each axis: range, count, grading. What is given is checked here; what is left to the program is found
//! later.

use super::along::SweptSystems;
use super::axis::{AxisSettings, Grade};
use super::axis_checks::{check_modes, refuse_cells, warn_of_few_cells, warn_of_idle_grade};
use super::equations::model_in_words;
use super::modes_of::ModesOf;
use crate::method::fixed_surfaces;
use crate::space::{Axis, CellSpace, Grading, SpaceError};
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::document::Document;
use crate::sweep_file::draft::{AxisDraft, Draft, MethodKind, Modes};
use crate::sweep_file::names::quotable;
use crate::sweep_file::reader::Reader;
use crate::sweep_file::value::Value;
use crate::system::{AxisDescription, Family, Model};

/// The key of `[cells]` that is no axis.
const ACCURACY: &str = "accuracy";

/// Checks `[cells]`; `None` if anything is wrong with it. Without a family there is no telling what bounds the model
/// knows.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    model: &Model,
    family: Option<&Family>,
) -> Option<Vec<AxisSettings>> {
    let names: Vec<&str> = model.axes.iter().map(|axis| axis.name.as_str()).collect();
    for entry in reader.entries(&["cells"]) {
        let is_axis = names.contains(&entry.key.as_str());
        if !is_axis && entry.key != ACCURACY {
            let axis = quotable(&entry.key);
            let diagnostic =
                Diagnostic::new(format!("{} has no axis `{axis}`", model_in_words(model)))
                    .at(&entry.key_place, "unknown axis")
                    .nearest(&entry.key, names.iter().copied());
            reader.report(diagnostic);
        }
    }
    let along = family.map(|family| SweptSystems::new(family, draft));
    // Every axis is read, so that all that is wrong is reported at once.
    let read: Vec<Option<AxisSettings>> = names
        .iter()
        .enumerate()
        .map(|(index, name)| {
            let described = (*name, &model.axes[index]);
            read_axis(reader, draft, described, along.as_ref(), index)
        })
        .collect();
    read.into_iter().collect()
}

/// A finding about the table `[cells]`.
pub(in crate::sweep_file) fn at_cells(document: &Document, diagnostic: Diagnostic) -> Diagnostic {
    diagnostic.at(
        document.root.find(&["cells"]).map(|entry| &entry.key_place),
        "these cells",
    )
}

fn read_axis(
    reader: &mut Reader<'_>,
    draft: &Draft,
    (name, described): (&str, &AxisDescription),
    along: Option<&SweptSystems<'_>>,
    index: usize,
) -> Option<AxisSettings> {
    let method = draft.method.kind;
    let series = ModesOf::new(along, index);
    let by_modes = method.takes_modes() && series.serve((index, described), along);
    if by_modes && reader.entry(&["cells", name]).is_none() {
        let bounds = along?.bounds(index);
        return Some(AxisSettings {
            ends: both(match series {
                ModesOf::Relaxing => bounds,
                ModesOf::Bounded | ModesOf::Noise { .. } | ModesOf::Turn => Some(bounds?),
            }),
            count: None,
            grade: Grade::Even,
            series,
            modes: Some(Modes::Auto),
        });
    }
    let Some(entry) = reader.entry(&["cells", name]) else {
        // Everything is left to the program.
        return Some(AxisSettings {
            ends: both(along.and_then(|along| along.bounds(index))),
            count: None,
            grade: match series {
                ModesOf::Turn => Grade::Even,
                _ => Grade::Auto,
            },
            series,
            modes: None,
        });
    };
    if !matches!(entry.node.value, Value::Table(_)) {
        return None;
    }
    if series == ModesOf::Turn {
        refuse_cells(reader, name)?;
    }
    let empty = AxisDraft::default();
    let axis = draft.axis(name).unwrap_or(&empty);
    let unsaid = axis.count.is_none() && reader.entry(&["cells", name, "count"]).is_none();
    let modes = axis.modes.or((by_modes && unsaid).then_some(Modes::Auto));
    let grade = read_grade(reader, axis, name);
    let bounds = along.map(|along| along.bounds(index));
    let ends = match axis.range {
        Some(_) => Some(both(bounds.flatten())),
        // What is wrong with it is reported already.
        None if reader.entry(&["cells", name, "range"]).is_some() => None,
        None => read_ends(reader, axis, name, bounds),
    };
    let ends = ends?;
    // An end by itself is often one at which noise dies: what is found for the other is found for the cells too.
    let is_one_found = ends.iter().filter(|end| end.is_none()).count() == 1;
    let is_unsaid = reader.entry(&["cells", name, "grade"]).is_none();
    let grade = match is_one_found && is_unsaid {
        true => Some(Grade::Auto),
        false => grade,
    };
    let settings = AxisSettings {
        ends,
        count: axis.count,
        grade: grade?,
        series,
        modes,
    };
    if modes.is_some() && method.takes_modes() {
        check_modes(reader, name, along?, index, settings.range())?;
    }
    match build_axis(reader.document(), name, &settings, method) {
        Ok(_) => {
            warn_of_few_cells(reader, name, &settings, method);
            warn_of_idle_grade(reader, name, &settings, method);
            Some(settings)
        }
        Err(diagnostic) => {
            reader.report(*diagnostic);
            None
        }
    }
}

/// Both ends of a range, or none.
fn both(range: Option<(f64, f64)>) -> [Option<f64>; 2] {
    [range.map(|range| range.0), range.map(|range| range.1)]
}

/// The ends that are given; one that is left out is the model's bound, where it knows one, and is found else. `None` if
/// something is wrong with them, or there is no telling what bounds the model knows.
fn read_ends(
    reader: &mut Reader<'_>,
    axis: &AxisDraft,
    name: &str,
    bounds: Option<Option<(f64, f64)>>,
) -> Option<[Option<f64>; 2]> {
    let end = |key: &str, value: Option<f64>, bound: Option<f64>| {
        let is_given = reader.entry(&["cells", name, key]).is_some();
        if is_given {
            value.map(Some)
        } else {
            bounds.map(|_| bound)
        }
    };
    let known = both(bounds.flatten());
    let ends = [
        end("from", axis.from, known[0])?,
        end("to", axis.to, known[1])?,
    ];
    let [Some(from), Some(to)] = ends else {
        return Some(ends);
    };
    if from < to && (to - from).is_finite() {
        return Some(ends);
    }
    let what = match from < to {
        true => "longer than the largest number",
        false => "empty or reversed",
    };
    // Plain numbers would have hundreds of digits.
    let [from, to] = [from, to].map(|end| match end.abs() < 1e15 {
        true => end.to_string(),
        false => format!("{end:e}"),
    });
    let title = format!("the range of axis `{name}`, from {from} to {to}, is {what}");
    let diagnostic = Diagnostic::new(title).allowed("finite numbers with `from` below `to`");
    let places = ["to", "from"].map(|key| reader.place(&["cells", name, key]));
    reader.report(match places.into_iter().flatten().next() {
        Some(place) => diagnostic.at(place, format!("the range is {from} to {to}")),
        None => at_cells(reader.document(), diagnostic),
    });
    None
}

/// What the file says of grading; `None` if something is wrong with it.
fn read_grade(reader: &mut Reader<'_>, axis: &AxisDraft, name: &str) -> Option<Grade> {
    let Some(entry) = reader.entry(&["cells", name, "grade"]) else {
        return Some(Grade::Even);
    };
    if !matches!(entry.node.value, Value::Table(_)) {
        return axis.grade.map(|_| Grade::Auto);
    }
    reader.require(&["cells", name, "grade", "at"]);
    reader.require(&["cells", name, "grade", "smallest"]);
    let at = axis.grade_at.clone()?;
    let smallest = axis.grade_smallest?;
    Some(if at.is_empty() {
        Grade::Even
    } else {
        Grade::Toward(Grading { at, smallest })
    })
}

/// Builds an axis, `None` where something is left to the program; what the space refuses is shown at the key that it
/// concerns.
fn build_axis(
    document: &Document,
    name: &str,
    settings: &AxisSettings,
    method: MethodKind,
) -> Result<Option<Axis>, Box<Diagnostic>> {
    let error = match settings.axis(method).transpose() {
        Ok(axis) => return Ok(axis),
        Err(error) => error,
    };
    let entry = |key: &[&str]| document.root.find(&[&["cells", name], key].concat());
    let place = match &error {
        SpaceError::GradingPoint { at, .. } => entry(&["grade", "at"]).and_then(|entry| {
            let items = entry.node.items().iter();
            // A repeated point is shown where it comes for the second time.
            items
                .rev()
                .find(|item| item.plain().and_then(|plain| plain.number()) == Some(*at))
                .map(|item| &item.place)
        }),
        SpaceError::Modes { .. } => entry(&["modes"]).map(|entry| &entry.node.place),
        SpaceError::GradingWidth { .. } => {
            entry(&["grade", "smallest"]).map(|entry| &entry.node.place)
        }
        _ => None,
    };
    let place = place.or_else(|| entry(&["count"]).map(|entry| &entry.node.place));
    let diagnostic = Diagnostic::new(format!("axis `{name}`: {error}"));
    Err(Box::new(diagnostic.at(place, "refused")))
}

/// The cell space of axes of which nothing is left to the program, with faces on all planes across an axis at which the
/// drift is not smooth all along the sweep: what is not smooth inside a cell is not seen there, however small the cell.
///
/// # Errors
/// The finding where the space refuses them, or something is left to the program.
pub(in crate::sweep_file) fn cell_space(
    document: &Document,
    family: &Family,
    axes: &[AxisSettings],
    method: MethodKind,
) -> Result<CellSpace, Box<Diagnostic>> {
    let mut built = Vec::new();
    let systems = family.along().unwrap_or_default();
    for (index, settings) in axes.iter().enumerate() {
        let name = family.axis(index);
        let Some(axis) = build_axis(document, name, settings, method)? else {
            let title = format!("range, grading or modes of axis `{name}` is left to the program");
            let diagnostic = Diagnostic::new(title).remedy("give numbers, or prepare the sweep");
            return Err(Box::new(at_cells(document, diagnostic)));
        };
        built.push(axis);
    }
    let with_faces = |space: CellSpace| {
        let axes = space.axes().iter().enumerate();
        let axes =
            axes.map(|(index, axis)| axis.with_faces_on(&fixed_surfaces(&systems, index, &space)));
        CellSpace::new(axes.collect())
    };
    CellSpace::new(built).and_then(with_faces).map_err(|error| {
        let diagnostic = Diagnostic::new(error.to_string());
        Box::new(at_cells(document, diagnostic))
    })
}
