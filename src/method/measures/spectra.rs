//! Numbers of the power spectra that a family asks for, as columns.
//!
//! Under a periodic force the mean of a state moves at its frequency Ω with the amplitude a. The power spectrum is then
//! a continuous one S(ω), of the fluctuations about that mean, and the lines of the mean, (π/2) a² at Ω and at -Ω. The
//! signal-to-noise ratio of stochastic resonance is that of both lines to the continuous spectrum there, π a²/S(Ω) (L.
//! Gammaitoni, P. Hänggi, P. Jung and F. Marchesoni, *Rev. Mod. Phys.* 70, 223, 1998, equation 2.18).

use std::f64::consts::PI;

use crate::continuation::measure::{
    AMPLITUDE, CORRELATION_TIME, SIGNAL_TO_NOISE, SPECTRAL_CURVATURE, SPECTRAL_PEAK, SPECTRAL_RISE,
    SPECTRAL_WIDTH,
};
use crate::continuation::{Measure, MeasureColumn, MeasureKind};
use crate::spectrum::Features;
use crate::system::Family;

const FEATURES: [MeasureKind; 5] = [
    SPECTRAL_PEAK,
    SPECTRAL_WIDTH,
    CORRELATION_TIME,
    SPECTRAL_CURVATURE,
    SPECTRAL_RISE,
];

/// Five columns a power spectrum, and a sixth of each state on a line that moves with a periodic force.
pub(super) fn columns(family: &Family) -> impl Iterator<Item = MeasureColumn> {
    let is_forced = family.model().phase_axis().is_some();
    let answers = move |of: &str| is_forced && family.states_on_lines().any(|(_, name)| name == of);
    let asked = family.questions.spectrum.iter();
    asked.flat_map(move |question| {
        let pairs = question.pairs.iter().filter(|(one, other)| one == other);
        pairs.flat_map(move |&pair| {
            let of = question.name(pair);
            let ratio = answers(&of).then_some(SIGNAL_TO_NOISE);
            let kinds = FEATURES.into_iter().chain(ratio);
            kinds.map(move |kind| MeasureColumn {
                kind,
                of: of.clone(),
            })
        })
    })
}

/// The numbers of a power spectrum that are known, as measures.
pub(in crate::method) fn measures(of: &str, features: &Features) -> Vec<Measure> {
    let all = [
        features.peak,
        features.width,
        features.correlation_time,
        features.curvature,
        features.rise,
    ];
    let known = FEATURES.into_iter().zip(all).filter_map(|(kind, known)| {
        let (value, error) = known?;
        Some(Measure {
            error: Some(error),
            ..kind.measure(of, value)
        })
    });
    known.collect()
}

/// The signal-to-noise ratio of a state at the frequency of a periodic force, from the amplitude of its mean, which is
/// among the measures, and the power of its fluctuations there; `None` without either, or where the power is not known
/// to be above zero.
pub(in crate::method) fn signal_to_noise(
    of: &str,
    measures: &[Measure],
    (power, power_error): (f64, f64),
) -> Option<Measure> {
    let name = AMPLITUDE.name(of);
    let amplitude = measures.iter().find(|one| one.name == name)?;
    let (value, error) = (amplitude.value, amplitude.error?);
    let least = power - power_error;
    (least > 0.0).then(|| {
        let ratio = PI * value * value / power;
        let largest = PI * (value + error).powi(2) / least;
        Measure {
            error: Some(largest - ratio),
            ..SIGNAL_TO_NOISE.measure(of, ratio)
        }
    })
}
