//! A start that is spread as a density: its mass in a region, brought from the cells of the density to those of a
//! passage.

use super::spread::{LINES, Point, Spread};
use crate::space::CellSpace;
use crate::space::nodes::NODES;

/// Most points at which a density is known at once; cells are taken one by one where there are more.
const MOST_POINTS: usize = 1 << 22;

/// Lines along another axis of a cell that a border cuts where cells have more than two axes.
const LINES_OF_SEVERAL: usize = LINES / 2;

/// The masses of several densities (at the nodes of `cells`, times local volumes) where `region` is negative, by
/// polynomials through so many nodes an axis; `levels` are those of the region at the nodes.
pub(super) fn masses_in(
    cells: &CellSpace,
    densities: &[&[f64]],
    (region, levels): (impl Fn(&[f64]) -> f64, &[f64]),
    nodes: usize,
) -> Vec<f64> {
    let axes = cells.axes().iter().filter(|axis| !axis.is_modes());
    let lines = match axes.count() {
        0..=2 => LINES,
        _ => LINES_OF_SEVERAL,
    };
    let of = |unknowns| Spread {
        cells,
        unknowns,
        region: &region,
        lines: if nodes == NODES { lines } else { lines / 2 },
        nodes,
    };
    let (is_whole, cut) = of(&[]).parts(levels);
    let places = of(&[]).points();
    let is_even = places.iter().map(Vec::len).product::<usize>() <= MOST_POINTS;
    let total = |points: Vec<Point>, spread: &Spread<'_, _>| -> f64 {
        spread.masses(points).map(|(_, mass)| mass).sum()
    };
    let masses = densities.iter().map(|unknowns| {
        let spread = of(unknowns);
        let of_cut = total(cut.clone(), &spread);
        let of_whole: f64 = match is_even {
            true => spread.masses_of_whole(&places, &is_whole).iter().sum(),
            false => (0..is_whole.len())
                .filter(|&cell| is_whole[cell])
                .map(|cell| total(spread.whole(cell), &spread))
                .sum(),
        };
        of_cut + of_whole
    });
    masses.collect()
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
        let (is_whole, cut) = spread.parts(levels);
        let cut = spread.masses(cut).collect();
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
