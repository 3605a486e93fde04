//! How the masses of cells spread over the bins of a quantity: its density, and its mean.
//!
//! Inside a sub-cell the quantity is taken as quadratic and the density as linear, so that no mass jumps from bin to
//! bin as a point would: the counts of neighbouring bins differ by what the density does. The first moment is exact to
//! fourth order in the sub-cell; what is left is how level lines bend inside the pieces of sub-cells that a bin's edge
//! crosses. Where level lines run along the cells those errors agree from sub-cell to sub-cell, elsewhere they cancel.
//! A second map with coarser sub-cells and polynomials of lower degree shows how much that is.

use super::series_map::layout_axis;
use super::sub_cell_values::{PerAxis, Share, SubCellValues};
use super::sub_cells::SubCells;
use crate::space::{Axis, CellSpace};
use crate::system::{BoundQuantity, LANES, Lanes};

/// What one axis of a watched density is.
#[derive(Debug, Clone)]
pub(crate) enum Coordinate {
    /// A coordinate of the state.
    Axis(usize),
    /// A quantity, over these bins; values beyond them are not counted.
    Quantity(Box<BoundQuantity>, Axis),
}

/// How finely cells are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Detail {
    /// As finely as serves a density without noise.
    Fine,
    /// Twice as coarsely, to see what the cut does.
    Coarse,
    /// For masses that carry noise, which polynomials of high degree would amplify.
    Sampled,
}

/// Sub-cells at most, all together, in the fine cut.
const MOST_SUB_CELLS: f64 = 160_000.0;
/// Parts of a cell along an axis at most: of one axis, and of several.
const MOST_PARTS: [f64; 2] = [64.0, 12.0];

/// Cells that a polynomial in the last cell before an end goes through, for a mean.
const LAST_WINDOW: usize = 3;

impl Detail {
    /// Parts of each cell along every axis.
    fn parts(self, cells: usize, axes: usize) -> usize {
        let share = (MOST_SUB_CELLS / cells as f64).powf(1.0 / axes as f64);
        let fine = share.floor().clamp(2.0, MOST_PARTS[usize::from(axes > 1)]) as usize;
        match self {
            Self::Fine => fine,
            Self::Coarse | Self::Sampled => (fine / 2).max(1),
        }
    }

    /// Cells that a polynomial goes through for a mean: in the last cell before an end few. There most of them lie on
    /// one side, where the density may be larger by many powers of e, and what a polynomial through these makes of the
    /// last cell is weighed most by formulas that grow.
    fn windows_for_means(self) -> [usize; 2] {
        match self {
            Self::Fine => [self.window(), LAST_WINDOW],
            Self::Coarse | Self::Sampled => [self.window(); 2],
        }
    }

    /// Cells that a polynomial goes through.
    fn window(self) -> usize {
        match self {
            Self::Fine => 7,
            Self::Coarse => 5,
            Self::Sampled => 3,
        }
    }
}

/// The four corners of two axes: whether the first one is at its upper end, and whether the second is.
const CORNERS: [[bool; 2]; 4] = [[false, false], [true, false], [false, true], [true, true]];

/// The axes that some coordinates depend on, cut into sub-cells.
#[derive(Debug, Clone)]
struct Cut {
    /// Number of each in the space.
    axes: Vec<usize>,
    sub_cells: SubCells,
    dimension: usize,
}

impl Cut {
    fn new(
        space: &CellSpace,
        coordinates: &[Coordinate],
        (detail, windows): (Detail, [usize; 2]),
        planes: &[(usize, f64)],
    ) -> Self {
        let needs = |axis: usize| {
            coordinates.iter().any(|coordinate| match coordinate {
                Coordinate::Axis(own) => *own == axis,
                Coordinate::Quantity(quantity, _) => {
                    quantity.states().get(axis).copied().unwrap_or(false)
                }
            })
        };
        let axes: Vec<usize> = (0..space.dimension()).filter(|&axis| needs(axis)).collect();
        let cut: Vec<&Axis> = axes.iter().map(|&axis| &space.axes()[axis]).collect();
        let cells = cut.iter().map(|axis| layout_axis(axis).count()).product();
        let place = |number: usize| axes.iter().position(|&axis| axis == number);
        let planes: Vec<(usize, f64)> = planes
            .iter()
            .filter_map(|&(axis, at)| Some((place(axis)?, at)))
            .collect();
        let parts = detail.parts(cells, axes.len());
        Self {
            sub_cells: SubCells::new(&cut, parts, (windows, detail == Detail::Coarse), &planes),
            dimension: space.dimension(),
            axes,
        }
    }

    /// The centre of a sub-cell; along axes that do not take part, the lower end.
    fn centre(&self, number: usize, space: &CellSpace) -> Vec<f64> {
        let mut own = vec![(0.0, 0.0); self.axes.len()];
        self.sub_cells.edges(number, &mut own);
        let mut centre: Vec<f64> = space.axes().iter().map(Axis::from).collect();
        for (&axis, ends) in self.axes.iter().zip(own) {
            centre[axis] = 0.5 * (ends.0 + ends.1);
        }
        centre
    }

