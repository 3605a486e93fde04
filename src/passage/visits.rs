//! How often a process enters a region, what share of the time it is inside, and how long a visit lasts.
//!
//! Where no noise acts across the border, a process crosses it with the rate at which its level L changes along the
//! drift f, dL/dt = ∇L·f, and enters at the rate ∫ δ(L) max(-dL/dt, 0) p, L being negative inside (S. O. Rice, Bell
//! System Technical Journal 24, 46 (1945)). A visit lasts P(L < 0) over that rate in the mean. Where noise acts across
//! the border a process crosses it infinitely often once it is there, and no visit has a length.
//!
//! The integral is over lines along each axis that meet the border: with g_a = (∂_a L)² over the sum of such squares,
//! a crossing counts g_a/|∂_a L|, so that lines which touch the border count nothing and all axes together count once.

use super::crossing::crossing;
use super::dips::{dip, may_dip};
use super::laid_out::{LaidOut, space_of};
use super::spread::GAUSS;
use super::start::add_state;
use super::steady::{change_by_modes, local_volumes, mass_beside};
use super::timed::WithError;
use super::{KnownDensity, PassageError, dot};
use crate::MAX_DIMENSION;
use crate::density::Roughness;
use crate::space::nodes::{FEWER_NODES, NODES};
use crate::space::{Axis, CellSpace};
use crate::system::{BoundQuantity, System};

/// Visits of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Visits {
    /// Share of the time that is spent inside: the probability of the region.
    pub time_share: WithError,
    /// Entries per unit of time, with the mean time that each visit lasts; `None` where the border is met nowhere, or
    /// noise acts across it.
    pub entries: Option<[WithError; 2]>,
    /// Whether noise acts across the border somewhere.
    pub is_endless: bool,
}

/// Intervals into which a cell is cut along the only axis across a line, and along one of several.
const INTERVALS: usize = 4;
const INTERVALS_OF_SEVERAL: usize = 2;

/// Steps of derivatives of the level, over the width of a cell.
const STEP: f64 = 1e-4;

/// Derivatives below this share of the largest one, both times the widths of cells, are rounding.
const ROUNDING: f64 = 1e-9;

/// Visits of the region where `region` is negative, of a system in the steady state `density` on cells.
///
/// # Errors
/// [`PassageError::Generator`] for a level that has no value at a node, [`PassageError::Space`] where modes across the
/// border take too many cells.
pub fn visits(
    cells: (&dyn System, &CellSpace),
    region: &BoundQuantity,
    density: KnownDensity<'_>,
) -> Result<Visits, PassageError> {
    Ok(visits_and(cells, region, density, &[])?.0)
}

/// The same, and what some other unknowns on these cells add to the probability of the region and to the entries per
/// unit of time; nothing of them where the region lies across axes of modes, on whose cells they are not known.
pub(crate) fn visits_and(
    (system, space): (&dyn System, &CellSpace),
    region: &BoundQuantity,
    density: KnownDensity<'_>,
    others: &[Vec<f64>],
) -> Result<(Visits, Vec<[f64; 2]>), PassageError> {
    let angles: Vec<bool> = space.axes().iter().map(Axis::is_closed).collect();
    let laid = LaidOut::new((system, space), region, density)?;
    let by_modes = change_by_modes(space, &density, region)?;
    let (cells, density) = match &laid {
        Some(laid) => (&laid.space, laid.density(density.planes)),
        None => (space, density),
    };
    let added = laid.as_ref().map(LaidOut::added).unwrap_or_default();
    let others = if laid.is_some() { &[] } else { others };
    let all = [added.as_slice(), others].concat();
    let largest = |changes: &mut dyn Iterator<Item = f64>| {
        changes.fold(0.0, |most: f64, change| most.max(change.abs()))
    };
    let (mut time_share, mut changes) = mass_beside(cells, &density, region, &all)?;
    let shares = changes.split_off(added.len());
    time_share.1 += largest(&mut changes.into_iter()) + by_modes;
    let axes = cells.axes().iter();
    let cut = axes.filter(|axis| !axis.is_modes()).count();
    let intervals = if cut > 2 {
        INTERVALS_OF_SEVERAL
    } else {
        INTERVALS
    };
    let border = |intervals| BorderCrossings::new((system, cells, &angles), region, intervals);
    let (fine, rough) = (border(intervals), border(intervals / 2));
    if fine.is_endless || fine.crossings.is_empty() {
        let visits = Visits {
            time_share,
            entries: None,
            is_endless: fine.is_endless,
        };
        return Ok((
            visits,
            shares.into_iter().map(|share| [share, 0.0]).collect(),
        ));
    }
    let (own, (rate, error)) = rate([&fine, &rough], density);
    let error = error + largest(&mut added.iter().map(|values| dot(&own, values)));
    let least = rate - error;
    let entries = (least > 0.0).then(|| {
        let visit = time_share.0 / rate;
        let longest = (time_share.0 + time_share.1) / least;
        [(rate, error), (visit, longest - visit)]
    });
    let visits = Visits {
        time_share,
        entries,
        is_endless: false,
    };
    let both = shares.into_iter().zip(others);
    let of_others = both.map(|(share, values)| [share, dot(&own, values)]);
    Ok((visits, of_others.collect()))
}

