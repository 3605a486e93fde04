//! What surrounds what in a joint density: rims of craters, rings (rims of constant height), and the peaks inside.
//!
//! A basin that higher ground encloses spills over at a saddle. The cells at least as high as the saddle that hang
//! together with it are its *rim*. Where the highest point of the rim is no higher than the saddle, within the errors
//! of both, the maximum lies along a closed curve: a *ring*, which has no peak of its own.

use super::persistence::CellValues;
use crate::space::Axis;

/// The rim of a basin.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Enclosure {
    /// The highest cell of the rim.
    pub(super) top: usize,
    /// For each cell of the grid where it lies.
    sides: Vec<Side>,
}

/// Where a cell lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Inside,
    Rim,
    Outside,
}

impl Enclosure {
    /// The rim that closes at a saddle of the grid.
    pub(super) fn at(grid: CellValues<'_>, saddle: usize) -> Self {
        let level = grid.values[saddle];
        let mut sides = vec![Side::Inside; grid.values.len()];
        let mut top = saddle;
        sides[saddle] = Side::Rim;
        let mut open = vec![saddle];
        while let Some(cell) = open.pop() {
            if grid.values[cell] > grid.values[top] {
                top = cell;
            }
            for next in neighbours(grid, cell, true) {
                if sides[next] == Side::Inside && grid.values[next] >= level {
                    sides[next] = Side::Rim;
                    open.push(next);
                }
            }
        }
        let at_border = |cell: usize| {
            let (row, column) = (cell / grid.columns, cell % grid.columns);
            row == 0 || column == 0 || row + 1 == grid.rows || column + 1 == grid.columns
        };
        open.extend(
            (0..sides.len()).filter(|&cell| at_border(cell) && sides[cell] == Side::Inside),
        );
        for &cell in &open {
            sides[cell] = Side::Outside;
        }
        while let Some(cell) = open.pop() {
            for next in neighbours(grid, cell, false) {
                if sides[next] == Side::Inside {
                    sides[next] = Side::Outside;
                    open.push(next);
                }
            }
        }
        Self { top, sides }
    }

    /// The middle of what lies within the rim: one coordinate an axis.
    pub(super) fn middle(&self, axes: &[Axis]) -> Vec<f64> {
        let columns = axes.last().map_or(1, Axis::count);
        let (mut sums, mut area) = ([0.0; 2], 0.0);
        for (cell, _) in self
            .sides
            .iter()
            .enumerate()
            .filter(|one| *one.1 == Side::Inside)
        {
            let (row, column) = (cell / columns, cell % columns);
            let weight = axes[0].width(row) * axes[1].width(column);
            sums[0] += weight * axes[0].centre(row);
            sums[1] += weight * axes[1].centre(column);
            area += weight;
        }
        sums.iter().map(|sum| sum / area).collect()
    }

    /// Whether a cell belongs to the rim.
    pub(super) fn is_rim(&self, cell: usize) -> bool {
        self.sides[cell] == Side::Rim
    }

    /// Whether a cell lies within the rim.
    pub(super) fn holds(&self, cell: usize) -> bool {
        self.sides[cell] == Side::Inside
    }
}

/// Cells beside a cell: across its faces, or also across its corners. Rims are connected across corners, what lies on
/// either side of them only across faces.
fn neighbours(grid: CellValues<'_>, cell: usize, corners: bool) -> impl Iterator<Item = usize> {
    let (row, column) = (cell / grid.columns, cell % grid.columns);
    let rows = row.saturating_sub(1)..(row + 2).min(grid.rows);
    rows.flat_map(move |r| {
        let columns = column.saturating_sub(1)..(column + 2).min(grid.columns);
        columns.map(move |c| (r, c))
    })
    .filter(move |&(r, c)| {
        let steps = r.abs_diff(row) + c.abs_diff(column);
        steps == 1 || (corners && steps == 2)
    })
    .map(move |(r, c)| r * grid.columns + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_divides_inside_from_outside() {
        // A wall one cell from the border of 9 × 9, with a gap of height 1, a tower beside it, and one in the middle.
        let mut values = [0.0; 81];
        for at in 1..8 {
            for cell in [9 + at, 63 + at, 9 * at + 1, 9 * at + 7] {
                values[cell] = 2.0;
            }
        }
        let (gap, tower, middle) = (63 + 4, 80, 9 * 4 + 4);
        (values[gap], values[tower], values[middle]) = (1.0, 4.0, 5.0);
        let grid = CellValues {
            rows: 9,
            columns: 9,
            values: &values,
        };
        let rim = Enclosure::at(grid, gap);
        assert!(rim.is_rim(gap) && rim.is_rim(10) && !rim.holds(10));
        assert!(rim.holds(middle) && rim.holds(20) && !rim.is_rim(middle));
        assert!(!rim.holds(0) && !rim.is_rim(0));
        assert_eq!(
            rim.top, tower,
            "hangs together with the wall across a corner"
        );
    }
}
