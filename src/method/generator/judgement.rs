//! The verdict on a solved point: its densities with the difference to the second scheme as their error, its measures,
//! and what must be known of it.

use std::borrow::Cow;
use std::sync::Arc;

use super::at_phases::{OverPeriod, moments_at_phases};
use super::coarse::{COARSE, Coarseness, rough_relaxation};
use super::forcing::{ForcedState, amplitude};
use super::last_modes::{LastModes, angles};
use super::relaxation::Relaxation;
use super::rotation::{Steady, rotation};
use super::second::{Second, SecondSolve};
use super::session::{FINE, GeneratorSession, PointSolve, ROUGH};
use super::source::{METHOD, SHARP};
use super::third::again;
use super::trail::{self, Trail};
use super::truncation::CutOff;
use super::unknowns::{by_schemes, negative_mass, summed_over_modes, with_walls};
use crate::continuation::measure::{ESCAPE_RATE, FACTORISATIONS, NEGATIVE_MASS};
use crate::continuation::{Finding, Measure, Solution};
use crate::density::EstimatedDensity;
use crate::generator::{cell_masses, resolution, summed_to_walls};
use crate::method::forcing::Forced;
use crate::method::measures::{Cells, Others};
use crate::method::report::{QUIET_ESCAPE, Reporter};
use crate::method::watched::planes;
use crate::method::{MethodError, Problem, natural_ends};
use crate::stationary::generator::{RateError, RateInfo};

/// Escape per unit time below which mass is said to stay in Ω, and relaxation is not looked at.
const NO_ESCAPE: f64 = 1e-12;

