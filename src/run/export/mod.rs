//! A run for other programs: its densities with their axes as one NetCDF file, or as tables of text.

mod csv;
mod netcdf;

use std::path::Path;

use super::arrays::{DensityPart, Layout};
use super::{RunError, arrays, bifurcations_csv};
use crate::continuation::measure::{DEVIATION, MEAN};
use crate::continuation::{MeasureKind, Point, StateField, SweepResult};
use crate::density::{EstimatedDensity, Variants};
use crate::space::Axis;
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

/// Name of the dimension of both ends of a cell.
const BOUNDS: &str = "bounds";

/// What is said of an array or of all of them.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    /// In words.
    Text(String),
    /// By a number.
    Number(f64),
}

impl From<String> for Attribute {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

/// A named array with its dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedArray {
    /// Its name, as in `densities.zarr`.
    pub name: String,
    /// Names and lengths, the slowest first.
    pub dimensions: Vec<(String, usize)>,
    /// The numbers, the last dimension the fastest; NaN where there is none.
    pub values: Vec<f64>,
    /// What it is, by the conventions CF (`long_name`, `units`, `bounds`, `valid_min`).
    pub attributes: Vec<(&'static str, Attribute)>,
}

impl NamedArray {
    fn new(name: String, dimensions: Vec<(String, usize)>, values: Vec<f64>, long: String) -> Self {
        let units = Attribute::Text("1".to_owned());
        Self {
            name,
            dimensions,
            values,
            attributes: vec![("long_name", long.into()), ("units", units)],
        }
    }

    fn line(name: &str, values: Vec<f64>, long_name: String) -> Self {
        let dimensions = vec![(name.to_owned(), values.len())];
        Self::new(name.to_owned(), dimensions, values, long_name)
    }

