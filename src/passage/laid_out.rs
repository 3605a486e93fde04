//! A steady state laid out on cells along axes of modes, for regions whose border lies across them.
//!
//! The masses at the nodes of a series say what its moments are, not how much lies on one side of a place. So the
//! series itself is taken at the nodes of cells of equal width. What its last modes do is a part of its error.
//!
//! Cells serve as well where a process ends on its way along an axis that noise does not act on, and a state on an axis
//! of modes says whether it goes out there or in, as coloured noise does. Its mean time then rises from zero, on one
//! side of a value of that state, as a root of the distance from it, which a series of some twenty modes hardly tells.
//! Of an angle some more harmonics do.

use super::{KnownDensity, Passage, Start};
use crate::space::{Axis, CellSpace, SpaceError};
use crate::system::{BoundQuantity, System};

/// Cells along an axis at least, and for each mode.
const CELLS: usize = 60;
const CELLS_OF_A_MODE: usize = 4;

/// Harmonics of an angle that says whether a process goes out or in, at least.
const HARMONICS: usize = 32;

/// Shares of an axis at which it is looked at whether one state moves another: a product of two may vanish at some.
const LOOKED_AT: [f64; 3] = [0.21, 0.5, 0.83];

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
    returning: Option<Vec<f64>>,
    beyond: f64,
}

impl LaidOut {
    /// `None` where neither the region nor how its border is crossed depends on an axis of modes.
    ///
    /// # Errors
    /// [`SpaceError`] for more cells than there may be.
    pub(super) fn new(
        (system, space): (&dyn System, &CellSpace),
        region: &BoundQuantity,
        density: KnownDensity<'_>,
    ) -> Result<Option<Self>, SpaceError> {
        let cells = space_of((system, space), region)?;
        Ok(cells.map(|cells| Self::on(cells, space, density)))
    }

    fn on(cells: CellSpace, space: &CellSpace, density: KnownDensity<'_>) -> Self {
        let laid = |values: &[f64], left_out: usize| values_on(&cells, (space, values), left_out);
        Self {
            unknowns: laid(density.unknowns, 0),
            fewer: LEFT_OUT.map(|left_out| laid(density.unknowns, left_out)),
            changes: density.changes.map(|changes| laid(changes, 0)),
            returning: density.returning.map(|returning| laid(returning, 0)),
            beyond: density.beyond,
            space: cells,
        }
    }

    /// With what the last modes add as a part of what a second discretisation changes.
    fn with_modes_in_changes(mut self) -> Self {
        let added = self.added();
        let changes = self
            .changes
            .get_or_insert_with(|| vec![0.0; self.unknowns.len()]);
        for (change, added) in changes.iter_mut().zip(&added[0]) {
            *change += added;
        }
        self
    }

    pub(super) fn density<'a>(&'a self, planes: &'a [(usize, f64)]) -> KnownDensity<'a> {
        KnownDensity {
            unknowns: &self.unknowns,
            changes: self.changes.as_deref(),
            by_modes: None,
            returning: self.returning.as_deref(),
            beyond: self.beyond,
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

/// The space with cells along axes of modes that a region depends on, or the direction in which its border is crossed;
/// `None` where there are none.
///
/// # Errors
/// [`SpaceError`] for more cells than there may be.
pub(super) fn space_of(
    (system, space): (&dyn System, &CellSpace),
    region: &BoundQuantity,
) -> Result<Option<CellSpace>, SpaceError> {
    let steering = steering((system, space), region);
    let wanted = region.states().iter().zip(&steering);
    let wanted: Vec<bool> = wanted
        .map(|(depends, steers)| *depends || *steers)
        .collect();
    laid_along(space, &wanted, |axis| {
        laid_axis(axis, (CELLS_OF_A_MODE * axis.count()).max(CELLS))
    })
}

/// The space with other axes in place of those axes of modes that are wanted; `None` where there are none.
fn laid_along(
    space: &CellSpace,
    wanted: &[bool],
    other: impl Fn(&Axis) -> Result<Axis, SpaceError>,
) -> Result<Option<CellSpace>, SpaceError> {
    let axes = || space.axes().iter().zip(wanted);
    if !axes().any(|(axis, &wanted)| wanted && axis.is_modes()) {
        return Ok(None);
    }
    let laid = axes().map(|(axis, &wanted)| match wanted && axis.is_modes() {
        true => other(axis),
        false => Ok(axis.clone()),
    });
    CellSpace::new(laid.collect::<Result<_, _>>()?).map(Some)
}

fn laid_axis(axis: &Axis, cells: usize) -> Result<Axis, SpaceError> {
    let (from, to) = axis.series_range();
    Axis::uniform(from, to, cells)
}

/// What a passage is solved on in place of a space with axes of modes of which one says whether the process goes out
/// over the border of the target or in: the space, and the steady state there if the start is of it. `None` where there
/// are no such axes.
///
/// # Errors
/// [`SpaceError`] for more cells than there may be.
pub(super) fn on_cells(
    (system, space): (&dyn System, &CellSpace),
    passage: &Passage,
    density: Option<KnownDensity<'_>>,
) -> Result<Option<(CellSpace, Option<LaidOut>)>, SpaceError> {
    let steering = steering((system, space), &passage.until);
    let other = |axis: &Axis| match axis.is_closed() {
        true => axis.with_modes(axis.mode_number().max(HARMONICS)),
        false => laid_axis(axis, CELLS),
    };
    let Some(cells) = laid_along(space, &steering, other)? else {
        return Ok(None);
    };
    let of_density = density.filter(|_| matches!(passage.start, Start::Density(_)));
    let laid = of_density
        .map(|density| LaidOut::on(cells.clone(), space, density).with_modes_in_changes());
    Ok(Some((cells, laid)))
}

/// The axes of modes on which the drift across the border of a region depends, along axes on which noise does not act.
fn steering((system, space): (&dyn System, &CellSpace), region: &BoundQuantity) -> Vec<bool> {
    let pairs = region.states().iter().enumerate();
    let across = pairs.filter(|&(axis, &depends)| depends && !system.is_noisy(axis));
    let across: Vec<usize> = across.map(|(axis, _)| axis).collect();
    let steers = |(axis, along): (usize, &Axis)| {
        let moved = |state: &[f64]| {
            let drift = |x: f64| {
                let mut state = state.to_vec();
                state[axis] = x;
                system.drift_at(0.0, &state)
            };
            let own = system.drift_at(0.0, state);
            let mut others = along.nodes().iter().map(|&x| drift(x));
            others.any(|other| across.iter().any(|&one| other[one] != own[one]))
        };
        along.is_modes() && states_all_over(space).any(|state| moved(&state))
    };
    space.axes().iter().enumerate().map(steers).collect()
}

/// States at each of some places along every axis.
fn states_all_over(space: &CellSpace) -> impl Iterator<Item = Vec<f64>> {
    let count = LOOKED_AT.len();
    (0..count.pow(space.dimension() as u32)).map(move |number| {
        let mut rest = number;
        let axes = space.axes().iter();
        axes.map(|axis| {
            let share = LOOKED_AT[rest % count];
            rest /= count;
            axis.nodes()[(share * axis.count() as f64) as usize]
        })
        .collect()
    })
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
        if axis.count() == laid.count() {
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
