//! `densities.zarr`, read back: the same densities bit for bit, with their errors, variants and structure.

mod opened;

use std::path::{Path, PathBuf};

use opened::Opened;

use super::RunError;
use super::arrays::EndNumber;
use super::zarr::StoredArray;
use crate::continuation::Subject;
use crate::density::{
    Density, EstimatedDensity, Kink, Observable, Structure, Truncation, Variants, errors_by_schemes,
};
use crate::method::OneAxisFamily;
use crate::space::{Axis, CellSpace};
use crate::system::{Family, Symmetry, proved_symmetry, symmetry_over_a_period};

/// Numbers that a density has of each of its axes, for each of their cells.
const OF_AXES: usize = 6;

/// The store of a run, opened for the observables that are wanted of it.
pub(super) struct StoredDensities {
    path: PathBuf,
    /// Parameter values in the order of the store.
    values: Vec<f64>,
    observed: Vec<Observed>,
    family: Family,
    /// Lower and upper end of every axis of the cells.
    ends: Vec<(f64, f64)>,
    /// What the equations say where there is one axis.
    one_axis: Option<OneAxisFamily>,
}

/// The arrays of one observable.
struct Observed {
    observable: Observable,
    axes: Vec<Axis>,
    density: StoredArray,
    error: StoredArray,
    second: Option<StoredArray>,
    /// In the order of [`EndNumber::ALL`].
    range_ends: [Option<StoredNumber>; EndNumber::ALL.len()],
    closed: Option<StoredArray>,
    replicates: Option<StoredArray>,
    centre: Option<Vec<f64>>,
    own_ends: Vec<[bool; 2]>,
    negligible: f64,
    kinks: Vec<StoredKink>,
}

/// A number at each parameter value: the array in which it stands, and where in a row.
struct StoredNumber {
    array: StoredArray,
    place: usize,
}

struct StoredKink {
    axis: usize,
    at: f64,
    bends: bool,
    jump: StoredArray,
}

/// How many numbers a density has, with what is known of its axes.
pub(super) fn numbers_of(estimate: &EstimatedDensity) -> usize {
    let EstimatedDensity {
        density,
        standard_error,
        variants,
        truncation,
        ..
    } = estimate;
    let of_variants = match variants {
        Variants::None => 0,
        Variants::Scheme(second) => second.len(),
        Variants::Jackknife(replicates) => replicates.iter().map(Vec::len).sum(),
    };
    let along: usize = density.axes.iter().map(Axis::count).sum();
    let in_cells = density.values.len() + standard_error.len() + truncation.change.len();
    in_cells + of_variants + OF_AXES * along
}

impl StoredDensities {
    /// Opens the store at `path`.
    ///
    /// # Errors
    /// [`RunError::ReadStore`]; [`RunError::NotStored`] for an observable that the store does not have;
    /// [`RunError::Cells`] when its cells or bins are others.
    pub(super) fn open(
        path: &Path,
        subject: &Subject,
        cells: (&CellSpace, &[Axis]),
    ) -> Result<Self, RunError> {
        let opened = Opened::new(path)?;
        let family = &subject.family;
        let mut values = opened.whole(family.parameter())?;
        // Stores of early versions grew, and had room for values that were not solved yet.
        let solved = values.iter().position(|value| value.is_nan());
        values.truncate(solved.unwrap_or(values.len()));
        let observed = subject
            .observables
            .iter()
            .map(|&observable| opened.observed(family, cells, observable))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            path: path.to_owned(),
            values,
            observed,
            family: family.clone(),
            ends: (cells.0.axes().iter())
                .map(|axis| (axis.from(), axis.to()))
                .collect(),
            one_axis: OneAxisFamily::new(family, cells.0),
        })
    }

    /// How many numbers the densities at a value have at most, with what is known of their axes.
    pub(super) fn numbers(&self) -> usize {
        self.observed.iter().map(Observed::numbers).sum()
    }

    /// The densities at a parameter value; `None` if the store has none there.
    ///
    /// # Errors
    /// [`RunError::ReadStore`].
    pub(super) fn at(&self, value: f64) -> Result<Option<Vec<EstimatedDensity>>, RunError> {
        let Some(index) = self.values.iter().position(|&known| known == value) else {
            return Ok(None);
        };
        let system = self.family.at(value).ok();
        let with_centre = self.observed.iter().any(|one| one.centre.is_some());
        let symmetric = system.as_deref().filter(|_| with_centre);
        // The centre that is stored is that of the value that was solved first, and others need not have it.
        let at_any_phase = symmetric.and_then(|system| proved_symmetry(system, &self.ends));
        let forced = symmetric.filter(|system| system.facts().phase.is_some());
        let over_a_period =
            (at_any_phase.clone()).or_else(|| symmetry_over_a_period(forced?, &self.ends));
        // At one phase a reflection does not serve that needs half a period; axes there are those of the state.
        let reflects = |observable: Observable| {
            let axes = observable.axes();
            let (axes, symmetry) = match self.family.at_phase(&axes) {
                Some((states, _)) => (states, &at_any_phase),
                None => (axes, &over_a_period),
            };
            // Axes of quantities are numbered on from those that are reflected.
            let is_reflected =
                |axis: &usize, one: &Symmetry| one.reflected.get(*axis).copied().unwrap_or(true);
            let one = symmetry.as_ref();
            one.is_some_and(|one| axes.iter().all(|axis| is_reflected(axis, one)))
        };
        let densities = self.observed.iter();
        densities
            .map(|observed| {
                let has_centre = reflects(observed.observable);
                let mut estimate = observed.estimate(&self.path, index as u64, has_centre)?;
                let mut axes = observed.observable.axes().into_iter();
                let is_forced = system
                    .as_ref()
                    .is_some_and(|one| one.facts().phase.is_some());
                estimate.structure.is_spread =
                    is_forced || axes.any(|axis| axis >= self.ends.len());
                // Which of its values were solved by quadrature, the store does not say; only the generator has a
                // second scheme.
                let is_solved = estimate.variants.second_scheme().is_some();
                let is_whole = estimate.observable == Observable::Marginal(0);
                let known = self.one_axis.filter(|_| is_solved && is_whole);
                if let Some((one_axis, system)) = known.zip(system.as_deref()) {
                    one_axis.restore(&mut estimate, system);
                }
                Ok(estimate)
            })
            .collect::<Result<_, _>>()
            .map(Some)
    }
}

