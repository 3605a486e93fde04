//! How fast angles turn, and how they spread, as columns.

use crate::continuation::MeasureColumn;
use crate::continuation::measure::{TURN_DIFFUSION, VELOCITY};
use crate::system::Family;

/// The columns of all angles: mean velocity and effective diffusion.
pub(super) fn rotation_columns(family: &Family) -> Vec<MeasureColumn> {
    let columns = family.angles().flat_map(|(_, name)| {
        [VELOCITY, TURN_DIFFUSION].map(|kind| MeasureColumn {
            kind,
            of: name.to_owned(),
        })
    });
    columns.collect()
}
