//! The files of a store: metadata and chunks, composed in memory by the Zarr library and put in place by renaming.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Map, Value, json};
use zarrs::array::{Array, ArrayBuilder, data_type};
use zarrs::storage::store::MemoryStore;
use zarrs::storage::{ListableStorageTraits, ReadableStorageTraits};

use super::DensityStore;
use crate::run::RunError;
use crate::run::arrays::{Layout, PARAMETER_CHUNK};
use crate::run::atomic::write_below;
use crate::system::Family;

/// The name of a chunk in the folder of its array, as readers expect it that look for no other encoding of chunks'
/// names.
pub(super) fn chunk_name(place: &[u64]) -> String {
    let numbers = place.iter().map(|number| format!("/{number}"));
    format!("c{}", numbers.collect::<String>())
}

impl DensityStore {
    /// Writes the metadata of every array with places for `count` parameter values, and last that of the store; nothing
    /// where it stands already.
    pub(super) fn write_all_metadata(
        &mut self,
        family: &Family,
        count: u64,
    ) -> Result<(), RunError> {
        let mut layouts = self.axes.clone();
        layouts.push(Layout::parameter(family, count));
        layouts.extend(self.arrays.iter().cloned().map(|mut layout| {
            layout.dimensions[0].1 = count;
            layout
        }));
        if layouts == self.described {
            return Ok(());
        }
        let mut metadata = Map::new();
        for layout in &layouts {
            self.write_metadata(layout, &mut metadata)?;
        }
        self.write_root(family, metadata)?;
        self.described = layouts;
        Ok(())
    }

    /// Writes the chunk of parameter values that holds the last one.
    pub(super) fn write_parameter(&self, family: &Family) -> Result<(), RunError> {
        let chunks = self.values.chunks(PARAMETER_CHUNK as usize);
        let last = chunks.len().saturating_sub(1);
        let values = chunks.last().unwrap_or(&[]);
        self.write_parameter_chunk(family, last, values)
    }

    /// Writes all parameter values.
    pub(super) fn write_parameters(&self, family: &Family) -> Result<(), RunError> {
        let mut chunks = self.values.chunks(PARAMETER_CHUNK as usize).enumerate();
        chunks.try_for_each(|(index, values)| self.write_parameter_chunk(family, index, values))
    }

    fn write_parameter_chunk(
        &self,
        family: &Family,
        index: usize,
        values: &[f64],
    ) -> Result<(), RunError> {
        let layout = Layout::parameter(family, self.values.len() as u64);
        let mut chunk = values.to_vec();
        chunk.resize(PARAMETER_CHUNK as usize, f64::NAN);
        self.write_chunk(&layout, &[index as u64], &chunk)
    }

    /// Writes an array's metadata, which is also added to `metadata`.
    fn write_metadata(
        &self,
        layout: &Layout,
        metadata: &mut Map<String, Value>,
    ) -> Result<(), RunError> {
        let (memory, array) = self.array(layout)?;
        array
            .store_metadata()
            .map_err(|error| self.failed(error.to_string()))?;
        metadata.insert(layout.name.clone(), serde_json::to_value(array.metadata())?);
        self.put_in_place(&memory)
    }

    /// Writes one chunk of an array.
    pub(super) fn write_chunk(
        &self,
        layout: &Layout,
        place: &[u64],
        values: &[f64],
    ) -> Result<(), RunError> {
        if self.is_linked {
            return Ok(());
        }
        let (memory, array) = self.array(layout)?;
        array
            .store_chunk(place, values)
            .map_err(|error| self.failed(error.to_string()))?;
        self.put_in_place(&memory)
    }

    /// An array in memory.
    fn array(&self, layout: &Layout) -> Result<(Arc<MemoryStore>, Array<MemoryStore>), RunError> {
        let memory = Arc::new(MemoryStore::new());
        let shape: Vec<u64> = layout.dimensions.iter().map(|d| d.1).collect();
        let names: Vec<&str> = layout.dimensions.iter().map(|d| d.0.as_str()).collect();
        let array = ArrayBuilder::new(shape, layout.chunk.clone(), data_type::float64(), f64::NAN)
            .dimension_names(names.into())
            .attributes(layout.attributes.clone())
            .build(memory.clone(), &format!("/{}", layout.name))
            .map_err(|error| self.failed(error.to_string()))?;
        Ok((memory, array))
    }

    /// Writes what was composed in memory.
    fn put_in_place(&self, memory: &MemoryStore) -> Result<(), RunError> {
        let keys = memory.list();
        for key in keys.map_err(|error| self.failed(error.to_string()))? {
            let bytes = memory.get(&key);
            let bytes = bytes.map_err(|error| self.failed(error.to_string()))?;
            let path = self.path.join(key.as_str());
            write_below(self.home(), &path, &bytes.unwrap_or_default())?;
        }
        Ok(())
    }

    fn failed(&self, message: String) -> RunError {
        RunError::Store {
            path: self.path.clone(),
            message,
        }
    }

    /// Writes the group's metadata with that of all arrays, so that readers need not list the folder.
    fn write_root(&self, family: &Family, metadata: Map<String, Value>) -> Result<(), RunError> {
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
        let text = serde_json::to_string_pretty(&root)? + "\n";
        write_below(self.home(), &self.path.join("zarr.json"), text.as_bytes())
    }

    /// The folder that holds the store.
    pub(super) fn home(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new("."))
    }
}
