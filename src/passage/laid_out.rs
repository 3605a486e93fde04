//! A steady state laid out on cells along axes of modes, for regions whose border lies across them.
//!
//! The masses at the nodes of a series say what its moments are, not how much lies on one side of a place. So the
//! series itself is taken at the nodes of cells of equal width. What its last modes do is a part of its error.

use super::KnownDensity;
use crate::space::{Axis, CellSpace, SpaceError};
use crate::system::BoundQuantity;

/// Cells along an axis at least, and for each mode.
const CELLS: usize = 60;
const CELLS_OF_A_MODE: usize = 4;

/// Modes that coarser series leave out: one of each parity, and as many again, because what the last ones add to a
/// region may vanish, as cos 8φ adds nothing to half a turn.
const LEFT_OUT: [usize; 2] = [2, 4];

/// Width about a node of a cell over which a series is averaged, as a share of the cell.
const WIDTH: f64 = 1e-3;

/// A density on cells along all axes that a region depends on.
pub(super) struct LaidOut {
    pub(super) space: CellSpace,
    unknowns: Vec<f64>,
    /// The same without the last modes.
    fewer: [Vec<f64>; 2],
    changes: Option<Vec<f64>>,
}

impl LaidOut {
    /// `None` where the region depends on no axis of modes.
    ///
    /// # Errors
    /// [`SpaceError`] for more cells than there may be.
    pub(super) fn new(
        space: &CellSpace,
        region: &BoundQuantity,
        density: KnownDensity<'_>,
    ) -> Result<Option<Self>, SpaceError> {
        let Some(cells) = space_of(space, region)? else {
            return Ok(None);
        };
        let laid = |values: &[f64], left_out: usize| values_on(&cells, (space, values), left_out);
        Ok(Some(Self {
            unknowns: laid(density.unknowns, 0),
            fewer: LEFT_OUT.map(|left_out| laid(density.unknowns, left_out)),
            changes: density.changes.map(|changes| laid(changes, 0)),
            space: cells,
        }))
    }

    pub(super) fn density<'a>(&'a self, planes: &'a [(usize, f64)]) -> KnownDensity<'a> {
        KnownDensity {
            unknowns: &self.unknowns,
            changes: self.changes.as_deref(),
            planes,
        }
    }

    /// What the last modes add to the unknowns, and those before them: by the larger one of what either adds to a
    /// number, modes that are missing may change it.
    pub(super) fn added(&self) -> Vec<Vec<f64>> {
        let [own, fewer, fewest] = [&self.unknowns, &self.fewer[0], &self.fewer[1]];
        let differences = [[own, fewer], [fewer, fewest]].map(|[more, less]| {
            let pairs = more.iter().zip(less);
            pairs.map(|(more, less)| more - less).collect()
        });
        differences.into()
    }
}

/// The space with cells along axes of modes that a region depends on; `None` where there are none.
///
/// # Errors
/// [`SpaceError`] for more cells than there may be.
pub(super) fn space_of(
    space: &CellSpace,
    region: &BoundQuantity,
) -> Result<Option<CellSpace>, SpaceError> {
    let axes = || space.axes().iter().zip(region.states());
    if !axes().any(|(axis, &depends)| depends && axis.is_modes()) {
        return Ok(None);
    }
    let laid = axes().map(|(axis, &depends)| match depends && axis.is_modes() {
        true => {
            let (from, to) = axis.series_range();
            Axis::uniform(from, to, (CELLS_OF_A_MODE * axis.count()).max(CELLS))
        }
        false => Ok(axis.clone()),
    });
    CellSpace::new(laid.collect::<Result<_, _>>()?).map(Some)
}

/// Values at the nodes of a space, times local volumes, as those at the nodes of the cells.
fn values_on(
    cells: &CellSpace,
    (space, values): (&CellSpace, &[f64]),
    left_out: usize,
) -> Vec<f64> {
    let mut values = values.to_vec();
    let pairs = space.axes().iter().zip(cells.axes()).enumerate();
    for (index, (axis, laid)) in pairs {
        if !axis.is_modes() || laid.is_modes() {
            continue;
        }
        let stride: usize = space.axes()[index + 1..].iter().map(Axis::count).product();
        let weights = node_weights(axis, laid, left_out);
        let mut next = vec![0.0; values.len() / axis.count() * laid.count()];
        let blocks = values.chunks_exact(axis.count() * stride);
        for (block, next) in blocks.zip(next.chunks_exact_mut(laid.count() * stride)) {
            let rows = weights.chunks_exact(axis.count());
            for (weights, row) in rows.zip(next.chunks_exact_mut(stride)) {
                for (weight, values) in weights.iter().zip(block.chunks_exact(stride)) {
                    let pairs = row.iter_mut().zip(values);
                    pairs.for_each(|(sum, value)| *sum += weight * value);
                }
            }
        }
        values = next;
    }
    values
}

/// What the mass at each node of a series adds to its density at the nodes of cells, times their widths.
fn node_weights(axis: &Axis, laid: &Axis, left_out: usize) -> Vec<f64> {
    let used = axis.count().saturating_sub(left_out).max(1);
    let edges: Vec<f64> = (0..laid.count())
        .flat_map(|cell| {
            let half = 0.5 * WIDTH * laid.width(cell);
            [laid.centre(cell) - half, laid.centre(cell) + half]
        })
        .collect();
    let all = axis.series_weights(&edges, used);
    // Every other bin lies about a node, those between them from one node to the next.
    let about = all.chunks_exact(axis.count()).step_by(2);
    about.flatten().map(|weight| weight / WIDTH).collect()
}
