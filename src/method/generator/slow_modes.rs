//! Slow modes at the values of a sweep, and a finding where fewer are known than are wanted.

use std::sync::Arc;

use super::GeneratorSource;
use crate::cancellation::Cancellation;
use crate::continuation::{Finding, PassageFault, SolveReport};
use crate::generator::{GeneratorOptions, Mesh, levels};
use crate::method::MethodError;
use crate::method::measures::{formula_measures, measures_of_slow_modes, switching_measures};
use crate::passage::KnownDensity;
use crate::space::Axis;
use crate::spectrum::{
    EscapeFormulas, SlowModes, SpectrumError, Steady, escape_formulas, slow_modes,
    slow_modes_on_line, switching,
};
use crate::stationary::generator::{RateError, RateOptions};
use crate::system::{BoundQuantity, DampedParticle, PassageStart, Region, System};

/// Error at which solves stop to be iterated, relative to their right side: well below what an eigenvalue may change
/// by more vectors.
const TOLERANCE: f64 = 1e-11;

/// Adds the numbers of the slow modes to a report, and the rates between states that passages ask for; `density` is the
/// steady state, where there is one, and `line` what its motion is solved on where there is one axis.
///
/// # Errors
/// [`MethodError::Cancelled`], and errors of values that the family does not have.
pub(super) fn add_slow_modes(
    report: &mut SolveReport,
    source: &GeneratorSource,
    (system, value): (&Arc<dyn System>, f64),
    (density, line): (Option<KnownDensity<'_>>, Option<&Mesh>),
    cancellation: &Cancellation,
) -> Result<(), MethodError> {
    let (subject, space) = (source.problem.subject(), source.problem.space());
    let wanted = subject.family.questions.slow_modes;
    if !subject.family.questions.asks_for_modes() || subject.measures.is_empty() {
        return Ok(());
    }
    let rates = RateOptions {
        tolerance: TOLERANCE,
        memory_limit_bytes: (source.options.memory_limit * 1e9) as u64,
        ..RateOptions::default()
    };
    let generator = GeneratorOptions {
        scheme: source.options.scheme,
    };
    let closed = &source.closed_ends;
    let solve = |density: KnownDensity<'_>| {
        let steady = Steady {
            masses: density.unknowns,
            closed,
            phase: None,
        };
        let settings = (&generator, &rates);
        slow_modes(system, space, wanted, steady, settings, cancellation)
    };
    let on_line = line.map(|line| slow_modes_on_line(line, wanted, &space.axes()[0]));
    let found = match density.filter(|_| on_line.is_none()).map(solve) {
        _ if on_line.is_some() => on_line,
        Some(Ok(found)) => Some(found),
        Some(Err(SpectrumError::Rate(RateError::Cancelled(cancelled)))) => {
            return Err(cancelled.into());
        }
        Some(Err(_)) | None => None,
    };
    let told = found.iter();
    (report.measures).extend(told.flat_map(|found| measures_of_slow_modes(found, wanted)));
    let known = found.as_ref().map_or(0, |found| found.modes.len());
    if known < wanted {
        report
            .findings
            .push(Finding::FewSlowModes { known, wanted });
    }
    add_switching(report, source, value, found.as_ref().zip(density))
}

/// Adds the rates between states that passages ask for, from the slow modes and the steady state.
fn add_switching(
    report: &mut SolveReport,
    source: &GeneratorSource,
    value: f64,
    known: Option<(&SlowModes, KnownDensity<'_>)>,
) -> Result<(), MethodError> {
    let (family, space) = (source.problem.family(), source.problem.space());
    let values = family.values_at(value)?;
    for (passage, question) in family.questions.passages.iter().enumerate() {
        let PassageStart::Region(from) = &question.start else {
            continue;
        };
        if !question.switching {
            continue;
        }
        let level = |region: &Region| -> Result<Vec<f64>, MethodError> {
            let bound = region.level().bind(&values)?;
            // A level without a value has no inside.
            Ok(levels(space, &bound).unwrap_or_else(|_| vec![0.0; space.n_cells()]))
        };
        let (first, second) = (level(from)?, level(&question.until)?);
        let rates = known.and_then(|(modes, density)| {
            let steady = (density.unknowns, density.changes);
            switching(modes, space, steady, [&first, &second])
        });
        match rates {
            Some(rates) => {
                let both = [rates.there, rates.back];
                report.measures.extend(switching_measures(question, both));
            }
            None => report.findings.push(Finding::NoPassage {
                passage,
                fault: PassageFault::NoSwitching,
            }),
        }
        if let Some(particle) = family.particle_at(value) {
            let bind = |region: &Region| region.level().bind(&values);
            let regions = [bind(from)?, bind(&question.until)?];
            let range = &space.axes()[particle.position];
            let rates = over_a_barrier(&particle, range, &regions);
            let rates = rates
                .iter()
                .flat_map(|rates| formula_measures(question, rates));
            report.measures.extend(rates);
        }
    }
    Ok(())
}

/// The rates by formulas at which a particle goes over the barrier between two regions.
fn over_a_barrier(
    particle: &DampedParticle,
    range: &Axis,
    [from, until]: &[BoundQuantity; 2],
) -> Option<EscapeFormulas> {
    let at_rest = |region: &BoundQuantity, position: f64| {
        let mut state = [0.0; 2];
        state[particle.position] = position;
        region.at(&state) < 0.0
    };
    let (first, second) = (|x| at_rest(from, x), |x| at_rest(until, x));
    escape_formulas(particle, (range.from(), range.to()), [&first, &second])
}
