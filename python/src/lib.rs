//! `pbif._pbif`: the library as the Python package `pbif` calls it. Nothing is computed here: texts and numbers go in,
//! texts, arrays and exceptions come out. What a user sees, with its documentation, is in `python/pbif/`.

mod arrays;
mod drift;
mod error;
mod figure;
mod found;
mod home;
mod job;
mod plane;
mod session;
mod sweep;
mod watch;

use std::ffi::OsString;
use std::io::Write as _;

use pbif::sweep_file::starting_files;
use pbif::system::registry;
use pyo3::prelude::*;

/// Carries out a command line, the program's name first, and gives the status that the process is to end with.
#[pyfunction]
fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| {
        let status = pbif::cli::run_with(words);
        // A program's end would do so. Without a reader there is nobody to tell.
        let _ = std::io::stdout().flush();
        status
    })
}

/// Name, title and text of every starting file.
#[pyfunction]
fn gallery() -> Vec<(&'static str, &'static str, &'static str)> {
    let files = starting_files().iter();
    files
        .map(|file| (file.name, file.title(), file.text))
        .collect()
}

/// A built-in model: name, title, equations, names of its axes; name, default and meaning of its parameters; source.
type Described = (
    String,
    String,
    Vec<String>,
    Vec<String>,
    Vec<(String, Option<f64>, String)>,
    String,
);

/// Every built-in model.
#[pyfunction]
fn systems() -> Vec<Described> {
    let models = registry::models().iter();
    let described = models.map(|model| {
        let parameters = model.parameters.iter();
        let parameters = parameters.map(|one| (one.name.clone(), one.default, one.meaning.clone()));
        (
            model.name.clone(),
            model.title.clone(),
            model.equations.clone(),
            model.axes.iter().map(|axis| axis.name.clone()).collect(),
            parameters.collect(),
            model.source.clone(),
        )
    });
    described.collect()
}

#[pymodule]
fn _pbif(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("version", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(gallery, module)?)?;
    module.add_function(wrap_pyfunction!(systems, module)?)?;
    module.add_function(wrap_pyfunction!(found::open, module)?)?;
    module.add_function(wrap_pyfunction!(plane::open_plane, module)?)?;
    module.add_class::<drift::Drift>()?;
    module.add_class::<figure::Figure>()?;
    module.add_class::<found::Found>()?;
    module.add_class::<plane::Plane>()?;
    module.add_class::<session::Session>()?;
    module.add_class::<sweep::Sweep>()
}
