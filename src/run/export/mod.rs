//! A run for other programs: its densities with their axes as one NetCDF file, or as tables of text.

mod csv;
mod netcdf;

use std::path::Path;

use super::RunError;
use super::arrays;
use crate::continuation::measure::{DEVIATION, MEAN};
use crate::continuation::{MeasureKind, Point, Subject};
use crate::density::{EstimatedDensity, Variants};
use crate::system::Family;

/// What a run can be written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportFormat {
    /// NetCDF classic with 64-bit offsets, one file.
    NetCdf,
    /// A folder with a table a density.
    Csv,
}

words! { ExportFormat, pub name: NetCdf: "netcdf", Csv: "csv" }

impl ExportFormat {
    /// Ending of the name of its file or folder.
    pub(crate) fn ending(self) -> &'static str {
        match self {
            Self::NetCdf => ".nc",
            Self::Csv => "-csv",
        }
    }
}

/// A named array with its dimensions.
struct Array {
    name: String,
    /// Names and lengths, the slowest first.
    dimensions: Vec<(String, usize)>,
    values: Vec<f64>,
    long_name: String,
}

impl Array {
    fn line(name: &str, values: Vec<f64>, long_name: String) -> Self {
        Self {
            name: name.to_owned(),
            dimensions: vec![(name.to_owned(), values.len())],
            values,
            long_name,
        }
    }
}

/// Everything that is exported: coordinates first, then moments, then densities, one value of the parameter after the
/// other.
struct DataSet {
    title: String,
    arrays: Vec<Array>,
}

/// Writes the densities and moments of a run's points to a file, or to a folder of tables. Points without a density are
/// left out. The arrays have the names of `densities.zarr`: `p_x` with dimensions of the parameter and `x`, normalised
/// to ∫ = 1, its standard error `p_x_error`, its second discretisation `p_x_second`; centres `x` and edges `x_edges` of
/// the cells; `mean_x` and `sd_x` with their errors `mean_x_error` and `sd_x_error`.
///
/// # Errors
/// [`RunError::Write`], [`RunError::Export`] when the format cannot hold it, [`RunError::NothingToExport`] when no
/// point has a density.
pub fn export(
    subject: &Subject,
    points: &[Point],
    title: &str,
    format: ExportFormat,
    path: &Path,
) -> Result<(), RunError> {
    let solved = points.iter().filter(|point| !point.densities.is_empty());
    let solved: Vec<&Point> = solved.collect();
    if solved.is_empty() {
        return Err(RunError::NothingToExport);
    }
    match format {
        ExportFormat::Csv => csv::write(subject, &solved, path),
        ExportFormat::NetCdf => netcdf::write(&data_set(subject, &solved, title), path),
    }
}

fn data_set(subject: &Subject, points: &[&Point], title: &str) -> DataSet {
    let family = &subject.family;
    let parameter = family.parameter();
    let values = points.iter().map(|point| point.value).collect();
    let mut arrays = vec![Array::line(
        parameter,
        values,
        format!("parameter {parameter}"),
    )];
    let Some(first) = points.first() else {
        return DataSet {
            title: title.to_owned(),
            arrays,
        };
    };
    for density in &first.densities {
        for (number, axis) in density.observable.axes().iter().zip(&density.density.axes) {
            let name = family.axis(*number);
            if arrays.iter().all(|known| known.name != name) {
                let edges = arrays::edges(name);
                arrays.push(Array::line(
                    name,
                    axis.centres(),
                    format!("centres of the cells of {name}"),
                ));
                arrays.push(Array::line(
                    &edges,
                    axis.edges().to_vec(),
                    format!("edges of the cells of {name}"),
                ));
            }
        }
    }
    arrays.extend(moments_at(family, points));
    for (index, density) in first.densities.iter().enumerate() {
        arrays.extend(densities(family, points, index, density));
    }
    DataSet {
        title: title.to_owned(),
        arrays,
    }
}

/// Names of means, standard deviations and their errors, with what they are.
pub(super) fn moments(family: &Family) -> impl Iterator<Item = (String, String)> {
    let values = family.averages().flat_map(|quantity| {
        let of =
            |kind: &MeasureKind, long: &str| (kind.name(quantity), format!("{long} of {quantity}"));
        [of(&MEAN, "mean"), of(&DEVIATION, "standard deviation")]
    });
    values.flat_map(|(name, long)| {
        let error = (format!("{name}_error"), format!("error of the {long}"));
        [(name, long), error]
    })
}

fn moments_at(family: &Family, points: &[&Point]) -> Vec<Array> {
    let array = |(name, long_name): (String, String)| {
        let value = |point: &&Point| {
            let found = match name.strip_suffix("_error") {
                Some(of) => point.report.error_of(of),
                None => point.report.measure(&name),
            };
            found.unwrap_or(f64::NAN)
        };
        Array {
            dimensions: vec![(family.parameter().to_owned(), points.len())],
            values: points.iter().map(value).collect(),
            long_name,
            name,
        }
    };
    moments(family).map(array).collect()
}

/// A density, its error, and its second discretisation where there is one.
fn densities(
    family: &Family,
    points: &[&Point],
    index: usize,
    like: &EstimatedDensity,
) -> Vec<Array> {
    let mut dimensions = vec![(family.parameter().to_owned(), points.len())];
    let mut cells = 1;
    for (number, axis) in like.observable.axes().iter().zip(&like.density.axes) {
        dimensions.push((family.axis(*number).to_owned(), axis.count()));
        cells *= axis.count();
    }
    let all = |name: String, of: &dyn Fn(&EstimatedDensity) -> Option<Vec<f64>>, long: &str| {
        let values = points.iter().flat_map(|point| {
            let found = point.densities.get(index).and_then(of);
            found
                .filter(|values| values.len() == cells)
                .unwrap_or(vec![f64::NAN; cells])
        });
        let observable = like.observable.name(family);
        Array {
            name,
            dimensions: dimensions.clone(),
            values: values.collect(),
            long_name: format!("{long} of {observable}"),
        }
    };
    let observable = like.observable;
    let density = |one: &EstimatedDensity| Some(one.density.values.clone());
    let error = |one: &EstimatedDensity| Some(one.standard_error.clone());
    let second = |one: &EstimatedDensity| match &one.variants {
        Variants::Scheme(second) => Some(second.clone()),
        _ => None,
    };
    let mut arrays = vec![
        all(arrays::density(family, observable), &density, "density"),
        all(
            arrays::error(family, observable),
            &error,
            "standard error of the density",
        ),
    ];
    if matches!(like.variants, Variants::Scheme(_)) {
        let name = arrays::second(family, observable);
        arrays.push(all(name, &second, "density by a second discretisation"));
    }
    arrays
}

#[cfg(test)]
mod tests;
