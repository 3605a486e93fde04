//! A store of densities while its arrays are looked up: which it has, and whether they are those of the run.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::super::arrays::{DensityPart, EndNumber};
use super::{Observed, StoredKink, StoredNumber};
use crate::density::{NEGLIGIBLE, Observable, layout_axis};
use crate::run::place::check_files;
use crate::run::zarr::StoredArray;
use crate::run::{RunError, arrays};
use crate::space::{Axis, CellSpace};
use crate::system::Family;

/// A store while its arrays are looked up.
pub(super) struct Opened {
    path: PathBuf,
    /// Names of all arrays, sorted.
    names: Vec<String>,
}

impl Opened {
    pub(super) fn new(path: &Path) -> Result<Self, RunError> {
        // Pipes would be waited for.
        check_files(path)?;
        let entries = std::fs::read_dir(path).map_err(RunError::store(path))?;
        let mut names: Vec<String> = entries
            .flatten()
            .filter(|entry| entry.path().is_dir())
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort_by_key(|name| (name.len(), name.clone()));
        Ok(Self {
            path: path.to_owned(),
            names,
        })
    }

    fn unreadable(&self, words: String) -> RunError {
        RunError::store(&self.path)(words)
    }

    fn has(&self, name: &str) -> bool {
        self.names.iter().any(|known| known == name)
    }

    fn array(&self, name: &str) -> Result<StoredArray, RunError> {
        StoredArray::open(&self.path.join(name))
            .map_err(|error| self.unreadable(format!("array `{name}`: {error}")))
    }

    fn optional(&self, name: &str, shape: &[u64]) -> Result<Option<StoredArray>, RunError> {
        self.has(name).then(|| self.shaped(name, shape)).transpose()
    }

    /// An array whose last dimensions must be `shape`, behind that of the parameter.
    fn shaped(&self, name: &str, shape: &[u64]) -> Result<StoredArray, RunError> {
        let array = self.array(name)?;
        let found = array.shape();
        if found.len() <= shape.len() || !found.ends_with(shape) {
            let words = format!("array `{name}` has shape {found:?}, not (parameter, {shape:?})");
            return Err(self.unreadable(words));
        }
        Ok(array)
    }

    pub(super) fn whole(&self, name: &str) -> Result<Vec<f64>, RunError> {
        let line = self.array(name)?.line();
        line.map_err(|error| self.unreadable(format!("array `{name}`: {error}")))
    }

    pub(super) fn observed(
        &self,
        family: &Family,
        (space, bins): (&CellSpace, &[Axis]),
        observable: Observable,
    ) -> Result<Observed, RunError> {
        let name = DensityPart::Density.name(family, observable);
        if !self.has(&name) {
            return Err(RunError::NotStored {
                observable: observable.name(family),
                stored: self.stored(),
            });
        }
        let numbers = observable.axes();
        let known = || space.axes().iter().chain(bins);
        let of = |&axis: &usize| known().nth(axis).map(layout_axis);
        let axes: Vec<Axis> = numbers.iter().filter_map(of).collect();
        for (&number, axis) in numbers.iter().zip(&axes) {
            if self.whole(&arrays::edges(family.axis(number)))? != axis.edges() {
                return Err(RunError::Cells {
                    path: self.path.clone(),
                    axis: family.axis(number).to_owned(),
                });
            }
        }
        let shape: Vec<u64> = axes.iter().map(|axis| axis.count() as u64).collect();
        let density = self.shaped(&name, &shape)?;
        // A quantity may have been given another formula under the same name.
        let formulas = density.attributes().get(arrays::FORMULAS);
        if formulas != arrays::formulas(family, observable).as_ref() {
            return Err(RunError::OtherFormula {
                observable: observable.name(family),
            });
        }
        let centre = density.attributes().get(arrays::CENTRE);
        let centre = centre.and_then(Value::as_array).map(|centre| {
            let numbers = centre.iter().filter_map(Value::as_f64);
            numbers.collect::<Vec<f64>>()
        });
        let own_ends = density.attributes().get(arrays::OWN_ENDS);
        let own_ends = own_ends.and_then(|ends| serde_json::from_value(ends.clone()).ok());
        let negligible = density.attributes().get(arrays::NEGLIGIBLE);
        let negligible = negligible.and_then(Value::as_f64);
        Ok(Observed {
            observable,
            error: self.shaped(&DensityPart::Error.name(family, observable), &shape)?,
            second: self.optional(&DensityPart::Second.name(family, observable), &shape)?,
            range_ends: self.range_ends(&name)?,
            closed: self.optional(&DensityPart::Closed.name(family, observable), &shape)?,
            replicates: self.optional(&DensityPart::Replicates.name(family, observable), &shape)?,
            own_ends: own_ends.unwrap_or_default(),
            centre: centre.filter(|centre| centre.len() == axes.len()),
            kinks: self.kinks(family, observable, &shape)?,
            negligible: negligible.unwrap_or(NEGLIGIBLE),
            axes,
            density,
        })
    }

