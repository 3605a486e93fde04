//! Where a run's densities are read: its store, and the journal of an unfinished one.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use super::holding_shard::{HoldingShard, check_densities};
use super::journal::Held;
use super::stored_densities::{StoredDensities, numbers_of};
use super::stored_fields::StoredFields;
use super::{Journal, RunError};
use crate::continuation::{Point, Subject};
use crate::density::EstimatedDensity;
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
    shards: Vec<Option<ShardDensities>>,
    store: Option<StoredDensities>,
    fields: Option<StoredFields>,
    /// What is opened.
    path: PathBuf,
}

/// The densities of a shard, and whether some of them were read.
struct ShardDensities {
    folder: PathBuf,
    store: StoredDensities,
    is_read: AtomicBool,
}

impl ShardDensities {
    fn open(
        folder: PathBuf,
        subject: &Subject,
        cells: (&CellSpace, &[Axis]),
    ) -> Result<Self, RunError> {
        Ok(Self {
            store: StoredDensities::open(&folder.join(STORE), subject, cells)?,
            folder,
            is_read: AtomicBool::new(false),
        })
    }

    fn at(&self, value: f64) -> Result<Option<Vec<EstimatedDensity>>, RunError> {
        self.is_read.store(true, Ordering::Relaxed);
        self.store.at(value)
    }
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
                let opened = found.map(|folder| ShardDensities::open(folder, subject, cells));
                shards.push(opened.transpose()?);
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

    /// How many numbers the densities at a value have at most, the first of `values` standing for all of those in a
    /// journal.
    ///
    /// # Errors
    /// As [`Journal::densities`].
    pub(super) fn numbers(&self, values: &[f64]) -> Result<usize, RunError> {
        let shards = self.shards.iter().flatten().map(|shard| &shard.store);
        let stores = shards.chain(&self.store).map(StoredDensities::numbers);
        let first = match (stores.max(), &self.journal) {
            (Some(numbers), _) => return Ok(numbers),
            (None, Some(journal)) => values
                .first()
                .map(|&value| journal.densities(self.subject, self.cells, value)),
            (None, None) => None,
        };
        Ok(match first.transpose()?.flatten() {
            Some(Held::Here(densities)) => densities.iter().map(numbers_of).sum(),
            _ => 0,
        })
    }

    /// Refuses the points at these values of the run in a folder where the system would not give the memory for their
    /// densities.
    ///
    /// # Errors
    /// [`RunError::Memory`]; as [`Journal::densities`].
    pub(super) fn check_room(&self, run: &Path, values: &[f64]) -> Result<(), RunError> {
        let one = self.numbers(values)?;
        let heaps = HEAP * rayon::current_num_threads() as f64;
        let bytes = (values.len() * one * size_of::<f64>()) as f64 + BESIDE + heaps;
        match has_room(bytes) {
            true => Ok(()),
            false => Err(RunError::Memory {
                path: run.to_owned(),
                bytes: bytes_in_words(bytes),
            }),
        }
    }

    /// Refuses shards whose densities were read and are not those that they left. Those that no point is of are left
    /// alone: a merge that was stopped early has read few of them.
    ///
    /// # Errors
    /// [`RunError::Damaged`], [`RunError::Read`], [`RunError::Checksums`].
    pub(super) fn check_shards(&self) -> Result<(), RunError> {
        let mut read =
            (self.shards.iter().flatten()).filter(|shard| shard.is_read.load(Ordering::Relaxed));
        read.try_for_each(|shard| check_densities(&shard.folder))
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
                    Some(Some(shard)) => shard.at(value)?,
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
