//! What a sweep has found over cells, as arrays of NumPy: fields of passages, and densities for a user's own detectors.

use numpy::{IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods};
use pbif::continuation::{Point, SweepResult};
use pbif::space::Axis;
use pbif::system::{Family, FieldKind, FieldQuestion};
use pyo3::prelude::*;

/// Name of an axis, centres and edges of its cells.
type Cells<'py> = (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Numbers over cells.
type Numbers<'py> = Bound<'py, PyArrayDyn<f64>>;

/// A field at every value that has a density: these values, numbers and errors over value and state, the axes.
pub(crate) type Field<'py> = (
    Bound<'py, PyArray1<f64>>,
    Numbers<'py>,
    Numbers<'py>,
    Vec<Cells<'py>>,
);

/// A density at every value that has it: the axes; value, density and standard errors.
pub(crate) type Densities<'py> = (Vec<Cells<'py>>, Vec<(f64, Numbers<'py>, Numbers<'py>)>);

fn cells<'py, 'a>(
    py: Python<'py>,
    family: &Family,
    axes: impl Iterator<Item = (usize, &'a Axis)>,
) -> (Vec<Cells<'py>>, Vec<usize>) {
    let of = |(number, axis): (usize, &Axis)| {
        let name = family.axis(number).to_owned();
        let centres = axis.centres().into_pyarray(py);
        let edges = axis.edges().to_vec().into_pyarray(py);
        ((name, centres, edges), axis.count())
    };
    axes.map(of).unzip()
}

/// The unit of a field over all axes, made of `t` and their names.
fn unit(family: &Family, field: &FieldQuestion) -> String {
    let axes = family.model().axes.iter().enumerate();
    let volume = |without: Option<usize>| {
        let others = axes.clone().filter(|(number, _)| Some(*number) != without);
        others.map(|(_, axis)| axis.name.as_str()).collect()
    };
    let one_over = |mut factors: Vec<&str>, time: Option<&'static str>| {
        factors.extend(time);
        match factors.as_slice() {
            [factor] => format!("1/{factor}"),
            _ => format!("1/({})", factors.join(" ")),
        }
    };
    match field.kind {
        FieldKind::MeanTime => "t".to_owned(),
        FieldKind::Committor => "1".to_owned(),
        FieldKind::ReactiveDensity => one_over(volume(None), None),
        FieldKind::ReactiveCurrent => one_over(volume(field.axis), Some("t")),
    }
}

/// The points that have a density: those that an export has.
fn solved(result: &SweepResult) -> impl Iterator<Item = &Point> {
    let points = result.points.iter();
    points.filter(|point| !point.densities.is_empty())
}

/// Names of the fields that are known at some value, with their units.
pub(crate) fn field_names(result: &SweepResult) -> Vec<(String, String)> {
    let family = &result.subject.family;
    let known = |field: &&FieldQuestion| {
        let mut fields = solved(result).flat_map(|point| &point.report.fields);
        fields.any(|one| one.name == field.name)
    };
    let wanted = family.fields().filter(known);
    wanted
        .map(|field| (field.name.clone(), unit(family, field)))
        .collect()
}

/// A field by its name, NaN where a value does not have it; `None` where none has.
pub(crate) fn field<'py>(
    py: Python<'py>,
    result: &SweepResult,
    name: &str,
) -> PyResult<Option<Field<'py>>> {
    let rows = solved(result).map(|point| {
        let mut fields = point.report.fields.iter();
        (point.value, fields.find(|one| one.name == name))
    });
    let (values, found): (Vec<f64>, Vec<_>) = rows.unzip();
    let Some(like) = found.iter().flatten().next() else {
        return Ok(None);
    };
    let (axes, counts) = cells(py, &result.subject.family, like.axes.iter().enumerate());
    let shape: Vec<usize> = [values.len()].into_iter().chain(counts).collect();
    let mut numbers = [(); 2].map(|()| Vec::with_capacity(shape.iter().product()));
    for one in &found {
        for (array, is_error) in numbers.iter_mut().zip([false, true]) {
            match one {
                Some(one) if is_error => array.extend_from_slice(&one.errors),
                Some(one) => array.extend_from_slice(&one.values),
                None => array.resize(array.len() + like.values.len(), f64::NAN),
            }
        }
    }
    let [field, errors] = numbers.map(|array| array.into_pyarray(py).reshape(shape.clone()));
    Ok(Some((values.into_pyarray(py), field?, errors?, axes)))
}

/// A density by its name, above zero; `None` where no value has it.
pub(crate) fn densities<'py>(
    py: Python<'py>,
    result: &SweepResult,
    name: &str,
) -> PyResult<Option<Densities<'py>>> {
    let subject = &result.subject;
    let family = &subject.family;
    let mut watched = subject.observables.iter();
    let Some(place) = watched.position(|one| one.name(family) == name) else {
        return Ok(None);
    };
    let points = result.points.iter();
    let known = points.filter_map(|point| Some((point.value, point.densities.get(place)?)));
    let (mut axes, mut rows) = (Vec::new(), Vec::new());
    for (value, one) in known {
        let numbers = one.observable.axes();
        let (names, shape) = cells(py, family, numbers.iter().copied().zip(&one.density.axes));
        let arrays = one.above_zero().map(|numbers| numbers.into_pyarray(py));
        let [density, errors] = arrays.map(|array| array.reshape(shape.clone()));
        axes = names;
        rows.push((value, density?, errors?));
    }
    Ok(Some((axes, rows)))
}
