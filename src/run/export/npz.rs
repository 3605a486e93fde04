//! NumPy's archive: a ZIP file without compression, of one `.npy` file an array (NumPy's format 1.0).

use std::io::{Cursor, Write as _};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::super::{RunError, write_atomically};
use super::{Array, DataSet};

/// First bytes of a `.npy` file: its name and the version of the format.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

/// Data begin at a multiple of this.
const ALIGNED: usize = 64;

pub(super) fn write(data: &DataSet, path: &Path) -> Result<(), RunError> {
    let bytes = archive(data).map_err(|error| RunError::Export {
        path: path.to_owned(),
        message: error.to_string(),
    })?;
    write_atomically(path, &bytes)
}

fn archive(data: &DataSet) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for array in &data.arrays {
        let large = array.values.len() > (u32::MAX / 16) as usize;
        archive.start_file(format!("{}.npy", array.name), options.large_file(large))?;
        archive.write_all(&npy(array))?;
    }
    Ok(archive.finish()?.into_inner())
}

/// An array as a `.npy` file.
pub(super) fn npy(array: &Array) -> Vec<u8> {
    let lengths: String = (array.dimensions.iter())
        .map(|(_, length)| format!("{length}, "))
        .collect();
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({lengths}), }}");
    let length = MAGIC.len() + 2 + header.len() + 1;
    header += &" ".repeat(length.next_multiple_of(ALIGNED) - length);
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    // No array has so many dimensions that its header exceeds 64 kB.
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for value in &array.values {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}
