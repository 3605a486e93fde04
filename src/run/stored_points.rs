//! `points.csv`, read back: everything of a point but its densities.

use std::path::{Path, PathBuf};

use super::findings::parse_findings;
use super::{Naming, RunError};
use crate::continuation::{Finding, MethodPart, Point, PointStatus, SolveReport};
use crate::density::Moments;

/// The points of a table, in its order. Signatures and distances are left out: they follow from the densities.
///
/// `methods` are the names that a row may give as its method. A table keeps the largest edge mass only: a point that was
/// read has one. Numbers that are not finite were written as empty cells and
/// come back as NaN.
///
/// # Errors
/// [`RunError::Read`]; [`RunError::Column`] and [`RunError::Row`] when the table is not one of this sweep.
pub(super) fn read_points(
    path: &Path,
    naming: &Naming<'_>,
    methods: &[&'static str],
) -> Result<Vec<Point>, RunError> {
    read_rows(path, |row| row.point(naming, methods))
}

/// Reads every row of a table.
///
/// # Errors
/// [`RunError::Read`], and those of `parse`.
pub(super) fn read_rows<T>(
    path: &Path,
    parse: impl Fn(&Row<'_>) -> Result<T, RunError>,
) -> Result<Vec<T>, RunError> {
    let bytes = std::fs::read(path).map_err(|source| RunError::Read {
        path: path.to_owned(),
        source,
    })?;
    // Rows that are too short are then reported by the column they lack.
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .from_reader(bytes.as_slice());
    let header = reader.byte_headers().cloned();
    let header = header.map_err(|error| unreadable(path, &error))?;
    let table = Columns {
        path: path.to_owned(),
        names: header
            .iter()
            .map(|name| String::from_utf8_lossy(name).into_owned())
            .collect(),
    };
    let mut rows = Vec::new();
    for record in reader.byte_records() {
        let record = record.map_err(|error| unreadable(path, &error))?;
        let line = record.position().map_or(0, csv::Position::line);
        let cells = record
            .iter()
            .map(|cell| String::from_utf8_lossy(cell).into_owned());
        let row = Row {
            table: &table,
            line,
            cells: cells.collect(),
        };
        rows.push(parse(&row)?);
    }
    Ok(rows)
}

fn unreadable(path: &Path, error: &csv::Error) -> RunError {
    RunError::Read {
        path: path.to_owned(),
        source: std::io::Error::other(error.to_string()),
    }
}

/// A table's columns.
pub(super) struct Columns {
    path: PathBuf,
    names: Vec<String>,
}

impl Columns {
    fn find(&self, column: &str) -> Option<usize> {
        self.names.iter().position(|name| name == column)
    }

    fn require(&self, column: &str) -> Result<usize, RunError> {
        self.find(column).ok_or_else(|| RunError::Column {
            path: self.path.clone(),
            column: column.to_owned(),
        })
    }
}

/// One row.
pub(super) struct Row<'t> {
    table: &'t Columns,
    /// Line of the file, counted from 1.
    line: u64,
    cells: Vec<String>,
}

impl Row<'_> {
    fn point(&self, naming: &Naming<'_>, methods: &[&'static str]) -> Result<Point, RunError> {
        let axes = || (0..naming.model.axes.len()).map(|axis| naming.axis(axis));
        let mut moments = Vec::new();
        let mut numerical_diffusion = Vec::new();
        for axis in axes() {
            let mean = self.optional(&format!("mean_{axis}"))?;
            let standard_deviation = self.optional(&format!("sd_{axis}"))?;
            moments.extend(
                mean.zip(standard_deviation)
                    .map(|(mean, standard_deviation)| Moments {
                        mean,
                        standard_deviation,
                    }),
            );
            numerical_diffusion.extend(self.optional(&format!("numerical_diffusion_{axis}"))?);
        }
        Ok(Point {
            value: self.number(naming.parameter)?,
            report: SolveReport {
                status: self.choice("status", &PointStatus::ALL, PointStatus::word)?,
                method: self.choice("method", methods, |name| name)?,
                iterations: self.count("iterations")?,
                residual: self.number_or_nan("residual")?,
                // Tables of earlier versions do not have it.
                solver_error: match self.table.find("solver_error") {
                    Some(_) => self.number_or_nan("solver_error")?,
                    None => 0.0,
                },
                escape_rate: self.number_or_nan("escape_rate")?,
                edge_mass: self.optional("edge_mass")?.into_iter().collect(),
                own: MethodPart {
                    factorisations: self.count("factorisations")?,
                    negative_mass: self.number_or_nan("negative_mass")?,
                    numerical_diffusion,
                    map_step: self.optional("map_step")?,
                    // Nor this.
                    time_step_bias: match self.table.find("time_step_bias") {
                        Some(_) => self.optional("time_step_bias")?,
                        None => None,
                    },
                },
                findings: self.findings(naming)?,
            },
            moments,
            densities: Vec::new(),
            detections: Vec::new(),
            distance: None,
            seconds: self.number("seconds")?,
        })
    }

    /// Findings; where there are only sentences, as of earlier versions, these as one.
    fn findings(&self, naming: &Naming<'_>) -> Result<Vec<Finding>, RunError> {
        let cell = match self.table.find("findings") {
            Some(_) => self.text("findings")?,
            None => "",
        };
        let wrong = |word: &str| self.wrong("findings", word, "a finding with its numbers");
        let findings = parse_findings(naming, cell).map_err(wrong)?;
        let told = self.text("warnings")?;
        Ok(match findings.is_empty() && !told.is_empty() {
            true => vec![Finding::Told(told.to_owned())],
            false => findings,
        })
    }

    pub(super) fn text(&self, column: &str) -> Result<&str, RunError> {
        let index = self.table.require(column)?;
        match self.cells.get(index) {
            Some(cell) => Ok(cell),
            None => Err(self.wrong(column, "", "a cell")),
        }
    }

    fn choice<T: Copy>(
        &self,
        column: &str,
        choices: &[T],
        word: fn(T) -> &'static str,
    ) -> Result<T, RunError> {
        let text = self.text(column)?;
        let found = choices.iter().find(|&&choice| word(choice) == text);
        found.copied().ok_or_else(|| {
            let words: Vec<&str> = choices.iter().map(|&choice| word(choice)).collect();
            self.wrong(column, text, &format!("one of {}", words.join(", ")))
        })
    }

    fn count(&self, column: &str) -> Result<usize, RunError> {
        let text = self.text(column)?;
        text.parse()
            .map_err(|_| self.wrong(column, text, "a whole number"))
    }

    pub(super) fn optional(&self, column: &str) -> Result<Option<f64>, RunError> {
        match self.text(column)? {
            "" => Ok(None),
            _ => self.number(column).map(Some),
        }
    }

    fn number_or_nan(&self, column: &str) -> Result<f64, RunError> {
        Ok(self.optional(column)?.unwrap_or(f64::NAN))
    }

    pub(super) fn number(&self, column: &str) -> Result<f64, RunError> {
        let text = self.text(column)?;
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.wrong(column, text, "a number"))
    }

    pub(super) fn wrong(&self, column: &str, value: &str, wanted: &str) -> RunError {
        RunError::Row {
            path: self.table.path.clone(),
            line: self.line,
            column: column.to_owned(),
            value: value.to_owned(),
            wanted: wanted.to_owned(),
        }
    }
}