/// Entries per unit of time over a border that is met at many places and at fewer, with an error; before it, what one
/// unit of the steady state's unknowns in each cell adds to it.
fn rate(
    [fine, rough]: [&BorderCrossings<'_>; 2],
    density: KnownDensity<'_>,
) -> (Vec<f64>, WithError) {
    let space = fine.space;
    let volumes = local_volumes(space);
    let of_cells = |border: &BorderCrossings<'_>, nodes: usize| {
        let weights = border.weights(nodes).into_iter().zip(&volumes);
        weights.map(|(weight, volume)| weight / volume).collect()
    };
    let own: Vec<f64> = of_cells(fine, NODES);
    let rate = dot(&own, density.unknowns);
    let others = [of_cells(fine, FEWER_NODES), of_cells(rough, NODES)];
    let others = others.map(|other: Vec<f64>| (dot(&other, density.unknowns) - rate).abs());
    let changed = density.changes.map_or(0.0, |changes| {
        // What the changes do were those of neighbouring layers of cells independent: their sum may vanish by chance.
        let roughness = Roughness {
            space,
            weights: density.unknowns,
            differences: changes,
            planes: density.planes,
        };
        let centred: Vec<f64> = own.iter().map(|value| value - rate).collect();
        dot(&own, changes).abs() + roughness.of(&centred)
    });
    let returning = density.returning.map_or(0.0, |values| dot(&own, values));
    let of_ends = density.of_ends(returning, rate);
    let error = others.iter().sum::<f64>() + changed + of_ends;
    (own, (rate, error))
}

/// Whether noise acts across the border of a region somewhere within the cells, so that it is crossed infinitely often.
pub(crate) fn is_endless(
    (system, space): (&dyn System, &CellSpace),
    region: &BoundQuantity,
) -> bool {
    let angles: Vec<bool> = space.axes().iter().map(Axis::is_closed).collect();
    let laid = space_of((system, space), region).ok().flatten();
    let cells = (system, laid.as_ref().unwrap_or(space), angles.as_slice());
    BorderCrossings::new(cells, region, 1).is_endless
}

/// A state on the border.
struct Crossing {
    state: [f64; MAX_DIMENSION],
    /// What a density of one there adds to the rate of entries.
    weight: f64,
}

/// All crossings of lines with the border of a region at which processes enter.
struct BorderCrossings<'a> {
    system: &'a dyn System,
    space: &'a CellSpace,
    /// Of each axis, whether its ends are one place.
    angles: &'a [bool],
    region: &'a BoundQuantity,
    crossings: Vec<Crossing>,
    is_endless: bool,
}

