//! What goes wrong, as the exceptions of `pbif.errors`, with the words that the program has for it.

use std::path::Path;

use pbif::job::JobError;
use pbif::run::RunError;
use pbif::sweep_file::Report;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyTuple, PyType};

/// The exception of a name in `pbif.errors`, made of these arguments.
fn exception<'py>(
    py: Python<'py>,
    cell: &'static PyOnceLock<Py<PyType>>,
    name: &str,
    arguments: impl FnOnce(Python<'py>) -> PyResult<Bound<'py, PyTuple>>,
) -> PyErr {
    let made = || {
        let class = cell.import(py, "pbif.errors", name)?;
        class.call1(arguments(py)?)
    };
    match made() {
        Ok(value) => PyErr::from_value(value),
        Err(error) => error,
    }
}

/// Bad input, with the place of each finding that has one.
pub(crate) fn input(py: Python<'_>, report: &Report) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let findings = report.diagnostics().iter().map(|one| {
        let place = one.place().and_then(|place| report.sources().locate(place));
        let place = place.map(|at| (at.source, at.line, at.column));
        (one.title().to_owned(), place)
    });
    let findings: Vec<_> = findings.collect();
    exception(py, &CLASS, "InputError", |py| {
        (report.to_string(), findings).into_pyobject(py)
    })
}

/// Anything else.
pub(crate) fn other(py: Python<'_>, words: impl ToString) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    exception(py, &CLASS, "PbifError", |py| {
        (words.to_string(),).into_pyobject(py)
    })
}

/// A folder that cannot be read or written.
pub(crate) fn run(py: Python<'_>, error: &RunError) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    exception(py, &CLASS, "RunError", |py| {
        (error.to_string(),).into_pyobject(py)
    })
}

/// A job that was not carried out.
pub(crate) fn job(py: Python<'_>, error: &JobError) -> PyErr {
    match error {
        JobError::Refused(report) => input(py, report),
        JobError::Run(error) => run(py, error),
        error => other(py, error),
    }
}

/// A job that was interrupted; what it has solved is kept in a folder, where there is one.
pub(crate) fn interrupted(py: Python<'_>, folder: Option<&Path>) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    exception(py, &CLASS, "Interrupted", |py| (folder,).into_pyobject(py))
}

/// Warns with the words that the program has.
pub(crate) fn warn(py: Python<'_>, words: &[String]) -> PyResult<()> {
    static WARN: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let warn = WARN.import(py, "pbif.errors", "warn")?;
    words
        .iter()
        .try_for_each(|one| warn.call1((one,)).map(drop))
}
