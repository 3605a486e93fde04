//! Spectra at the values of a sweep, and a finding where they are not known.

use std::sync::Arc;

use super::GeneratorSource;
use crate::cancellation::Cancellation;
use crate::continuation::{Finding, Fluctuations, SolveReport};
use crate::generator::{GeneratorOptions, Mesh};
use crate::method::measures::{measures_of_spectrum, signal_to_noise};
use crate::method::{MethodError, Problem};
use crate::spectrum::{
    PowerQuestion, Spectrum, SpectrumError, StateFunction, Steady, power_spectra,
    power_spectra_on_line, rate_of_change, turning_rate,
};
use crate::stationary::generator::{RateError, RateOptions};
use crate::system::{BoundQuantity, Fluctuating, SpectrumQuestion, System};

/// Error of a power, relative to it, from which it is said not to be known.
const UNKNOWN: f64 = 0.1;

/// Highest frequency that is looked at where none is given, over the rate at which states change.
const HIGHEST: f64 = 6.0;

/// A function of the state with values of all parameters.
type BoundFunction<'a> = Box<dyn Fn(&[f64]) -> f64 + Sync + 'a>;

/// Adds the spectra that a family asks for to a report; `unknowns` are those of the steady state, where there is one,
/// and `line` what its motion is solved on where there is one axis.
///
/// # Errors
/// [`MethodError::Cancelled`].
pub(super) fn add_spectra(
    report: &mut SolveReport,
    source: &GeneratorSource,
    (system, value): (&Arc<dyn System>, f64),
    (unknowns, line): (Option<&[f64]>, Option<&Mesh>),
    cancellation: &Cancellation,
) -> Result<(), MethodError> {
    let (subject, space) = (source.problem.subject(), source.problem.space());
    let Some(question) = subject
        .family
        .questions
        .spectrum
        .as_ref()
        .filter(|_| !subject.measures.is_empty())
    else {
        return Ok(());
    };
    let bound = bound(&source.problem, question, value)?;
    let functions: Vec<BoundFunction<'_>> = question
        .observables
        .iter()
        .zip(&bound)
        .map(|(one, bound)| function(one, bound.as_ref()))
        .collect();
    let observables: Vec<StateFunction<'_>> = functions
        .iter()
        .map(|one| &**one as StateFunction<'_>)
        .collect();
    let phase = source.problem.family().model().phase_axis();
    let force = phase.map(|axis| turning_rate(system.as_ref(), space, axis));
    let frequencies = question.band.frequencies();
    let (looked_at, at_force) = with_force(&frequencies, force);
    let asked = PowerQuestion {
        observables: &observables,
        pairs: &question.pairs,
        frequencies: &looked_at,
        lags: question.lags(),
    };
    let (generator, rates) = options(source.options.scheme, source.options.memory_limit);
    let solve = |masses| {
        let steady = Steady {
            masses,
            closed: &source.closed_ends,
            phase,
        };
        power_spectra(
            system,
            space,
            &asked,
            steady,
            (&generator, &rates),
            cancellation,
        )
    };
    let on_line = line.and_then(|line| power_spectra_on_line(line, &asked));
    let found = match unknowns.filter(|_| line.is_none()).map(solve) {
        _ if on_line.is_some() => on_line.unwrap_or_default(),
        Some(Ok(found)) => found.spectra,
        Some(Err(SpectrumError::Rate(RateError::Cancelled(cancelled)))) => {
            return Err(cancelled.into());
        }
        Some(Err(_)) | None => {
            report.findings.push(Finding::NoSpectrum);
            return Ok(());
        }
    };
    for (&pair, mut spectrum) in question.pairs.iter().zip(found) {
        let of = question.name(pair);
        let at_force = at_force.and_then(|place| spectrum.taken_out(place));
        let ratio = at_force.and_then(|power| signal_to_noise(&of, &report.measures, power));
        if let Some(features) = &spectrum.features {
            report.measures.extend(measures_of_spectrum(&of, features));
            report.measures.extend(ratio);
            report.findings.extend(cut_off(&spectrum, &frequencies));
        }
        report
            .fluctuations
            .push(fluctuations(of, spectrum, question));
    }
    Ok(())
}

/// Frequencies with that of a periodic force among them, in ascending order, and its number.
fn with_force(frequencies: &[f64], force: Option<f64>) -> (Vec<f64>, Option<usize>) {
    let mut all = frequencies.to_vec();
    let number = force.map(|force| {
        let number = all.partition_point(|&frequency| frequency < force);
        all.insert(number, force);
        number
    });
    (all, number)
}

/// A finding where a power spectrum is not known from a frequency on.
fn cut_off(spectrum: &Spectrum, frequencies: &[f64]) -> Option<Finding> {
    let mut powers = spectrum.real.iter().zip(frequencies);
    // At zero the power of a velocity is none.
    let (_, &frequency) = powers.find(|((power, error), frequency)| {
        let is_known = *error <= UNKNOWN * power.abs();
        **frequency > 0.0 && !is_known
    })?;
    Some(Finding::SpectrumCut { frequency })
}

fn fluctuations(of: String, spectrum: Spectrum, question: &SpectrumQuestion) -> Fluctuations {
    let factor = question.sides.factor();
    let sided = |known: Vec<(f64, f64)>| {
        let all = known.into_iter();
        all.map(|(value, error)| (factor * value, factor * error))
            .collect()
    };
    Fluctuations {
        of,
        power: sided(spectrum.real),
        imaginary: sided(spectrum.imaginary),
        correlation: spectrum.correlation,
    }
}

/// The quantities at a value of the parameter; `None` for axes.
fn bound(
    problem: &Problem,
    question: &SpectrumQuestion,
    value: f64,
) -> Result<Vec<Option<BoundQuantity>>, MethodError> {
    let values = problem.family().values_at(value)?;
    let all = question.observables.iter().map(|one| match one {
        Fluctuating::Axis(..) => Ok(None),
        Fluctuating::Quantity(quantity) => Ok(Some(quantity.bind(&values)?)),
    });
    all.collect()
}

fn function<'a>(observable: &Fluctuating, bound: Option<&'a BoundQuantity>) -> BoundFunction<'a> {
    match (observable, bound) {
        (Fluctuating::Axis(axis, _), _) => {
            let axis = *axis;
            Box::new(move |state| state[axis])
        }
        (Fluctuating::Quantity(_), Some(bound)) => Box::new(|state| bound.at(state)),
        (Fluctuating::Quantity(_), None) => Box::new(|_| 0.0),
    }
}

fn options(
    scheme: crate::generator::AdvectiveScheme,
    memory_limit: f64,
) -> (GeneratorOptions, RateOptions) {
    let rates = RateOptions {
        memory_limit_bytes: (memory_limit * 1e9) as u64,
        ..RateOptions::default()
    };
    (GeneratorOptions { scheme }, rates)
}

/// The highest frequency that is looked at where none is given: some times the rate at which states change, where that
/// is largest at both ends of a sweep and in its middle; `None` where there is no steady state at any of these.
///
/// # Errors
/// [`MethodError::Cancelled`]; a system that cannot be had.
pub(crate) fn highest_frequency(
    problem: &Problem,
    options_of: &crate::method::GeneratorMethodOptions,
    cancellation: &Cancellation,
) -> Result<Option<f64>, MethodError> {
    let (generator, rates) = options(options_of.scheme, options_of.memory_limit);
    let mut highest: Option<f64> = None;
    for system in problem.family().along()? {
        cancellation.check()?;
        let found = rate_of_change(&system, problem.space(), (&generator, &rates), cancellation);
        if let Ok(rate) = found {
            highest = Some(highest.map_or(rate, |known| known.max(rate)));
        }
    }
    Ok(highest.map(|rate| HIGHEST * rate))
}
