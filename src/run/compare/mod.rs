//! The tables of a comparison of methods, for programs in full and for people rounded.

mod measures;
mod people;
mod rows;

pub(crate) use people::compare_tables;
pub(super) use rows::column_names;

use measures::measures_csv;
use people::{compare_markdown, compare_tex};
use rows::{accuracy_csv, agreement_csv, compare_csv, compare_json, densities_csv, distances_csv};

use super::RunError;
use crate::compare::{Comparison, Method};
use crate::system::Family;

/// A comparison with what the tables need beside it.
#[derive(Clone, Copy)]
pub(crate) struct ComparedRun<'a> {
    /// What was found.
    pub(crate) comparison: &'a Comparison,
    /// The resolved sweep, as TOML.
    pub(crate) sweep: &'a str,
    /// What describes the comparison in full, as TOML: the sweep with the settings of every method.
    pub(crate) of: &'a str,
    /// Threads that were used: times depend on them.
    pub(crate) threads: usize,
}

impl<'a> ComparedRun<'a> {
    /// The systems of which some were compared.
    pub(crate) fn family(&self) -> &'a Family {
        &self.comparison.subject.family
    }
}

/// Name of a partner in a pair.
fn partner(second: Option<Method>) -> &'static str {
    second.map_or("exact", Method::name)
}

/// The files of a comparison by their names.
///
/// # Errors
/// [`RunError`] when a file cannot be composed.
pub(crate) fn compare_files(run: &ComparedRun<'_>) -> Result<Vec<(String, String)>, RunError> {
    let files = [
        ("compare.csv", compare_csv(run)?),
        ("compare.md", compare_markdown(run)),
        ("compare.tex", compare_tex(run)),
        ("compare.json", compare_json(run)?),
        ("distances.csv", distances_csv(run)?),
        ("agreement.csv", agreement_csv(run)?),
        ("measures.csv", measures_csv(run)?),
        ("accuracy.csv", accuracy_csv(run)?),
        ("densities.csv", densities_csv(run)?),
    ];
    Ok(files.map(|(name, text)| (name.to_owned(), text)).into())
}
