//! The generator at work: assemble Q, solve Q u = 0 with the neighbour's factorisation, and state the error of the grid
//! as the difference to a second scheme.
//!
//! A polynomial through the last few points predicts the next one. (The tangent at the first point would save fewer
//! iterations than it takes.) The difference to the second scheme comes from the factorisation that is there: with the
//! second scheme's Q' = Q + δQ it is Q δu = -(δQ) u to first order. It is predicted likewise, and iterated only as far
//! as the prediction is not good enough.

use std::borrow::Cow;
use std::sync::Arc;

use super::GeneratorSource;
use super::coarse::{COARSE, Coarseness, rough_relaxation};
use super::forcing::Forced;
use super::largest_exponent::add_largest_exponent;
use super::one_axis;
use super::passages::{add_passages, at_nodes};
use super::relaxation::Relaxation;
use super::rotation::{Steady, rotation};
use super::second::{Second, SecondSolve, companion};
use super::sensitivity::GeneratorSensitivity;
use super::slow_modes::add_slow_modes;
use super::source::METHOD;
use super::spectra::add_spectra;
use super::stand::Stand;
use super::trail::{self, Trail};
use super::unknowns::{by_schemes, distance, negative_mass, summed_over_modes, with_walls};
use crate::cancellation::Cancellation;
use crate::continuation::measure::{ESCAPE_RATE, FACTORISATIONS, NEGATIVE_MASS};
use crate::continuation::{Measure, Solution, SolveReport};
use crate::density::EstimatedDensity;
use crate::generator::{Generator, cell_masses, resolution, summed_to_walls};
use crate::method::measures::{Cells, Others};
use crate::method::neighbours::Neighbours;
use crate::method::report::{QUIET_ESCAPE, Reporter};
use crate::method::watched::planes;
use crate::method::{MethodError, Problem};
use crate::passage::KnownDensity;
use crate::stationary::generator::{Along, RateInfo, RateSolver, RateSteadyState};
use crate::system::System;

/// Escape per unit time below which mass is said to stay in Ω, and relaxation is not looked at.
const NO_ESCAPE: f64 = 1e-12;

/// Relative error of differences between schemes, which estimate errors.
const ROUGH: f64 = 1e-2;

/// Distance in L1 of the unknowns that were expected to those that were found up to which a difference between schemes
/// that was worked out for the first is that of the second, to [`ROUGH`].
const NEAR: f64 = 1e-3;

/// Owns the factorisation and what the solved points say of the next one.
pub(super) struct GeneratorSession {
    pub(super) source: GeneratorSource,
    pub(super) solver: RateSolver,
    /// Every solved point with those before it.
    pub(super) trails: Neighbours<Trail>,
    /// Where the solver stands.
    pub(super) stand: Stand,
    /// Whether the last solve has left a trail.
    pub(super) has_left: bool,
    cancellation: Cancellation,
}

/// What was solved at one point.
pub(super) struct PointSolve {
    pub(super) value: f64,
    pub(super) system: Arc<dyn System>,
    pub(super) steady: RateSteadyState,
    /// Rates at which the cells' masses leave Ω.
    pub(super) escape: Vec<f64>,
    /// The generator by the second scheme; `None` in a check, which states no error of its own.
    second: Option<Generator>,
    /// By how much the second scheme's unknowns differ, where that came along with the solve, and whether the unknowns
    /// were expected well enough for that to be it.
    along: Option<(Vec<f64>, bool)>,
}

/// Unknowns of a steady state, and by how much those of another discretisation differ.
type Unknowns<'a> = (&'a [f64], &'a [f64]);

