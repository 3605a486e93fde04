//! Finding cells without branches, for histograms of billions of states. The cells are exactly those of
//! [`Axis::find`](crate::space::Axis::find).
//!
//! A range is cut into bins of equal width. Rounding makes the number of a coordinate's bin uncertain by one, but
//! it is a monotone function of the coordinate; so the cells that can meet a bin follow from the bins *computed*
//! for the edges. A table gives the lowest of them; the right one is as many cells above it as of the next edges
//! lie below the coordinate. Where more than a few cells meet a bin a binary search over a fixed number of cells
//! finds it, one compare and one conditional add a round.

use crate::space::{Axis, CellSpace};
use crate::system::LANES;

/// Most bins of an axis: 32 KB of table, which stay in the cache.
const MOST_BINS: usize = 8192;

/// Cells that may meet one bin before the number of bins is doubled.
const FEW: usize = 4;

/// One axis prepared for lookups.
#[derive(Debug, Clone)]
struct AxisLookup {
    from: f64,
    to: f64,
    /// Bins per unit length.
    scale: f64,
    /// Lowest cell that meets each bin.
    lowest: Vec<u32>,
    /// Largest number of cells that meet one bin.
    candidates: usize,
    /// The lower edges of the cells, and then as many infinities as a search may reach.
    edges: Vec<f64>,
}

impl AxisLookup {
    fn new(axis: &Axis) -> Self {
        let mut bins = axis.count();
        let mut lookup = Self::with_bins(axis, bins);
        while lookup.candidates > FEW && 2 * bins <= MOST_BINS {
            bins *= 2;
            lookup = Self::with_bins(axis, bins);
        }
        lookup
    }

    fn with_bins(axis: &Axis, bins: usize) -> Self {
        let count = axis.count();
        let (from, to) = (axis.from(), axis.to());
        let scale = bins as f64 / (to - from);
        let bin_of = |x: f64| (((x - from) * scale) as usize).min(bins - 1);
        let of_edges: Vec<usize> = axis.edges().iter().map(|&edge| bin_of(edge)).collect();
        // A coordinate in bin b and cell c has bin(lower edge of c) ≤ b ≤ bin(upper edge of c).
        let lowest = |bin: usize| {
            of_edges[1..]
                .partition_point(|&upper| upper < bin)
                .min(count - 1)
        };
        let highest = |bin: usize| of_edges[..count].partition_point(|&lower| lower <= bin) - 1;
        let candidates = (0..bins).map(|bin| highest(bin) - lowest(bin) + 1).max();
        let candidates = candidates.unwrap_or(1);
        let mut edges = axis.edges()[..count].to_vec();
        edges.extend(std::iter::repeat_n(f64::INFINITY, candidates.max(FEW)));
        Self {
            from,
            to,
            scale,
            lowest: (0..bins).map(|bin| lowest(bin) as u32).collect(),
            candidates,
            edges,
        }
    }

    /// Cell of a coordinate, and whether it lies in the range at all.
    #[inline(always)]
    fn find(&self, x: f64) -> (usize, bool) {
        let inside = x >= self.from && x <= self.to;
        // Converting saturates, and makes 0 of what is not a number.
        let bin = (((x - self.from) * self.scale) as u32 as usize).min(self.lowest.len() - 1);
        let mut cell = self.lowest[bin] as usize;
        if self.candidates <= FEW {
            // As many of the next edges as lie below: compares that do not wait for each other, and no branch.
            let next = &self.edges[cell + 1..cell + FEW];
            let below = next.iter().map(|&edge| usize::from(x >= edge));
            return (cell + below.sum::<usize>(), inside);
        }
        let mut candidates = self.candidates;
        while candidates > 1 {
            let half = candidates / 2;
            cell += half * usize::from(x >= self.edges[cell + half]);
            candidates -= half;
        }
        (cell, inside)
    }
}

/// A cell space prepared for lookups.
#[derive(Debug, Clone)]
pub(crate) struct CellLookup {
    axes: Vec<(AxisLookup, usize)>,
    n_cells: usize,
}

impl CellLookup {
    pub(crate) fn new(space: &CellSpace) -> Self {
        let mut stride = space.n_cells();
        let axis = |axis: &Axis| {
            stride /= axis.count();
            (AxisLookup::new(axis), stride)
        };
        Self {
            axes: space.axes().iter().map(axis).collect(),
            n_cells: space.n_cells(),
        }
    }

