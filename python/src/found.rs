//! What a sweep or a single solve has found: rows, columns, arrays, figures.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArrayMethods};
use pbif::continuation::{Point, SweepResult};
use pbif::explore::StoredPage;
use pbif::figure::Figures;
use pbif::job::{CurveJob, FirstRow, curve_rows};
use pbif::run::{
    Attribute, CURVES, DataSet, ExportFormat, RunError, StoredRun, doubt_in_words, export,
    finding_in_words,
};
use pbif::sweep_file::{Report, Sweep, SweepFile};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays;
use crate::drift::Failure;
use crate::error;
use crate::figure::Figure;
use crate::home::Home;
use crate::job::{How, carried_out};
use crate::plane::{Plane, stored_plane};
use crate::session::Session;

/// What was found along a sweep, or at one value.
#[pyclass(frozen, module = "pbif._pbif")]
pub(crate) struct Found {
    sweep: Arc<Sweep>,
    result: SweepResult,
    home: Option<Arc<Home>>,
    /// What a drift in Python has raised.
    failure: Option<Arc<Failure>>,
}

impl Found {
    /// At one value.
    pub(crate) fn of_point(sweep: &Arc<Sweep>, point: Point) -> Self {
        let result = SweepResult {
            subject: sweep.problem.subject().clone(),
            points: vec![point],
            labels: Vec::new(),
            checks: None,
            looks: Vec::new(),
            interrupted: false,
        };
        Self {
            sweep: Arc::clone(sweep),
            result,
            home: None,
            failure: None,
        }
    }

    /// Along a sweep that was just run; what must be known of it is warned of.
    pub(crate) fn of_run(
        py: Python<'_>,
        sweep: &Arc<Sweep>,
        result: SweepResult,
        (home, failure): (Arc<Home>, Option<Arc<Failure>>),
    ) -> PyResult<Self> {
        let warnings = StoredRun::open(home.path()).map(|run| run.warnings().to_vec());
        error::warn(py, &warnings.unwrap_or_default())?;
        Ok(Self {
            sweep: Arc::clone(sweep),
            result,
            home: Some(home),
            failure,
        })
    }
}

/// Reads a run, with settings of `detect`, `locate` and `figures` in the place of its own.
pub(crate) fn stored(py: Python<'_>, home: Arc<Home>, settings: &[String]) -> PyResult<Found> {
    let read = || -> Result<(Sweep, SweepResult), ReadError> {
        let run = StoredRun::open(home.path())?;
        let sweep = run.sweep_file().set_all("set", settings).validate()?;
        let sweep = sweep.fixed()?;
        let result = run.detect(&sweep)?;
        Ok((sweep, result))
    };
    match py.detach(read) {
        Ok((sweep, result)) => Ok(Found {
            sweep: Arc::new(sweep),
            result,
            home: Some(home),
            failure: None,
        }),
        Err(ReadError::Run(error)) => Err(error::run(py, &error)),
        Err(ReadError::File(report)) => Err(error::input(py, &report)),
    }
}

/// Why a run was not read.
enum ReadError {
    Run(RunError),
    File(Report),
}

impl From<RunError> for ReadError {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl From<Report> for ReadError {
    fn from(report: Report) -> Self {
        Self::File(report)
    }
}

/// Opens the run in a folder.
#[pyfunction]
pub(crate) fn open(py: Python<'_>, folder: PathBuf, settings: Vec<String>) -> PyResult<Found> {
    stored(py, Arc::new(Home::new(Some(folder))?), &settings)
}

#[pymethods]
impl Found {
    /// The folder; `None` of a single solve.
    #[getter]
    fn folder(&self) -> Option<PathBuf> {
        Some(self.home.as_ref()?.path().to_owned())
    }

    /// Keeps the folder for good.
    fn keep(&self) {
        self.home.iter().for_each(|home| home.keep());
    }

    #[getter]
    fn title(&self) -> &str {
        &self.sweep.settings.title
    }

    #[getter]
    fn parameter(&self) -> &str {
        self.result.subject.family.parameter()
    }

    #[getter]
    fn observables(&self) -> Vec<String> {
        let subject = &self.result.subject;
        let watched = subject.observables.iter();
        watched.map(|one| one.name(&subject.family)).collect()
    }

    /// The complete sweep file.
    #[getter]
    fn toml(&self) -> String {
        self.sweep.to_toml()
    }

