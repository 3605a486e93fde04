//! Quantities as a file has them: `name = formula`, with the place of everything that is wrong with them; and the
//! values over which they are watched.

use std::sync::Arc;

use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::draft::Draft;
use crate::sweep_file::formula_place::inside;
use crate::sweep_file::reader::Reader;
use crate::system::{Family, Model, Quantity, QuantityError, quantities};

/// A quantity as it was given.
#[derive(Debug, Clone)]
pub(super) struct GivenQuantity {
    pub(super) name: String,
    /// An axis at a phase of the forcing, which needs no formula.
    pub(super) at_phase: Option<Quantity>,
    /// The formula, and where it begins in the string; `None` for a definition of the model.
    pub(super) formula: Option<(String, usize)>,
    pub(super) name_place: Place,
    /// Where the string stands.
    pub(super) place: Place,
}

/// Bins of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BinSettings {
    /// First and last value; `None` where they are left to the program.
    pub range: Option<(f64, f64)>,
    /// Number of bins.
    pub count: usize,
}

/// Bins by themselves: at least and at most.
const COUNTS: (usize, usize) = (40, 200);

/// Name, formula, and where the formula begins, of `name = formula`; `None` for anything else.
pub(super) fn split(text: &str) -> Option<(&str, &str, usize)> {
    let bytes = text.as_bytes();
    let is_sign = |at: Option<usize>| {
        at.and_then(|at| bytes.get(at))
            .is_some_and(|byte| b"=<>!".contains(byte))
    };
    let at = text.find('=')?;
    if is_sign(at.checked_sub(1)) || is_sign(Some(at + 1)) {
        return None;
    }
    let formula = text[at + 1..].trim_start();
    Some((
        text[..at].trim(),
        formula.trim_end(),
        text.len() - formula.len(),
    ))
}

/// The name that a text gives a formula, as in `name = formula`.
pub(in crate::sweep_file) fn quantity_name(text: &str) -> Option<&str> {
    split(text).map(|(name, _, _)| name)
}

/// Reads quantities, and reports everything that is wrong with them.
pub(super) fn read_all(
    reader: &mut Reader<'_>,
    model: &Model,
    given: &[GivenQuantity],
) -> Vec<Arc<Quantity>> {
    let formulas: Vec<&GivenQuantity> = given.iter().filter(|one| one.at_phase.is_none()).collect();
    let texts: Vec<(&str, Option<&str>)> = formulas
        .iter()
        .map(|one| {
            let formula = one.formula.as_ref().map(|(formula, _)| formula.as_str());
            (one.name.as_str(), formula)
        })
        .collect();
    match quantities(model, &texts) {
        Ok(read) => {
            let mut read = read.into_iter();
            let all = given.iter().filter_map(|one| match &one.at_phase {
                Some(at_phase) => Some(Arc::new(at_phase.clone())),
                None => read.next(),
            });
            all.collect()
        }
        Err(errors) => {
            for error in errors {
                if let Some(one) = formulas.get(error.index) {
                    let diagnostic = diagnostic(reader, one, &error);
                    reader.report(diagnostic);
                }
            }
            Vec::new()
        }
    }
}

fn diagnostic(reader: &Reader<'_>, one: &GivenQuantity, error: &QuantityError) -> Diagnostic {
    let title = format!("quantity `{}`: {}", one.name, error.fault);
    let diagnostic = Diagnostic::new(title);
    let offset = one.formula.as_ref().map_or(0, |(_, offset)| *offset);
    let diagnostic = match error.fault.span() {
        Some(span) => {
            let span = span.start + offset..span.end + offset;
            let sources = &reader.document().sources;
            diagnostic.at(&inside(sources, &one.place, &span), "here")
        }
        None => diagnostic.at(&one.name_place, "this quantity"),
    };
    diagnostic.advice(error.fault.allowed(), error.fault.remedy())
}

/// Checks `[detect.bins]`.
pub(super) fn read_bins(
    reader: &mut Reader<'_>,
    draft: &Draft,
    family: &Family,
) -> Vec<BinSettings> {
    let known: Vec<&str> = family.quantities().iter().map(|one| one.name()).collect();
    for entry in reader.entries(&["detect", "bins"]) {
        if !known.contains(&entry.key.as_str()) {
            // A stored run may be looked at again with fewer quantities.
            let title = format!("no quantity `{}` is watched", entry.key);
            let diagnostic = Diagnostic::warning(title).at(&entry.key_place, "bins of what?");
            let diagnostic = diagnostic.nearest(&entry.key, known.iter().copied());
            reader.warn(diagnostic);
        }
    }
    let bins = family.quantities().iter().map(|quantity| {
        let name = quantity.name();
        let given = draft.bins(name);
        let ends = given.map_or((None, None), |bins| (bins.from, bins.to));
        let range = match ends {
            (Some(from), Some(to)) if from < to => Some((from, to)),
            (None, None) => None,
            _ => {
                let title = format!("the bins of `{name}` need both ends, `from` below `to`");
                let diagnostic = Diagnostic::new(title);
                let remedy = "give both, or leave both to the program";
                let entry = reader.entry(&["detect", "bins", name]);
                reader.report(match entry {
                    Some(entry) => diagnostic.at(&entry.key_place, "these bins").remedy(remedy),
                    None => diagnostic.remedy(remedy),
                });
                None
            }
        };
        let needed = family.model().axes.iter().zip(quantity.states());
        let counts = needed
            .filter(|(_, needed)| **needed)
            .filter_map(|(axis, _)| draft.axis(&axis.name)?.count);
        let count = counts.max().unwrap_or(COUNTS.0).clamp(COUNTS.0, COUNTS.1);
        BinSettings {
            range,
            count: given.and_then(|bins| bins.count).unwrap_or(count),
        }
    });
    bins.collect()
}
