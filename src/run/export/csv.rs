//! Tables of text: of every density, and of every field of a passage, one row a cell and value of the parameter, for
//! programs that read columns.

use std::fmt::Write as _;
use std::path::Path;

use super::super::arrays::DensityPart;
use super::super::number::format_number;
use super::super::{RunError, write_anywhere};
use crate::continuation::{Point, Subject};
use crate::space::Axis;
use crate::system::Family;

/// Writes `p_x.csv`, `p_xy.csv`, … into a folder: parameter, coordinates of the cell's centre, density, standard error;
/// and the same of fields of passages, `exit_mean_time.csv`, ….
pub(super) fn write(subject: &Subject, points: &[&Point], folder: &Path) -> Result<(), RunError> {
    let family = &subject.family;
    for (index, observable) in subject.observables.iter().enumerate() {
        let name = DensityPart::Density.name(family, *observable);
        let mut text = header(family, &observable.axes(), &name);
        for point in points {
            if let Some(one) = point.densities.get(index) {
                let numbers = (one.density.values.as_slice(), one.stated_errors());
                add(&mut text, point.value, &one.density.axes, numbers);
            }
        }
        write_anywhere(&folder.join(format!("{name}.csv")), text.as_bytes())?;
    }
    let fields = || points.iter().flat_map(|point| &point.report.fields);
    let mut known = std::collections::BTreeSet::new();
    for like in fields().filter(|field| known.insert(field.name.as_str())) {
        let name = &like.name;
        let axes: Vec<usize> = (0..like.axes.len()).collect();
        let mut text = header(family, &axes, name);
        for point in points {
            let own = point.report.fields.iter().filter(|one| one.name == *name);
            for field in own {
                let numbers = (field.values.as_slice(), field.errors.clone());
                add(&mut text, point.value, &field.axes, numbers);
            }
        }
        write_anywhere(&folder.join(format!("{name}.csv")), text.as_bytes())?;
    }
    Ok(())
}

/// The names of the columns: the parameter, axes, and what is tabulated with its error.
fn header(family: &Family, axes: &[usize], name: &str) -> String {
    let axes = axes.iter().map(|&axis| family.axis(axis));
    let names: Vec<&str> = [family.parameter()].into_iter().chain(axes).collect();
    format!("{},{name},{name}_error\n", names.join(","))
}

/// The rows of a point: numbers with their errors at the cells of one axis or two, but where there are none.
fn add(text: &mut String, value: f64, axes: &[Axis], (values, errors): (&[f64], Vec<f64>)) {
    let value = format_number(value);
    let centres: Vec<Vec<String>> = (axes.iter())
        .map(|axis| axis.centres().into_iter().map(format_number).collect())
        .collect();
    let numbers = values.iter().zip(&errors).enumerate();
    for (cell, (density, error)) in numbers.filter(|(_, (value, _))| !value.is_nan()) {
        let place = match &centres[..] {
            [x, y] => format!("{},{}", x[cell / y.len()], y[cell % y.len()]),
            [x] => x[cell].clone(),
            _ => continue,
        };
        let (density, error) = (format_number(*density), format_number(*error));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{value},{place},{density},{error}");
    }
}
