//! Tables of records. Each column is declared once: its name, how a record is written into it, and, where the table is
//! read back, what of the record is read from it.

use std::path::Path;

use serde_json::{Map, Value};

use super::RunError;
use super::cell::Cell;
use super::number::format_number;

/// What the cells of a column hold, for JSON.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Number,
    Word,
    Flag,
}

/// Sets what of a record a cell tells.
type Fill<'a, T> = Box<dyn Fn(&Cell<'_>, &mut T) -> Result<(), RunError> + 'a>;

/// A column of records `T`.
pub(super) struct Column<'a, T> {
    name: String,
    kind: Kind,
    write: Box<dyn Fn(&T) -> String + 'a>,
    /// Nothing where the column follows from others.
    fill: Option<Fill<'a, T>>,
    /// Whether tables of earlier versions lack it.
    newer: bool,
}

/// A column of words.
pub(super) fn word<'a, T, W: Into<String>>(
    name: impl Into<String>,
    of: impl Fn(&T) -> W + 'a,
) -> Column<'a, T> {
    Column {
        name: name.into(),
        kind: Kind::Word,
        write: Box::new(move |record| of(record).into()),
        fill: None,
        newer: false,
    }
}

/// A column of numbers, written by a function of its own; an empty text is a number that is not there.
pub(super) fn digits<'a, T>(
    name: impl Into<String>,
    of: impl Fn(&T) -> String + 'a,
) -> Column<'a, T> {
    Column {
        kind: Kind::Number,
        ..word(name, of)
    }
}

/// A column of numbers in full; those that are not finite leave an empty cell.
pub(super) fn number<'a, T>(name: impl Into<String>, of: impl Fn(&T) -> f64 + 'a) -> Column<'a, T> {
    digits(name, move |record| format_number(of(record)))
}

/// A column of numbers that may be missing.
pub(super) fn optional<'a, T>(
    name: impl Into<String>,
    of: impl Fn(&T) -> Option<f64> + 'a,
) -> Column<'a, T> {
    digits(name, move |record| {
        of(record).map_or(String::new(), format_number)
    })
}

/// A column of whole numbers.
pub(super) fn count<'a, T>(
    name: impl Into<String>,
    of: impl Fn(&T) -> usize + 'a,
) -> Column<'a, T> {
    digits(name, move |record| of(record).to_string())
}

/// A column of `true` and `false`.
pub(super) fn flag<'a, T>(name: impl Into<String>, of: impl Fn(&T) -> bool + 'a) -> Column<'a, T> {
    Column {
        kind: Kind::Flag,
        ..word(name, move |record| of(record).to_string())
    }
}

impl<'a, T> Column<'a, T> {
    /// Reads the column back: `parse` says what stands in a cell, `set` puts it into the record.
    pub(super) fn read<V>(
        self,
        parse: impl for<'t> Fn(&Cell<'t>) -> Result<V, RunError> + 'a,
        set: impl Fn(&mut T, V) + 'a,
    ) -> Self {
        let fill = move |cell: &Cell<'_>, record: &mut T| {
            set(record, parse(cell)?);
            Ok(())
        };
        Self {
            fill: Some(Box::new(fill)),
            ..self
        }
    }

    /// Tables of earlier versions do not have the column: what it tells then stays as it is in a new record.
    pub(super) fn newer(self) -> Self {
        Self {
            newer: true,
            ..self
        }
    }
}

/// A table's columns.
pub(super) struct Columns<'a, T>(pub(super) Vec<Column<'a, T>>);