    /// Looks at a quantity in every sub-cell, in the order of their numbers.
    fn look(&self, quantity: &BoundQuantity, mut see: impl FnMut(usize, &SubCellValues)) {
        let count = self.sub_cells.count();
        let mut edges = vec![[(0.0, 0.0); LANES]; self.axes.len()];
        let mut own = vec![(0.0, 0.0); self.axes.len()];
        let mut states: Vec<Lanes> = vec![[0.0; LANES]; self.dimension];
        let varied = self.axes.iter().enumerate();
        let varied = varied.filter(|&(_, &axis)| quantity.states()[axis]);
        let varied: Vec<usize> = varied.map(|(index, _)| index).collect();
        for start in (0..count).step_by(LANES) {
            for lane in 0..LANES {
                self.sub_cells
                    .edges((start + lane).min(count - 1), &mut own);
                for (index, &ends) in own.iter().enumerate() {
                    edges[index][lane] = ends;
                    states[self.axes[index]][lane] = 0.5 * (ends.0 + ends.1);
                }
            }
            let centre = quantity.values(&states);
            let mut seen = centre.map(|value| SubCellValues::new(value, self.axes.len()));
            let mut at = |ends: &[(usize, bool)]| {
                let kept = states.clone();
                for &(index, is_high) in ends {
                    let lanes = edges[index].iter().zip(&mut states[self.axes[index]]);
                    lanes.for_each(|(ends, state)| *state = if is_high { ends.1 } else { ends.0 });
                }
                let values = quantity.values(&states);
                states = kept;
                values
            };
            for &one in &varied {
                let ends = [false, true].map(|end| at(&[(one, end)]));
                let lanes = seen.iter_mut().enumerate();
                lanes.for_each(|(lane, seen)| seen.add_ends(one, ends[0][lane], ends[1][lane]));
                for &other in varied.iter().filter(|&&other| other > one) {
                    let corners = CORNERS.map(|[a, b]| at(&[(one, a), (other, b)]));
                    for (lane, seen) in seen.iter_mut().enumerate() {
                        seen.add_corners((one, other), corners.map(|values| values[lane]));
                    }
                }
            }
            for (lane, seen) in seen.iter().enumerate().take(count - start) {
                see(start + lane, seen);
            }
        }
    }
}

/// A sub-cell whose mass falls into one bin.
fn whole(bin: usize) -> Share {
    Share {
        bin,
        mass: 1.0,
        of_change: PerAxis::default(),
    }
}

/// The map from masses of cells to masses of bins, worked out once.
#[derive(Debug, Clone)]
pub(super) struct Spread {
    cut: Cut,
    /// Where the entries of each sub-cell begin.
    starts: Vec<u32>,
    /// The bin of each entry.
    bins: Vec<u32>,
    /// Weights of each entry: of the sub-cell's mass, and of its change along each axis.
    weights: Vec<f64>,
}

impl Spread {
    /// For one or two coordinates.
    pub(super) fn new(
        space: &CellSpace,
        coordinates: &[Coordinate],
        detail: Detail,
        planes: &[(usize, f64)],
    ) -> Self {
        let windows = [detail.window(); 2];
        let cut = Cut::new(space, coordinates, (detail, windows), planes);
        let count = cut.sub_cells.count();
        let seen = |coordinate: &Coordinate| {
            let mut found: Vec<Vec<Share>> = Vec::with_capacity(count);
            match coordinate {
                Coordinate::Axis(axis) => {
                    let place = cut.axes.iter().position(|own| own == axis).unwrap_or(0);
                    found.extend((0..count).map(|number| {
                        let bin = cut.sub_cells.cell(number, place);
                        vec![whole(bin)]
                    }));
                }
                Coordinate::Quantity(quantity, bins) => {
                    let mut own = Vec::new();
                    cut.look(quantity, |_, seen| {
                        seen.shares(bins, &mut own);
                        found.push(own.clone());
                    });
                }
            }
            found
        };
        let columns = match coordinates.get(1) {
            None => 1,
            Some(Coordinate::Axis(axis)) => layout_axis(&space.axes()[*axis]).count(),
            Some(Coordinate::Quantity(_, bins)) => bins.count(),
        };
        let first = coordinates.first().map(&seen).unwrap_or_default();
        let second = coordinates.get(1).map(&seen);
        let mut spread = Self {
            starts: vec![0],
            bins: Vec::new(),
            weights: Vec::new(),
            cut,
        };
        let only = vec![whole(0)];
        for (number, one) in first.iter().enumerate() {
            let other = second.as_ref().map_or(&only, |second| &second[number]);
            spread.add(one, other, columns);
        }
        spread
    }

