//! A figure of the library, as notebooks and files take it.

use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error;

/// A figure as a journal prints it.
#[pyclass(frozen, module = "pbif")]
pub(crate) struct Figure(pub(crate) pbif::figure::Figure);

#[pymethods]
impl Figure {
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    #[getter]
    fn caption(&self) -> &str {
        &self.0.caption
    }

    #[getter]
    fn data(&self) -> &str {
        &self.0.data
    }

    #[getter]
    fn svg(&self) -> String {
        self.0.svg()
    }

    #[getter]
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.0.png());
        let bytes = bytes.map_err(|error| error::other(py, error))?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[getter]
    fn pdf<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let bytes = py.detach(|| self.0.pdf());
        PyBytes::new(py, &bytes)
    }

    fn _repr_svg_(&self) -> String {
        self.0.svg()
    }

    fn __repr__(&self) -> String {
        format!("<pbif.Figure {}>", self.0.name)
    }
}