/// A solution, and the trail that leads on from it where there is one.
type Judged = (Solution<'static>, Option<Trail>);

impl GeneratorSession {
    pub(super) fn new(source: &GeneratorSource, cancellation: &Cancellation) -> Self {
        Self {
            source: source.clone(),
            solver: source.solver(cancellation),
            trails: Neighbours::default(),
            stand: Stand::default(),
            has_left: false,
            cancellation: cancellation.clone(),
        }
    }

    pub(super) fn solve_from_nearest(&mut self, value: f64) -> Result<Solution<'_>, MethodError> {
        self.cancellation.check()?;
        self.has_left = false;
        let system = self.source.system_at(value)?;
        if let Some(why) = one_axis::absorbed(&self.source, system.as_ref()) {
            return Ok(one_axis::without_density(&self.source, why));
        }
        if let Some(found) = one_axis::masses(&self.source, system.as_ref()) {
            let mut solution = one_axis::solution(&self.source, value, system.as_ref(), &found)?;
            let (unknowns, changes) = at_nodes(&found.masses);
            let known = Some((unknowns.as_slice(), changes.as_slice()));
            let Solution {
                report, densities, ..
            } = &mut solution;
            self.add_asked(report, value, &system, (known, densities))?;
            return Ok(solution);
        }
        let nearest = self.trails.nearest(value).cloned();
        let before = nearest.map(|trail| trail.completed(value, self.trails.all()));
        let guess = before.as_ref().and_then(|trail| trail.mass_at(value));
        let expected = before.as_ref().and_then(|trail| trail.difference_at(value));
        let factorisations = self.solver.factorisations();
        if let Some(guess) = guess.as_deref().filter(|_| self.solver.is_worn()) {
            self.renew_ahead(value, guess)?;
        }
        let mut solved = self.solved(value, system, guess.as_deref(), expected.as_deref())?;
        solved.steady.info.factorisations = self.solver.factorisations() - factorisations;
        let (mut solution, trail) = self.judge(&solved, before.as_ref())?;
        let newest = trail.as_ref().and_then(Trail::newest);
        let known = newest.map(|newest| (newest.mass.as_slice(), newest.difference.as_slice()));
        let Solution {
            report, densities, ..
        } = &mut solution;
        self.add_asked(report, value, &solved.system, (known, densities))?;
        let Some(trail) = trail else {
            return Ok(solution);
        };
        let unknowns = Arc::new(solved.steady.mass);
        self.keep(value, trail);
        solution.sensitivity = Some(Box::new(GeneratorSensitivity {
            source: &self.source,
            solver: &mut self.solver,
            value,
            system: solved.system,
            unknowns,
        }));
        Ok(solution)
    }

    /// Adds what is asked of first passages, slow modes and spectra at a value, unless densities are all that is asked
    /// for; `known` are the unknowns of the steady state, and by how much those of another discretisation differ;
    /// `watched` are its densities.
    fn add_asked(
        &self,
        report: &mut SolveReport,
        value: f64,
        system: &Arc<dyn System>,
        (known, watched): (Option<Unknowns<'_>>, &[EstimatedDensity]),
    ) -> Result<(), MethodError> {
        if self.source.checks {
            return Ok(());
        }
        let planes = planes(&self.source.kinked);
        let density = known.map(|(unknowns, changes)| KnownDensity {
            unknowns,
            changes: Some(changes),
            planes: &planes,
        });
        let (problem, options) = (&self.source.problem, &self.source.options);
        let (asked, cancellation) = ((problem, value), &self.cancellation);
        add_passages(
            report,
            asked,
            system,
            (density, watched),
            options,
            cancellation,
        )?;
        let at = (system, value);
        add_largest_exponent(report, &self.source, at, known, cancellation)?;
        let unknowns = known.map(|(unknowns, _)| unknowns);
        add_slow_modes(report, &self.source, at, density, cancellation)?;
        add_spectra(report, &self.source, at, unknowns, cancellation)
    }

    /// Factorises ahead of a value in place of at it, where the sweep goes on: values on either side of the factorised
    /// one are as near to it. Where that cannot be, the solve factorises at the value itself.
    fn renew_ahead(&mut self, value: f64, guess: &[f64]) -> Result<(), MethodError> {
        let Some(ahead) = self
            .stand
            .ahead_of(value, self.source.problem.family().ends())
        else {
            return Ok(());
        };
        let Ok(system) = self.source.system_at(ahead) else {
            return Ok(());
        };
        let assembled = self
            .source
            .assemble(system.as_ref(), self.source.options.scheme);
        if let Ok(generator) = assembled {
            self.solver
                .renew(&generator.matrix, &generator.escape, guess)?;
            self.stand.factorised = Some(ahead);
        }
        Ok(())
    }

    /// Keeps what a point leaves: the masses, and as many differences between schemes.
    pub(super) fn keep(&mut self, value: f64, trail: Trail) {
        let cells = self.source.problem.space().n_cells();
        let bytes = 2 * size_of::<f64>() * cells;
        self.trails.keep(value, trail, bytes);
        self.has_left = true;
    }

    fn solved(
        &mut self,
        value: f64,
        system: Arc<dyn System>,
        guess: Option<&[f64]>,
        expected: Option<&[f64]>,
    ) -> Result<PointSolve, MethodError> {
        let (source, solver) = (&self.source, &mut self.solver);
        let (generator, second) = rayon::join(
            || source.assemble(system.as_ref(), source.options.scheme),
            || {
                let wanted = (!source.checks).then(|| companion(source.options.scheme));
                let second = wanted.map(|scheme| source.assemble(system.as_ref(), scheme));
                second.transpose()
            },
        );
        let (generator, second) = (generator?, second?);
        let along = second.as_ref().map(|second| Along {
            derivative: &second.matrix,
            expected,
            tolerance: ROUGH,
        });
        let factorisations = solver.factorisations();
        let (matrix, escape) = (&generator.matrix, &generator.escape);
        let steady = solver.solve_along(matrix, escape, guess, along.as_ref());
        if solver.factorisations() > factorisations {
            self.stand.factorised = Some(value);
        }
        let (steady, answer) = steady?;
        self.stand.solved = Some(value);
        let near = guess.is_some_and(|guess| distance(guess, &steady.mass) <= NEAR);
        Ok(PointSolve {
            value,
            system,
            steady,
            escape: generator.escape,
            second,
            along: answer.map(|answer| (answer, near)),
        })
    }

    /// Judges a solution and turns it into densities.
    fn judge(
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
        for judged in resolution(solved.system.as_ref(), space, &masses) {
            reporter.resolution(&judged);
        }
        let (mut densities, second) = self.densities(solved, &masses)?;
        if solved.second.is_some() {
            self.truncate(solved, &masses, reporter.missing(), &mut densities)?;
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
        let of_quantities = maps.exact_moments(space, &masses, second.masses(), kinked)?;
        let moments = [of_axes, of_quantities].concat();
        reporter.moments(&moments);
        reporter
            .report
            .measures
            .extend(self.rotations(solved, &second.change)?);
        let answers = self.answers_to_forcing(solved, &second.change);
        reporter.report.measures.extend(answers);
        let cells = Cells {
            system: solved.system.as_ref(),
            space,
            weights: &weights,
            others: others.as_deref().map_or(Others::None, Others::Second),
            planes: &planes,
            closed: &self.source.closed_ends,
            escape_rate: info.escape_rate,
        };
        // Of more axes it is not cheap.
        if space.dimension() == 2 {
            reporter.balances(&cells);
        }
        Ok((
            reporter.solution(densities, Some(&cells)),
            Some(trail_after(solved, second.change, relaxation, before)),
        ))
    }

    /// How fast angles turn, and how they spread; nothing in a check.
    fn rotations(
        &mut self,
        solved: &PointSolve,
        change: &[f64],
    ) -> Result<Vec<Measure>, MethodError> {
        let problem = &self.source.problem;
        let Some(second) = &solved.second else {
            return Ok(Vec::new());
        };
        let mut found = Vec::new();
        let mut first = None;
        for angle in problem.family().angles() {
            let system = solved.system.as_ref();
            let first = match &mut first {
                Some(first) => first,
                None => first.insert(self.source.assemble(system, self.source.options.scheme)?),
            };
            let steady = Steady {
                system,
                space: problem.space(),
                unknowns: &solved.steady.mass,
                error: solved.steady.info.error_estimate,
                first: &first.matrix,
                second,
                change,
            };
            found.extend(rotation(&steady, angle, &mut self.solver)?);
        }
        Ok(found)
    }

    /// How states answer to a forcing; nothing in a check.
    fn answers_to_forcing(&self, solved: &PointSolve, change: &[f64]) -> Vec<Measure> {
        let family = self.source.problem.family();
        let Some(phase) = family.model().phase_axis().filter(|_| !self.source.checks) else {
            return Vec::new();
        };
        let forced = Forced {
            system: solved.system.as_ref(),
            space: self.source.problem.space(),
            phase,
            unknowns: &solved.steady.mass,
            change,
            error: solved.steady.info.error_estimate,
        };
        forced.measures(family)
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
        let problem = &self.source.problem;
        let (system, space) = (solved.system.as_ref(), problem.space());
        let unknowns = &solved.steady.mass;
        let change = match (&solved.second, &solved.along) {
            (Some(_), Some((change, true))) => change.clone(),
            (Some(second), along) => {
                let expected = along.as_ref().map(|(change, _)| change.as_slice());
                let solver = &mut self.solver;
                solver.sensitivity_within(&second.matrix, unknowns, expected, ROUGH)?
            }
            (None, _) => vec![0.0; unknowns.len()],
        };
        let changed: Vec<f64> = unknowns.iter().zip(&change).map(|(u, du)| u + du).collect();
        let by_second = cell_masses(system, space, &changed);
        let difference: Vec<f64> = by_second.iter().zip(masses).map(|(b, a)| b - a).collect();
        let kinked = &self.source.kinked;
        let maps = self.source.maps(solved.value)?;
        let mut densities = maps.exact(problem, masses, &difference)?;
        for one in &mut densities {
            one.structure = maps.structure(system, problem, masses, one.observable, kinked);
        }
        let solved = solved.second.is_some().then_some(SecondSolve {
            unknowns: changed,
            masses: by_second,
        });
        Ok((densities, Second { change, solved }))
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
