//! `densities.zarr`: marginal and joint densities as a Zarr v3 store that `xarray.open_zarr` reads as it is.
//!
//! Arrays: the swept parameter; a coordinate an axis (cell centres, `x`) with its edges (`x_edges`); a density an
//! observable (`p_x`, `p_xy`) with dimensions (parameter, axes …) and its standard error (`p_x_error`). One chunk a
//! parameter value. The Zarr library composes every key in memory; the files are then put in place by renaming, since
//! its own file store truncates in place and a kill would leave half a chunk. The densities of a running sweep stand in the
//! order in which they were solved and are put in ascending order at the end.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Map, Value, json};
use zarrs::array::{Array, ArrayBuilder, data_type};
use zarrs::storage::store::MemoryStore;
use zarrs::storage::{ListableStorageTraits, ReadableStorageTraits};

use super::{Naming, RunError, atomic::write_atomically};
use crate::density::{EstimatedDensity, Observable};
use crate::space::Axis;

/// Values a chunk of the parameter's coordinate holds.
const PARAMETER_CHUNK: u64 = 1024;

/// The store of a run's densities.
#[derive(Debug)]
pub struct DensityStore {
    path: PathBuf,
    values: Vec<f64>,
}

/// One array of the store: name, dimensions with lengths, and what it says of itself.
struct Layout {
    name: String,
    dimensions: Vec<(String, u64)>,
    chunk: Vec<u64>,
    long_name: String,
}