impl<'a> BorderCrossings<'a> {
    fn new(
        (system, space, angles): (&'a dyn System, &'a CellSpace, &'a [bool]),
        region: &'a BoundQuantity,
        intervals: usize,
    ) -> Self {
        let mut border = Self {
            system,
            space,
            angles,
            region,
            crossings: Vec::new(),
            is_endless: false,
        };
        for axis in 0..space.dimension() {
            if !space.axes()[axis].is_modes() {
                border.cross_along(axis, intervals);
            }
        }
        border
    }

    /// What a density of one at each node adds to the rate of entries, by polynomials through so many nodes an axis.
    fn weights(&self, nodes: usize) -> Vec<f64> {
        let (space, all) = (self.space, vec![true; self.space.n_cells()]);
        let mut weights = vec![0.0; all.len()];
        for one in &self.crossings {
            let state = &one.state[..space.dimension()];
            add_state(space, &all, (state, one.weight), nodes, &mut weights);
        }
        weights
    }

    /// Adds the crossings of all lines along an axis.
    fn cross_along(&mut self, axis: usize, intervals: usize) {
        let others: Vec<usize> = (0..self.space.dimension())
            .filter(|&other| other != axis)
            .collect();
        let points: Vec<Vec<(f64, f64)>> = others
            .iter()
            .map(|&other| points(&self.space.axes()[other], intervals))
            .collect();
        let count: usize = points.iter().map(Vec::len).product();
        for number in 0..count {
            let (mut rest, mut share) = (number, 1.0);
            let mut state = [0.0; MAX_DIMENSION];
            for (&other, points) in others.iter().zip(&points) {
                let (x, width) = points[rest % points.len()];
                rest /= points.len();
                state[other] = x;
                share *= width;
            }
            self.cross_line(axis, state, share);
        }
    }

    /// Adds the crossings of a line along an axis; it stands for a share of the other axes.
    fn cross_line(&mut self, axis: usize, mut state: [f64; MAX_DIMENSION], share: f64) {
        let (space, region) = (self.space, self.region);
        let dimension = space.dimension();
        let level = |x: f64| {
            let mut there = state;
            there[axis] = x;
            region.at(&there[..dimension])
        };
        let edges = space.axes()[axis].edges();
        let levels: Vec<f64> = edges.iter().map(|&x| level(x)).collect();
        // The line between two places, as shares of the way.
        let between = |[low, high]: [(f64, f64); 2]| {
            let at = |share: f64| low.0 + share * (high.0 - low.0);
            at(crossing(
                &|share| level(at(share)),
                [(0.0, low.1), (1.0, high.1)],
            ))
        };
        let mut found = Vec::new();
        for cell in 0..levels.len() - 1 {
            let ends = [cell, cell + 1].map(|edge| (edges[edge], levels[edge]));
            let before = cell.checked_sub(1).map(|edge| levels[edge]);
            let [low, high] = ends.map(|end| end.1);
            if (low < 0.0) != (high < 0.0) {
                found.push(between(ends));
            } else if may_dip(before, [low, high], levels.get(cell + 2).copied())
                && let Some(place) = dip(&mut |x| level(x), ends)
            {
                let lowest = (place, level(place));
                found.extend([between([ends[0], lowest]), between([lowest, ends[1]])]);
            }
        }
        for x in found {
            state[axis] = x;
            self.cross_at(axis, state, share);
        }
        let [first, last] = [levels[0], levels[levels.len() - 1]].map(|level| level < 0.0);
        if self.angles[axis] && first != last {
            state[axis] = edges[0];
            self.cross_seam(axis, state, (share, first));
        }
    }

    /// Adds the crossing of the place where an angle's range ends and begins anew, at a state there: the region is on
    /// one side of it alone, at the lower end or at the upper one.
    fn cross_seam(
        &mut self,
        axis: usize,
        state: [f64; MAX_DIMENSION],
        (share, is_lower): (f64, bool),
    ) {
        let place = &state[..self.space.dimension()];
        let speed = self.system.drift_at(0.0, place)[axis];
        self.is_endless |= self.system.intensity_at(axis, 0.0, place) > 0.0;
        let entering = if is_lower { speed } else { -speed };
        if entering > 0.0 {
            self.crossings.push(Crossing {
                state,
                weight: share * entering,
            });
        }
    }

    /// Adds a crossing at a state on the border.
    fn cross_at(&mut self, axis: usize, state: [f64; MAX_DIMENSION], share: f64) {
        let dimension = self.space.dimension();
        let place = &state[..dimension];
        let slopes = self.slopes(state);
        // Slopes count by what they are across a cell.
        let sized = |other: usize| (slopes[other].0 * slopes[other].1).abs();
        let largest = (0..dimension).map(sized).fold(0.0, f64::max);
        let squares: f64 = (0..dimension).map(|other| sized(other).powi(2)).sum();
        if sized(axis) <= ROUNDING * largest {
            return;
        }
        let drift = self.system.drift_at(0.0, place);
        let mut change = 0.0;
        for (other, (slope, _)) in slopes.iter().enumerate().take(dimension) {
            if sized(other) <= ROUNDING * largest {
                continue;
            }
            change += slope * drift[other];
            self.is_endless |= self.system.intensity_at(other, 0.0, place) > 0.0;
        }
        let weight = share * sized(axis).powi(2) / squares / slopes[axis].0.abs();
        if change < 0.0 {
            self.crossings.push(Crossing {
                state,
                weight: -change * weight,
            });
        }
    }

    /// Derivatives of the level along each axis, with the widths of the cells there.
    fn slopes(&self, state: [f64; MAX_DIMENSION]) -> [(f64, f64); MAX_DIMENSION] {
        let mut slopes = [(0.0, 0.0); MAX_DIMENSION];
        let axes = self.space.axes().iter().enumerate();
        for (index, axis) in axes {
            let width = (axis.to() - axis.from()) / axis.count() as f64;
            let step = STEP * width;
            let [low, high] = [-step, step].map(|step| {
                let mut beside = state;
                beside[index] += step;
                self.region.at(&beside[..self.space.dimension()])
            });
            slopes[index] = ((high - low) / (2.0 * step), width);
        }
        slopes
    }
}

/// Coordinates along an axis across lines, with the lengths that they stand for: Gauss points of parts of cells, or the
/// nodes of modes.
fn points(axis: &Axis, intervals: usize) -> Vec<(f64, f64)> {
    if axis.is_modes() {
        let nodes = axis.nodes().iter().enumerate();
        return nodes
            .map(|(node, &x)| (x, axis.node_stretch(node)))
            .collect();
    }
    let cells = axis.edges().windows(2);
    let parts = cells.flat_map(|ends| {
        let width = (ends[1] - ends[0]) / intervals as f64;
        let from = ends[0];
        (0..intervals).map(move |part| (from + part as f64 * width, width))
    });
    parts
        .flat_map(|(from, width)| GAUSS.map(|share| (from + share * width, 0.5 * width)))
        .collect()
}