/// A solution, and where there is one the trail that leads on from it, with errors of the unknowns.
type Judged = (Solution<'static>, Option<(Trail, KnownErrors)>);

/// By how much the unknowns of a steady state may be off.
pub(super) struct KnownErrors {
    /// Changes by the second scheme, and what all schemes err alike.
    pub(super) changes: Vec<f64>,
    /// Changes by modes that are not there, where they are known.
    pub(super) by_modes: Option<Vec<f64>>,
    pub(super) cut_off: CutOff,
}

impl GeneratorSession {
    /// Judges a solution and turns it into densities. No error is known of a state of which another scheme's cannot be
    /// solved: that is told as one that is not solved itself.
    pub(super) fn judge(
        &mut self,
        solved: &PointSolve,
        before: Option<&Trail>,
    ) -> Result<Judged, MethodError> {
        match self.judge_by_schemes(solved, before) {
            Err(MethodError::Rates(RateError::Sensitivity)) => {
                let info = &solved.steady.info;
                let mut reporter = reporter(&self.source.problem, info);
                reporter.not_converged(info.error_estimate);
                Ok((Solution::without_density(reporter.report), None))
            }
            judged => judged,
        }
    }

    fn judge_by_schemes(
        &mut self,
        solved: &PointSolve,
        before: Option<&Trail>,
    ) -> Result<Judged, MethodError> {
        let info = &solved.steady.info;
        let unknowns = &solved.steady.mass;
        let problem = self.source.problem.clone();
        let space = problem.space();
        let mut reporter = reporter(&problem, info);
        let finite = unknowns.iter().all(|value| value.is_finite());
        if !info.converged || !finite {
            reporter.not_converged(info.error_estimate);
        }
        if !finite {
            return Ok((Solution::without_density(reporter.report), None));
        }
        let relaxation = self.relaxation(solved, before);
        let time = relaxation.as_ref().map(|known| known.time);
        let Some(share) = reporter.escaping_share(time, self.source.options.escape_limit) else {
            return Ok((Solution::without_density(reporter.report), None));
        };
        reporter.escaping(share);
        let masses = cell_masses(solved.system.as_ref(), space, unknowns);
        reporter.edge_mass(&masses, &self.source.closed_ends);
        let system = solved.system.as_ref();
        let natural = &self.source.natural_ends;
        for finding in natural_ends::findings(system, space, &masses, natural) {
            if matches!(finding, Finding::Absorbed { .. }) {
                reporter.no_steady_state(finding);
                return Ok((Solution::without_density(reporter.report), None));
            }
            reporter.tell(finding);
        }
        for judged in resolution(solved.system.as_ref(), space, &masses) {
            reporter.resolution(&judged);
        }
        let (mut densities, second) = self.densities(solved, &masses)?;
        let mut without_last_modes = None;
        let mut cut_off = CutOff::default();
        if solved.second.is_some() {
            cut_off = self.truncate(solved, reporter.missing(), &mut densities)?;
            without_last_modes = self.add_last_modes(solved, &masses, &mut densities)?;
        }
        // What is negative along a series is told of its modes.
        let carried = |axis: &usize| space.axes().get(*axis).is_some_and(|axis| axis.is_modes());
        let by_cells = densities
            .iter()
            .filter(|one| !one.observable.axes().iter().any(carried));
        let watched = by_cells.map(|one| negative_mass(&one.density.masses()));
        let watched = watched.fold(0.0, f64::max);
        let maps = self.source.maps(solved.value)?;
        reporter.few_modes(self.source.options.change_by_modes);
        reporter.series(&maps.changes_by_last_modes(&self.source.problem, &masses)?);
        reporter.negative_mass(negative_mass(&summed_over_modes(space, &masses)), watched);
        let (kinked, planes) = (&self.source.kinked, planes(&self.source.kinked));
        let weights = summed_to_walls(solved.system.as_ref(), space, unknowns);
        let others = second.unknowns();
        let others = others.map(|one| summed_to_walls(solved.system.as_ref(), space, one));
        let of_axes = by_schemes(space, &weights, others.as_deref(), &planes);
        let of_axes = match weights {
            Cow::Owned(_) => {
                let at = (solved.system.as_ref(), space);
                with_walls(of_axes, at, (unknowns, &weights), time)
            }
            Cow::Borrowed(_) => of_axes,
        };
        let third = solved.third.as_ref().map(|change| {
            let there: Vec<f64> = unknowns.iter().zip(change).map(|(u, du)| u + du).collect();
            cell_masses(solved.system.as_ref(), space, &there)
        });
        let by_others = [second.masses(), third.as_deref()];
        let by_others: Vec<&[f64]> = by_others.into_iter().flatten().collect();
        let of_quantities = maps.exact_moments(space, &masses, &by_others, kinked)?;
        let at_phases = moments_at_phases(
            problem.family(),
            &OverPeriod {
                space,
                unknowns,
                second: second.unknowns(),
                weights: &weights,
                others: others.as_deref(),
                masses: &masses,
                planes: &planes,
                closed: &self.source.closed_ends,
            },
        )?;
        let of_states = [of_axes, of_quantities].concat();
        let (of_states, by_modes) = self.with_last_modes(solved, of_states, without_last_modes)?;
        let moments = [of_states, at_phases].concat();
        reporter.moments(&moments);
        let shifts = reporter.shifts(&moments);
        let rotations = self.rotations(solved, (&second.change, &shifts))?;
        reporter.report.measures.extend(rotations);
        let answers = self.answers_to_forcing(solved, (&second.change, &shifts));
        reporter.report.measures.extend(answers);
        let cells = Cells {
            system: solved.system.as_ref(),
            space,
            weights: &weights,
            others: others.as_deref().map_or(Others::None, Others::Second),
            closed: &self.source.closed_ends,
            escape_rate: info.escape_rate,
            beyond: reporter.missing().beyond,
        };
        // Of more axes it is not cheap.
        if space.dimension() == 2 {
            reporter.balances(&cells);
        }
        let solution = reporter.solution(densities, Some(&cells));
        let trail = trail_after(solved, second.by_scheme, relaxation, before);
        let known = KnownErrors {
            changes: second.change,
            by_modes,
            cut_off,
        };
        Ok((solution, Some((trail, known))))
    }

    /// How fast angles turn, and how they spread, from what the second scheme changes, and by how much the ends of the
    /// ranges shift the mean of each axis; nothing in a check.
    fn rotations(
        &mut self,
        solved: &PointSolve,
        (change, shifts): (&[f64], &[f64]),
    ) -> Result<Vec<Measure>, MethodError> {
        let problem = &self.source.problem;
        let Some(second) = &solved.second else {
            return Ok(Vec::new());
        };
        let rates = second;
        let asked = angles(problem);
        let mut found = Vec::new();
        let mut both = None;
        for angle in problem.family().angles() {
            let system = solved.system.as_ref();
            let (first, second) = match &mut both {
                Some(both) => both,
                None => both.insert((
                    self.source.assemble(system, self.source.options.scheme)?,
                    (second.generator()).map_err(|error| self.source.refused(error))?,
                )),
            };
            let steady = Steady {
                system,
                space: problem.space(),
                unknowns: &solved.steady.mass,
                error: solved.steady.info.error_estimate,
                first: &first.matrix,
                second,
                change,
                shifts,
            };
            let harmonics = LastModes {
                space: problem.space(),
                asked: &asked,
                scheme: rates,
            };
            found.extend(rotation(&steady, angle, (&mut self.solver, &harmonics))?);
        }
        Ok(found)
    }

    /// How states answer to a forcing, from what the second scheme changes, and by how much the ends of the ranges
    /// shift the mean of each axis; nothing in a check.
    fn answers_to_forcing(
        &self,
        solved: &PointSolve,
        (change, shifts): (&[f64], &[f64]),
    ) -> Vec<Measure> {
        let family = self.source.problem.family();
        let Some(phase) = family.model().phase_axis().filter(|_| !self.source.checks) else {
            return Vec::new();
        };
        let forced = Forced {
            system: solved.system.as_ref(),
            space: self.source.problem.space(),
            phase,
        };
        let solved = ForcedState {
            unknowns: &solved.steady.mass,
            change,
            error: solved.steady.info.error_estimate,
            shifts,
            planes: &planes(&self.source.kinked),
        };
        forced.measures(family, |axis| amplitude(&forced, &solved, axis))
    }

    /// The time in which deviations die out, where mass escapes: a neighbour's, or that of fewer cells, where it will
    /// do.
    fn relaxation(&mut self, solved: &PointSolve, before: Option<&Trail>) -> Option<Relaxation> {
        let (rate, mass) = (solved.steady.info.escape_rate, &solved.steady.mass);
        if self.source.checks || rate <= NO_ESCAPE {
            return None;
        }
        let neighbour = before.and_then(|trail| trail.relaxation.as_deref());
        let carried = |known: &Relaxation| Relaxation::carry_over(known, rate, QUIET_ESCAPE);
        let of_fewer_cells = |coarseness: &Coarseness| {
            let time =
                rough_relaxation(&self.source, solved.value, coarseness, &self.cancellation)?;
            Some(Relaxation::rough(time, coarseness.off, neighbour))
                .filter(|found| found.is_quiet(rate, QUIET_ESCAPE))
        };
        let near = neighbour.and_then(carried).or_else(|| {
            // Where so few cells did not do before, they do not do here.
            let will_do = COARSE.iter();
            will_do
                .filter(|one| neighbour.is_none_or(|known| one.off <= known.off))
                .find_map(of_fewer_cells)
        });
        near.or_else(|| Relaxation::compute(&mut self.solver, mass, neighbour))
    }

    /// Densities with the difference to the second scheme as their error, and what the second scheme gives.
    fn densities(
        &mut self,
        solved: &PointSolve,
        masses: &[f64],
    ) -> Result<(Vec<EstimatedDensity>, Second), MethodError> {
        let unknowns = &solved.steady.mass;
        let change = match (&solved.second, &solved.along) {
            (Some(_), Some((change, true))) if !self.source.sharp => change.clone(),
            (Some(second), along) => {
                let expected = along.as_ref().map(|(change, _)| change.as_slice());
                let solver = &mut self.solver;
                let tolerance = if self.source.sharp { FINE } else { ROUGH };
                solver.response(&second.product(unknowns), unknowns, expected, tolerance)?
            }
            (None, _) => vec![0.0; unknowns.len()],
        };
        let change = match &solved.second {
            Some(second) if second.has_breaks() => {
                again(&mut self.solver, second, unknowns, change)?
            }
            _ => change,
        };
        let by_scheme = change.clone();
        let change = self.with_bends(solved, change)?;
        let problem = &self.source.problem;
        let (system, space) = (solved.system.as_ref(), problem.space());
        let changed: Vec<f64> = unknowns.iter().zip(&change).map(|(u, du)| u + du).collect();
        let by_second = cell_masses(system, space, &changed);
        let difference: Vec<f64> = by_second.iter().zip(masses).map(|(b, a)| b - a).collect();
        let kinked = &self.source.kinked;
        let maps = self.source.maps(solved.value)?;
        let mut densities = maps.exact(problem, masses, &difference)?;
        let open = self.source.open_at(solved.value)?;
        for one in &mut densities {
            one.structure = maps.structure(&*open, problem, masses, one.observable, kinked);
            if self.source.sharp {
                one.negligible *= SHARP;
            }
        }
        let solved = solved.second.is_some().then_some(SecondSolve {
            unknowns: changed,
            masses: by_second,
        });
        let second = Second {
            change,
            by_scheme,
            solved,
        };
        Ok((densities, second))
    }
}

/// The numbers of a solve.
fn reporter<'a>(problem: &'a Problem, info: &RateInfo) -> Reporter<'a> {
    let mut reporter = Reporter::new(METHOD, problem);
    let report = &mut reporter.report;
    report.iterations = info.iterations;
    report.residual = info.residual;
    report.solver_error = info.error_estimate;
    report.add(&ESCAPE_RATE, "", info.escape_rate.max(0.0));
    report.add(&FACTORISATIONS, "", info.factorisations as f64);
    report.add(&NEGATIVE_MASS, "", info.negative_mass);
    reporter
}

/// What a point leaves for its neighbour, with the points before.
fn trail_after(
    solved: &PointSolve,
    difference: Vec<f64>,
    relaxation: Option<Relaxation>,
    before: Option<&Trail>,
) -> Trail {
    let point = trail::TrailPoint {
        value: solved.value,
        mass: solved.steady.mass.clone(),
        difference,
    };
    // What has not converged is no start for an extrapolation.
    let trail = before.filter(|_| solved.steady.info.converged).cloned();
    trail
        .unwrap_or_default()
        .with(point, relaxation.map(Arc::new))
}
