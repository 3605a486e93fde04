//! `densities.zarr`: marginal and joint densities of a sweep as a Zarr v3 store that `xarray.open_zarr` reads as it is.
//!
//! What the arrays are is said in `arrays`. The store is written at once; until then the journal holds all densities.
//! It is made beside its place and put there when it is whole.
//!
//! An array is divided into a file a value where few of its values have numbers, or where the whole store has few
//! values: damage to a file then costs one value, and what has no numbers takes no room. Else it is one file, or a few
//! large ones.

use std::path::Path;

use rayon::prelude::*;
use serde_json::{Map, json};

use super::RunError;
use super::arrays::{DensityPart, EndNumber, Layout, RANGE_ENDS};
use super::checksums::Sums;
use super::tree::rename;
use super::zarr::{self, Chunks, PointValues, StoredValues, Written};
use crate::UNFINISHED;
use crate::continuation::StateField;
use crate::density::{EstimatedDensity, Variants};
use crate::space::Axis;
use crate::system::Family;

/// What is stored of a point: the value of the parameter, densities, and fields of passages.
pub(super) type StoredPoint<'a> = (f64, &'a [EstimatedDensity], &'a [StateField]);

/// Writes the densities at values of the parameter in their order, in the place of a store that is there; nothing where
/// there are none. Returns the checksums of its files by their names in it.
///
/// # Errors
/// [`RunError::Write`].
pub(super) fn write_store(
    path: &Path,
    family: &Family,
    points: &[StoredPoint<'_>],
) -> Result<Sums, RunError> {
    if points.is_empty() {
        return Ok(Sums::new());
    }
    let failed = RunError::writing(path);
    let home = path.parent().unwrap_or(Path::new("."));
    let room = tempfile::Builder::new().prefix(UNFINISHED).tempdir_in(home);
    let room = room.map_err(failed)?;
    let fresh = room.path().join("fresh");
    let mut store = Store::default();
    store.name_densities(family, points);
    for (index, (value, densities, fields)) in points.iter().enumerate() {
        store.add(family, (index, *value), densities);
        store.add_fields(family, index, fields);
    }
    let sums = store.write(family, &fresh).map_err(failed)?;
    // What stands there is of an unfinished run, whose journal holds the same densities.
    if path.exists() {
        std::fs::remove_dir_all(path).map_err(failed)?;
    }
    rename(&fresh, path)?;
    Ok(sums)
}

/// Values of a density, counted over all arrays, up to which each is a file: a run then has no more than about 60
/// files.
const MOST_FILES: usize = 36;

/// Values of one array with numbers up to which each is a file, where others have none.
const FEW_VALUES: usize = 4;

/// A store that is composed.
#[derive(Default)]
struct Store<'a> {
    /// The densities of all values, by the names of their arrays.
    densities: Vec<String>,
    arrays: Vec<(Layout, Vec<PointValues<'a>>)>,
}

impl<'a> Store<'a> {
    fn name_densities(&mut self, family: &Family, points: &[StoredPoint<'_>]) {
        for estimate in points.iter().flat_map(|(_, densities, _)| *densities) {
            let name = DensityPart::Density.name(family, estimate.observable);
            if !self.densities.contains(&name) {
                self.densities.push(name);
            }
        }
    }

    /// Adds what the ends of the ranges have left of all densities at a value; nothing where they have left nothing.
    fn add_range_ends(&mut self, family: &Family, index: usize, densities: &[EstimatedDensity]) {
        let mut numbers = Vec::new();
        for name in &self.densities {
            let mut all = densities.iter();
            let is_it = |one: &&EstimatedDensity| {
                DensityPart::Density.name(family, one.observable) == *name
            };
            let truncation = all.find(is_it).map(|one| &one.truncation);
            numbers.extend(EndNumber::ALL.map(|number| {
                let found = truncation.map(|truncation| match number {
                    EndNumber::Share => truncation.share,
                    EndNumber::Level => truncation.level,
                });
                found.filter(|found| *found > 0.0).unwrap_or(f64::NAN)
            }));
        }
        if numbers.iter().any(|number| !number.is_nan()) {
            let layout = Layout::range_ends(family, &self.densities);
            self.put(layout, index, vec![numbers.into()]);
        }
    }

    /// Adds the densities at a value of the parameter, with the first of them their axes.
    fn add(
        &mut self,
        family: &Family,
        (index, value): (usize, f64),
        densities: &'a [EstimatedDensity],
    ) {
        self.put(Layout::parameter(family), index, vec![vec![value].into()]);
        for estimate in densities {
            let axes = estimate.observable.axes();
            for (number, axis) in axes.into_iter().zip(&estimate.density.axes) {
                self.add_axis(family.axis(number), axis);
            }
            self.add_estimate(family, index, estimate);
        }
        self.add_range_ends(family, index, densities);
    }

    fn add_axis(&mut self, name: &str, axis: &Axis) {
        let [centres, edges] = Layout::axis(name);
        for (layout, numbers) in [(centres, &axis.centres()[..]), (edges, axis.edges())] {
            if !self.has(&layout.name) {
                let rows = numbers.iter().map(|&one| vec![vec![one].into()]);
                self.arrays.push((layout, rows.collect()));
            }
        }
    }

    fn add_fields(&mut self, family: &Family, index: usize, fields: &'a [StateField]) {
        for field in fields {
            for (number, axis) in field.axes.iter().enumerate() {
                self.add_axis(family.axis(number), axis);
            }
            let both = [&field.values, &field.errors];
            for (layout, numbers) in Layout::field(family, field).into_iter().zip(both) {
                self.put(layout, index, vec![StoredValues::Known(numbers)]);
            }
        }
    }

    fn add_estimate(&mut self, family: &Family, index: usize, estimate: &'a EstimatedDensity) {
        let whole = |values: &'a [f64]| vec![StoredValues::Known(values)];
        let values = whole(&estimate.density.values);
        self.put(
            Layout::part(DensityPart::Density, family, estimate),
            index,
            values,
        );
        let errors = vec![StoredValues::Later(Box::new(|| estimate.stated_errors()))];
        self.put(
            Layout::part(DensityPart::Error, family, estimate),
            index,
            errors,
        );
        let truncation = &estimate.truncation;
        if !truncation.change.is_empty() {
            let change = whole(&truncation.change);
            self.put(
                Layout::part(DensityPart::Closed, family, estimate),
                index,
                change,
            );
        }
        match &estimate.variants {
            Variants::None => {}
            Variants::Scheme(second) => {
                self.put(
                    Layout::part(DensityPart::Second, family, estimate),
                    index,
                    whole(second),
                );
            }
            Variants::Jackknife(replicates) => {
                let layout = Layout::part(DensityPart::Replicates, family, estimate);
                let parts = replicates.iter().map(|one| StoredValues::Known(one));
                self.put(layout, index, parts.collect());
            }
        }
        for kink in &estimate.structure.kinks {
            // A kink keeps its number although another may be missing at some parameter value.
            let mut number = 0;
            let mut layout = Layout::kink(family, estimate, kink, number);
            let known = self.arrays.iter().find(|(known, _)| known.is_kink(&layout));
            match known {
                Some((known, _)) => layout.name.clone_from(&known.name),
                None => {
                    while self.has(&layout.name) {
                        number += 1;
                        layout = Layout::kink(family, estimate, kink, number);
                    }
                }
            }
            let bins: u64 = layout.dimensions.iter().skip(1).map(|one| one.1).product();
            let jumps: Vec<f64> = (0..bins as usize).map(|bin| kink.jump_at(bin)).collect();
            self.put(layout, index, vec![jumps.into()]);
        }
    }

    fn has(&self, name: &str) -> bool {
        self.arrays.iter().any(|(known, _)| known.name == name)
    }

    /// Adds the numbers of an array at a place along the parameter.
    fn put(&mut self, layout: Layout, index: usize, row: PointValues<'a>) {
        let known = (self.arrays.iter()).position(|(known, _)| known.name == layout.name);
        let known = known.unwrap_or_else(|| {
            self.arrays.push((layout.clone(), Vec::new()));
            self.arrays.len() - 1
        });
        let (kept, rows) = &mut self.arrays[known];
        for (length, other) in kept.dimensions.iter_mut().zip(&layout.dimensions) {
            length.1 = length.1.max(other.1);
        }
        rows.resize_with(index, Vec::new);
        rows.push(row);
    }

    /// Writes all arrays, and what readers need not look for then: the metadata of all of them in one place.
    fn write(mut self, family: &Family, folder: &Path) -> std::io::Result<Sums> {
        let values = self.arrays.first().map_or(0, |(_, rows)| rows.len());
        let filled = |rows: &[PointValues<'_>]| rows.iter().filter(|row| !row.is_empty()).count();
        let of_densities = |layout: &Layout| {
            let is_along = layout.is_along(family) && layout.dimensions.len() > 1;
            is_along && layout.name != RANGE_ENDS
        };
        let densities = self
            .arrays
            .iter()
            .filter(|(layout, _)| of_densities(layout));
        let is_small = densities.map(|(_, rows)| filled(rows)).sum::<usize>() <= MOST_FILES;
        let written = self.arrays.par_iter_mut().map(|(layout, rows)| {
            let number = filled(rows);
            if layout.is_along(family) {
                rows.resize_with(values, Vec::new);
            }
            let is_sparse = number <= FEW_VALUES && number < rows.len();
            let chunks = if of_densities(layout) && (is_small || is_sparse) {
                Chunks::EachIndex
            } else {
                Chunks::Few
            };
            layout.dimensions[0].1 = rows.len() as u64;
            let folder = folder.join(&layout.name);
            let (dimensions, attributes) = (&layout.dimensions, &layout.attributes);
            let written = zarr::write(&folder, dimensions, attributes, (rows, chunks))?;
            Ok((layout.name.clone(), written))
        });
        let written: std::io::Result<Vec<(String, Written)>> = written.collect();
        let (mut metadata, mut sums) = (Map::new(), Sums::new());
        for (array, written) in written? {
            let of_array = written.sums.into_iter();
            sums.extend(of_array.map(|(name, sum)| (format!("{array}/{name}"), sum)));
            metadata.insert(array, written.about);
        }
        let root = json!({
            "zarr_format": 3,
            "node_type": "group",
            "attributes": { "title": family.model().title, "model": family.model().name },
            "consolidated_metadata": {
                "kind": "inline",
                "must_understand": false,
                "metadata": metadata,
            },
        });
        sums.extend([zarr::write_metadata(folder, &root)?]);
        Ok(sums)
    }
}