    /// Number of cells; also the number that stands for the sink.
    pub(crate) fn n_cells(&self) -> usize {
        self.n_cells
    }

    /// Cells of a batch; the sink's number for states outside Ω and those that are not numbers.
    #[inline(always)]
    pub(crate) fn find(&self, states: &[[f64; LANES]], cells: &mut [usize; LANES]) {
        self.find_along(states, cells, |_, _, _| {});
    }

    /// The same, with the position along each axis of each state, that of the nearest cell beyond Ω.
    #[inline(always)]
    pub(super) fn find_positions(
        &self,
        states: &[[f64; LANES]],
        cells: &mut [usize; LANES],
        positions: &mut [[usize; LANES]],
    ) {
        self.find_along(states, cells, |axis, lane, cell| {
            positions[axis][lane] = cell
        });
    }

    #[inline(always)]
    fn find_along(
        &self,
        states: &[[f64; LANES]],
        cells: &mut [usize; LANES],
        mut tell: impl FnMut(usize, usize, usize),
    ) {
        cells.fill(0);
        let mut outside = [false; LANES];
        for (number, (lanes, (axis, stride))) in states.iter().zip(&self.axes).enumerate() {
            for lane in 0..LANES {
                let (cell, inside) = axis.find(lanes[lane]);
                tell(number, lane, cell);
                cells[lane] += stride * cell;
                outside[lane] |= !inside;
            }
        }
        for lane in 0..LANES {
            cells[lane] = if outside[lane] {
                self.n_cells
            } else {
                cells[lane]
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grading;
    use proptest::prelude::*;

    fn graded(from: f64, to: f64, count: usize, at: Vec<f64>, smallest: f64) -> Axis {
        Axis::graded(from, to, count, &Grading { at, smallest }).unwrap()
    }

    fn axes() -> Vec<Axis> {
        vec![
            Axis::uniform(-3.0, 3.0, 50).unwrap(),
            Axis::uniform(0.1, 0.7, 7).unwrap(),
            graded(-5.5, 5.5, 100, vec![0.0], 0.002),
            graded(-1.0, 2.0, 60, vec![-1.0, 0.3], 1e-5),
        ]
    }

    fn assert_same(axis: &Axis, lookup: &AxisLookup, x: f64) {
        let (cell, inside) = lookup.find(x);
        assert_eq!(axis.find(x), inside.then_some(cell), "{x:?}");
    }

    #[test]
    fn edges_and_their_neighbours_fall_into_the_same_cells_as_by_the_axis() {
        for axis in axes() {
            let lookup = AxisLookup::new(&axis);
            for &edge in axis.edges() {
                for x in [edge, edge.next_up(), edge.next_down()] {
                    assert_same(&axis, &lookup, x);
                }
            }
            for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
                assert_same(&axis, &lookup, x);
            }
        }
    }

    #[test]
    fn bins_keep_searches_short() {
        let candidates: Vec<usize> = axes()
            .iter()
            .map(|axis| AxisLookup::new(axis).candidates)
            .collect();
        assert!(candidates[0] <= 3 && candidates[2] <= FEW, "{candidates:?}");
    }

    proptest! {
        #[test]
        fn coordinates_fall_into_the_same_cells_as_by_the_axis(share in -0.1..1.1_f64, near in -1.0..1.0_f64) {
            for axis in axes() {
                let lookup = AxisLookup::new(&axis);
                assert_same(&axis, &lookup, axis.from() + share * (axis.to() - axis.from()));
                assert_same(&axis, &lookup, near.powi(7));
            }
        }

        #[test]
        fn cells_are_those_of_the_cell_space(x in -3.5..3.5_f64, y in -6.0..6.0_f64) {
            let axes = axes();
            let space = CellSpace::new(vec![axes[0].clone(), axes[2].clone()]).unwrap();
            let lookup = CellLookup::new(&space);
            let mut cells = [0; LANES];
            lookup.find(&[[x; LANES], [y; LANES]], &mut cells);
            let expected = space.find(&[x, y]).unwrap_or(space.n_cells());
            prop_assert!(cells.iter().all(|&cell| cell == expected));
        }
    }
}