impl<T> Columns<'_, T> {
    /// The whole table.
    ///
    /// # Errors
    /// [`RunError::Table`].
    pub(super) fn csv<'r>(
        &self,
        records: impl IntoIterator<Item = &'r T>,
    ) -> Result<String, RunError>
    where
        T: 'r,
    {
        Ok(self.header()? + &self.lines(records)?)
    }

    /// The names of the columns.
    pub(super) fn names(&self) -> Vec<Named> {
        let columns = self.0.iter();
        columns.map(|column| Named::new(&column.name, "")).collect()
    }

    /// The first line.
    ///
    /// # Errors
    /// [`RunError::Table`].
    pub(super) fn header(&self) -> Result<String, RunError> {
        compose([self.0.iter().map(|column| column.name.clone())])
    }

    /// The lines of records.
    ///
    /// # Errors
    /// [`RunError::Table`].
    pub(super) fn lines<'r>(
        &self,
        records: impl IntoIterator<Item = &'r T>,
    ) -> Result<String, RunError>
    where
        T: 'r,
    {
        let records = records.into_iter();
        compose(records.map(|record| self.0.iter().map(|column| (column.write)(record))))
    }

    /// A list of objects with the columns' names: numbers as numbers, `true` and `false` as such, empty cells as null.
    pub(super) fn json<'r>(&self, records: impl IntoIterator<Item = &'r T>) -> Value
    where
        T: 'r,
    {
        let object = |record: &T| {
            let entry = |column: &Column<'_, T>| {
                let text = (column.write)(record);
                let value = match (column.kind, text.parse::<f64>()) {
                    _ if text.is_empty() => Value::Null,
                    (Kind::Number, Ok(number)) if number.is_finite() => number.into(),
                    (Kind::Flag, _) => (text == "true").into(),
                    _ => text.into(),
                };
                (column.name.clone(), value)
            };
            self.0.iter().map(entry).collect::<Map<_, _>>()
        };
        let records = records.into_iter();
        records
            .map(|record| Value::Object(object(record)))
            .collect()
    }

    /// Reads a table back; `blank` makes a record that has what no column tells. A last line without its end is one
    /// that a killed run did not finish: it is left out, unless the table is said to be `complete`.
    ///
    /// # Errors
    /// [`RunError::Read`], [`RunError::Column`], [`RunError::Row`].
    pub(super) fn read(
        &self,
        path: &Path,
        complete: bool,
        blank: impl Fn() -> T,
    ) -> Result<Vec<T>, RunError> {
        let unreadable = RunError::reading(path);
        let broken = |error: csv::Error| unreadable(std::io::Error::other(error.to_string()));
        let bytes = super::place::read(path).map_err(unreadable)?;
        let end = bytes.iter().rposition(|&byte| byte == b'\n');
        let whole = if complete {
            &bytes[..]
        } else {
            &bytes[..end.map_or(0, |end| end + 1)]
        };
        // Rows that are too short are then told by the column they lack.
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(whole);
        let header = reader.byte_headers().map_err(broken)?;
        let places = self.places(path, header)?;
        let mut records = Vec::new();
        for row in reader.byte_records() {
            let row = row.map_err(broken)?;
            let mut record = blank();
            for source in &places {
                let text = row.get(source.place).map(String::from_utf8_lossy);
                let cell = Cell {
                    path,
                    line: row.position().map_or(0, csv::Position::line),
                    column: source.name,
                    text: text.as_deref().unwrap_or_default(),
                };
                match text {
                    Some(_) => (source.fill)(&cell, &mut record)?,
                    None => return Err(cell.wrong("a cell")),
                }
            }
            records.push(record);
        }
        Ok(records)
    }

    /// The columns that are read, with their places in the table.
    fn places(
        &self,
        path: &Path,
        header: &csv::ByteRecord,
    ) -> Result<Vec<Source<'_, T>>, RunError> {
        let mut sources = Vec::new();
        for column in &self.0 {
            let Some(fill) = &column.fill else {
                continue;
            };
            let mut names = header.iter();
            match names.position(|name| name == column.name.as_bytes()) {
                Some(place) => sources.push(Source {
                    name: &column.name,
                    fill,
                    place,
                }),
                None if column.newer => {}
                None => {
                    return Err(RunError::Column {
                        path: path.to_owned(),
                        column: column.name.clone(),
                    });
                }
            }
        }
        Ok(sources)
    }
}

/// A column that is read, with its place in the table at hand.
struct Source<'c, T> {
    name: &'c str,
    fill: &'c Fill<'c, T>,
    place: usize,
}

/// Rows of words as lines of CSV.
fn compose<R: IntoIterator<Item = String>>(
    rows: impl IntoIterator<Item = R>,
) -> Result<String, RunError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(row)?;
    }
    let bytes = writer.into_inner();
    let bytes = bytes.map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A name that a run gives.
pub(super) struct Named {
    pub(super) name: String,
    /// What has the name, in words; empty of a column.
    pub(super) what: String,
    /// Whether a number ends the name.
    pub(super) is_numbered: bool,
}

impl Named {
    pub(super) fn new(name: impl Into<String>, what: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            what: what.into(),
            is_numbered: false,
        }
    }

    /// The name that both would have.
    pub(super) fn shared<'n>(&'n self, other: &'n Self) -> Option<&'n str> {
        let begins =
            |one: &Self, other: &Self| one.is_numbered && other.name.starts_with(&one.name);
        if self.name == other.name || begins(self, other) {
            Some(&other.name)
        } else if begins(other, self) {
            Some(&self.name)
        } else {
            None
        }
    }
}
