//! Arrays of numbers in the format Zarr v3, as far as this program has ever written it: an array is a folder with its
//! metadata as JSON and its chunks, files of little-endian numbers without compression.
//!
//! Chunks divide the first dimension: into single indices, of which those without numbers have no chunk, or into a few
//! long parts, of which those without numbers have none either. Those of early versions may divide the second dimension
//! too. NaN stands for what no chunk holds.

use std::fs::File;
use std::io::{Error, ErrorKind, Read as _, Result, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::checksums::{self, Sums};

/// Bytes of a chunk, at most: that of one index may be larger.
const LARGEST_CHUNK: u64 = 1 << 25;

/// The file of metadata.
const METADATA: &str = "zarr.json";

/// Bytes of a number.
const NUMBER: u64 = 8;

/// What the metadata of an array say.
#[derive(Debug, Deserialize)]
struct Metadata {
    shape: Vec<u64>,
    data_type: String,
    chunk_grid: Value,
    chunk_key_encoding: Value,
    codecs: Value,
    #[serde(default)]
    attributes: Map<String, Value>,
}

/// The one way in which chunks are named.
fn names_of_chunks() -> Value {
    json!({ "name": "default", "configuration": { "separator": "/" } })
}

/// The one way in which numbers are written.
fn codecs() -> Value {
    json!([{ "name": "bytes", "configuration": { "endian": "little" } }])
}

/// The numbers of an array at one index of the first dimension, in parts; what they do not fill is NaN.
pub(super) type PointValues<'a> = Vec<StoredValues<'a>>;

/// Numbers that are written one after the other.
pub(super) enum StoredValues<'a> {
    /// Those that somebody has.
    Known(&'a [f64]),
    /// Those that were made to be written.
    Made(Vec<f64>),
    /// Those that are made when they are written, since all of them at once would fill the memory.
    Later(Box<dyn Fn() -> Vec<f64> + Send + Sync + 'a>),
}

impl From<Vec<f64>> for StoredValues<'_> {
    fn from(numbers: Vec<f64>) -> Self {
        Self::Made(numbers)
    }
}

impl StoredValues<'_> {
    fn add_to(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Known(numbers) => add(numbers, bytes),
            Self::Made(numbers) => add(numbers, bytes),
            Self::Later(make) => add(&make(), bytes),
        }
    }
}

/// Adds numbers as bytes.
fn add(numbers: &[f64], bytes: &mut Vec<u8>) {
    let start = bytes.len();
    bytes.resize(start + numbers.len() * NUMBER as usize, 0);
    let (places, _) = bytes[start..].as_chunks_mut();
    for (place, number) in places.iter_mut().zip(numbers) {
        *place = number.to_le_bytes();
    }
}

/// What was written of an array.
pub(super) struct Written {
    /// Its metadata.
    pub(super) about: Value,
    /// Checksums of its files, by their names in its folder.
    pub(super) sums: Sums,
}

/// How an array is divided into chunks along its first dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Chunks {
    /// As few as [`LARGEST_CHUNK`] allows.
    Few,
    /// One an index that has numbers.
    EachIndex,
}

