//! A validated sweep: what a sweep file says, with every default filled in and every number checked.

mod cells;
mod choices;
mod resolved;
mod swept;

use std::path::{Path, PathBuf};

use crate::continuation::LocateOptions;
use crate::figure::Format;
use crate::method::{MethodOptions, Problem};
use crate::topology::{DetectOptions, PersistenceDetector};

pub use cells::AxisCells;
pub use choices::EveryMethod;

use super::diagnostic::{Diagnostic, Report};
use super::document::Document;
use super::reader::Reader;

/// Everything a sweep needs.
#[derive(Debug, Clone)]
pub struct SweepSpec {
    /// Title of the run.
    pub title: String,
    /// The sweep file.
    pub file: PathBuf,
    /// The file's name without folder and ending; the output folder is named after it.
    pub name: String,
    /// The systems along the path from the first value of the swept parameter to the last, the cells, and what is watched, marginals
    /// first.
    pub problem: Problem,
    /// Number of values, at least 2.
    pub points: usize,
    /// How each axis is cut into cells, in the model's order of axes.
    pub cells: Vec<AxisCells>,
    /// Settings of the method.
    pub method: MethodOptions,
    /// Settings of all methods, the chosen one among them.
    pub every_method: EveryMethod,
    /// Settings of detection.
    pub detect: DetectOptions,
    /// Settings of location.
    pub locate: LocateOptions,
    /// Parameter values at which densities are drawn.
    pub figures_at: Vec<f64>,
    /// Formats of the figures.
    pub figure_formats: Vec<Format>,
}

impl SweepSpec {
    /// Reads and checks a sweep file with its `KEY=VALUE` overrides.
    ///
    /// # Errors
    /// A report of everything that is wrong with them.
    pub fn load(file: &Path, overrides: &[String]) -> Result<Self, Report> {
        Self::build(file, Document::read(file, overrides)?)
    }

    /// Reads the resolved sweep file of a stored run, `text` of the manifest `file`, with its overrides.
    ///
    /// # Errors
    /// As [`SweepSpec::load`].
    pub fn stored(file: &Path, text: &str, overrides: &[String]) -> Result<Self, Report> {
        let name = file.display().to_string();
        Self::build(file, Document::parse(&name, text, overrides)?)
    }

    /// The detector: its confidence holds for all densities of the sweep together.
    pub fn detector(&self) -> PersistenceDetector {
        PersistenceDetector::new(
            self.detect.clone(),
            self.points * self.problem.observables().len(),
        )
    }

    fn build(file: &Path, document: Document) -> Result<Self, Report> {
        let mut reader = Reader::new(document);
        let (method, every_method) = choices::read_method(&mut reader);
        let model = swept::read_model(&mut reader);
        let swept = model
            .as_ref()
            .and_then(|model| swept::read(&mut reader, model));
        let cells = model
            .as_deref()
            .and_then(|model| cells::read(&mut reader, model, swept.as_ref(), &method));
        let observables = model
            .as_deref()
            .map(|model| choices::read_observables(&mut reader, model));
        let figures_at = choices::read_figures_at(&mut reader, swept.as_ref());
        let (detect, locate) = (choices::read_detect(&reader), choices::read_locate(&reader));
        let formats = choices::read_formats(&reader);
        let (Some(swept), Some((cells, space)), Some(observables), true) =
            (swept, cells, observables, reader.is_clean())
        else {
            return Err(reader.into_report());
        };
        let problem = Problem::new(swept.family, space, observables);
        let problem = match problem {
            Ok(problem) => problem,
            Err(error) => {
                reader.report(Diagnostic::new(error.to_string()));
                return Err(reader.into_report());
            }
        };
        let family = problem.family();
        let title = reader.text(&["title"]).map(|title| title.value);
        let stem = file
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned());
        Ok(Self {
            title: title.unwrap_or_else(|| {
                format!("{}, sweep of {}", family.model().title, family.parameter())
            }),
            file: file.to_owned(),
            name: stem.unwrap_or_else(|| "sweep".to_owned()),
            points: swept.points,
            problem,
            cells,
            method,
            every_method,
            detect,
            locate,
            figures_at,
            figure_formats: formats,
        })
    }
}

#[cfg(test)]
mod tests;
