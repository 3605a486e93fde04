//! Numbers of the power spectra that a family asks for, as columns.

use crate::continuation::measure::{
    CORRELATION_TIME, SPECTRAL_CURVATURE, SPECTRAL_PEAK, SPECTRAL_RISE, SPECTRAL_WIDTH,
};
use crate::continuation::{Measure, MeasureColumn};
use crate::spectrum::Features;
use crate::system::Family;

/// Five columns a power spectrum.
pub(super) fn columns(family: &Family) -> impl Iterator<Item = MeasureColumn> {
    let asked = family.questions.spectrum.iter();
    asked.flat_map(move |question| {
        let pairs = question.pairs.iter().filter(|(one, other)| one == other);
        pairs.flat_map(move |&pair| {
            let of = question.name(pair);
            [
                SPECTRAL_PEAK,
                SPECTRAL_WIDTH,
                CORRELATION_TIME,
                SPECTRAL_CURVATURE,
                SPECTRAL_RISE,
            ]
            .map(|kind| MeasureColumn {
                kind,
                of: of.clone(),
            })
        })
    })
}

/// The numbers of a power spectrum that are known, as measures.
pub(in crate::method) fn measures(of: &str, features: &Features) -> Vec<Measure> {
    let all = [
        (SPECTRAL_PEAK, features.peak),
        (SPECTRAL_WIDTH, features.width),
        (CORRELATION_TIME, features.correlation_time),
        (SPECTRAL_CURVATURE, features.curvature),
        (SPECTRAL_RISE, features.rise),
    ];
    let known = all.into_iter().filter_map(|(kind, known)| {
        let (value, error) = known?;
        Some(Measure {
            error: Some(error),
            ..kind.measure(of, value)
        })
    });
    known.collect()
}
