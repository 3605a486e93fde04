//! A start that is spread as a density: its mass in a region, brought from the cells of the density to those of a
//! passage.

use super::spread::{LINES, Point, Spread};
use crate::space::CellSpace;
use crate::space::nodes::NODES;

/// Most points at which a density is known at once; cells are taken one by one where there are more.
const MOST_POINTS: usize = 1 << 22;

/// Spreads a density (at the nodes of `cells`, times local volumes), as far as it lies where `region` is negative, over
/// the kept nodes of other cells, with so many nodes an axis about each point; gives the mass that was spread. `levels`
/// are those of the region at the nodes.
pub(super) fn add_density(
    target: (&CellSpace, &[bool]),
    density: (&CellSpace, &[f64]),
    region: (impl Fn(&[f64]) -> f64, &[f64]),
    nodes: usize,
    weights: &mut [f64],
) -> f64 {
    Masses::new(density, region, nodes).add(target, weights)
}

/// The masses of a density in a region, at points that may be spread over the nodes of several grids.
pub(super) struct Masses<'a, R> {
    spread: Spread<'a, R>,
    is_whole: Vec<bool>,
    /// Points of the cells that the border cuts, in cell coordinates, with their masses.
    cut: Vec<Point>,
    /// Of all points of whole cells, their places along each axis and their masses, which are zero in other cells;
    /// `None` where these are too many at once.
    even: Option<(Vec<Vec<f64>>, Vec<f64>)>,
}

impl<'a, R: Fn(&[f64]) -> f64> Masses<'a, R> {
    /// Of a density at the nodes of cells, times local volumes; `levels` are those of the region at the nodes.
    pub(super) fn new(
        (cells, unknowns): (&'a CellSpace, &'a [f64]),
        (region, levels): (R, &[f64]),
        nodes: usize,
    ) -> Self {
        let spread = Spread {
            cells,
            unknowns,
            region,
            lines: if nodes == NODES { LINES } else { LINES / 2 },
            nodes,
        };
        let mut is_whole = vec![false; cells.n_cells()];
        let mut cut = Vec::new();
        let is_near_border = spread.near_border(levels);
        for (cell, &level) in levels.iter().enumerate() {
            let is_inside = level < 0.0;
            let parts = is_near_border[cell].then(|| spread.cut(cell));
            match parts {
                Some(Some(points)) => cut.extend(spread.masses(points)),
                Some(None) => is_whole[cell] = true,
                None => is_whole[cell] = is_inside,
            }
        }
        let points = spread.points();
        let count: usize = points.iter().map(Vec::len).product();
        let even = (count <= MOST_POINTS).then(|| {
            let masses = spread.masses_of_whole(&points, &is_whole);
            (points, masses)
        });
        Self {
            spread,
            is_whole,
            cut,
            even,
        }
    }

    /// Spreads them over the kept nodes of a grid; gives the mass that was spread.
    pub(super) fn add(&self, target: (&CellSpace, &[bool]), weights: &mut [f64]) -> f64 {
        let mut sum = self.spread.add(&self.cut, target, weights);
        if let Some((points, masses)) = &self.even {
            return sum + self.spread.add_even(points, masses, target, weights);
        }
        let cells = 0..self.is_whole.len();
        for cell in cells.filter(|&cell| self.is_whole[cell]) {
            let points: Vec<Point> = self.spread.masses(self.spread.whole(cell)).collect();
            sum += self.spread.add(&points, target, weights);
        }
        sum
    }
}
