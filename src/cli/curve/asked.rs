//! What is asked of curves: the options of the command, and before them the section `[curve]` of the sweep file.

use super::refusals::{chosen_row, refused, which_box, which_parameter};
use crate::cli::CommandError;
use crate::cli::args::CurveArguments;
use crate::continuation::curve::{CurveOptions, Plane};
use crate::continuation::{BifurcationStatus, LabelledPoint, PointType, SweepResult};
use crate::sweep_file::{CurveSettings, Sweep};

/// The curves that are wanted.
pub(super) struct Asked {
    /// The second parameter.
    pub(super) second: String,
    /// Its lowest and highest value.
    ends: (f64, f64),
    /// Those of the swept parameter, where they are not the ends of the sweep.
    first: (Option<f64>, Option<f64>),
    rows: Rows,
    /// Longest step between points.
    pub(super) step: f64,
    /// Whether the curves that start from points of codimension two are wanted too.
    pub(super) branches: bool,
}

/// The rows that are followed.
enum Rows {
    /// The one that can be.
    TheOnly,
    /// Those of these labels.
    Named(Vec<String>),
    /// All that an indicator has located, and that are in the box.
    All,
}

impl Asked {
    /// What a command asks for; what it leaves out is taken from the sweep file, where that has curves of the same
    /// parameter.
    ///
    /// # Errors
    /// [`CommandError::Input`] where something is said in neither.
    pub(super) fn by(arguments: &CurveArguments, spec: &Sweep) -> Result<Self, CommandError> {
        let written = spec.settings.curve.as_ref();
        let second = arguments.second.clone();
        let second = second.or_else(|| written.map(|curve| curve.parameter.clone()));
        let second = second.ok_or_else(|| which_parameter(spec))?;
        let written = written.filter(|curve| curve.parameter == second);
        let from = arguments.from.or(written.map(|curve| curve.from));
        let to = arguments.to.or(written.map(|curve| curve.to));
        let (Some(from), Some(to)) = (from, to) else {
            return Err(which_box(&second));
        };
        let rows = match (&arguments.row, written) {
            (Some(row), _) => Rows::Named(vec![row.clone()]),
            (None, Some(curve)) => rows_of(curve),
            (None, None) => Rows::TheOnly,
        };
        let usual = CurveOptions::default();
        let step = arguments.step.or(written.map(|curve| curve.step));
        let branches = written.map_or(usual.branches, |curve| curve.branches);
        Ok(Self {
            second,
            ends: (from.min(to), from.max(to)),
            first: (
                arguments.first_from.or(written.map(|curve| curve.first.0)),
                arguments.first_to.or(written.map(|curve| curve.first.1)),
            ),
            rows,
            step: step.unwrap_or(usual.largest_step),
            branches: branches && !arguments.alone,
        })
    }

    /// What a sweep file asks for.
    pub(super) fn of(curve: &CurveSettings) -> Self {
        Self {
            second: curve.parameter.clone(),
            ends: (curve.from, curve.to),
            first: (Some(curve.first.0), Some(curve.first.1)),
            rows: rows_of(curve),
            step: curve.step,
            branches: curve.branches,
        }
    }

    /// The box.
    ///
    /// # Errors
    /// [`CommandError::Input`] where it has no extent.
    pub(super) fn plane(&self, spec: &Sweep) -> Result<Plane, CommandError> {
        let family = spec.problem.family();
        let (from, to) = self.first_side(spec);
        let second = (self.second.as_str(), self.ends.0, self.ends.1);
        Plane::new((family.parameter(), from, to), second).map_err(refused)
    }

    fn first_side(&self, spec: &Sweep) -> (f64, f64) {
        let (low, high) = spec.problem.family().range();
        (self.first.0.unwrap_or(low), self.first.1.unwrap_or(high))
    }

    /// The rows of a result that are followed.
    ///
    /// # Errors
    /// [`CommandError::Input`] where one is not there, or which one is not clear.
    pub(super) fn rows<'r>(
        &self,
        spec: &Sweep,
        result: &'r SweepResult,
    ) -> Result<Vec<&'r LabelledPoint>, CommandError> {
        match &self.rows {
            Rows::TheOnly => Ok(vec![chosen_row(None, result)?]),
            Rows::Named(labels) => {
                let rows = labels.iter();
                rows.map(|label| chosen_row(Some(label), result)).collect()
            }
            Rows::All => {
                let (from, to) = self.first_side(spec);
                let is_wanted = |row: &&LabelledPoint| {
                    let known = [BifurcationStatus::Located, BifurcationStatus::Unchecked];
                    row.kind == PointType::Bifurcation
                        && row.indicator.is_some()
                        && row.status.is_some_and(|status| known.contains(&status))
                        && (from..=to).contains(&row.value)
                };
                Ok(result.labels.iter().filter(is_wanted).collect())
            }
        }
    }
}

fn rows_of(curve: &CurveSettings) -> Rows {
    match &curve.rows {
        Some(labels) => Rows::Named(labels.clone()),
        None => Rows::All,
    }
}
