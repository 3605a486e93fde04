//! The tables of a comparison of methods, for programs in full and for people rounded, and the folder they go to.

mod folder;
mod people;
mod rows;

pub use folder::CompareFolder;
pub use people::{CompareTable, compare_tables};

use people::{compare_markdown, compare_tex};
use rows::{accuracy_csv, agreement_csv, compare_csv, compare_json, densities_csv, distances_csv};

use super::Naming;
use crate::compare::{Comparison, Method, Solved};

/// A comparison with what the tables need beside it.
#[derive(Clone, Copy)]
pub struct ComparedRun<'a> {
    /// Names of axes, observables and the parameter.
    pub naming: Naming<'a>,
    /// What was found.
    pub comparison: &'a Comparison,
    /// Bytes at work at one point, and what the number rests on.
    pub bytes: &'a dyn Fn(&Solved) -> (f64, &'static str),
    /// The resolved sweep, as TOML.
    pub sweep: &'a str,
    /// Threads that were used: times depend on them.
    pub threads: usize,
}

/// Name of a partner in a pair.
fn partner(second: Option<Method>) -> &'static str {
    second.map_or("exact", Method::name)
}
