//! Where a run's densities are read: its store, and the journal of an unfinished one.

use std::path::{Path, PathBuf};

use super::holding_shard::HoldingShard;
use super::journal::Held;
use super::stored_densities::StoredDensities;
use super::stored_fields::StoredFields;
use super::{Journal, RunError};
use crate::continuation::{Point, Subject};
use crate::space::{Axis, CellSpace};
use crate::sweep_file::{bytes_in_words, has_room};

/// Name of a store.
const STORE: &str = "densities.zarr";

/// No density is as large: its square is still a number.
const LARGEST: f64 = 1e150;

/// Bytes that are tried for beside densities: what is read and drawn, and a heap a thread, for which the C library
/// sets so many addresses aside.
const BESIDE: f64 = 1e8;
const HEAP: f64 = 6.8e7;

/// The densities of a run, opened for the observables of a subject.
pub(super) struct PointDensities<'a> {
    subject: &'a Subject,
    cells: (&'a CellSpace, &'a [Axis]),
    journal: Option<Journal>,
    /// Stores of the shards in which the journal says that densities are.
    shards: Vec<Option<StoredDensities>>,
    store: Option<StoredDensities>,
    fields: Option<StoredFields>,
    /// What is opened.
    path: PathBuf,
}

impl<'a> PointDensities<'a> {
    /// Opens those of the run in a folder.
    ///
    /// # Errors
    /// As [`StoredDensities::open`]; [`RunError::Journal`], [`RunError::Read`].
    pub(super) fn open(
        run: &Path,
        is_complete: bool,
        subject: &'a Subject,
        cells: (&'a CellSpace, &'a [Axis]),
    ) -> Result<Self, RunError> {
        let path = run.join(STORE);
        let journal = if is_complete {
            None
        } else {
            Journal::look(run)?
        };
        let mut shards = Vec::new();
        if let Some(journal) = &journal {
            for shard in journal.shards::<Option<HoldingShard>>()? {
                let found = shard.map(|shard| shard.find(run)).transpose()?;
                let store = found.map(|shard| shard.join(STORE));
                let store = store.map(|store| StoredDensities::open(&store, subject, cells));
                shards.push(store.transpose()?);
            }
        }
        // Unfinished runs of early versions have a store that grew.
        let store = if journal.is_none() || path.join("zarr.json").is_file() {
            Some(StoredDensities::open(&path, subject, cells)?)
        } else {
            None
        };
        let fields = match &store {
            Some(_) => Some(StoredFields::open(&path, &subject.family, cells.0)?),
            None => None,
        };
        let path = match &journal {
            Some(journal) => journal.path(),
            None => path,
        };
        Ok(Self {
            subject,
            cells,
            journal,
            shards,
            store,
            fields,
            path,
        })
    }

    /// Refuses so many points of the run in a folder where the system would not give the memory for their densities.
    ///
    /// # Errors
    /// [`RunError::Memory`].
    pub(super) fn check_room(&self, run: &Path, points: usize) -> Result<(), RunError> {
        let one = self.store.as_ref().map_or(0, StoredDensities::numbers);
        let heaps = HEAP * rayon::current_num_threads() as f64;
        let bytes = (points * one * size_of::<f64>()) as f64 + BESIDE + heaps;
        match has_room(bytes) {
            true => Ok(()),
            false => Err(RunError::Memory {
                path: run.to_owned(),
                bytes: bytes_in_words(bytes),
            }),
        }
    }

    /// Gives a point its densities, and its fields of passages.
    ///
    /// # Errors
    /// [`RunError::NoDensity`], [`RunError::NotFinite`]; as [`StoredDensities::at`] and [`Journal::densities`].
    pub(super) fn read(&self, point: &mut Point) -> Result<(), RunError> {
        let value = point.value;
        let mut found = None;
        if let Some(journal) = &self.journal {
            let held = journal.densities(self.subject, self.cells, value)?;
            found = match held {
                None => None,
                Some(Held::Here(densities)) => Some(densities),
                Some(Held::In(shard)) => match self.shards.get(shard) {
                    Some(Some(store)) => store.at(value)?,
                    _ => None,
                },
            };
        }
        if let (None, Some(store)) = (&found, &self.store) {
            found = store.at(value)?;
        }
        let (path, family) = (|| self.path.clone(), &self.subject.family);
        let parameter = || family.parameter().to_owned();
        point.densities = found.ok_or_else(|| RunError::NoDensity {
            path: path(),
            parameter: parameter(),
            value,
        })?;
        if let Some(fields) = &self.fields {
            point.report.fields = fields.at(value)?;
        }
        let is_number = |value: &f64| value.is_finite() && value.abs() < LARGEST;
        for one in &point.densities {
            let mut values = one.density.values.iter().chain(&one.standard_error);
            if !values.all(is_number) {
                return Err(RunError::NotFinite {
                    path: path(),
                    observable: one.observable.name(family),
                    parameter: parameter(),
                    value,
                });
            }
        }
        Ok(())
    }
}