/// Writes an array with named dimensions into the folder `folder`, which is made: its chunks side by side.
///
/// # Errors
/// Whatever the system says.
pub(super) fn write(
    folder: &Path,
    dimensions: &[(String, u64)],
    attributes: &Map<String, Value>,
    (rows, chunks): (&[PointValues<'_>], Chunks),
) -> Result<Written> {
    let (names, mut chunk): (Vec<&str>, Vec<u64>) = dimensions
        .iter()
        .map(|(name, n)| (name.as_str(), *n))
        .unzip();
    let shape = chunk.clone();
    let length: u64 = shape.iter().skip(1).product();
    let most = (LARGEST_CHUNK / NUMBER / length.max(1)).max(1);
    let long = match chunks {
        Chunks::Few => rows_of_chunks(rows, most),
        Chunks::EachIndex => 1,
    };
    if let Some(first) = chunk.first_mut() {
        *first = long;
    }
    std::fs::create_dir_all(folder)?;
    let parts = rows.par_chunks(long as usize).enumerate();
    let parts = parts.filter(|(_, rows)| !rows.iter().all(Vec::is_empty));
    let sums = parts.map(|(number, rows)| {
        let mut bytes = Vec::with_capacity((long * length * NUMBER) as usize);
        for (index, row) in rows.iter().enumerate() {
            row.iter().for_each(|part| part.add_to(&mut bytes));
            fill(&mut bytes, (index as u64 + 1) * length);
        }
        fill(&mut bytes, long * length);
        let name = chunk_name(number as u64, 0, shape.len());
        let path = folder.join(&name);
        std::fs::create_dir_all(path.parent().unwrap_or(folder))?;
        std::fs::write(path, &bytes)?;
        Ok((name, checksums::sum(&bytes)))
    });
    let mut sums = sums.collect::<Result<Sums>>()?;
    let metadata = json!({
        "zarr_format": 3,
        "node_type": "array",
        "shape": shape,
        "data_type": "float64",
        "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": chunk } },
        "chunk_key_encoding": names_of_chunks(),
        "fill_value": "NaN",
        "codecs": codecs(),
        "attributes": attributes,
        "dimension_names": names,
    });
    sums.extend([write_metadata(folder, &metadata)?]);
    let about = metadata;
    Ok(Written { about, sums })
}

