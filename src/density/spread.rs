//! How the masses of cells spread over the bins of a quantity: its density, and its mean.
//!
//! Inside a sub-cell the quantity is taken as linear and the density too. The values of a linear function over a box
//! have a trapezoid for their density, whose integral over each bin is known, so that no mass jumps from bin to bin as
//! a point would: the counts of neighbouring bins differ by what the density does. The first moment is exact to fourth
//! order in the sub-cell; what is left is the bend of the level lines inside sub-cells that a bin's edge crosses, and
//! has no sign. A second map with coarser sub-cells and polynomials of lower degree shows how much that is.

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

    /// Cells that a polynomial goes through.
    fn window(self) -> usize {
        match self {
            Self::Fine => 7,
            Self::Coarse => 5,
            Self::Sampled => 3,
        }
    }
}

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
        detail: Detail,
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
        let cells = cut.iter().map(|axis| axis.count()).product();
        let place = |number: usize| axes.iter().position(|&axis| axis == number);
        let planes: Vec<(usize, f64)> = planes
            .iter()
            .filter_map(|&(axis, at)| Some((place(axis)?, at)))
            .collect();
        let parts = detail.parts(cells, axes.len());
        Self {
            sub_cells: SubCells::new(&cut, parts, detail.window(), &planes),
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
    fn look(&self, quantity: &BoundQuantity, mut see: impl FnMut(usize, &Seen)) {
        let count = self.sub_cells.count();
        let mut edges = vec![[(0.0, 0.0); LANES]; self.axes.len()];
        let mut own = vec![(0.0, 0.0); self.axes.len()];
        let mut states: Vec<Lanes> = vec![[0.0; LANES]; self.dimension];
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
            let mut seen: Vec<Seen> = centre
                .iter()
                .map(|&value| Seen::new(value, self.axes.len()))
                .collect();
            for (index, &axis) in self.axes.iter().enumerate() {
                if !quantity.states()[axis] {
                    continue;
                }
                let kept = states[axis];
                let [low, high] = [0, 1].map(|end| {
                    for lane in 0..LANES {
                        let ends = edges[index][lane];
                        states[axis][lane] = if end == 0 { ends.0 } else { ends.1 };
                    }
                    quantity.values(&states)
                });
                states[axis] = kept;
                for (lane, seen) in seen.iter_mut().enumerate() {
                    seen.add(index, centre[lane], low[lane], high[lane]);
                }
            }
            for (lane, seen) in seen.iter().enumerate().take(count - start) {
                see(start + lane, seen);
            }
        }
    }
}

/// A quantity in a sub-cell.
#[derive(Debug, Clone)]
struct Seen {
    /// Its mean, to fourth order.
    mean: f64,
    /// Its change from end to end along each axis.
    change: Vec<f64>,
    lowest: f64,
    highest: f64,
}

impl Seen {
    fn new(centre: f64, axes: usize) -> Self {
        Self {
            mean: centre,
            change: vec![0.0; axes],
            lowest: centre,
            highest: centre,
        }
    }

    fn add(&mut self, axis: usize, centre: f64, low: f64, high: f64) {
        self.mean += (low + high - 2.0 * centre) / 6.0;
        self.change[axis] = high - low;
        self.lowest = self.lowest.min(low).min(high);
        self.highest = self.highest.max(low).max(high);
    }

    /// The widths of the trapezoid, the larger first: those of the largest change, and of all others together.
    fn widths(&self) -> (f64, f64) {
        let largest = self.change.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let squares: f64 = self.change.iter().map(|change| change * change).sum();
        let rest = (squares - largest * largest).max(0.0).sqrt();
        (largest.max(rest), largest.min(rest))
    }
}

/// Mass below, and density at, an offset from the mean of the sum of two uniform variables of widths `a` ≥ `b`.
fn trapezoid(offset: f64, a: f64, b: f64) -> (f64, f64) {
    let t = offset.abs();
    let (inner, outer) = (0.5 * (a - b), 0.5 * (a + b));
    let (above, density) = if t >= outer {
        (0.0, 0.0)
    } else if t > inner {
        let left = outer - t;
        (left * left / (2.0 * a * b), left / (a * b))
    } else {
        (0.5 - t / a, 1.0 / a)
    };
    (if offset > 0.0 { 1.0 - above } else { above }, density)
}

/// Share of a bin's width below which a sub-cell has one value.
const POINT: f64 = 1e-9;
/// Share of a bin's width by which a value may lie beyond the end of the bins from rounding.
const ROUNDING: f64 = 1e-6;

/// A share of a sub-cell's mass: bin, share, and the share's change by a shift of the quantity.
type Share = (usize, f64, f64);

