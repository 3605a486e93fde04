//! What is tried of quantities once the cells are known: whether they have values all over them, means, and bins that
//! hold any of these values.

use super::diagnostic::{Diagnostic, Place};
use super::document::Document;
use super::report::Report;
use super::settings::{Settings, cell_space, quantity_name};
use super::value::{SpannedValue, Value};
use super::verify::short;
use crate::cancellation::Cancellation;
use crate::method::{BinsError, QuantityRange, automatic_bins, check_averaged};

impl Settings {
    /// Finds the values over which quantities are watched, where the file leaves them open, and refuses quantities and
    /// bins that cannot be.
    ///
    /// # Errors
    /// A report with the place of what cannot be.
    pub(super) fn find_bins(&mut self, cancellation: &Cancellation) -> Result<(), Report> {
        if self.family.quantities().is_empty() && self.family.questions.averaged.is_empty() {
            return Ok(());
        }
        let space = cell_space(&self.document, &self.family, &self.axes, self.method.kind)
            .map_err(|diagnostic| self.refuse(*diagnostic))?;
        let open = self.bins.iter().any(|bins| bins.range.is_none());
        let ranges = automatic_bins(&self.family, &space, open, cancellation)
            .and_then(|ranges| check_averaged(&self.family, &space).map(|()| ranges))
            .map_err(|error| self.refuse(diagnostic(&self.document, &error)))?;
        for (number, range) in ranges.into_iter().enumerate() {
            match self.bins[number].range {
                None => self.bins[number].range = Some(range.ends),
                Some(given) => self.check_bins(number, given, range)?,
            }
        }
        Ok(())
    }

    /// Refuses bins that no value of the quantity falls into.
    fn check_bins(
        &self,
        number: usize,
        (from, to): (f64, f64),
        QuantityRange {
            extremes: (least, most),
            ..
        }: QuantityRange,
    ) -> Result<(), Report> {
        if from < most && least < to {
            return Ok(());
        }
        let name = self.family.quantities()[number].name();
        let title = format!("no value of `{name}` lies in its bins, from {from} to {to}");
        let diagnostic = Diagnostic::new(title)
            .allowed(format!(
                "on these cells `{name}` goes from {} to {}",
                short(least),
                short(most)
            ))
            .remedy("leave `from` and `to` out, and the program finds them");
        let entry = self.document.root.find(&["detect", "bins", name]);
        Err(self.refuse(diagnostic.at(entry.map(|entry| &entry.key_place), "these bins")))
    }
}

/// What is wrong with a quantity, at its place in the file.
fn diagnostic(document: &Document, error: &BinsError) -> Diagnostic {
    let diagnostic = Diagnostic::new(error.to_string());
    let (quantity, remedy) = match error {
        BinsError::NotFinite { quantity, .. } => (
            quantity,
            "watch a formula that has a value all over the cells, or move the cells",
        ),
        BinsError::NoMean { quantity, .. } => (
            quantity,
            "average a formula that has a value all over the cells, in units in which it is near 1, or move the cells",
        ),
        BinsError::Scale { quantity, .. } => (quantity, "watch it in other units"),
        BinsError::OneValue { quantity, .. } => {
            (quantity, "watch a formula that changes over the cells")
        }
        BinsError::System(_) | BinsError::Cancelled(_) => return diagnostic,
    };
    let diagnostic = diagnostic.remedy(remedy);
    diagnostic.at(quantity_place(document, quantity).as_ref(), "this quantity")
}

/// Where a quantity was given.
pub(super) fn quantity_place(document: &Document, name: &str) -> Option<Place> {
    let named = |table: &str| document.root.find(&[table, name]);
    let definition = || document.root.find(&["system", "define", name]);
    let entry = |key: &str| document.root.find(&["detect", key]);
    let lists = ["marginals", "joint"];
    let in_lists = lists
        .iter()
        .find_map(|key| text_that_names(&entry(key)?.node, name));
    in_lists.or_else(|| Some(named("watch").or_else(definition)?.key_place.clone()))
}

/// The first text of a list, or of lists in it, that gives a formula this name.
fn text_that_names(node: &SpannedValue, name: &str) -> Option<Place> {
    match &node.value {
        Value::Text(text) if quantity_name(text) == Some(name) => Some(node.place.clone()),
        _ => node
            .items()
            .iter()
            .find_map(|item| text_that_names(item, name)),
    }
}
