//! `densities.zarr`: marginal and joint densities as a Zarr v3 store that `xarray.open_zarr` reads as it is.
//!
//! What the arrays are is said in `arrays`. One chunk a parameter value. The Zarr library composes every key in
//! memory; the files are then put in place by renaming, since its own file store truncates in place and a kill would
//! leave half a chunk. The densities of a running sweep stand in the order in which they were solved and are put in
//! ascending order at the end.

mod files;

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::RunError;
use super::arrays::{KINK_AT, Layout, REPLICATE_CHUNK};
use super::atomic::make_below;
use super::exchange::{Fresh, Leftover};
use super::tree::link;
use crate::density::{EstimatedDensity, Variants};
use crate::space::Axis;
use crate::system::Family;
use files::chunk_name;

/// The store of a run's densities.
#[derive(Debug)]
pub(crate) struct DensityStore {
    path: PathBuf,
    values: Vec<f64>,
    /// Centres and edges of the axes so far.
    axes: Vec<Layout>,
    /// Every array so far with a dimension along the parameter.
    arrays: Vec<Layout>,
    /// Whether the chunks of arrays and axes are not written, because they stand elsewhere and will be linked.
    is_linked: bool,
    /// Arrays with the lengths that their metadata say.
    described: Vec<Layout>,
}

/// Places along the parameter that a growing store has room for are a multiple of this: what is not done yet is NaN,
/// and the metadata of all arrays need not be written for every point.
const ROOM: u64 = 64;

