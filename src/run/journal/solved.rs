//! The densities of an unfinished sweep, which stand in its journal alone.
//!
//! Beside each solve of the sweep itself, those of its checks left out, a short record says of which point it is, and
//! of what its densities are: another sweep file may watch other quantities under the same names.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::kept::Kept;
use super::{Journal, Key};
use crate::continuation::{Point, Subject};
use crate::density::{EstimatedDensity, Observable, layout_axis};
use crate::run::RunError;
use crate::space::{Axis, CellSpace};
use crate::system::Family;

/// What a density is of: its name, and the formulas of its quantities.
type Described = (String, Vec<Option<String>>);

/// The densities of a point.
#[derive(Debug, Serialize, Deserialize)]
struct PointRecord {
    place: RecordPlace,
    /// In the order of the densities.
    densities: Vec<Described>,
}

/// Where the solve of a point stands.
#[derive(Debug, Serialize, Deserialize)]
enum RecordPlace {
    /// In the record of this key.
    At(Key),
    /// Here, since a shard has solved it.
    Here(Box<Kept>),
    /// In the store of a shard, by its place in [`Journal::shards`].
    In(usize),
}

/// Where a journal has the densities of a point.
#[derive(Debug, PartialEq)]
pub(in crate::run) enum Held {
    /// In itself.
    Here(Vec<EstimatedDensity>),
    /// In the shard of this place in [`Journal::shards`].
    In(usize),
}

fn described(family: &Family, observable: Observable) -> Described {
    let axes = observable.axes().into_iter();
    let quantities = axes.filter_map(|axis| family.quantity(axis));
    let formulas = quantities.map(|one| one.formula().map(str::to_owned));
    (observable.name(family), formulas.collect())
}

fn of_densities(family: &Family, densities: &[EstimatedDensity]) -> Vec<Described> {
    let all = densities.iter();
    all.map(|one| described(family, one.observable)).collect()
}

impl Journal {
    /// Says which shards hold densities.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(in crate::run) fn write_shards<T: Serialize>(&self, shards: &[T]) -> Result<(), RunError> {
        self.write(Key::SHARDS, &shards)
    }

    /// The shards that hold densities, as they were written.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Journal`].
    pub(in crate::run) fn shards<T: DeserializeOwned>(&self) -> Result<Vec<T>, RunError> {
        Ok(self.get(Key::SHARDS)?.unwrap_or_default())
    }

    /// Says that a solve is that of a point.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(super) fn write_point(
        &self,
        family: &Family,
        (value, key): (f64, Key),
        kept: &Kept,
    ) -> Result<(), RunError> {
        let densities = of_densities(family, kept.densities());
        let place = RecordPlace::At(key);
        self.write(Key::of_point(value), &PointRecord { place, densities })
    }

    /// Keeps a point that a shard has solved, unless an earlier process has: where it is, if the shard of that place in
    /// [`Journal::shards`] holds its densities, or all of it.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(crate) fn write_known(
        &self,
        family: &Family,
        point: &Point,
        shard: Option<usize>,
    ) -> Result<(), RunError> {
        if self.has_point(point.value) {
            return Ok(());
        }
        let densities = of_densities(family, &point.densities);
        let place = match shard {
            Some(place) => RecordPlace::In(place),
            None => RecordPlace::Here(Box::new(Kept::of_point(point))),
        };
        self.write(
            Key::of_point(point.value),
            &PointRecord { place, densities },
        )
    }

    /// Whether an earlier process has said where a point is.
    pub(super) fn has_point(&self, value: f64) -> bool {
        self.lock().places.contains_key(&Key::of_point(value))
    }

    /// The densities of a point of a sweep that earlier processes have solved, for the observables of `subject` on
    /// these cells and bins.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Journal`]; [`RunError::NotStored`], [`RunError::OtherFormula`] and
    /// [`RunError::Cells`] where the sweep watches something else.
    pub(in crate::run) fn densities(
        &self,
        subject: &Subject,
        (space, bins): (&CellSpace, &[Axis]),
        value: f64,
    ) -> Result<Option<Held>, RunError> {
        let Some(record) = self.get::<PointRecord>(Key::of_point(value))? else {
            return Ok(None);
        };
        let broken = || RunError::Journal { path: self.path() };
        let kept = match record.place {
            RecordPlace::At(key) => self.get(key)?.ok_or_else(broken)?,
            RecordPlace::Here(kept) => *kept,
            RecordPlace::In(shard) => return Ok(Some(Held::In(shard))),
        };
        if !kept.is_sound() || kept.densities().len() != record.densities.len() {
            return Err(broken());
        }
        let family = &subject.family;
        let axis_of = |number: usize| space.axes().iter().chain(bins).nth(number).map(layout_axis);
        let wanted = subject.observables.iter();
        let found = wanted.map(|&observable| {
            let (name, formulas) = described(family, observable);
            let mut there = record.densities.iter().zip(kept.densities());
            let Some(((_, known), density)) = there.find(|((known, _), _)| *known == name) else {
                let stored = record.densities.iter();
                return Err(RunError::NotStored {
                    observable: name,
                    stored: stored.map(|(name, _)| name.clone()).collect(),
                });
            };
            if *known != formulas {
                return Err(RunError::OtherFormula { observable: name });
            }
            for (number, axis) in observable.axes().into_iter().zip(&density.density.axes) {
                if axis_of(number).as_ref().map(Axis::edges) != Some(axis.edges()) {
                    return Err(RunError::Cells {
                        path: self.path(),
                        axis: family.axis(number).to_owned(),
                    });
                }
            }
            Ok(EstimatedDensity {
                observable,
                ..density.clone()
            })
        });
        let found = found.collect::<Result<_, _>>()?;
        Ok(Some(Held::Here(found)))
    }
}