impl DensityStore {
    /// A store that will be made at `path` with the first density.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            values: Vec::new(),
        }
    }

    /// Adds the densities of one parameter value at the end.
    ///
    /// # Errors
    /// [`RunError::Store`] or [`RunError::Write`].
    pub fn append(
        &mut self,
        naming: &Naming<'_>,
        value: f64,
        densities: &[EstimatedDensity],
    ) -> Result<(), RunError> {
        let place = self.values.len() as u64;
        self.values.push(value);
        let mut metadata = Map::new();
        for (name, axis) in axes_of(naming, densities) {
            self.write_axis(&name, &axis, &mut metadata)?;
        }
        self.write_parameter(naming, &mut metadata)?;
        for estimate in densities {
            let name = format!("p_{}", naming.observable(estimate.observable));
            let error = format!("{name}_error");
            let words = words(naming, estimate.observable);
            let chunk = [place, 0, 0];
            let chunk = &chunk[..=estimate.density.axes.len()];
            let layout = self.layout(naming, estimate, &name, &words);
            self.write_array(&layout, chunk, &estimate.density.values, &mut metadata)?;
            let layout = self.layout(
                naming,
                estimate,
                &error,
                &format!("standard error of the {words}"),
            );
            self.write_array(&layout, chunk, &estimate.standard_error, &mut metadata)?;
        }
        self.write_root(naming, metadata)
    }

    /// Replaces the whole store by the given densities, in their order; the old one stays until the new one is
    /// complete.
    ///
    /// # Errors
    /// As [`DensityStore::append`].
    pub fn replace(
        &mut self,
        naming: &Naming<'_>,
        densities: &[(f64, &[EstimatedDensity])],
    ) -> Result<(), RunError> {
        if densities.is_empty() {
            return Ok(());
        }
        let failed = |source| RunError::Write {
            path: self.path.clone(),
            source,
        };
        let fresh = self.path.with_extension("zarr.new");
        if fresh.exists() {
            std::fs::remove_dir_all(&fresh).map_err(failed)?;
        }
        let mut store = Self::new(&fresh);
        for (value, densities) in densities {
            store.append(naming, *value, densities)?;
        }
        if self.path.exists() {
            std::fs::remove_dir_all(&self.path).map_err(failed)?;
        }
        std::fs::rename(&fresh, &self.path).map_err(failed)?;
        self.values = store.values;
        Ok(())
    }

    fn layout(
        &self,
        naming: &Naming<'_>,
        estimate: &EstimatedDensity,
        name: &str,
        long_name: &str,
    ) -> Layout {
        let mut dimensions = vec![(naming.parameter.to_owned(), self.values.len() as u64)];
        let axes = observed_axes(estimate.observable);
        for (axis, cells) in axes.iter().zip(&estimate.density.axes) {
            dimensions.push((naming.axis(*axis).to_owned(), cells.count() as u64));
        }
        let mut chunk: Vec<u64> = dimensions.iter().map(|dimension| dimension.1).collect();
        chunk[0] = 1;
        Layout {
            name: name.to_owned(),
            dimensions,
            chunk,
            long_name: long_name.to_owned(),
        }
    }

    fn write_parameter(
        &self,
        naming: &Naming<'_>,
        metadata: &mut Map<String, Value>,
    ) -> Result<(), RunError> {
        let count = self.values.len() as u64;
        let layout = Layout {
            name: naming.parameter.to_owned(),
            dimensions: vec![(naming.parameter.to_owned(), count)],
            chunk: vec![PARAMETER_CHUNK],
            long_name: "swept parameter".to_owned(),
        };
        let index = (count - 1) / PARAMETER_CHUNK;
        let mut chunk = self.values[(index * PARAMETER_CHUNK) as usize..].to_vec();
        chunk.resize(PARAMETER_CHUNK as usize, 0.0);
        self.write_array(&layout, &[index], &chunk, metadata)
    }

    fn write_axis(
        &self,
        name: &str,
        axis: &Axis,
        metadata: &mut Map<String, Value>,
    ) -> Result<(), RunError> {
        let one_dimension = |name: &str, dimension: &str, count: usize, long_name: &str| Layout {
            name: name.to_owned(),
            dimensions: vec![(dimension.to_owned(), count as u64)],
            chunk: vec![count as u64],
            long_name: long_name.to_owned(),
        };
        let centres = one_dimension(name, name, axis.count(), "centres of the cells");
        self.write_array(&centres, &[0], &axis.centres(), metadata)?;
        let edges = format!("{name}_edges");
        let layout = one_dimension(&edges, &edges, axis.count() + 1, "edges of the cells");
        self.write_array(&layout, &[0], axis.edges(), metadata)
    }

    /// Writes one chunk of an array with the array's metadata, which is also added to `metadata`.
    fn write_array(
        &self,
        layout: &Layout,
        chunk: &[u64],
        values: &[f64],
        metadata: &mut Map<String, Value>,
    ) -> Result<(), RunError> {
        let memory = Arc::new(MemoryStore::new());
        let failed = |message: String| RunError::Store {
            path: self.path.clone(),
            message,
        };
        let shape: Vec<u64> = layout.dimensions.iter().map(|d| d.1).collect();
        let names: Vec<&str> = layout.dimensions.iter().map(|d| d.0.as_str()).collect();
        let mut attributes = Map::new();
        attributes.insert("long_name".to_owned(), layout.long_name.clone().into());
        let array: Array<MemoryStore> =
            ArrayBuilder::new(shape, layout.chunk.clone(), data_type::float64(), f64::NAN)
                .dimension_names(names.into())
                .attributes(attributes)
                .build(memory.clone(), &format!("/{}", layout.name))
                .map_err(|error| failed(error.to_string()))?;
        array.store_metadata().map_err(|e| failed(e.to_string()))?;
        array
            .store_chunk(chunk, values)
            .map_err(|error| failed(error.to_string()))?;
        metadata.insert(layout.name.clone(), serde_json::to_value(array.metadata())?);
        for key in memory.list().map_err(|e| failed(e.to_string()))? {
            let bytes = memory.get(&key).map_err(|e| failed(e.to_string()))?;
            write_atomically(&self.path.join(key.as_str()), &bytes.unwrap_or_default())?;
        }
        Ok(())
    }

    /// Writes the group's metadata with that of all arrays, so that readers need not list the folder.
    fn write_root(
        &self,
        naming: &Naming<'_>,
        metadata: Map<String, Value>,
    ) -> Result<(), RunError> {
        let root = json!({
            "zarr_format": 3,
            "node_type": "group",
            "attributes": { "title": naming.model.title, "model": naming.model.name },
            "consolidated_metadata": {
                "kind": "inline",
                "must_understand": false,
                "metadata": metadata,
            },
        });
        let text = serde_json::to_string_pretty(&root)? + "\n";
        write_atomically(&self.path.join("zarr.json"), text.as_bytes())
    }
}

/// Every axis that occurs in the densities, by name, each once.
fn axes_of(naming: &Naming<'_>, densities: &[EstimatedDensity]) -> Vec<(String, Axis)> {
    let mut axes: Vec<(String, Axis)> = Vec::new();
    for estimate in densities {
        let numbers = observed_axes(estimate.observable);
        for (number, axis) in numbers.iter().zip(&estimate.density.axes) {
            let name = naming.axis(*number);
            if axes.iter().all(|(known, _)| known != name) {
                axes.push((name.to_owned(), axis.clone()));
            }
        }
    }
    axes
}

fn observed_axes(observable: Observable) -> Vec<usize> {
    match observable {
        Observable::Marginal(axis) => vec![axis],
        Observable::Joint(first, second) => vec![first, second],
    }
}

fn words(naming: &Naming<'_>, observable: Observable) -> String {
    match observable {
        Observable::Marginal(axis) => format!("marginal density of {}", naming.axis(axis)),
        Observable::Joint(first, second) => {
            format!(
                "joint density of {} and {}",
                naming.axis(first),
                naming.axis(second)
            )
        }
    }
}