/// How many rows each of few chunks has, at most `most`: as few as leave all rows with numbers in one chunk, where they
/// fit into one, since chunks without numbers are not written. Else all chunks have as many, because the last one has
/// to be as long as the others.
fn rows_of_chunks(rows: &[PointValues<'_>], most: u64) -> u64 {
    let all = rows.len() as u64;
    let has_numbers = |row: &PointValues<'_>| !row.is_empty();
    let ends = [
        rows.iter().position(has_numbers),
        rows.iter().rposition(has_numbers),
    ];
    if let [Some(first), Some(last)] = ends.map(|end| end.map(|index| index as u64)) {
        let mut lengths = last - first + 1..=most.min(all);
        if let Some(fewest) = lengths.find(|length| first / length == last / length) {
            return fewest;
        }
    }
    let count = all.div_ceil(most).max(1);
    all.div_ceil(count).max(1)
}

/// Writes the metadata of an array, or of the folder of several, and returns their name with their checksum.
///
/// # Errors
/// Whatever the system says.
pub(super) fn write_metadata(folder: &Path, metadata: &Value) -> Result<(String, String)> {
    let text = serde_json::to_string_pretty(metadata)? + "\n";
    std::fs::write(folder.join(METADATA), &text)?;
    Ok((METADATA.to_owned(), checksums::sum(text.as_bytes())))
}

/// Adds NaN up to so many numbers.
fn fill(bytes: &mut Vec<u8>, numbers: u64) {
    while (bytes.len() as u64) < numbers * NUMBER {
        bytes.extend(f64::NAN.to_le_bytes());
    }
}

/// The file of the chunk with these numbers along the first two of so many dimensions, `/` between folders.
fn chunk_name(first: u64, second: u64, dimensions: usize) -> String {
    let numbers = [first, second].into_iter().chain(std::iter::repeat(0));
    let numbers = numbers.take(dimensions).map(|number| number.to_string());
    let parts: Vec<String> = std::iter::once("c".to_owned()).chain(numbers).collect();
    parts.join("/")
}

/// An array that is read.
#[derive(Debug, Clone)]
pub(super) struct StoredArray {
    folder: PathBuf,
    shape: Vec<u64>,
    chunk: Vec<u64>,
    attributes: Map<String, Value>,
}

impl StoredArray {
    /// Opens the array in a folder.
    ///
    /// # Errors
    /// Whatever the system says; metadata of arrays that this program does not write.
    pub(super) fn open(folder: &Path) -> Result<Self> {
        let text = super::place::read(&folder.join(METADATA))?;
        let metadata: Metadata = serde_json::from_slice(&text)?;
        let chunk = &metadata.chunk_grid["configuration"]["chunk_shape"];
        let chunk: Vec<u64> = Deserialize::deserialize(chunk)?;
        let shape = metadata.shape;
        let is_known = metadata.data_type == "float64"
            && metadata.codecs == codecs()
            && metadata.chunk_key_encoding == names_of_chunks()
            && !chunk.contains(&0)
            && !chunk.is_empty()
            && chunk.len() == shape.len()
            && chunk.get(2..) == shape.get(2..);
        match is_known {
            true => Ok(Self {
                folder: folder.to_owned(),
                shape,
                chunk,
                attributes: metadata.attributes,
            }),
            false => Err(Error::other("it is not stored as this program does it")),
        }
    }

    /// Lengths of the dimensions, of which there is one at least.
    pub(super) fn shape(&self) -> &[u64] {
        &self.shape
    }

    pub(super) fn attributes(&self) -> &Map<String, Value> {
        &self.attributes
    }

    /// The numbers at one index of the first dimension; none, or fewer than there is room for, where no more were
    /// written.
    ///
    /// # Errors
    /// Whatever the system says; chunks of another length than the metadata say.
    pub(super) fn row(&self, index: u64) -> Result<Vec<f64>> {
        let (first, place) = (index / self.chunk[0], index % self.chunk[0]);
        let dimensions = self.shape.len();
        let along = |lengths: &[u64]| lengths.get(1).copied().unwrap_or(1);
        let count = along(&self.shape).div_ceil(along(&self.chunk));
        let mut numbers = Vec::new();
        for second in 0..count {
            let name = chunk_name(first, second, dimensions);
            match self.chunk(&name, Some(place))? {
                Some(found) => numbers.extend(found),
                None => break,
            }
        }
        let length: u64 = self.shape.iter().skip(1).product();
        numbers.truncate(length as usize);
        Ok(numbers)
    }

    /// All numbers of an array with one dimension, as far as they were written.
    ///
    /// # Errors
    /// As [`StoredArray::row`].
    pub(super) fn line(&self) -> Result<Vec<f64>> {
        let mut numbers = Vec::new();
        for first in 0..self.shape[0].div_ceil(self.chunk[0]) {
            match self.chunk(&chunk_name(first, 0, 1), None)? {
                Some(found) => numbers.extend(found),
                None => break,
            }
        }
        numbers.truncate(self.shape[0] as usize);
        Ok(numbers)
    }

    /// A chunk, or what it holds at one of its places along the first dimension; `None` where there is none.
    fn chunk(&self, name: &str, place: Option<u64>) -> Result<Option<Vec<f64>>> {
        let mut file = match File::open(self.folder.join(name)) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            file => file?,
        };
        let product = |lengths: &[u64]| {
            let mut lengths = lengths.iter();
            lengths.try_fold(NUMBER, |product, length| product.checked_mul(*length))
        };
        let (whole, part) = (product(&self.chunk), product(&self.chunk[1..]));
        let found = file.metadata()?.len();
        let (Some(part), true) = (part, whole == Some(found)) else {
            let words = format!("the chunk {name} has another length, {found} bytes");
            return Err(Error::other(words));
        };
        let mut bytes = Vec::new();
        match place {
            Some(place) => {
                file.seek(SeekFrom::Start(place * part))?;
                file.take(part).read_to_end(&mut bytes)?;
            }
            None => {
                file.read_to_end(&mut bytes)?;
            }
        }
        let (numbers, _) = bytes.as_chunks();
        Ok(Some(
            numbers.iter().map(|one| f64::from_le_bytes(*one)).collect(),
        ))
    }
}