/// The bins that a sub-cell's values fall into. Where none of the values that were looked at lies beyond an end,
/// nothing does.
fn shares(bins: &Axis, seen: &Seen, shares: &mut Vec<Share>) {
    shares.clear();
    let (a, b) = seen.widths();
    if !(seen.mean.is_finite() && a.is_finite()) {
        return;
    }
    let ends = (bins.from(), bins.to());
    let last = bins.count() - 1;
    let within = (
        seen.lowest >= ends.0 - ROUNDING * bins.width(0),
        seen.highest <= ends.1 + ROUNDING * bins.width(last),
    );
    let mean = match within {
        (true, true) => seen.mean.clamp(ends.0, ends.1),
        (true, false) => seen.mean.max(ends.0),
        (false, true) => seen.mean.min(ends.1),
        (false, false) => seen.mean,
    };
    let reach = 0.5 * (a + b);
    let (low, high) = ((mean - reach).max(ends.0), (mean + reach).min(ends.1));
    let (Some(first), true) = (bins.find(low), low <= high) else {
        return;
    };
    if a <= POINT * bins.width(first) {
        shares.push((first, 1.0, 0.0));
        return;
    }
    let at = |edge: usize| match edge {
        0 if within.0 => (0.0, 0.0),
        edge if edge > last && within.1 => (1.0, 0.0),
        edge => trapezoid(bins.edges()[edge] - mean, a, b),
    };
    let mut below = at(first);
    for bin in first..=last {
        let above = at(bin + 1);
        shares.push((bin, above.0 - below.0, below.1 - above.1));
        below = above;
        if bins.edges()[bin + 1] >= high {
            break;
        }
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
        let cut = Cut::new(space, coordinates, detail, planes);
        let count = cut.sub_cells.count();
        let seen = |coordinate: &Coordinate| {
            let mut found: Vec<(Vec<Share>, Vec<f64>)> = Vec::with_capacity(count);
            match coordinate {
                Coordinate::Axis(axis) => {
                    let place = cut.axes.iter().position(|own| own == axis).unwrap_or(0);
                    let cell = |number| vec![(cut.sub_cells.cell(number, place), 1.0, 0.0)];
                    found.extend((0..count).map(|number| (cell(number), Vec::new())));
                }
                Coordinate::Quantity(quantity, bins) => {
                    let mut own = Vec::new();
                    cut.look(quantity, |_, seen| {
                        shares(bins, seen, &mut own);
                        found.push((own.clone(), seen.change.clone()));
                    });
                }
            }
            found
        };
        let columns = match coordinates.get(1) {
            None => 1,
            Some(Coordinate::Axis(axis)) => space.axes()[*axis].count(),
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
        let whole = (vec![(0, 1.0, 0.0)], Vec::new());
        for (number, one) in first.iter().enumerate() {
            let other = second.as_ref().map_or(&whole, |second| &second[number]);
            spread.add(one, other, columns);
        }
        spread
    }

    /// Adds the entries of the next sub-cell.
    fn add(
        &mut self,
        one: &(Vec<Share>, Vec<f64>),
        other: &(Vec<Share>, Vec<f64>),
        columns: usize,
    ) {
        let change = |of: &Vec<f64>, axis: usize| of.get(axis).copied().unwrap_or(0.0) / 12.0;
        for &(row, a, shifted_a) in &one.0 {
            for &(column, b, shifted_b) in &other.0 {
                self.bins.push((row * columns + column) as u32);
                self.weights.push(a * b);
                for axis in 0..self.cut.axes.len() {
                    let shift = change(&one.1, axis) * shifted_a * b
                        + change(&other.1, axis) * shifted_b * a;
                    self.weights.push(shift);
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
        let cut = Cut::new(space, &coordinates, detail, planes);
        let mut weights = [Vec::new(), Vec::new()];
        let mut undefined = None;
        cut.look(quantity, |number, seen| {
            let squares: f64 = seen.change.iter().map(|change| change * change).sum();
            weights[0].push(seen.mean);
            let square = seen.mean * seen.mean + squares / 12.0;
            weights[1].push(square);
            if !square.is_finite() && undefined.is_none() {
                undefined = Some(cut.centre(number, space));
            }
            for change in &seen.change {
                weights[0].push(change / 12.0);
                weights[1].push(2.0 * seen.mean * change / 12.0);
            }
        });
        Self {
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
        let found = self.cut.sub_cells.apply(masses);
        let stride = found.len();
        [0, 1].map(|which| {
            let weights = self.weights[which].chunks(stride).enumerate();
            weights
                .map(|(number, weights)| {
                    let terms = weights.iter().zip(&found);
                    terms
                        .map(|(weight, values)| weight * values[number])
                        .sum::<f64>()
                })
                .sum()
        })
    }
}
