//! NetCDF classic with 64-bit offsets, which every program that knows NetCDF reads; `long_name` says what an array is.
//!
//! Written here, because the format is a header and the numbers: *The NetCDF Classic Format Specification* (Unidata),
//! in whose words functions are named. Everything is big-endian, names and texts are filled up to four bytes.

use std::fs::File;
use std::io::{BufWriter, Error, Write};
use std::path::Path;

use super::super::RunError;
use super::{Attribute, DataSet, NamedArray};

/// Magic number of the variant in which places of data have 64 bits.
const OFFSET_64: &[u8; 4] = b"CDF\x02";
const DIMENSIONS: u32 = 10;
const VARIABLES: u32 = 11;
const ATTRIBUTES: u32 = 12;
const TEXT: u32 = 2;
const DOUBLE: u32 = 6;
/// Bytes that an array may have, and a dimension's length at most.
const MOST_BYTES: u64 = u32::MAX as u64 - 3;
const LONGEST: usize = i32::MAX as usize;

pub(super) fn write(data: &DataSet, path: &Path) -> Result<(), RunError> {
    let header = header(data).map_err(|message| RunError::Export {
        path: path.to_owned(),
        message,
    })?;
    let written = RunError::writing(path);
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    // Beside its place, so that it appears whole or not at all.
    let room = tempfile::Builder::new().prefix(".pbif-").tempdir_in(folder);
    let room = room.map_err(written)?;
    let file = room.path().join("export.nc");
    fill(&header, &data.arrays, &file).map_err(written)?;
    std::fs::rename(&file, path).map_err(written)
}

/// Everything before the numbers; or why the format cannot hold them.
fn header(data: &DataSet) -> Result<Vec<u8>, String> {
    let mut dimensions: Vec<(&str, usize)> = Vec::new();
    let mut names: Vec<&str> = Vec::new();
    for array in &data.arrays {
        for (name, length) in &array.dimensions {
            match dimensions.iter().find(|known| known.0 == name) {
                None => dimensions.push((name, *length)),
                Some(known) if known.1 == *length => {}
                Some(_) => return Err(format!("dimension `{name}` has two lengths")),
            }
        }
        if names.contains(&array.name.as_str()) {
            return Err(format!("two arrays are called `{}`", array.name));
        }
        names.push(&array.name);
        if bytes(array) > MOST_BYTES {
            return Err(format!("`{}` has more than 4 GB", array.name));
        }
    }
    if let Some((name, _)) = dimensions.iter().find(|one| one.1 > LONGEST) {
        return Err(format!("dimension `{name}` is too long"));
    }
    let begin = encode(data, &dimensions, 0).len() as u64;
    Ok(encode(data, &dimensions, begin))
}

/// The header if the numbers begin at the byte `begin`; its length does not depend on that.
fn encode(data: &DataSet, dimensions: &[(&str, usize)], begin: u64) -> Vec<u8> {
    let mut header = Header(OFFSET_64.to_vec());
    // No dimension grows.
    header.number(0);
    header.list(DIMENSIONS, dimensions.len());
    for (name, length) in dimensions {
        header.text(name);
        header.number(*length as u32);
    }
    header.list(ATTRIBUTES, data.attributes.len());
    for (name, value) in &data.attributes {
        header.text_attribute(name, value);
    }
    header.list(VARIABLES, data.arrays.len());
    let mut place = begin;
    for array in &data.arrays {
        header.text(&array.name);
        header.number(array.dimensions.len() as u32);
        for (name, _) in &array.dimensions {
            let number = dimensions.iter().position(|known| known.0 == name);
            header.number(number.unwrap_or_default() as u32);
        }
        header.list(ATTRIBUTES, array.attributes.len());
        for (name, value) in &array.attributes {
            match value {
                Attribute::Text(text) => header.text_attribute(name, text),
                Attribute::Number(number) => header.number_attribute(name, *number),
            }
        }
        header.number(DOUBLE);
        header.number(bytes(array) as u32);
        header.0.extend(place.to_be_bytes());
        place += bytes(array);
    }
    header.0
}

fn bytes(array: &NamedArray) -> u64 {
    8 * array.values.len() as u64
}

struct Header(Vec<u8>);

impl Header {
    fn number(&mut self, number: u32) {
        self.0.extend(number.to_be_bytes());
    }

    /// What a list is of, and its length. An empty one is of nothing.
    fn list(&mut self, kind: u32, length: usize) {
        self.number(if length > 0 { kind } else { 0 });
        self.number(length as u32);
    }

    fn text(&mut self, text: &str) {
        self.number(text.len() as u32);
        self.0.extend(text.as_bytes());
        self.0.resize(self.0.len().next_multiple_of(4), 0);
    }

    fn text_attribute(&mut self, name: &str, value: &str) {
        self.text(name);
        self.number(TEXT);
        self.text(value);
    }

    fn number_attribute(&mut self, name: &str, value: f64) {
        self.text(name);
        self.number(DOUBLE);
        self.number(1);
        self.0.extend(value.to_be_bytes());
    }
}

fn fill(header: &[u8], arrays: &[NamedArray], path: &Path) -> Result<(), Error> {
    let mut file = BufWriter::new(File::create_new(path)?);
    file.write_all(header)?;
    for value in arrays.iter().flat_map(|array| &array.values) {
        file.write_all(&value.to_be_bytes())?;
    }
    file.flush()
}
