//! Persistence of peaks and craters on a grid by union-find (Edelsbrunner & Harer, *Computational
//! Topology*, 2010, ch. VII).
//!
//! Lower a level through the density. A component of the superlevel set {p ≥ level} is *born* at a local
//! maximum and *dies* at the cell (a saddle) where it meets one that was born higher; its persistence is
//! the difference. Raising the level instead gives the local minima of the sublevel sets; the outside of the grid
//! counts as lower than everything and is joined to the border, so that a basin open to the border is no
//! crater. By Alexander duality these craters are the holes of the superlevel sets, provided that superlevel sets are
//! 8-connected and sublevel sets 4-connected: else a diagonal pair would both join and separate.
//!
//! Of components that are born equally high the one that the level reaches first is the elder: the highest peak, which
//! is named apart, must not die too. Persistences are the same whichever is, and a plateau makes components of
//! persistence zero, which are dropped. Hence mirroring or transposing the grid leaves the persistences as they are, to
//! the last bit.

use crate::density::EstimatedDensity;

/// A component of the superlevel (sublevel) sets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Component {
    /// Cell of the local maximum (minimum).
    pub(super) birth: usize,
    /// The saddle where it merges; `None` for the highest peak, which never does.
    pub(super) death: Option<usize>,
    /// Difference of the values at birth and death, positive; over zero for the highest peak.
    pub(super) persistence: f64,
}

/// Values on a grid of `rows × columns` cells, the last axis fastest; one row for a marginal.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellValues<'a> {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) values: &'a [f64],
}

/// The grid of a density, unless it cannot have features.
pub(super) fn grid(estimated: &EstimatedDensity) -> Option<CellValues<'_>> {
    let values = &estimated.density.values;
    let (rows, columns) = match estimated.density.axes.as_slice() {
        [axis] => (1, axis.count()),
        [first, second] => (first.count(), second.count()),
        _ => return None,
    };
    let is_whole = values.len() == rows * columns && estimated.standard_error.len() == values.len();
    let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
    let usable = is_whole && finite(values) && finite(&estimated.standard_error);
    (usable && estimated.density.maximum() > 0.0).then_some(CellValues {
        rows,
        columns,
        values,
    })
}

/// Steps to the neighbours of a cell; the first four are those across a face.
const STEPS: [(isize, isize); 8] = [
    (-1, 0),
    (0, -1),
    (0, 1),
    (1, 0),
    (-1, -1),
    (-1, 1),
    (1, -1),
    (1, 1),
];

/// Mark of a cell that the level has not reached.
const UNREACHED: u32 = u32::MAX;

/// Peaks and craters of a grid, each in the order of death, the highest peak last. All values finite.
pub(super) fn components(grid: CellValues<'_>) -> (Vec<Component>, Vec<Component>) {
    let order = descending(grid.values);
    let value = |cell: u32| grid.values[cell as usize];
    let mut peaks = Forest::new(grid, &STEPS, false).grow(order.iter().copied());
    if let Some(&highest) = order.first() {
        peaks.push(Component {
            birth: highest as usize,
            death: None,
            persistence: value(highest),
        });
    }
    // On a single row every cell is at the border: no craters.
    let craters = if grid.rows < 3 || grid.columns < 3 {
        Vec::new()
    } else {
        Forest::new(grid, &STEPS[..4], true).grow(order.iter().rev().copied())
    };
    (peaks, craters)
}

/// Cells by falling value, ties by number.
fn descending(values: &[f64]) -> Vec<u32> {
    // The bits of a float, with the sign bit turned (all bits, of a negative one), sort as the numbers do;
    // sorting keys beside their cells is several times faster than looking values up.
    let key = |value: f64| {
        let bits = value.to_bits();
        let ascending = if bits >> 63 == 1 {
            !bits
        } else {
            bits | 1 << 63
        };
        !ascending
    };
    let cells = values.iter().zip(0u32..);
    let mut keyed: Vec<(u64, u32)> = cells.map(|(&value, cell)| (key(value), cell)).collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, cell)| cell).collect()
}

/// Union-find over the cells that the level has reached. The root of a tree is the cell of its birth; the
/// outside is one more node, elder than all cells.
struct Forest<'a> {
    grid: CellValues<'a>,
    steps: &'static [(isize, isize)],
    outside_joined: bool,
    parent: Vec<u32>,
}

impl<'a> Forest<'a> {
    fn new(grid: CellValues<'a>, steps: &'static [(isize, isize)], outside_joined: bool) -> Self {
        let outside = grid.values.len();
        let mut parent = vec![UNREACHED; outside + 1];
        parent[outside] = outside as u32;
        Self {
            grid,
            steps,
            outside_joined,
            parent,
        }
    }

