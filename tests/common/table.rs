//! Tables of runs, by the names of their columns.

use std::collections::BTreeMap;
use std::ops::Index;
use std::path::Path;

/// A row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row(BTreeMap<String, String>);

impl Index<&str> for Row {
    type Output = str;

    fn index(&self, column: &str) -> &str {
        let text = self.0.get(column);
        text.unwrap_or_else(|| panic!("no column {column} in {self:?}"))
    }
}

impl Row {
    pub(crate) fn number(&self, column: &str) -> f64 {
        let text = &self[column];
        text.parse().unwrap_or_else(|_| panic!("{column}: {text}"))
    }

    pub(crate) fn numbers<const N: usize>(&self, columns: [&str; N]) -> [f64; N] {
        columns.map(|column| self.number(column))
    }

    pub(crate) fn texts<const N: usize>(&self, columns: [&str; N]) -> [&str; N] {
        columns.map(|column| &self[column])
    }

    /// Whether a value lies in the band of this row of bifurcations.csv.
    pub(crate) fn holds(&self, value: f64) -> bool {
        self.number("lower") <= value && value <= self.number("upper")
    }
}

/// Rows in the order of their file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Table(pub(crate) Vec<Row>);

impl Table {
    pub(crate) fn read(file: &Path) -> Self {
        let reader = csv::Reader::from_path(file);
        let mut reader = reader.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let rows = reader.deserialize().map(|row| Row(row.unwrap()));
        Self(rows.collect())
    }

    pub(crate) fn column(&self, name: &str) -> Vec<&str> {
        self.0.iter().map(|row| &row[name]).collect()
    }

    /// The same without some columns, such as times.
    pub(crate) fn without(mut self, columns: &[&str]) -> Self {
        for row in &mut self.0 {
            row.0.retain(|name, _| !columns.contains(&name.as_str()));
        }
        self
    }

    /// The P-bifurcations of one observable in bifurcations.csv.
    pub(crate) fn changes(&self, observable: &str) -> Vec<&Row> {
        let is_change = |row: &&Row| row["label"].starts_with("PB");
        let rows = self.0.iter().filter(is_change);
        rows.filter(|row| &row["observable"] == observable)
            .collect()
    }
}