    /// The rows of the table of changes.
    fn changes<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let family = &self.result.subject.family;
        let row = |label: &pbif::continuation::Label| {
            let row = PyDict::new(py);
            let words = label.words(family);
            let word = |of: fn(&pbif::continuation::RowWords) -> String| {
                words.as_ref().map(of).unwrap_or_default()
            };
            row.set_item("label", label.name())?;
            row.set_item("parameter", family.parameter())?;
            row.set_item("value", label.value())?;
            row.set_item("error", label.error())?;
            row.set_item("lower", label.bracket().0)?;
            row.set_item("upper", label.bracket().1)?;
            row.set_item("observable", word(|one| one.of.clone()))?;
            row.set_item("before", word(|one| one.before.clone()))?;
            row.set_item("after", word(|one| one.after.clone()))?;
            row.set_item("status", word(|one| one.status.word().to_owned()))?;
            row.set_item("change", word(|one| one.change.clone()))?;
            row.set_item("method", word(|one| one.method.to_owned()))?;
            let reason = label.reason().map(|doubt| doubt_in_words(family, doubt));
            row.set_item("reason", reason.unwrap_or_default())?;
            Ok(row)
        };
        self.result.labels.iter().map(row).collect()
    }

    /// Columns over the values of the parameter: name to numbers or words, and unit.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (columns, points) = (PyDict::new(py), &self.result.points);
        let numbers = |name: &str, unit: &str, of: &dyn Fn(&Point) -> Option<f64>| {
            let values = points.iter().map(|point| of(point).unwrap_or(f64::NAN));
            let values: Vec<f64> = values.collect();
            columns.set_item(name, (values.into_pyarray(py), unit))
        };
        numbers(self.parameter(), "", &|point| Some(point.value))?;
        let statuses = points.iter().map(|point| point.report.status.word());
        columns.set_item("status", (PyList::new(py, statuses)?, ""))?;
        numbers("residual", "1", &|point| Some(point.report.residual))?;
        let measures = points.iter().flat_map(|point| &point.report.measures);
        for measure in measures {
            if columns.contains(&measure.name)? {
                continue;
            }
            let name = measure.name.as_str();
            let of = |point: &Point| {
                let mut known = point.report.measures.iter();
                known.find(|one| one.name == name).cloned()
            };
            numbers(name, &measure.unit, &|point| Some(of(point)?.value))?;
            if points
                .iter()
                .any(|point| of(point).is_some_and(|one| one.error.is_some()))
            {
                let unit = &measure.unit;
                numbers(&format!("{name}_error"), unit, &|point| of(point)?.error)?;
            }
        }
        numbers("seconds", "s", &|point| Some(point.seconds))?;
        Ok(columns)
    }

    /// What was counted in every density, a list a value in the order of the observables; what must be known of each
    /// value, in words.
    #[allow(clippy::type_complexity)]
    fn seen(&self) -> (Vec<Vec<String>>, Vec<Vec<String>>) {
        let family = &self.result.subject.family;
        let points = self.result.points.iter();
        let of = |point: &Point| {
            let signatures = point.detections.iter().map(|one| one.signature.to_string());
            let findings = point.report.findings.iter();
            let findings = findings.map(|one| finding_in_words(family, one));
            (signatures.collect(), findings.collect())
        };
        points.map(of).unzip()
    }

    /// Peaks, valleys and craters: value, observable, kind, place, density, persistence, verdict.
    #[allow(clippy::type_complexity)]
    fn features(&self) -> Vec<(f64, String, String, Vec<f64>, f64, f64, String)> {
        let subject = &self.result.subject;
        let mut rows = Vec::new();
        for point in &self.result.points {
            let watched = subject.observables.iter().zip(&point.detections);
            for (observable, detection) in watched {
                rows.extend(detection.features.iter().map(|one| {
                    (
                        point.value,
                        observable.name(&subject.family),
                        format!("{:?}", one.kind).to_lowercase(),
                        one.position.clone(),
                        one.density,
                        one.persistence,
                        format!("{:?}", one.verdict).to_lowercase(),
                    )
                }));
            }
        }
        rows
    }

    /// The arrays of an export, and what is said of them all: each its name, dimensions, numbers and attributes. The
    /// numbers go over without a copy.
    #[allow(clippy::type_complexity)]
    fn arrays<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Vec<Bound<'py, PyAny>>, Vec<(&'static str, String)>)> {
        let data = py.detach(|| DataSet::new(&self.result, &self.sweep.settings.title));
        let data = data.map_err(|error| error::run(py, &error))?;
        let array = |one: pbif::run::NamedArray| {
            let (names, lengths): (Vec<String>, Vec<usize>) = one.dimensions.into_iter().unzip();
            let attributes = PyDict::new(py);
            for (name, value) in one.attributes {
                match value {
                    Attribute::Text(text) => attributes.set_item(name, text)?,
                    Attribute::Number(number) => attributes.set_item(name, number)?,
                }
            }
            let values = one.values.into_pyarray(py).reshape(lengths)?;
            Ok((one.name, names, values, attributes)
                .into_pyobject(py)?
                .into_any())
        };
        let arrays = data
            .arrays
            .into_iter()
            .map(array)
            .collect::<PyResult<_>>()?;
        Ok((arrays, data.attributes))
    }

    /// Names of the fields of passages over the state, with their units.
    fn fields(&self) -> Vec<(String, String)> {
        arrays::field_names(&self.result)
    }

    /// A field by its name. Its numbers are copied once.
    fn field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<arrays::Field<'py>>> {
        arrays::field(py, &self.result, name)
    }

    /// A density by its name, value by value.
    fn densities<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<Option<arrays::Densities<'py>>> {
        arrays::densities(py, &self.result, name)
    }

    /// Opens a session of its sweep.
    fn session(&self) -> Session {
        Session::new(&self.sweep, self.failure.clone())
    }

    /// Names of all figures.
    fn figure_names(&self) -> Vec<String> {
        self.with_figures(&[], |figures| figures.names())
    }

    /// A figure by its name, the first page of one of several; marginals and joint densities at the computed values
    /// nearest to `at`.
    fn figure(&self, py: Python<'_>, name: &str, at: Vec<f64>) -> PyResult<Option<Figure>> {
        let drawn = py.detach(|| self.with_figures(&at, |figures| figures.draw(name)));
        let drawn = drawn.map_err(|error| error::other(py, error))?;
        Ok(drawn.into_iter().next().map(Figure))
    }

    /// The page of the explorer, as HTML.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let page = py.detach(|| StoredPage::new(&self.sweep, &self.result));
        let page = page.map_err(|error| error::other(py, error))?;
        Ok(page.html().to_owned())
    }

    /// Writes densities and moments to a NetCDF file, or as tables into a folder.
    fn export(&self, py: Python<'_>, path: PathBuf, csv: bool) -> PyResult<()> {
        let format = if csv {
            ExportFormat::Csv
        } else {
            ExportFormat::NetCdf
        };
        let title = &self.sweep.settings.title;
        let written = py.detach(|| export(&self.result, title, format, &path));
        written.map_err(|error| error::run(py, &error))
    }

    /// Follows the curves from a row, as `settings` (of `[curve]`) say, in a folder or in that of the run.
    fn curve(
        &self,
        py: Python<'_>,
        settings: Vec<String>,
        out: Option<PathBuf>,
        how: How<'_>,
    ) -> PyResult<Plane> {
        let mut file = SweepFile::parse("the run's sweep", &self.sweep.to_toml());
        let sweep = file.set_all("set", &settings).validate();
        let sweep = sweep.and_then(|settings| settings.fixed());
        let sweep = Arc::new(sweep.map_err(|report| error::input(py, &report))?);
        let rows = curve_rows(&sweep, &self.result, true);
        let rows: Vec<FirstRow<'_>> = rows.map_err(|report| error::input(py, &report))?;
        let row = *rows
            .first()
            .ok_or_else(|| error::other(py, "no row to follow"))?;
        let job = CurveJob::new(&sweep, &self.result, row);
        let job = job.map_err(|report| error::input(py, &report))?;
        let plane = job.plane().clone();
        let name = format!("{}-{}", row.label(), plane.sides()[1].parameter);
        let (home, holder) = match (out, &self.home) {
            (None, Some(home)) => {
                let below = home.path().join(CURVES).join(name);
                (Home::new(Some(below))?, Some(Arc::clone(home)))
            }
            (out, _) => (Home::new(out)?, None),
        };
        let home = Arc::new(home);
        let found = carried_out(py, job, (home.path(), self.failure.as_deref()), &how, None)
            .inspect_err(|_| {
                home.keep();
                self.keep();
            })?;
        let plane = match found {
            Some(tree) => Plane::of_curves(&sweep, (plane, tree), row, home),
            None => stored_plane(py, home)?,
        };
        Ok(plane.held_by(holder))
    }
}

impl Found {
    /// Does something with the figures; without values with those at the sweep file's.
    fn with_figures<T>(&self, at: &[f64], of: impl FnOnce(&Figures<'_>) -> T) -> T {
        let settings = &self.sweep.settings;
        let single: Vec<f64> = self.result.points.iter().map(|point| point.value).collect();
        let at = match (at, self.home.is_some()) {
            ([], true) => &settings.figures.at,
            ([], false) => &single,
            (at, _) => at,
        };
        let problem = &self.sweep.problem;
        let figures = Figures::of_sweep(&self.result, &settings.title, at)
            .carried_by(problem.family(), problem.space().axes());
        of(&figures.with_style(&settings.figures.style))
    }
}
