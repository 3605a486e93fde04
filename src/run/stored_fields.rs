//! Fields of passages in `densities.zarr`, read back.

use std::path::{Path, PathBuf};

use super::zarr::StoredArray;
use super::{RunError, arrays};
use crate::continuation::StateField;
use crate::space::{Axis, CellSpace};
use crate::system::Family;

/// The fields of a store, opened.
pub(super) struct StoredFields {
    path: PathBuf,
    /// Parameter values in the order of the store.
    values: Vec<f64>,
    axes: Vec<Axis>,
    fields: Vec<(String, [StoredArray; 2])>,
}

impl StoredFields {
    /// Opens those that a family asks for and the store at `path` has.
    ///
    /// # Errors
    /// [`RunError::ReadStore`].
    pub(super) fn open(path: &Path, family: &Family, space: &CellSpace) -> Result<Self, RunError> {
        let array = |name: &str| {
            let array = StoredArray::open(&path.join(name));
            let words = array.map_err(|error| format!("array `{name}`: {error}"));
            words.map_err(RunError::store(path))
        };
        let mut fields = Vec::new();
        for one in family.fields() {
            if path.join(&one.name).is_dir() {
                let both = [array(&one.name)?, array(&arrays::field_error(&one.name))?];
                fields.push((one.name.clone(), both));
            }
        }
        let values = match fields.is_empty() {
            true => Vec::new(),
            false => array(family.parameter())?
                .line()
                .map_err(RunError::store(path))?,
        };
        Ok(Self {
            path: path.to_owned(),
            values,
            axes: space.axes().to_vec(),
            fields,
        })
    }

    /// The fields at a parameter value that are known there.
    ///
    /// # Errors
    /// [`RunError::ReadStore`].
    pub(super) fn at(&self, value: f64) -> Result<Vec<StateField>, RunError> {
        let Some(index) = self.values.iter().position(|&known| known == value) else {
            return Ok(Vec::new());
        };
        let cells: usize = self.axes.iter().map(Axis::count).product();
        let mut all = Vec::new();
        for (name, [values, errors]) in &self.fields {
            let row = |array: &StoredArray| {
                let row = array.row(index as u64);
                row.map_err(RunError::store(&self.path))
            };
            let (values, errors) = (row(values)?, row(errors)?);
            // No numbers stand for a field that is not known; other cells were written by another file.
            let is_known = values.len() == cells && errors.len() == cells;
            if is_known && values.iter().any(|value| value.is_finite()) {
                let (name, axes) = (name.clone(), self.axes.clone());
                all.push(StateField {
                    name,
                    axes,
                    values,
                    errors,
                });
            }
        }
        Ok(all)
    }
}
