//! How often regions are visited by SGCM, from the masses of its cells by Rice's formula (`passage`, `visits.rs`).
//!
//! The numbers are linear in the masses, and so is what replicates, the noise that the cells and the time step add, and
//! the curvature of the density inside the cells change of them.

use super::SgcmSource;
use super::source::SampledPoint;
use crate::continuation::SolveReport;
use crate::method::MethodError;
use crate::method::measures::add_visits;
use crate::method::report::Missing;
use crate::method::step_errors::by_wider_noise;
use crate::numerics::jackknife;
use crate::passage::{KnownDensity, Visits, visits_and};
use crate::space::CellSpace;

impl SgcmSource {
    /// Adds how often regions are visited at a value to a report, with findings. `share` is that by which the noise is
    /// larger, and `missing` what is not in the ranges.
    ///
    /// # Errors
    /// [`MethodError`] for a value that the family does not have.
    pub(super) fn add_visits(
        &self,
        report: &mut SolveReport,
        point: &SampledPoint,
        (masses, replicates): (&[f64], &[Vec<f64>]),
        (share, missing): (f64, Missing),
    ) -> Result<(), MethodError> {
        let family = self.problem.family();
        if family.questions.visits.is_empty() || self.problem.subject().measures.is_empty() {
            return Ok(());
        }
        let (space, values) = (self.problem.space(), family.values_at(point.value)?);
        let (nodes, curved) = at_nodes(space, masses);
        let volumes = space.volumes();
        let densities: Vec<f64> = (masses.iter().zip(&volumes))
            .map(|(mass, volume)| mass / volume)
            .collect();
        let mut wider = by_wider_noise(masses, &densities, share);
        (wider.iter_mut().zip(&volumes)).for_each(|(change, volume)| *change *= volume);
        let mut others = vec![curved, wider];
        let change = |one: &Vec<f64>| one.iter().zip(masses).map(|(one, all)| one - all).collect();
        others.extend(replicates.iter().map(change));
        let density = KnownDensity {
            unknowns: &nodes,
            changes: None,
            by_modes: None,
            returning: None,
            beyond: 0.0,
            planes: &[],
        };
        for (number, question) in family.questions.visits.iter().enumerate() {
            let region = question.region.level().bind(&values)?;
            let cells = (point.system.as_ref(), space);
            let found = visits_and(cells, &region, density, &others);
            let found = found.ok();
            let found = found.map(|(found, changes)| with_errors(found, &changes, missing));
            let is_endless = found.is_some_and(|found| found.is_endless);
            add_visits(report, (number, question), found.as_ref(), is_endless);
        }
        Ok(())
    }
}

/// The numbers with the errors of sampling, of cells and steps, and of what is missing. `changes` are those of the
/// probability and of the entries by curvature, by wider noise, and by each replicate.
fn with_errors(found: Visits, changes: &[[f64; 2]], missing: Missing) -> Visits {
    let (certain, sampled) = changes.split_at(2);
    let missing = missing.beyond + missing.leak;
    // What a change of both numbers does to one that follows from them.
    let error = |of: &dyn Fn([f64; 2]) -> f64| -> f64 {
        let sizes = certain.iter().map(|&change| of(change).abs());
        let sampling = match sampled.len() {
            0 | 1 => f64::INFINITY,
            _ => jackknife(sampled.iter().map(|&change| of(change))),
        };
        sizes.sum::<f64>() + sampling
    };
    let (share, of_cells) = found.time_share;
    let elsewhere = missing * share.max(1.0 - share);
    let time_share = (share, of_cells + error(&|change| change[0]) + elsewhere);
    let entries = found.entries.and_then(|[(rate, of_cells), length]| {
        let rate_error = of_cells + error(&|change| change[1]) + missing * rate;
        let of_length = |change: [f64; 2]| (share + change[0]) / (rate + change[1]) - length.0;
        let length_error = length.1 + error(&of_length) + (elsewhere + missing * share) / rate;
        let is_known = rate_error < rate;
        is_known.then_some([(rate, rate_error), (length.0, length_error)])
    });
    Visits {
        time_share,
        entries,
        ..found
    }
}

/// Densities at the nodes times local volumes, from the masses of cells, and what that changes. In the coordinate in
/// which cells have equal widths a mean over a cell differs from the value in its middle by a twenty-fourth of the
/// second difference.
fn at_nodes(space: &CellSpace, masses: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut nodes = masses.to_vec();
    let mut changes = vec![0.0; masses.len()];
    let mut stride = 1;
    for (index, axis) in space.axes().iter().enumerate().rev() {
        for cell in 0..masses.len() {
            let position = space.position(cell, index);
            if position == 0 || position + 1 == axis.count() {
                continue;
            }
            let bend = masses[cell + stride] - 2.0 * masses[cell] + masses[cell - stride];
            nodes[cell] -= bend / 24.0;
            changes[cell] += bend / 24.0;
        }
        stride *= axis.count();
    }
    (nodes, changes)
}