    fn root(&mut self, mut node: u32) -> u32 {
        while self.parent[node as usize] != node {
            let grandparent = self.parent[self.parent[node as usize] as usize];
            self.parent[node as usize] = grandparent;
            node = grandparent;
        }
        node
    }

    /// Components that die as the level reaches the cells in the given order.
    fn grow(mut self, order: impl Iterator<Item = u32>) -> Vec<Component> {
        let outside = self.grid.values.len() as u32;
        let mut deaths = Vec::new();
        for cell in order {
            let (row, column) = (
                cell as usize / self.grid.columns,
                cell as usize % self.grid.columns,
            );
            let at_border = row == 0
                || column == 0
                || row + 1 == self.grid.rows
                || column + 1 == self.grid.columns;
            let mut root = UNREACHED;
            for &(down, right) in self.steps {
                if at_border && !self.is_inside(row, column, down, right) {
                    continue;
                }
                let offset = down * self.grid.columns as isize + right;
                let neighbour = cell.wrapping_add_signed(offset as i32);
                if self.parent[neighbour as usize] != UNREACHED {
                    let other = self.root(neighbour);
                    root = self.join(cell, root, other, &mut deaths);
                }
            }
            if at_border && self.outside_joined {
                root = self.join(cell, root, outside, &mut deaths);
            }
            self.parent[cell as usize] = if root == UNREACHED { cell } else { root };
        }
        deaths
    }

    /// Whether a step from a cell stays on the grid.
    fn is_inside(&self, row: usize, column: usize, down: isize, right: isize) -> bool {
        let on = |at: usize, step: isize, count: usize| {
            at.checked_add_signed(step).is_some_and(|at| at < count)
        };
        on(row, down, self.grid.rows) && on(column, right, self.grid.columns)
    }

    /// Whether the level reaches a cell before another one, the outside before all. Heights over where they meet would
    /// not tell: values that differ in the last bit may have the same.
    fn is_reached_before(&self, one: u32, other: u32) -> bool {
        let outside = self.grid.values.len() as u32;
        if one == outside || other == outside {
            return one == outside;
        }
        let [here, there] = [one, other].map(|cell| self.grid.values[cell as usize]);
        let is_before = there.total_cmp(&here).then(one.cmp(&other)).is_lt();
        // Craters are reached from below.
        is_before != self.outside_joined
    }