    /// Adds the entries of the next sub-cell.
    fn add(&mut self, one: &[Share], other: &[Share], columns: usize) {
        for first in one {
            for second in other {
                self.bins.push((first.bin * columns + second.bin) as u32);
                self.weights.push(first.mass * second.mass);
                for axis in 0..self.cut.axes.len() {
                    let [a, b] = [first, second].map(|share| share.of_change[axis]);
                    self.weights.push(a * second.mass + b * first.mass);
                }
            }
        }
        self.starts.push(self.bins.len() as u32);
    }

    /// The axes of the space that take part.
    pub(super) fn axes(&self) -> &[usize] {
        &self.cut.axes
    }

    /// Adds the masses of the bins, from the masses of the cells of the axes that take part.
    pub(super) fn add_masses(&self, masses: &[f64], bins: &mut [f64]) {
        let found = self.cut.sub_cells.apply(masses);
        let stride = 1 + self.cut.axes.len();
        for (number, ends) in self.starts.windows(2).enumerate() {
            for entry in ends[0] as usize..ends[1] as usize {
                let weights = &self.weights[entry * stride..(entry + 1) * stride];
                let terms = weights.iter().zip(&found);
                let mass: f64 = terms.map(|(weight, values)| weight * values[number]).sum();
                bins[self.bins[entry] as usize] += mass;
            }
        }
    }
}

/// The map from masses of cells to mean and standard deviation of a quantity.
#[derive(Debug, Clone)]
pub(super) struct Averages {
    cut: Cut,
    /// Weights of the mass of each sub-cell, and of its change along each axis, for the mean and for the mean square.
    weights: [Vec<f64>; 2],
    /// The centre of a sub-cell whose weights are not all finite.
    undefined: Option<Vec<f64>>,
    /// Which of the axes that take part have cells, by their places.
    with_cells: Vec<usize>,
}

impl Averages {
    pub(super) fn new(
        space: &CellSpace,
        quantity: &BoundQuantity,
        detail: Detail,
        planes: &[(usize, f64)],
    ) -> Self {
        let bins = Axis::uniform(0.0, 1.0, 2);
        let coordinates: Vec<Coordinate> = bins
            .into_iter()
            .map(|bins| Coordinate::Quantity(Box::new(quantity.clone()), bins))
            .collect();
        let windows = detail.windows_for_means();
        let cut = Cut::new(space, &coordinates, (detail, windows), planes);
        let mut weights = [Vec::new(), Vec::new()];
        let mut undefined = None;
        cut.look(quantity, |number, seen| {
            let change = &seen.change[..cut.axes.len()];
            let squares: f64 = change.iter().map(|change| change * change).sum();
            let mean = seen.mean();
            weights[0].push(mean);
            let square = mean * mean + squares / 12.0;
            weights[1].push(square);
            if !square.is_finite() && undefined.is_none() {
                undefined = Some(cut.centre(number, space));
            }
            for change in change {
                weights[0].push(change / 12.0);
                weights[1].push(2.0 * mean * change / 12.0);
            }
        });
        let places = cut.axes.iter().enumerate();
        let with_cells = places.filter(|&(_, &axis)| !space.axes()[axis].is_modes());
        Self {
            with_cells: with_cells.map(|(place, _)| place).collect(),
            cut,
            weights,
            undefined,
        }
    }

    pub(super) fn undefined(&self) -> Option<&[f64]> {
        self.undefined.as_deref()
    }

    pub(super) fn axes(&self) -> &[usize] {
        &self.cut.axes
    }

    /// Mean and mean square, from the masses of the cells of the axes that take part.
    pub(super) fn of(&self, masses: &[f64]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        self.each(masses, |_, parts| {
            sums.iter_mut()
                .zip(parts)
                .for_each(|(sum, part)| *sum += part);
        });
        sums
    }

    /// What each layer of cells across each of these axes adds to mean and mean square. Series along axes of modes have
    /// no layers: their waves cancel.
    pub(super) fn layers(&self, masses: &[f64]) -> Vec<Vec<[f64; 2]>> {
        let sub_cells = &self.cut.sub_cells;
        let mut layers: Vec<Vec<[f64; 2]>> = vec![Vec::new(); self.with_cells.len()];
        self.each(masses, |number, parts| {
            for (&axis, layers) in self.with_cells.iter().zip(&mut layers) {
                let cell = sub_cells.cell(number, axis);
                if layers.len() <= cell {
                    layers.resize(cell + 1, [0.0; 2]);
                }
                let sums = layers[cell].iter_mut().zip(parts);
                sums.for_each(|(sum, part)| *sum += part);
            }
        });
        layers
    }

    /// Looks at what each sub-cell adds to mean and mean square.
    fn each(&self, masses: &[f64], mut look: impl FnMut(usize, [f64; 2])) {
        let found = self.cut.sub_cells.apply(masses);
        let stride = found.len();
        for number in 0..self.cut.sub_cells.count() {
            let parts = [0, 1].map(|which| {
                let weights = &self.weights[which][number * stride..(number + 1) * stride];
                let terms = weights.iter().zip(&found);
                terms
                    .map(|(weight, values)| weight * values[number])
                    .sum::<f64>()
            });
            look(number, parts);
        }
    }
}