    fn with(mut self, name: &'static str, attribute: Attribute) -> Self {
        self.attributes.push((name, attribute));
        self
    }
}

/// Everything that is exported: coordinates first, then moments, then densities, one value of the parameter after the
/// other.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSet {
    /// Title, source, equations, the parameters that are held (JSON) and the table of changes (CSV).
    pub attributes: Vec<(&'static str, String)>,
    /// The arrays.
    pub arrays: Vec<NamedArray>,
}

/// Writes the densities and moments of a run's points to a file, or to a folder of tables. Points without a density are
/// left out. The arrays have the names of `densities.zarr`: `p_x` with dimensions of the parameter and `x`, normalised
/// to ∫ = 1, its standard error `p_x_error`, its second discretisation `p_x_second`; centres `x` and edges `x_edges` of
/// the cells; `mean_x` and `sd_x` with their errors `mean_x_error` and `sd_x_error`. See [`DataSet::new`].
///
/// # Errors
/// [`RunError::Write`], [`RunError::Export`] when the format cannot hold it, [`RunError::NothingToExport`] when no
/// point has a density.
pub fn export(
    result: &SweepResult,
    title: &str,
    format: ExportFormat,
    path: &Path,
) -> Result<(), RunError> {
    match format {
        ExportFormat::Csv => csv::write(&result.subject, &solved_points(result)?, path),
        ExportFormat::NetCdf => netcdf::write(&DataSet::new(result, title)?, path),
    }
}

/// The points with a density.
fn solved_points(result: &SweepResult) -> Result<Vec<&Point>, RunError> {
    let points = result.points.iter();
    let solved: Vec<&Point> = points.filter(|point| !point.densities.is_empty()).collect();
    if solved.is_empty() {
        return Err(RunError::NothingToExport);
    }
    Ok(solved)
}

impl DataSet {
    /// The densities and moments of a result. Cells have bounds beside their edges. Densities are
    /// [above zero](EstimatedDensity::above_zero): `valid_min` holds, and a map runs from one end of its colours.
    ///
    /// # Errors
    /// [`RunError::NothingToExport`] when no point has a density; [`RunError::Table`].
    pub fn new(result: &SweepResult, title: &str) -> Result<Self, RunError> {
        let points = &solved_points(result)?;
        let family = &result.subject.family;
        let parameter = family.parameter();
        let values = points.iter().map(|point| point.value).collect();
        let mut arrays = vec![NamedArray::line(
            parameter,
            values,
            format!("parameter {parameter}"),
        )];
        let first = points.first().into_iter();
        let densities = first.flat_map(|point| &point.densities);
        for density in densities.clone() {
            for (number, axis) in density.observable.axes().iter().zip(&density.density.axes) {
                let name = family.axis(*number);
                if arrays.iter().all(|known| known.name != name) {
                    arrays.extend(axis_arrays(name, axis));
                }
            }
        }
        for field in points.iter().flat_map(|point| &point.report.fields) {
            for (number, axis) in field.axes.iter().enumerate() {
                let name = family.axis(number);
                if arrays.iter().all(|known| known.name != name) {
                    arrays.extend(axis_arrays(name, axis));
                }
            }
        }
        arrays.extend(moments_at(family, points));
        for (index, density) in densities.enumerate() {
            arrays.extend(density_arrays(family, points, index, density));
        }
        for field in family.fields() {
            arrays.extend(field_arrays(family, points, &field.name));
        }
        let held: serde_json::Map<String, serde_json::Value> = family
            .fixed()
            .map(|(name, value)| (name.to_owned(), value.into()))
            .collect();
        let attributes = vec![
            ("title", title.to_owned()),
            ("Conventions", "CF-1.8".to_owned()),
            (
                "source",
                concat!("pbif ", env!("CARGO_PKG_VERSION")).to_owned(),
            ),
            ("equations", family.model().equations.join("\n")),
            ("parameters", serde_json::Value::Object(held).to_string()),
            ("changes", bifurcations_csv(family, &result.labels)?),
        ];
        Ok(Self { attributes, arrays })
    }
}

/// Centres, edges and bounds of the cells of an axis.
fn axis_arrays(name: &str, axis: &Axis) -> [NamedArray; 3] {
    let (edges, bounds) = (arrays::edges(name), format!("{name}_{BOUNDS}"));
    let centres = NamedArray::line(
        name,
        axis.centres(),
        format!("centres of the cells of {name}"),
    );
    let of_edges = format!("edges of the cells of {name}");
    let dimensions = vec![(name.to_owned(), axis.count()), (BOUNDS.to_owned(), 2)];
    let ends = axis.edges().windows(2).flatten().copied().collect();
    [
        centres.with("bounds", bounds.clone().into()),
        NamedArray::line(&edges, axis.edges().to_vec(), of_edges),
        NamedArray::new(
            bounds,
            dimensions,
            ends,
            format!("ends of the cells of {name}"),
        ),
    ]
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

fn moments_at(family: &Family, points: &[&Point]) -> Vec<NamedArray> {
    let array = |(name, long_name): (String, String)| {
        let value = |point: &&Point| {
            let found = match name.strip_suffix("_error") {
                Some(of) => point.report.error_of(of),
                None => point.report.measure(&name),
            };
            found.unwrap_or(f64::NAN)
        };
        let dimensions = vec![(family.parameter().to_owned(), points.len())];
        let values = points.iter().map(value).collect();
        NamedArray::new(name, dimensions, values, long_name)
    };
    moments(family).map(array).collect()
}

/// A density, its error, and its second discretisation where there is one.
fn density_arrays(
    family: &Family,
    points: &[&Point],
    index: usize,
    like: &EstimatedDensity,
) -> Vec<NamedArray> {
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
        let long_name = format!("{long} of {observable}");
        NamedArray::new(name, dimensions.clone(), values.collect(), long_name)
    };
    let observable = like.observable;
    let part = |number: usize| {
        move |one: &EstimatedDensity| {
            let mut parts = one.above_zero();
            Some(std::mem::take(&mut parts[number]))
        }
    };
    let second = |one: &EstimatedDensity| match &one.variants {
        Variants::Scheme(second) => Some(second.clone()),
        _ => None,
    };
    let mut arrays = vec![
        all(
            DensityPart::Density.name(family, observable),
            &part(0),
            "density",
        )
        .with("valid_min", Attribute::Number(0.0)),
        all(
            DensityPart::Error.name(family, observable),
            &part(1),
            "standard error of the density",
        ),
    ];
    if matches!(like.variants, Variants::Scheme(_)) {
        let name = DensityPart::Second.name(family, observable);
        arrays.push(all(name, &second, "density by a second discretisation"));
    }
    arrays
}

/// A field of a passage and its error, where a point has it.
fn field_arrays(family: &Family, points: &[&Point], name: &str) -> Vec<NamedArray> {
    let of = |point: &&Point| -> Option<StateField> {
        point
            .report
            .fields
            .iter()
            .find(|one| one.name == name)
            .cloned()
    };
    let found: Vec<Option<StateField>> = points.iter().map(of).collect();
    let Some(like) = found.iter().flatten().next() else {
        return Vec::new();
    };
    Layout::field(family, like)
        .into_iter()
        .zip([
            |one: &StateField| one.values.clone(),
            |one: &StateField| one.errors.clone(),
        ])
        .map(|(layout, numbers)| {
            let mut dimensions: Vec<(String, usize)> = layout
                .dimensions
                .iter()
                .map(|(name, length)| (name.clone(), *length as usize))
                .collect();
            dimensions[0].1 = points.len();
            let none = vec![f64::NAN; like.values.len()];
            let values = found
                .iter()
                .flat_map(|one| one.as_ref().map_or(none.clone(), numbers));
            let words = arrays::field_words(name);
            let words = if layout.name == name {
                words
            } else {
                format!("error of the {words}")
            };
            NamedArray::new(layout.name, dimensions, values.collect(), words)
        })
        .collect()
}

#[cfg(test)]
mod tests;
