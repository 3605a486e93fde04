//! The tables of a comparison of methods, for programs in full and for people rounded, and the folder they go to.

mod folder;
mod people;
mod rows;

pub use folder::CompareFolder;
pub(super) use folder::ENTRIES;
pub use people::{CompareTable, compare_tables};

use people::{compare_markdown, compare_tex};
use rows::{accuracy_csv, agreement_csv, compare_csv, compare_json, densities_csv, distances_csv};

use crate::compare::{Comparison, Method};
use crate::system::Family;

/// What an unfinished comparison has solved.
const PART: &str = "compare.part.bin";

/// A comparison with what the tables need beside it.
#[derive(Clone, Copy)]
pub struct ComparedRun<'a> {
    /// What was found.
    pub comparison: &'a Comparison,
    /// The resolved sweep, as TOML.
    pub sweep: &'a str,
    /// What describes the comparison in full, as TOML: the sweep with the settings of every method.
    pub of: &'a str,
    /// Threads that were used: times depend on them.
    pub threads: usize,
}

impl<'a> ComparedRun<'a> {
    /// The systems of which some were compared.
    pub fn family(&self) -> &'a Family {
        &self.comparison.subject.family
    }
}

/// Name of a partner in a pair.
fn partner(second: Option<Method>) -> &'static str {
    second.map_or("exact", Method::name)
}
