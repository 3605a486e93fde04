//! Forced systems by SGCM: cells along the phase, map steps that pass whole cells of it, and what is known at phases.
//!
//! Cell k of m along the phase stands for the phase k/m, and a map step passes j cells, j without a common divisor with
//! m: then all phases are one class, and the chain goes round all of them (`sampling`). What is solved is a density at
//! each phase, 1/m of the mass each.

use crate::continuation::Measure;
use crate::density::{EstimatedMoments, Moments, moments, phase_factors, times};
use crate::method::forcing::Forced;
use crate::method::report::Missing;
use crate::method::{MethodError, Problem, StepChoice};
use crate::sampling::part_of_period;
use crate::space::CellSpace;
use crate::system::System;

/// Cells along the phase, at least. Each costs a transition matrix over a map step. A density over the period is a mean
/// of so many phases m, which sees harmonics m, 2m, … of the density: of a normal density that moves by r deviations to
/// either side it ripples by 2 exp(-m²/2r²), which is 7e-4 at r = 4; with half as many it were 6 % at r = 3.
pub(crate) const FEWEST_PHASES: usize = 16;

/// Integrator steps of a period, at least, where the step is left to the program: Heun's step then follows the forcing
/// to 1e-3.
const STEPS_OF_A_PERIOD: f64 = 64.0;

/// How a forced system is mapped along a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PhaseMap {
    /// Cells along the phase that a map step passes.
    pub(super) passed: usize,
    /// Time in which the phase passes one, where it does so fastest.
    part: f64,
    count: usize,
}

impl PhaseMap {
    /// For some systems along a sweep: the shortest map that spans the wanted time, or the nearest to it where that was
    /// given. `None` without forcing.
    pub(super) fn choose<'a>(
        systems: impl Iterator<Item = &'a dyn System>,
        space: &CellSpace,
        (choice, wanted): (StepChoice, f64),
    ) -> Option<Self> {
        let mut parts = Vec::new();
        let mut count = 1;
        for system in systems {
            parts.extend(part_of_period(system, space));
            count = space.axes()[system.facts().phase?].count();
        }
        let part = parts.into_iter().reduce(f64::min)?;
        let wanted = (wanted / part).clamp(1.0, u32::MAX.into());
        let goes_all_round = |passed: &usize| num_integer::gcd(*passed, count) == 1;
        // Whole turns and one cell more go round: a map that does is never far.
        let above = (wanted * (1.0 - 1e-9)).ceil() as usize;
        let above = (above..).find(goes_all_round).unwrap_or(1);
        let below = (1..=wanted as usize).rev().find(goes_all_round);
        let is_nearer = |below: &usize| wanted - (*below as f64) < above as f64 - wanted;
        let passed = match choice {
            StepChoice::Fixed(_) => below.filter(is_nearer).unwrap_or(above),
            StepChoice::Auto => above,
        };
        Some(Self {
            passed,
            part,
            count,
        })
    }

    /// The map step where it is shortest.
    pub(super) fn map_step(&self) -> f64 {
        self.passed as f64 * self.part
    }

    /// The longest time step that follows the forcing.
    pub(super) fn longest_step(&self) -> f64 {
        self.count as f64 * self.part / STEPS_OF_A_PERIOD
    }
}

/// Mean and standard deviation of an axis at a phase, with standard errors from replicates, and the axis; in the order
/// of the phases that are watched.
pub(super) fn moments_at_phases(
    problem: &Problem,
    masses: &[f64],
    replicates: &[Vec<f64>],
) -> Result<Vec<(EstimatedMoments, usize)>, MethodError> {
    let (family, space) = (problem.family(), problem.space());
    let Some(along) = family.model().phase_axis() else {
        return Ok(Vec::new());
    };
    let at_phases = family.at_phases().map(|(at, _)| {
        let factors = phase_factors(space, along, at.phase, 0);
        let of = |masses: &[f64]| -> Result<Moments, MethodError> {
            let here = times(masses, &factors);
            let whole: f64 = here.iter().sum();
            let here: Vec<f64> = here.iter().map(|mass| mass / whole).collect();
            Ok(moments(space, &here)?[at.axis])
        };
        let others: Result<Vec<Moments>, _> = replicates.iter().map(|one| of(one)).collect();
        let estimated = EstimatedMoments::by_replicates(of(masses)?, &others?);
        Ok((estimated, at.axis))
    });
    at_phases.collect()
}

/// Amplitudes and amplifications of states. Their errors are those of sampling, the highest harmonic that the phases
/// tell apart (what is taken for the first is less), a share of them, which the time step and the cells add, and what
/// the mass that is missing in the ranges would make of the mean at their ends.
pub(super) fn amplitudes(
    problem: &Problem,
    system: &dyn System,
    (masses, replicates): (&[f64], &[Vec<f64>]),
    (share, missing): (f64, Missing),
) -> Vec<Measure> {
    let (family, space) = (problem.family(), problem.space());
    let Some(phase) = family.model().phase_axis() else {
        return Vec::new();
    };
    let forced = Forced {
        system,
        space,
        phase,
    };
    let highest = space.axes()[phase].count() / 2;
    forced.measures(family, |axis| {
        let of = |masses: &[f64]| Moments {
            mean: forced.amplitude(axis, 1, masses),
            standard_deviation: 0.0,
        };
        let others: Vec<Moments> = replicates.iter().map(|one| of(one)).collect();
        let found = EstimatedMoments::by_replicates(of(masses), &others);
        let (amplitude, sampling) = (found.moments.mean, found.errors.map(|errors| errors.mean));
        let last = forced.amplitude(axis, highest, masses);
        let ends = &space.axes()[axis];
        let reach = ends.from().abs().max(ends.to().abs());
        let missing = 2.0 * reach * (missing.beyond + missing.leak);
        (
            amplitude,
            sampling.unwrap_or(f64::INFINITY) + last + share * amplitude + missing,
        )
    })
}
