//! A sweep file, made ready to run.

use std::path::PathBuf;
use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::continuation::{Point, evenly_spaced};
use pbif::job::{MapJob, SweepJob};
use pbif::run::check_names;
use pbif::sweep_file::{Report, SweepFile};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::drift::{Drift, Failure, verify};
use crate::error;
use crate::found::{Found, stored};
use crate::home::Home;
use crate::job::{Eye, How, carried_out};
use crate::plane::{Plane, stored_plane};
use crate::session::Session;
use crate::watch::watched;

/// A sweep that is ready to run: everything is checked, and whatever was left to the program is chosen.
#[pyclass(frozen, module = "pbif._pbif")]
pub(crate) struct Sweep {
    inner: Arc<pbif::sweep_file::Sweep>,
    /// What holds a drift in Python.
    drift: Option<Py<Drift>>,
}

impl Sweep {
    fn failure(&self) -> Option<Arc<Failure>> {
        self.drift
            .as_ref()
            .map(|drift| Arc::clone(&drift.get().failure))
    }
}

/// The sweep of a sweep file with settings on top.
fn prepared(
    file: &mut SweepFile,
    settings: &[String],
    cancellation: &Cancellation,
) -> Result<(pbif::sweep_file::Sweep, Vec<String>), Report> {
    let settings = file.set_all("set", settings).validate()?;
    check_names(&settings)?;
    let warnings = &settings.warnings;
    let warnings = (!warnings.is_empty()).then(|| warnings.render(false).trim().to_owned());
    Ok((settings.prepare(cancellation)?, Vec::from_iter(warnings)))
}

#[pymethods]
impl Sweep {
    /// Reads a sweep file, a text that messages call `name`, or the file `name` without one.
    #[new]
    fn new(
        py: Python<'_>,
        name: PathBuf,
        text: Option<String>,
        settings: Vec<String>,
        drift: Option<Py<Drift>>,
    ) -> PyResult<Self> {
        let cancellation = Cancellation::new();
        let failure = drift.as_ref().map(|drift| Arc::clone(&drift.get().failure));
        let (read, raised) = watched(py, &cancellation, None, failure.as_deref(), |_| {
            let mut file = match &text {
                Some(text) => SweepFile::parse(&name.display().to_string(), text),
                None => SweepFile::read(&name)?,
            };
            prepared(&mut file, &settings, &cancellation)
        });
        if let Some(raised) = raised {
            return Err(raised);
        }
        let (sweep, warnings) = read.map_err(|report| error::input(py, &report))?;
        error::warn(py, &warnings)?;
        if failure.is_some() {
            let tried = py.detach(|| verify(&sweep));
            failure.as_deref().map_or(Ok(()), Failure::raised)?;
            tried.map_err(PyValueError::new_err)?;
        }
        Ok(Self {
            inner: Arc::new(sweep),
            drift,
        })
    }

    /// The complete sweep file.
    #[getter]
    fn toml(&self) -> String {
        self.inner.to_toml()
    }

    /// What is known of it: title, parameter, its values, parameters that are held, equations as lines and as MathML,
    /// axes, densities that are watched, method.
    fn about<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (settings, problem) = (&self.inner.settings, &self.inner.problem);
        let family = problem.family();
        let model = family.model();
        let about = PyDict::new(py);
        about.set_item("title", &settings.title)?;
        about.set_item("parameter", family.parameter())?;
        about.set_item("values", evenly_spaced(family.ends(), settings.points))?;
        about.set_item("held", family.fixed().collect::<Vec<_>>())?;
        about.set_item("equations", model.equations.clone())?;
        let typeset = model.typeset().iter().map(ToString::to_string);
        about.set_item("typeset", typeset.collect::<Vec<_>>())?;
        let axes = model.axes.iter().map(|axis| axis.name.as_str());
        about.set_item("axes", axes.collect::<Vec<_>>())?;
        let watched = problem.observables().iter().map(|one| one.name(family));
        about.set_item("observables", watched.collect::<Vec<_>>())?;
        about.set_item("is_map", settings.map.is_some())?;
        about.set_item("chosen", settings.chosen.clone())?;
        Ok(about)
    }

    /// Runs it in a folder, or in one that lasts as long as what is given. `look` is called with every value that is
    /// found, as what a session gives.
    fn run(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        how: How<'_>,
        look: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Found> {
        let home = Arc::new(Home::new(out)?);
        let job = SweepJob::new(&self.inner);
        let failure = self.failure();
        let call = |look: &Bound<'_, PyAny>, point: Box<Point>| {
            look.call1((Found::of_point(&self.inner, *point),))
                .map(drop)
        };
        let eye = look.as_ref().map(|look| move |point| call(look, point));
        let eye = eye.as_ref().map(|eye| eye as Eye<'_>);
        let found = carried_out(py, job, (home.path(), failure.as_deref()), &how, eye)
            .inspect_err(|_| home.keep())?;
        match found {
            Some(found) => Found::of_run(py, &self.inner, found, (home, self.failure())),
            None => stored(py, home, &[]),
        }
    }

    /// Makes its map of regimes, likewise.
    fn map(&self, py: Python<'_>, out: Option<PathBuf>, how: How<'_>) -> PyResult<Plane> {
        let home = Arc::new(Home::new(out)?);
        let job = MapJob::new(&self.inner);
        let failure = self.failure();
        let found = carried_out(py, job, (home.path(), failure.as_deref()), &how, None)
            .inspect_err(|_| home.keep())?;
        match found {
            Some(map) => Ok(Plane::of_map(&self.inner, map, home)),
            None => stored_plane(py, home),
        }
    }

    /// Opens a session.
    fn session(&self) -> Session {
        Session::new(&self.inner, self.failure())
    }
}