impl Observed {
    fn numbers(&self) -> usize {
        let optional = [&self.second, &self.closed, &self.replicates];
        let arrays = optional.into_iter().flatten();
        let arrays = arrays.chain([&self.density, &self.error]);
        let length = |array: &StoredArray| array.shape()[1..].iter().product::<u64>() as usize;
        let along: usize = self.axes.iter().map(Axis::count).sum();
        arrays.map(length).sum::<usize>() + OF_AXES * along
    }

    fn estimate(
        &self,
        path: &Path,
        index: u64,
        has_centre: bool,
    ) -> Result<EstimatedDensity, RunError> {
        let read = |array: &StoredArray| at_index(path, array, index);
        let cells = self.axes.iter().map(Axis::count).product();
        let in_cells = |array: &StoredArray| -> Result<Vec<f64>, RunError> {
            let mut values = read(array)?;
            values.resize(cells, f64::NAN);
            Ok(values)
        };
        let mut kinks = Vec::new();
        for kink in &self.kinks {
            let jump = read(&kink.jump)?;
            if !is_missing(&jump) {
                let (axis, at) = (kink.axis, kink.at);
                let jump = if kink.bends { Vec::new() } else { jump };
                kinks.push(Kink { axis, at, jump });
            }
        }
        let centre = self.centre.clone().filter(|_| has_centre);
        let density = Density {
            axes: self.axes.clone(),
            values: in_cells(&self.density)?,
        };
        let variants = self.variants(path, index)?;
        let truncation = self.truncation(path, index)?;
        // What is stored has what ends and numbers of modes may have changed.
        let standard_error = match variants.second_scheme() {
            Some(second) if truncation != Truncation::default() => {
                errors_by_schemes(&density, second)
            }
            _ => in_cells(&self.error)?,
        };
        Ok(EstimatedDensity {
            observable: self.observable,
            density,
            standard_error,
            variants,
            structure: Structure {
                centre,
                kinks,
                own_ends: self.own_ends.clone(),
                ..Structure::default()
            },
            negligible: self.negligible,
            truncation,
        })
    }

    fn truncation(&self, path: &Path, index: u64) -> Result<Truncation, RunError> {
        let mut truncation = Truncation::default();
        if let Some(array) = &self.closed {
            truncation.change = at_index(path, array, index)?;
            if is_missing(&truncation.change) {
                truncation.change.clear();
            }
        }
        for (number, stored) in EndNumber::ALL.into_iter().zip(&self.range_ends) {
            let Some(StoredNumber { array, place }) = stored else {
                continue;
            };
            let row = at_index(path, array, index)?;
            let found = row.get(*place).copied().filter(|found| found.is_finite());
            let found = found.unwrap_or(0.0);
            match number {
                EndNumber::Share => truncation.share = found,
                EndNumber::Level => truncation.level = found,
            }
        }
        Ok(truncation)
    }

    fn variants(&self, path: &Path, index: u64) -> Result<Variants, RunError> {
        if let Some(second) = &self.second {
            let second = at_index(path, second, index)?;
            if !is_missing(&second) {
                return Ok(Variants::Scheme(second));
            }
        }
        let Some(array) = &self.replicates else {
            return Ok(Variants::None);
        };
        let cells = self.axes.iter().map(Axis::count).product();
        let values = at_index(path, array, index)?;
        let replicates: Vec<Vec<f64>> = values
            .chunks(cells)
            .take_while(|one| !is_missing(one))
            .map(<[f64]>::to_vec)
            .collect();
        Ok(if replicates.is_empty() {
            Variants::None
        } else {
            Variants::Jackknife(replicates)
        })
    }
}

/// NaN, or nothing, stands for values that a parameter value does not have.
fn is_missing(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_nan())
}

/// An array at one parameter value.
fn at_index(path: &Path, array: &StoredArray, index: u64) -> Result<Vec<f64>, RunError> {
    array.row(index).map_err(RunError::store(path))
}
