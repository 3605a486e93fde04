//! The cell space: ranges, counts and grading of each axis, and whether it fits in memory.

use std::sync::Arc;

use crate::generator::automatic_grading;
use crate::method::cost;
use crate::method::{MethodOptions, SgcmOptions, automatic_ranges};
use crate::space::{Axis, CellSpace, Grading, SpaceError};
use crate::sweep_file::diagnostic::{Diagnostic, list};
use crate::sweep_file::document::Value;
use crate::sweep_file::reader::{Reader, Sited};
use crate::system::{Model, System};

use super::swept::Swept;

/// How one axis is cut into cells.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisCells {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Number of cells.
    pub count: usize,
    /// Where the cells get narrower; `None` for cells of equal width.
    pub grading: Option<Grading>,
}

impl AxisCells {
    fn axis(&self) -> Result<Axis, SpaceError> {
        match &self.grading {
            Some(grading) => Axis::graded(self.from, self.to, self.count, grading),
            None => Axis::uniform(self.from, self.to, self.count),
        }
    }
}

/// An axis as the file has it: what is `None` or `Auto` is left to the program.
struct RawAxis {
    range: Option<(f64, f64)>,
    count: usize,
    grade: RawGrade,
}

enum RawGrade {
    Given(Option<Grading>),
    Auto,
}

/// Finds the ranges and gradings that are left to the program.
fn resolve(reader: &mut Reader, raw: &[RawAxis], swept: Option<&Swept>) -> Option<Vec<AxisCells>> {
    let systems = swept.map_or(&[][..], |swept| &swept.ends);
    let known: Vec<Option<(f64, f64)>> = raw.iter().map(|axis| axis.range).collect();
    let given: Option<Vec<(f64, f64)>> = known.iter().copied().collect();
    let ranges = match given {
        Some(ranges) => ranges,
        None if systems.is_empty() => return None,
        None => match automatic_ranges(systems, &known, SgcmOptions::default().seed) {
            Some(ranges) => ranges,
            None => {
                let diagnostic = Diagnostic::new(
                    "no range holds the density: free trajectories run away somewhere along the sweep",
                )
                .remedy("give `from` and `to` instead of `range = \"auto\"`");
                reader.report(at_cells(reader, diagnostic));
                return None;
            }
        },
    };
    let cells = raw.iter().enumerate().map(|(index, axis)| {
        let (from, to) = ranges[index];
        let count = axis.count;
        let finest =
            |system: &Arc<dyn System>| automatic_grading(system.as_ref(), &ranges, index, count);
        let grading = match &axis.grade {
            RawGrade::Given(grading) => grading.clone(),
            RawGrade::Auto => systems
                .iter()
                .filter_map(finest)
                .min_by(|a, b| a.smallest.total_cmp(&b.smallest)),
        };
        AxisCells {
            from,
            to,
            count,
            grading,
        }
    });
    Some(cells.collect())
}

/// Reads `[cells]`; `None` if anything is wrong with it.
pub(super) fn read(
    reader: &mut Reader,
    model: &Model,
    swept: Option<&Swept>,
    method: &MethodOptions,
) -> Option<(Vec<AxisCells>, CellSpace)> {
    let names: Vec<&str> = model.axes.iter().map(|axis| axis.name.as_str()).collect();
    for name in reader.names(&["cells"]) {
        if !names.contains(&name.value.as_str()) {
            let title = format!("model `{}` has no axis `{}`", model.name, name.value);
            let diagnostic = Diagnostic::new(title)
                .at(&name.place, "unknown axis")
                .nearest(&name.value, names.iter().copied());
            reader.report(diagnostic);
        }
    }
    let axes = names.iter().enumerate();
    // Every axis is read, so that all that is wrong is reported at once.
    let read: Vec<Option<RawAxis>> = axes
        .map(|(index, name)| read_axis(reader, index, name, swept))
        .collect();
    let raw: Vec<RawAxis> = read.into_iter().collect::<Option<_>>()?;
    let cells = resolve(reader, &raw, swept)?;
    check_memory(reader, &cells, method)?;
    let axes: Vec<Option<Axis>> = names
        .iter()
        .zip(&cells)
        .map(|(name, cells)| build_axis(reader, name, cells))
        .collect();
    match CellSpace::new(axes.into_iter().collect::<Option<_>>()?) {
        Ok(space) => {
            check_factors(reader, &space, method)?;
            Some((cells, space))
        }
        Err(error) => {
            reader.report(at_cells(reader, Diagnostic::new(error.to_string())));
            None
        }
    }
}

/// A finding about the table `[cells]`.
fn at_cells(reader: &Reader, diagnostic: Diagnostic) -> Diagnostic {
    match reader.entry(&["cells"]) {
        Some(entry) => diagnostic.at(&entry.key_place, "these cells"),
        None => diagnostic,
    }
}

