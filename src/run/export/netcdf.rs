//! NetCDF classic with 64-bit offsets, which every program that knows NetCDF reads; `long_name` says what an array is.

use std::path::Path;

use netcdf3::error::WriteError;
use netcdf3::{DataSet as Definition, FileWriter, Version};

use super::super::RunError;
use super::DataSet;

pub(super) fn write(data: &DataSet, path: &Path) -> Result<(), RunError> {
    let failed = |message: String| RunError::Export {
        path: path.to_owned(),
        message,
    };
    let written = |source| RunError::Write {
        path: path.to_owned(),
        source,
    };
    let definition = define(data).map_err(|error| failed(format!("{error:?}")))?;
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    // Beside its place, so that it appears whole or not at all.
    let room = tempfile::Builder::new().prefix(".pbif-").tempdir_in(folder);
    let room = room.map_err(written)?;
    let file = room.path().join("export.nc");
    fill(data, &definition, &file).map_err(|error| match error {
        WriteError::IOErrorKind(kind) => written(kind.into()),
        error => failed(format!("{error:?}")),
    })?;
    std::fs::rename(&file, path).map_err(written)
}

fn define(data: &DataSet) -> Result<Definition, netcdf3::error::InvalidDataSet> {
    let mut definition = Definition::new();
    definition.add_global_attr_string("title", &data.title)?;
    definition.add_global_attr_string("Conventions", "CF-1.8")?;
    definition.add_global_attr_string("source", concat!("pbif ", env!("CARGO_PKG_VERSION")))?;
    for array in &data.arrays {
        for (name, length) in &array.dimensions {
            if definition.dim_size(name).is_none() {
                definition.add_fixed_dim(name, *length)?;
            }
        }
        let names: Vec<&str> = array.dimensions.iter().map(|one| one.0.as_str()).collect();
        definition.add_var_f64(&array.name, &names)?;
        definition.add_var_attr_string(&array.name, "long_name", &array.long_name)?;
    }
    Ok(definition)
}

fn fill(data: &DataSet, definition: &Definition, file: &Path) -> Result<(), WriteError> {
    let mut writer = FileWriter::create_new(file)?;
    writer.set_def(definition, Version::Offset64Bit, 0)?;
    for array in &data.arrays {
        writer.write_var_f64(&array.name, &array.values)?;
    }
    writer.close()
}
