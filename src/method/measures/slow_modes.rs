//! Decay rates and frequencies of the slow modes that a family asks for, as columns.

use crate::continuation::measure::{DECAY_DISCRIMINANT, DECAY_FREQUENCY, DECAY_RATE};
use crate::continuation::{Measure, MeasureColumn, MeasureKind};
use crate::spectrum::SlowModes;
use crate::system::Family;

/// Two columns a mode, by its number from 1 on, and that of the two slowest together.
pub(super) fn columns(family: &Family) -> impl Iterator<Item = MeasureColumn> {
    let wanted = family.slow_modes();
    let of_mode = |number: usize| {
        [DECAY_RATE, DECAY_FREQUENCY].map(|kind| MeasureColumn {
            kind,
            of: number.to_string(),
        })
    };
    let together = (wanted > 1).then(|| MeasureColumn {
        kind: DECAY_DISCRIMINANT,
        of: String::new(),
    });
    (1..=wanted).flat_map(of_mode).chain(together)
}

/// The numbers of slow modes as measures.
pub(in crate::method) fn measures(found: &SlowModes, wanted: usize) -> Vec<Measure> {
    let known = |kind: MeasureKind, of: &str, (value, error): (f64, f64)| Measure {
        error: Some(error),
        ..kind.measure(of, value)
    };
    let modes = found.modes.iter().enumerate().flat_map(|(index, mode)| {
        let number = (index + 1).to_string();
        [
            known(DECAY_RATE, &number, mode.decay),
            known(DECAY_FREQUENCY, &number, mode.frequency),
        ]
    });
    let together = found.discriminant.filter(|_| wanted > 1);
    let together = together.map(|both| known(DECAY_DISCRIMINANT, "", both));
    modes.chain(together).collect()
}