    /// The numbers that the ends of the ranges leave of a density, by the name of its array. Stores of earlier versions
    /// have an array of each.
    fn range_ends(
        &self,
        density: &str,
    ) -> Result<[Option<StoredNumber>; EndNumber::ALL.len()], RunError> {
        let mut found = EndNumber::ALL.map(|_| None);
        let together = self.optional(arrays::RANGE_ENDS, &[])?;
        for (number, found) in EndNumber::ALL.into_iter().zip(&mut found) {
            let place = match &together {
                None => None,
                Some(array) => self.place_of(array, density, number)?,
            };
            *found = match (&together, place) {
                (Some(array), Some(place)) => Some(StoredNumber {
                    array: array.clone(),
                    place,
                }),
                _ => {
                    let own = format!("{density}_{}", number.word());
                    let array = self.optional(&own, &[])?;
                    array.map(|array| StoredNumber { array, place: 0 })
                }
            };
        }
        Ok(found)
    }

    /// Where in a row of the array of all densities a number stands; `None` of a density that is not in it.
    fn place_of(
        &self,
        array: &StoredArray,
        density: &str,
        number: EndNumber,
    ) -> Result<Option<usize>, RunError> {
        let place = |attribute: &str, word: &str| -> Option<(usize, usize)> {
            let words = array.attributes().get(attribute)?.as_array()?;
            let place = words.iter().position(|one| one.as_str() == Some(word));
            Some((place?, words.len()))
        };
        let row = place(arrays::RANGE_ENDS_DENSITIES, density);
        let column = place(arrays::RANGE_ENDS_NUMBERS, number.word());
        let (Some((row, rows)), Some((column, columns))) = (row, column) else {
            return Ok(None);
        };
        if array.shape()[1..] != [rows as u64, columns as u64] {
            let (name, found) = (arrays::RANGE_ENDS, array.shape());
            let words = format!("array `{name}` has shape {found:?}, not that of what it names");
            return Err(self.unreadable(words));
        }
        Ok(Some(row * columns + column))
    }

    /// The kinks of a density in the order of their numbers.
    fn kinks(
        &self,
        family: &Family,
        observable: Observable,
        shape: &[u64],
    ) -> Result<Vec<StoredKink>, RunError> {
        let prefix = DensityPart::Kinks.name(family, observable);
        let names = self.names.iter().filter(|name| name.starts_with(&prefix));
        names
            .map(|name| {
                let array = self.array(name)?;
                let attributes = array.attributes();
                let axis = attributes.get(arrays::KINK_AXIS).and_then(Value::as_str);
                let axes = observable.axes();
                let axis = axes.iter().position(|&a| Some(family.axis(a)) == axis);
                let at = attributes.get(arrays::KINK_AT).and_then(Value::as_f64);
                let bends = attributes.contains_key(arrays::KINK_BENDS);
                let (Some(axis), Some(at)) = (axis, at) else {
                    let words = format!("array `{name}` does not say on which plane it stands");
                    return Err(self.unreadable(words));
                };
                let mut rest = shape.to_vec();
                rest.remove(axis);
                let jump = self.shaped(name, &rest)?;
                Ok(StoredKink {
                    axis,
                    at,
                    bends,
                    jump,
                })
            })
            .collect()
    }

    /// Names of the observables that the store has.
    fn stored(&self) -> Vec<String> {
        let names = self.names.iter();
        names
            .filter_map(|name| name.strip_prefix("p_"))
            .filter(|name| self.has(&format!("p_{name}_error")))
            .map(str::to_owned)
            .collect()
    }
}