impl DensityStore {
    /// A store that will be made at `path` with the first density.
    pub(crate) fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            values: Vec::new(),
            axes: Vec::new(),
            arrays: Vec::new(),
            is_linked: false,
            described: Vec::new(),
        }
    }

    /// The folder of the store.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Adds the densities of one parameter value at the end. Until it is replaced as a whole, the store has room for
    /// more: places without a density are NaN, in the parameter too.
    ///
    /// # Errors
    /// [`RunError::Store`] or [`RunError::Write`].
    pub(crate) fn append(
        &mut self,
        family: &Family,
        value: f64,
        densities: &[EstimatedDensity],
    ) -> Result<(), RunError> {
        self.add(family, value, densities)?;
        self.write_parameter(family)?;
        let room = (self.values.len() as u64).next_multiple_of(ROOM);
        self.write_all_metadata(family, room)
    }

    /// Replaces the whole store by the given densities, in their order; the old one stays until the new one is
    /// complete. Densities that were appended before must be the same: their chunks are linked, not written again.
    ///
    /// # Errors
    /// As [`DensityStore::append`].
    pub(crate) fn replace(
        &mut self,
        family: &Family,
        densities: &[(f64, &[EstimatedDensity])],
    ) -> Result<(), RunError> {
        self.replaced(family, densities).map(drop)
    }

    /// The same; gives the old one, which is removed when it is dropped.
    pub(super) fn replaced(
        &mut self,
        family: &Family,
        densities: &[(f64, &[EstimatedDensity])],
    ) -> Result<Option<Leftover>, RunError> {
        if densities.is_empty() {
            return Ok(None);
        }
        let fresh = Fresh::beside(&self.path)?;
        let place = |(value, _): &(f64, &[EstimatedDensity])| {
            let mut known = self.values.iter();
            known.position(|one| one.to_bits() == value.to_bits())
        };
        let places: Option<Vec<usize>> = densities.iter().map(place).collect();
        let mut store = Self::new(&fresh.path);
        store.is_linked = places.is_some();
        for (value, densities) in densities {
            store.add(family, *value, densities)?;
        }
        if let Some(places) = places {
            store.link_chunks(self, &places)?;
            store.is_linked = false;
        }
        store.write_parameters(family)?;
        store.write_all_metadata(family, store.values.len() as u64)?;
        let before = fresh.take_place(&self.path)?;
        store.path.clone_from(&self.path);
        *self = store;
        Ok(before)
    }

    /// Gives all chunks of arrays and axes a second place here: those that stand in another store at these places.
    fn link_chunks(&self, other: &Self, places: &[usize]) -> Result<(), RunError> {
        let folders = |layout: &Layout, known: &Layout| -> Result<(PathBuf, PathBuf), RunError> {
            let to = self.path.join(&layout.name);
            make_below(self.home(), &to)?;
            Ok((other.path.join(&known.name), to))
        };
        for layout in &self.axes {
            let (from, to) = folders(layout, layout)?;
            let name = chunk_name(&[0]);
            link(&from.join(&name), &to.join(&name))?;
        }
        // Arrays stand in folders of their own: nobody waits for another.
        let linked = self.arrays.par_iter().map(|layout| {
            // The numbers of kinks depend on the order of the values.
            let is_kink = layout.attributes.contains_key(KINK_AT);
            let is_it = |known: &&Layout| match is_kink {
                true => known.is_kink(layout),
                false => known.name == layout.name,
            };
            let Some(known) = other.arrays.iter().find(is_it) else {
                return Ok(());
            };
            let (from, to) = folders(layout, known)?;
            let rest = layout.chunks_of_a_value();
            for (new, old) in places.iter().enumerate() {
                for rest in &rest {
                    let name = |place: usize| chunk_name(&[&[place as u64], &rest[..]].concat());
                    // A kink may be missing at some value.
                    link(&from.join(name(*old)), &to.join(name(new)))?;
                }
            }
            Ok(())
        });
        let linked: Vec<Result<(), RunError>> = linked.collect();
        linked.into_iter().collect()
    }

    /// Writes the chunks of one parameter value, and with the first those of the axes.
    fn add(
        &mut self,
        family: &Family,
        value: f64,
        densities: &[EstimatedDensity],
    ) -> Result<(), RunError> {
        self.values.push(value);
        for (name, axis) in axes_of(family, densities) {
            if self.axes.iter().all(|known| known.name != name) {
                let [centres, edges] = Layout::axis(&name, &axis);
                self.write_chunk(&centres, &[0], &axis.centres())?;
                self.write_chunk(&edges, &[0], axis.edges())?;
                self.axes.extend([centres, edges]);
            }
        }
        for estimate in densities {
            self.write_estimate(family, estimate)?;
        }
        Ok(())
    }

    /// Writes the chunks of one density at the last parameter value.
    fn write_estimate(
        &mut self,
        family: &Family,
        estimate: &EstimatedDensity,
    ) -> Result<(), RunError> {
        let values = &estimate.density.values;
        self.write_values(Layout::density(family, estimate), values)?;
        self.write_values(Layout::error(family, estimate), &estimate.standard_error)?;
        match &estimate.variants {
            Variants::None => {}
            Variants::Scheme(second) => {
                self.write_values(Layout::second(family, estimate), second)?;
            }
            Variants::Jackknife(replicates) => {
                let layout = Layout::replicates(family, estimate, replicates.len());
                self.write_replicates(layout, replicates)?;
            }
        }
        let mut number = 0;
        for kink in &estimate.structure.kinks {
            // A kink keeps its number although another may be missing at some parameter value.
            let mut layout = Layout::kink(family, estimate, kink, number);
            match self.arrays.iter().find(|known| known.is_kink(&layout)) {
                Some(known) => layout.name.clone_from(&known.name),
                None => {
                    while self.arrays.iter().any(|known| known.name == layout.name) {
                        number += 1;
                        layout = Layout::kink(family, estimate, kink, number);
                    }
                }
            }
            let bins: u64 = layout.chunk.iter().product();
            let jumps: Vec<f64> = (0..bins as usize).map(|bin| kink.jump_at(bin)).collect();
            self.write_values(layout, &jumps)?;
        }
        Ok(())
    }

    /// Writes one value a cell at the last parameter value.
    fn write_values(&mut self, layout: Layout, values: &[f64]) -> Result<(), RunError> {
        let layout = self.register(layout);
        let mut place = vec![0; layout.dimensions.len()];
        place[0] = self.values.len() as u64 - 1;
        self.write_chunk(&layout, &place, values)
    }

    /// Writes replicates at the last parameter value, chunk by chunk; what a chunk does not fill is NaN.
    fn write_replicates(
        &mut self,
        layout: Layout,
        replicates: &[Vec<f64>],
    ) -> Result<(), RunError> {
        let layout = self.register(layout);
        if self.is_linked {
            return Ok(());
        }
        let length = layout.chunk.iter().product::<u64>() as usize;
        for (number, part) in replicates.chunks(REPLICATE_CHUNK as usize).enumerate() {
            let mut values = part.concat();
            values.resize(length, f64::NAN);
            let mut place = vec![0; layout.dimensions.len()];
            (place[0], place[1]) = (self.values.len() as u64 - 1, number as u64);
            self.write_chunk(&layout, &place, &values)?;
        }
        Ok(())
    }

    /// Remembers an array, brings all to the present number of parameter values, and returns it as it is now.
    fn register(&mut self, layout: Layout) -> Layout {
        let known = self.arrays.iter().position(|one| one.name == layout.name);
        let index = known.unwrap_or_else(|| {
            self.arrays.push(layout.clone());
            self.arrays.len() - 1
        });
        let dimensions = self.arrays[index].dimensions.iter_mut();
        for (length, other) in dimensions.zip(&layout.dimensions) {
            length.1 = length.1.max(other.1);
        }
        for known in &mut self.arrays {
            known.dimensions[0].1 = self.values.len() as u64;
        }
        self.arrays[index].clone()
    }
}

/// Every axis that occurs in the densities, by name, each once.
fn axes_of(family: &Family, densities: &[EstimatedDensity]) -> Vec<(String, Axis)> {
    let mut axes: Vec<(String, Axis)> = Vec::new();
    for estimate in densities {
        let numbers = estimate.observable.axes();
        for (number, axis) in numbers.iter().zip(&estimate.density.axes) {
            let name = family.axis(*number);
            if axes.iter().all(|(known, _)| known != name) {
                axes.push((name.to_owned(), axis.clone()));
            }
        }
    }
    axes
}