    /// Joins two trees at a cell and returns the root of both; the younger one dies.
    fn join(&mut self, cell: u32, root: u32, other: u32, deaths: &mut Vec<Component>) -> u32 {
        if root == UNREACHED || root == other {
            return other;
        }
        let outside = self.grid.values.len() as u32;
        let values = self.grid.values;
        let age = |root: u32| {
            if root == outside {
                f64::INFINITY
            } else {
                (values[root as usize] - values[cell as usize]).abs()
            }
        };
        let (elder, younger) = if self.is_reached_before(other, root) {
            (other, root)
        } else {
            (root, other)
        };
        self.parent[younger as usize] = elder;
        if age(younger) > 0.0 {
            deaths.push(Component {
                birth: younger as usize,
                death: Some(cell as usize),
                persistence: age(younger),
            });
        }
        elder
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn of_peaks_as_high_as_each_other_each_is_found_once() {
        // Heights over the valley are equal to the last bit for values that are not, and for those that are; either
        // peak may be the first neighbour of the cell where they meet.
        let next = f64::from_bits(0.495_5_f64.to_bits() + 1);
        for bits in 0..40 {
            let valley = f64::from_bits(0.243_9_f64.to_bits() + bits);
            for [left, right] in [[0.495_5, next], [next, 0.495_5], [next, next]] {
                let row = [0.1, left, valley, valley, right, 0.1];
                for (rows, columns) in [(1, 6), (6, 1)] {
                    let grid = CellValues {
                        rows,
                        columns,
                        values: &row,
                    };
                    let mut births: Vec<usize> =
                        components(grid).0.iter().map(|one| one.birth).collect();
                    births.sort_unstable();
                    assert_eq!(births, [1, 4], "{left} {valley} {right}");
                }
            }
        }
        // Two peaks that meet at a cell which sees the later one first.
        let values = [
            0.0, 0.0, 0.0, 0.0, //
            0.0, 0.2, 0.4, 0.9, //
            0.0, 0.9, 0.4, 0.2, //
            0.0, 0.0, 0.0, 0.0,
        ];
        let grid = CellValues {
            rows: 4,
            columns: 4,
            values: &values,
        };
        let mut births: Vec<usize> = components(grid).0.iter().map(|one| one.birth).collect();
        births.sort_unstable();
        assert_eq!(births, [7, 9]);
    }

    /// Connected regions of the marked cells of a grid, by flooding.
    fn regions(marked: &[bool], columns: usize, steps: &[(isize, isize)]) -> usize {
        let rows = marked.len() / columns;
        let mut left = marked.to_vec();
        let mut count = 0;
        while let Some(start) = left.iter().position(|&cell| cell) {
            count += 1;
            let mut stack = vec![start];
            while let Some(cell) = stack.pop() {
                if !std::mem::take(&mut left[cell]) {
                    continue;
                }
                for &(down, right) in steps {
                    let row = (cell / columns) as isize + down;
                    let column = (cell % columns) as isize + right;
                    if (0..rows as isize).contains(&row) && (0..columns as isize).contains(&column)
                    {
                        stack.push(row as usize * columns + column as usize);
                    }
                }
            }
        }
        count
    }

    /// Components and holes of {p ≥ level}: holes are regions of the rest that a frame of outside cells does
    /// not reach.
    fn count_at(grid: CellValues<'_>, level: f64) -> (usize, usize) {
        let above: Vec<bool> = grid.values.iter().map(|&value| value >= level).collect();
        let width = grid.columns + 2;
        let mut below = vec![true; (grid.rows + 2) * width];
        for (cell, &above) in above.iter().enumerate() {
            below[(cell / grid.columns + 1) * width + cell % grid.columns + 1] = !above;
        }
        let holes = regions(&below, width, &STEPS[..4]) - 1;
        (regions(&above, grid.columns, &STEPS), holes)
    }

    fn check_against_flooding(grid: CellValues<'_>) -> Result<(), TestCaseError> {
        let (peaks, craters) = components(grid);
        let value = |cell: usize| grid.values[cell];
        for &level in grid.values {
            let alive = peaks.iter().filter(|peak| {
                value(peak.birth) >= level && peak.death.is_none_or(|cell| value(cell) < level)
            });
            let open = craters.iter().filter(|crater| {
                value(crater.birth) < level && crater.death.is_some_and(|cell| value(cell) >= level)
            });
            prop_assert_eq!((alive.count(), open.count()), count_at(grid, level));
        }
        for component in peaks.iter().chain(&craters) {
            if let Some(death) = component.death {
                let difference = (value(component.birth) - value(death)).abs();
                prop_assert_eq!(component.persistence, difference);
            }
        }
        Ok(())
    }

    fn sorted(components: &[Component]) -> Vec<f64> {
        let mut persistences: Vec<f64> = components.iter().map(|c| c.persistence).collect();
        persistences.sort_by(f64::total_cmp);
        persistences
    }

    #[test]
    fn cells_are_sorted_by_falling_value_whatever_the_sign() {
        let values = [0.5, -2.0, 3.0, 0.5, -0.1, 1e-300, -1e300];
        assert_eq!(descending(&values), [2, 0, 3, 5, 4, 1, 6]);
    }

    proptest! {
        // Few distinct values make plateaus and ties; many make none.
        #[test]
        fn counts_at_every_level_are_those_of_flooding(
            rows in 1usize..9, columns in 1usize..9, distinct in 2u32..60,
            raw in prop::collection::vec(any::<u32>(), 64),
        ) {
            let values: Vec<f64> = raw[..rows * columns].iter().map(|v| (v % distinct) as f64).collect();
            check_against_flooding(CellValues { rows, columns, values: &values })?;
        }

        #[test]
        fn mirroring_and_transposing_leave_persistences_even_with_ties(
            rows in 3usize..9, columns in 3usize..9, distinct in 2u32..12,
            raw in prop::collection::vec(any::<u32>(), 64),
        ) {
            let values: Vec<f64> = raw[..rows * columns].iter().map(|v| (v % distinct) as f64).collect();
            let mirrored: Vec<f64> = values.chunks(columns).flat_map(|row| row.iter().rev().copied()).collect();
            let transposed: Vec<f64> = (0..rows * columns).map(|i| values[i % rows * columns + i / rows]).collect();
            let (peaks, craters) = components(CellValues { rows, columns, values: &values });
            for (rows, columns, values) in [(rows, columns, &mirrored), (columns, rows, &transposed)] {
                let (other_peaks, other_craters) = components(CellValues { rows, columns, values });
                prop_assert_eq!(sorted(&peaks), sorted(&other_peaks));
                prop_assert_eq!(sorted(&craters), sorted(&other_craters));
            }
        }
    }
}
