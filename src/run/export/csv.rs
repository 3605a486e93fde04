//! Tables of text: of every density one row a cell and value of the parameter, for programs that read columns.

use std::fmt::Write as _;
use std::path::Path;

use super::super::number::format_number;
use super::super::{RunError, write_anywhere};
use crate::continuation::{Point, Subject};

/// Writes `p_x.csv`, `p_xy.csv`, … into a folder: parameter, coordinates of the cell's centre, density, standard error.
pub(super) fn write(subject: &Subject, points: &[&Point], folder: &Path) -> Result<(), RunError> {
    let family = &subject.family;
    for (index, observable) in subject.observables.iter().enumerate() {
        let name = super::arrays::density(family, *observable);
        let mut text = family.parameter().to_owned();
        for axis in observable.axes() {
            text += &format!(",{}", family.axis(axis));
        }
        text += &format!(",{name},{name}_error\n");
        for point in points {
            add(&mut text, point, index);
        }
        write_anywhere(&folder.join(format!("{name}.csv")), text.as_bytes())?;
    }
    Ok(())
}

/// The rows of a point.
fn add(text: &mut String, point: &Point, index: usize) {
    let Some(estimate) = point.densities.get(index) else {
        return;
    };
    let value = format_number(point.value);
    let axes = &estimate.density.axes;
    let centres: Vec<Vec<String>> = (axes.iter())
        .map(|axis| axis.centres().into_iter().map(format_number).collect())
        .collect();
    let errors = estimate.stated_errors();
    let numbers = estimate.density.values.iter().zip(&errors);
    for (cell, (density, error)) in numbers.enumerate() {
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
