//! Decay rates and frequencies of the slow modes that a family asks for, as columns.

use crate::continuation::measure::{DECAY_DISCRIMINANT, DECAY_FREQUENCY, DECAY_RATE};
use crate::continuation::{Measure, MeasureColumn, MeasureKind};
use crate::spectrum::{SlowMode, SlowModes};
use crate::system::Family;

/// Two columns a mode, by its number from 1 on, and the discriminant of the first two.
pub(super) fn columns(family: &Family) -> impl Iterator<Item = MeasureColumn> {
    let of_mode = |number: usize| {
        [DECAY_RATE, DECAY_FREQUENCY].map(|kind| MeasureColumn {
            kind,
            of: number.to_string(),
        })
    };
    let wanted = family.questions.slow_modes;
    let discriminant = (wanted >= 2).then(|| MeasureColumn {
        kind: DECAY_DISCRIMINANT,
        of: String::new(),
    });
    (1..=wanted).flat_map(of_mode).chain(discriminant)
}

/// The numbers of the first slow modes, at most as many as wanted, as measures.
pub(in crate::method) fn measures(found: &SlowModes, wanted: usize) -> Vec<Measure> {
    let one = |kind: MeasureKind, of: &str, (value, error): (f64, f64)| Measure {
        error: Some(error),
        ..kind.measure(of, value)
    };
    let of_mode = |(index, mode): (usize, &SlowMode)| {
        let number = (index + 1).to_string();
        [
            one(DECAY_RATE, &number, mode.decay),
            one(DECAY_FREQUENCY, &number, mode.frequency),
        ]
    };
    let modes = found
        .modes
        .iter()
        .take(wanted)
        .enumerate()
        .flat_map(of_mode);
    let discriminant = found.discriminant.filter(|_| wanted >= 2);
    let discriminant = discriminant.map(|known| one(DECAY_DISCRIMINANT, "", known));
    modes.chain(discriminant).collect()
}
