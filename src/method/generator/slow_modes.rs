//! Slow modes at the values of a sweep, and a finding where fewer are known than are wanted.

use std::sync::Arc;

use super::GeneratorSource;
use crate::cancellation::Cancellation;
use crate::continuation::{Finding, SolveReport};
use crate::generator::GeneratorOptions;
use crate::method::MethodError;
use crate::method::measures::measures_of_slow_modes;
use crate::spectrum::{SpectrumError, Steady, slow_modes};
use crate::stationary::generator::{RateError, RateOptions};
use crate::system::System;

/// Error at which solves stop to be iterated, relative to their right side: well below what an eigenvalue may change
/// by more vectors.
const TOLERANCE: f64 = 1e-11;

/// Adds the numbers of the slow modes to a report; `unknowns` are those of the steady state, where there is one.
///
/// # Errors
/// [`MethodError::Cancelled`].
pub(super) fn add_slow_modes(
    report: &mut SolveReport,
    source: &GeneratorSource,
    system: &Arc<dyn System>,
    unknowns: Option<&[f64]>,
    cancellation: &Cancellation,
) -> Result<(), MethodError> {
    let (subject, space) = (source.problem.subject(), source.problem.space());
    let wanted = subject.family.slow_modes();
    if wanted == 0 || subject.measures.is_empty() {
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
    let solve = |masses| {
        let steady = Steady { masses, closed };
        let settings = (&generator, &rates);
        slow_modes(system, space, wanted, steady, settings, cancellation)
    };
    let known = match unknowns.map(solve) {
        Some(Ok(found)) => {
            report.measures.extend(measures_of_slow_modes(&found.modes));
            found.modes.len()
        }
        Some(Err(SpectrumError::Rate(RateError::Cancelled(cancelled)))) => {
            return Err(cancelled.into());
        }
        Some(Err(_)) | None => 0,
    };
    if known < wanted {
        report
            .findings
            .push(Finding::FewSlowModes { known, wanted });
    }
    Ok(())
}