fn read_axis(
    reader: &mut Reader,
    index: usize,
    name: &str,
    swept: Option<&Swept>,
) -> Option<RawAxis> {
    let Some(entry) = reader.entry(&["cells", name]) else {
        let diagnostic = Diagnostic::new(format!("no cells for axis `{name}`")).remedy(format!(
            "add `{name} = {{ from = …, to = …, count = 50 }}` to [cells]"
        ));
        reader.report(at_cells(reader, diagnostic));
        return None;
    };
    if !matches!(entry.node.value, Value::Table(_)) {
        return None;
    }
    reader.require(&["cells", name, "count"]);
    let bounds = swept.and_then(|swept| bounds(swept, index));
    let grade = read_grading(reader, name);
    let count = reader.integer::<usize>(&["cells", name, "count"]);
    if reader.text(&["cells", name, "range"]).is_some() {
        return Some(RawAxis {
            range: bounds,
            count: count?.value,
            grade: grade?,
        });
    }
    let from = read_end(reader, name, "from", bounds.map(|bounds| bounds.0), swept);
    let to = read_end(reader, name, "to", bounds.map(|bounds| bounds.1), swept);
    let (from, to) = (from?, to?);
    if from >= to || !(to - from).is_finite() {
        let title =
            format!("the range of axis `{name}`, from {from} to {to}, is empty or reversed");
        let diagnostic = Diagnostic::new(title).allowed("finite numbers with `from` below `to`");
        let paths = [["cells", name, "to"], ["cells", name, "from"]];
        let place = paths.iter().find_map(|path| reader.entry(path));
        let place = place.map(|entry| entry.node.place.clone());
        reader.report(match place {
            Some(place) => diagnostic.at(&place, format!("the range is {from} to {to}")),
            None => at_cells(reader, diagnostic),
        });
        return None;
    }
    Some(RawAxis {
        range: Some((from, to)),
        count: count?.value,
        grade: grade?,
    })
}

/// The widest range that the model's bounds of an axis take at the ends of the sweep.
fn bounds(swept: &Swept, axis: usize) -> Option<(f64, f64)> {
    let ends: Option<Vec<(f64, f64)>> = swept.ends.iter().map(|end| end.bounds(axis)).collect();
    ends?
        .into_iter()
        .reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
}

fn read_end(
    reader: &mut Reader,
    axis: &str,
    key: &str,
    bound: Option<f64>,
    swept: Option<&Swept>,
) -> Option<f64> {
    let path = ["cells", axis, key];
    if reader.entry(&path).is_some() {
        return Some(reader.number(&path)?.value);
    }
    // Without a system there is no telling whether it knows a bound.
    if bound.is_none() && swept.is_some() {
        reader.require(&path);
    }
    bound
}

/// What the file says of grading, `None` if something is wrong with it.
fn read_grading(reader: &mut Reader, axis: &str) -> Option<RawGrade> {
    let Some(entry) = reader.entry(&["cells", axis, "grade"]) else {
        return Some(RawGrade::Given(None));
    };
    if !matches!(entry.node.value, Value::Table(_)) {
        return reader
            .text(&["cells", axis, "grade"])
            .map(|_| RawGrade::Auto);
    }
    let (at_path, smallest_path) = (
        ["cells", axis, "grade", "at"],
        ["cells", axis, "grade", "smallest"],
    );
    reader.require(&at_path);
    reader.require(&smallest_path);
    let at: Vec<f64> = reader
        .numbers(&at_path)?
        .iter()
        .map(|at| at.value)
        .collect();
    let smallest = reader.number(&smallest_path)?.value;
    let grading = (!at.is_empty()).then_some(Grading { at, smallest });
    Some(RawGrade::Given(grading))
}

/// Builds an axis; what the space refuses is shown at the key that it concerns.
fn build_axis(reader: &mut Reader, name: &str, cells: &AxisCells) -> Option<Axis> {
    let error = match cells.axis() {
        Ok(axis) => return Some(axis),
        Err(error) => error,
    };
    let place = match &error {
        SpaceError::GradingPoint { at, .. } => {
            let points = reader.numbers(&["cells", name, "grade", "at"]);
            let points: Vec<Sited<f64>> = points.unwrap_or_default();
            // A repeated point is shown where it comes for the second time.
            points.into_iter().rfind(|point| point.value == *at)
        }
        SpaceError::GradingWidth { .. } => reader.number(&["cells", name, "grade", "smallest"]),
        _ => None,
    };
    let place = place.map(|sited| sited.place).or_else(|| {
        let entry = reader.entry(&["cells", name, "count"])?;
        Some(entry.node.place.clone())
    });
    let diagnostic = Diagnostic::new(format!("axis `{name}`: {error}"));
    reader.report(match place {
        Some(place) => diagnostic.at(&place, "refused"),
        None => diagnostic,
    });
    None
}

/// Refuses cells whose least need exceeds the machine's memory; runs before anything is laid out.
fn check_memory(reader: &mut Reader, cells: &[AxisCells], method: &MethodOptions) -> Option<()> {
    let n_cells: f64 = cells.iter().map(|axis| axis.count as f64).product();
    let least = cost::least_bytes(n_cells, cells.len(), method);
    let Some(memory) = cost::machine_memory().filter(|&memory| least > memory) else {
        return Some(());
    };
    let counts: Vec<String> = cells.iter().map(|axis| axis.count.to_string()).collect();
    let title = format!(
        "{} cells need at least {} of memory; this machine has {}",
        counts.join(" × "),
        cost::bytes_in_words(least),
        cost::bytes_in_words(memory)
    );
    let names: Vec<String> = reader
        .names(&["cells"])
        .into_iter()
        .map(|name| format!("cells.{}.count", name.value))
        .collect();
    let diagnostic = Diagnostic::new(title).remedy(format!("lower one of {}", list(&names)));
    reader.report(at_cells(reader, diagnostic));
    None
}

/// Refuses cells whose factors exceed the memory that they may take.
fn check_factors(reader: &mut Reader, space: &CellSpace, method: &MethodOptions) -> Option<()> {
    let MethodOptions::Generator(options) = method else {
        return Some(());
    };
    let Err(error) = cost::factorisation(space, options) else {
        return Some(());
    };
    let diagnostic = Diagnostic::new(error.to_string())
        .remedy("use fewer cells, or raise `method.memory_limit` (gigabytes)");
    reader.report(at_cells(reader, diagnostic));
    None
}
