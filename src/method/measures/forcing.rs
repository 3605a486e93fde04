//! How states answer to a periodic forcing, as columns.

use crate::continuation::MeasureColumn;
use crate::continuation::measure::{AMPLIFICATION, AMPLITUDE};
use crate::system::Family;

/// The columns of all states that are no angles: amplitude of the mean, and spectral amplification.
pub(super) fn forcing_columns(family: &Family) -> Vec<MeasureColumn> {
    if family.model().phase_axis().is_none() {
        return Vec::new();
    }
    let columns = family.states_on_lines().flat_map(|(_, name)| {
        [AMPLITUDE, AMPLIFICATION].map(|kind| MeasureColumn {
            kind,
            of: name.to_owned(),
        })
    });
    columns.collect()
}
