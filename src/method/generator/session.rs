//! The generator at work: assemble Q, solve Q u = 0 with the neighbour's factorisation, and state the error of the grid
//! as the difference to a second scheme.
//!
//! A polynomial through the last few points predicts the next one. (The tangent at the first point would save fewer
//! iterations than it takes.) The difference to the second scheme comes from the factorisation that is there: with the
//! second scheme's Q' = Q + δQ it is Q δu = -(δQ) u to first order. It is predicted likewise, and iterated only as far
//! as the prediction is not good enough.

use std::sync::Arc;

use super::GeneratorSource;
use super::largest_exponent::add_largest_exponent;
use super::one_axis;
use super::passages::{add_passages, at_nodes};
use super::second::companion;
use super::sensitivity::GeneratorSensitivity;
use super::slow_modes::add_slow_modes;
use super::spectra::add_spectra;
use super::stand::Stand;
use super::trail::Trail;
use crate::cancellation::Cancellation;
use crate::continuation::{Solution, SolveReport};
use crate::density::EstimatedDensity;
use crate::generator::{LineRates, MESH_DEPTH, MESH_PLACES, Reach, normalised_to_walls};
use crate::method::MethodError;
use crate::method::neighbours::Neighbours;
use crate::method::watched::planes;
use crate::numerics::distance;
use crate::passage::{KnownDensity, PassageMemory};
use crate::stationary::generator::{Along, RateSolver, RateSteadyState};
use crate::system::System;

/// Relative error of differences between schemes, which estimate errors.
pub(super) const ROUGH: f64 = 1e-2;

/// The same where low peaks decide: what a difference may be off by is spread over all cells, and must be small against
/// their heights.
pub(super) const FINE: f64 = 1e-6;

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
    /// What the passages of the last value have left, one a question.
    passages: Vec<PassageMemory>,
    pub(super) cancellation: Cancellation,
}

/// What was solved at one point.
pub(super) struct PointSolve {
    pub(super) value: f64,
    pub(super) system: Arc<dyn System>,
    pub(super) steady: RateSteadyState,
    /// Rates at which the cells' masses leave Ω.
    pub(super) escape: Vec<f64>,
    /// The generator by the second scheme; `None` in a check, which states no error of its own.
    pub(super) second: Option<LineRates>,
    /// By how much the second scheme's unknowns differ, where that came along with the solve, and whether the unknowns
    /// were expected well enough for that to be it.
    pub(super) along: Option<(Vec<f64>, bool)>,
    /// By how much the unknowns of a third scheme differ, where means of formulas want it.
    pub(super) third: Option<Vec<f64>>,
}

impl GeneratorSession {
    pub(super) fn new(source: &GeneratorSource, cancellation: &Cancellation) -> Self {
        Self {
            source: source.clone(),
            solver: source.solver(cancellation),
            trails: Neighbours::default(),
            stand: Stand::default(),
            has_left: false,
            passages: (source.problem.family().questions.passages.iter())
                .map(|_| PassageMemory::default())
                .collect(),
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
            let Solution {
                report, densities, ..
            } = &mut solution;
            let beyond = densities.iter().map(|one| one.truncation.share);
            let known = Some(KnownDensity {
                unknowns: &unknowns,
                changes: Some(&changes),
                by_modes: None,
                returning: None,
                beyond: beyond.fold(0.0, f64::max),
                planes: &planes(&self.source.kinked),
            });
            let reach = one_axis::reach(&self.source, system.as_ref(), &found);
            self.add_asked(report, value, (&system, reach), (known, None, densities))?;
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
        solved.third = self.by_third_scheme(&solved)?;
        let (mut solution, judged) = self.judge(&solved, before.as_ref())?;
        let newest = judged
            .as_ref()
            .and_then(|(trail, errors)| Some((trail.newest()?, errors)));
        let planes = planes(&self.source.kinked);
        let (system, space) = (solved.system.as_ref(), self.source.problem.space());
        let to_walls = newest.map(|(newest, _)| normalised_to_walls(system, space, &newest.mass));
        let pairs = newest.zip(to_walls.as_ref());
        let known = pairs.map(|((_, errors), (unknowns, changed))| KnownDensity {
            unknowns,
            changes: Some(&errors.changes),
            by_modes: errors.by_modes.as_deref(),
            returning: errors.cut_off.returning.as_deref(),
            // What walls change of all values alike is made good to fourth order, and taken for its own error.
            beyond: errors.cut_off.beyond + changed,
            planes: &planes,
        });
        let Solution {
            report, densities, ..
        } = &mut solution;
        let third = solved.third.as_deref();
        let known = (known, third, densities.as_slice());
        self.add_asked(report, value, (&solved.system, None), known)?;
        let Some((trail, _)) = judged else {
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
    /// for; `density` is the steady state, with what a third scheme changes of its unknowns where there is one, and
    /// `watched` are its densities. With a reach of one axis they are those of a line.
    fn add_asked(
        &self,
        report: &mut SolveReport,
        value: f64,
        (system, reach): (&Arc<dyn System>, Option<Reach<'_>>),
        (density, third, watched): (
            Option<KnownDensity<'_>>,
            Option<&[f64]>,
            &[EstimatedDensity],
        ),
    ) -> Result<(), MethodError> {
        // Questions are asked in coordinates that stay.
        if self.source.checks || self.source.problem.family().has_moving_origin() {
            return Ok(());
        }
        let (problem, options) = (&self.source.problem, &self.source.options);
        let (asked, cancellation) = ((problem, value), &self.cancellation);
        add_passages(
            report,
            asked,
            (system, reach.as_ref()),
            (density, watched),
            (options, &self.passages),
            cancellation,
        )?;
        let at = (system, value);
        let known = density.map(|one| (one.unknowns, one.changes.unwrap_or(&[])));
        add_largest_exponent(report, &self.source, at, (known, third), cancellation)?;
        let unknowns = density.map(|one| one.unknowns);
        let asks = &problem.family().questions;
        let is_line_asked = asks.spectrum.is_some() || asks.asks_for_modes();
        let reach = reach.filter(|_| is_line_asked && !problem.subject().measures.is_empty());
        let line = reach.and_then(|reach| reach.mesh(MESH_PLACES, MESH_DEPTH, &[]));
        let line = line.as_ref();
        add_slow_modes(report, &self.source, at, (density, line), cancellation)?;
        add_spectra(report, &self.source, at, (unknowns, line), cancellation)
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
        let scheme = source.options.scheme;
        let (generator, second) = if source.checks {
            (source.assemble(system.as_ref(), scheme)?, None)
        } else {
            let schemes = [scheme, companion(scheme)];
            let [first, second] = source.assemble_lines(system.as_ref(), schemes)?;
            let generator = first.generator().map_err(|error| source.refused(error))?;
            (generator, Some(second))
        };
        // What the second scheme says of a steady state of the first is what they differ by.
        let change = second.as_ref().zip(guess);
        let change = change.map(|(second, guess)| second.product(guess));
        let along = change.as_ref().map(|change| Along {
            change,
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
            third: None,
        })
    }
}
