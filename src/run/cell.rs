//! A cell of a table that is read, and what may stand in it; what is wrong is told with its place.

use std::path::Path;

use super::RunError;

/// A cell with its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell<'t> {
    /// The table.
    pub(super) path: &'t Path,
    /// Line of the file, counted from 1.
    pub(super) line: u64,
    /// Name of the column.
    pub(super) column: &'t str,
    /// What stands there.
    pub(super) text: &'t str,
}

impl Cell<'_> {
    /// A finite number.
    pub(super) fn number(&self) -> Result<f64, RunError> {
        let number = self.text.parse().ok();
        number
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| self.wrong("a number"))
    }

    /// A finite number; `None` for an empty cell.
    pub(super) fn optional(&self) -> Result<Option<f64>, RunError> {
        match self.text {
            "" => Ok(None),
            _ => self.number().map(Some),
        }
    }

    /// A number; NaN for an empty cell, as which a number that is not finite was written.
    pub(super) fn number_or_nan(&self) -> Result<f64, RunError> {
        Ok(self.optional()?.unwrap_or(f64::NAN))
    }

    /// A whole number.
    pub(super) fn count(&self) -> Result<usize, RunError> {
        self.text.parse().map_err(|_| self.wrong("a whole number"))
    }

    /// One of a few things by its word.
    pub(super) fn choice<T: Copy>(
        &self,
        choices: &[T],
        word: impl Fn(T) -> &'static str,
    ) -> Result<T, RunError> {
        let found = choices.iter().find(|&&choice| word(choice) == self.text);
        found.copied().ok_or_else(|| {
            let words: Vec<&str> = choices.iter().map(|&choice| word(choice)).collect();
            self.wrong(&format!("one of {}", words.join(", ")))
        })
    }

    /// Says that something else should stand here.
    pub(super) fn wrong(&self, wanted: &str) -> RunError {
        RunError::Row {
            path: self.path.to_owned(),
            line: self.line,
            column: self.column.to_owned(),
            value: self.text.to_owned(),
            wanted: wanted.to_owned(),
        }
    }
}
