//! Decay rates and frequencies of the slow modes that a family asks for, as columns.

use crate::continuation::measure::{DECAY_FREQUENCY, DECAY_RATE};
use crate::continuation::{Measure, MeasureColumn, MeasureKind};
use crate::spectrum::SlowMode;
use crate::system::Family;

/// Two columns a mode, by its number from 1 on.
pub(super) fn columns(family: &Family) -> impl Iterator<Item = MeasureColumn> {
    let of_mode = |number: usize| {
        [DECAY_RATE, DECAY_FREQUENCY].map(|kind| MeasureColumn {
            kind,
            of: number.to_string(),
        })
    };
    (1..=family.questions.slow_modes).flat_map(of_mode)
}

/// The numbers of slow modes as measures.
pub(in crate::method) fn measures(modes: &[SlowMode]) -> Vec<Measure> {
    let of_mode = |(index, mode): (usize, &SlowMode)| {
        let one = |kind: MeasureKind, (value, error): (f64, f64)| Measure {
            error: Some(error),
            ..kind.measure(&(index + 1).to_string(), value)
        };
        [
            one(DECAY_RATE, mode.decay),
            one(DECAY_FREQUENCY, mode.frequency),
        ]
    };
    modes.iter().enumerate().flat_map(of_mode).collect()
}
